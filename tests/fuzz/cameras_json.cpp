// Fuzz target: the cameras.json of 3DGS training.
#include "engine/io/cameras/cameras.h"
#include "tests/fuzz/fuzz_helpers.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace gse;
    return fuzz::exercise([&] {
        for (const View& view : parse_cameras_json({reinterpret_cast<const char*>(data), size}).views)
            GSE_CHECK(view.camera.fx > 0 && view.camera.width > 0 &&
                      std::isfinite(view.camera.translation.x));
    });
}
