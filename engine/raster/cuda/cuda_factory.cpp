// Makes the CUDA rasterizer only on a device that draws as the processor does; choice of a rasterizer by
// name.
#include <fmt/format.h>

#include "engine/base/error.h"
#include "engine/base/printable.h"
#include "engine/raster/cuda/cuda_factory.h"
#include "engine/raster/cuda/device_rasterizer.h"
#include "engine/raster/cuda/driver.h"
#include "engine/raster/cuda/self_check.h"
#include "engine/raster/rasterizer.h"

namespace gse::raster {

namespace cuda {

std::unique_ptr<Rasterizer> make_checked_rasterizer(std::unique_ptr<Device> device) {
    const std::string what = device->name();
    auto rasterizer = make_device_rasterizer(std::move(device), "cuda");
    require_agreement(*rasterizer, what);
    return rasterizer;
}

}  // namespace cuda

std::unique_ptr<Rasterizer> make_cuda_rasterizer() {
    return cuda::make_checked_rasterizer(cuda::open_cuda_device());
}

bool cuda_usable(std::string* why) {
    try {
        make_cuda_rasterizer();
        return true;
    } catch (const Error& error) {
        if (why != nullptr) *why = error.what();
        return false;
    }
}

std::unique_ptr<Rasterizer> make_rasterizer_of(const std::string& kernels, ThreadPool& pool) {
    return kernels == "cuda" ? make_cuda_rasterizer() : make_fast_rasterizer(pool, kernels);
}

std::unique_ptr<Rasterizer> make_rasterizer(const std::string& choice, ThreadPool& pool) {
    if (choice == "cuda") return make_cuda_rasterizer();
    if (choice == "auto" || choice == "cpu") return make_fast_rasterizer(pool);
    throw Error(ErrorCode::InvalidArgument, fmt::format("there is no rasterizer \"{}\"", printable(choice)),
                "choose auto, cpu or cuda");
}

void require_rasterizer(const std::string& choice) {
    ThreadPool pool(1);
    make_rasterizer(choice, pool);
}

}  // namespace gse::raster
