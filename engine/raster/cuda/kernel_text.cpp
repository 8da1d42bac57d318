// The kernels' PTX text, if the build had a compiler for it.
#include "engine/raster/cuda/driver.h"

#ifdef GSE_CUDA_TEXT
#include GSE_CUDA_TEXT
#else
namespace gse::raster::cuda {
constexpr const char* KernelText = "";
}
#endif

namespace gse::raster::cuda {

const std::string& kernel_text() {
    static const std::string text = KernelText;
    return text;
}

}  // namespace gse::raster::cuda
