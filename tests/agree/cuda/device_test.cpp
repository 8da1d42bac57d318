// The CUDA rasterizer on a device, where there is one: a program of its own, so that what was left out is
// seen.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "engine/raster/cuda/emulated_device.h"
#include "tests/agree/raster/cuda_cases.h"
#include "tests/test_paths.h"

namespace device_test {

using namespace gse;
using namespace gse::raster;

namespace {

// 2^x of a device is good to 2^-22, and sums of tiles are added in another order: twice what the vector
// kernels are held to.
constexpr double DeviceTolerance = 2;

}  // namespace

DOCTEST_TEST_CASE("a CUDA device agrees with the plain version and with the emulation") {
    std::string why;
    if (!cuda_usable(&why)) {
        test::skip(why);
        return;
    }
    const auto device = make_cuda_rasterizer();
    const auto emulated = cuda::make_emulated_cuda_rasterizer();
    for (const test::Case& c : test::device_cases()) {
        DOCTEST_CAPTURE(c.name);
        test::compare(c, *device, DeviceTolerance);
        const GaussianData data = test::random_scene(c.recipe);
        const Camera camera = test::test_camera(c.width, c.height, c.distance);
        const test::Everything found = test::run(*device, data, camera, c.settings);
        DOCTEST_CHECK(test::identical(test::run(*device, data, camera, c.settings), found));
        DOCTEST_CHECK(found.image.pairs == test::run(*emulated, data, camera, c.settings).image.pairs);
    }
}

}  // namespace device_test
