// The CUDA version up to the device: the kernels' text, the driver behind a stand-in, what is refused and in
// which words.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <dlfcn.h>
#include <doctest/doctest.h>

#include <cstdlib>
#include <numeric>
#include <thread>

#include "engine/base/error.h"
#include "engine/base/random.h"
#include "engine/raster/cuda/cuda_factory.h"
#include "engine/raster/cuda/device_sort.h"
#include "engine/raster/cuda/driver.h"
#include "engine/raster/cuda/emulated_device.h"
#include "engine/raster/cuda/self_check.h"
#include "tests/agree/raster/scenes.h"
#include "tests/test_paths.h"

namespace cuda_test {

using namespace gse;
using namespace gse::raster;

namespace {

/// False where the build had no clang: the case is to return and counts as skipped.
bool has_kernels() {
    if (!cuda::kernel_text().empty()) return true;
    test::skip("this build has no CUDA kernels (clang was not found)");
    return false;
}

/// Fault of the stand-in while this lives.
class Wrong {
public:
    explicit Wrong(const char* what) { setenv("GSE_FAKE_DRIVER", what, 1); }
    ~Wrong() { unsetenv("GSE_FAKE_DRIVER"); }
    Wrong(const Wrong&) = delete;
    Wrong& operator=(const Wrong&) = delete;
};

std::unique_ptr<Rasterizer> by_stand_in() {
    return cuda::make_checked_rasterizer(cuda::open_cuda_device(GSE_FAKE_CUDA_DRIVER));
}

std::string refusal(const char* what) {
    const Wrong wrong(what);
    try {
        by_stand_in();
    } catch (const Error& error) { return error.what(); }
    return "nothing was refused";
}

int leaks() {
    void* library = dlopen(GSE_FAKE_CUDA_DRIVER, RTLD_NOW);  // the very same as long as it is open
    DOCTEST_REQUIRE(library != nullptr);
    const auto count = reinterpret_cast<int (*)()>(dlsym(library, "fake_driver_leaks"));
    DOCTEST_REQUIRE(static_cast<bool>(count));
    const int result = count();
    dlclose(library);
    return result;
}

std::vector<std::uint32_t> downloaded(cuda::Device& device, const std::uint32_t* from, std::size_t count) {
    std::vector<std::uint32_t> values(count);
    if (count > 0) device.download(values.data(), from, count * sizeof(std::uint32_t));
    return values;
}

}  // namespace

DOCTEST_TEST_CASE("the kernels' text has every kernel and needs nothing that it has not") {
    if (!has_kernels()) return;
    const std::string& text = cuda::kernel_text();
    for (const char* name : cuda::KernelNames) {
        DOCTEST_CAPTURE(name);
        DOCTEST_CHECK(text.find(std::string(".visible .entry ") + name + "(") != std::string::npos);
    }
    std::size_t entries = 0;
    for (auto at = text.find(".entry"); at != std::string::npos; at = text.find(".entry", at + 1)) ++entries;
    DOCTEST_CHECK(entries == std::size(cuda::KernelNames));
    DOCTEST_CHECK(text.find(".target sm_60") != std::string::npos);
    DOCTEST_CHECK(text.find(".extern") == std::string::npos);  // a function of a library that no device has
    DOCTEST_CHECK(text.find(".func") == std::string::npos);    // all is in the kernels
    DOCTEST_CHECK(text.find(".local") == std::string::npos);   // no array that had to leave the registers
    DOCTEST_CHECK(text.find("fma.rn.f64") != std::string::npos);
    DOCTEST_CHECK(text.find("mul.f64") == std::string::npos);  // the driver would be free to fuse these
    DOCTEST_CHECK(text.find("mul.f32") == std::string::npos);
}

DOCTEST_TEST_CASE(
    "the CUDA rasterizer through a driver draws what the emulation draws, on any thread, and gives "
    "everything back") {
    if (!has_kernels()) return;
    void* keep = dlopen(GSE_FAKE_CUDA_DRIVER, RTLD_NOW);
    DOCTEST_REQUIRE(keep != nullptr);
    {
        const auto rasterizer = by_stand_in();
        DOCTEST_CHECK(rasterizer->name() == "cuda");
        const GaussianData data = test::random_scene({.count = 300, .seed = 5});
        const Camera camera = test::test_camera(60, 45);
        const Image d_colour = test::noise_image(60, 45, 3, 1);
        ForwardOutput image, expected;
        Gradients gradients, expected_gradients;
        std::thread([&] {
            rasterizer->forward(spans(data), camera, {}, image);
            rasterizer->backward(d_colour, {}, 0, gradients);
        }).join();
        const auto emulated = cuda::make_emulated_cuda_rasterizer();
        emulated->forward(spans(data), camera, {}, expected);
        emulated->backward(d_colour, {}, 0, expected_gradients);
        DOCTEST_CHECK(test::identical(image, expected));
        DOCTEST_CHECK(test::identical(gradients, expected_gradients));
        DOCTEST_CHECK(leaks() > 0);
    }
    DOCTEST_CHECK(leaks() == 0);
    for (const char* what : {"text", "memory", "launch", "result", "old", "no device"}) {
        DOCTEST_CAPTURE(what);
        refusal(what);
        DOCTEST_CHECK(leaks() == 0);
    }
    dlclose(keep);
}

DOCTEST_TEST_CASE("what a driver cannot do is said in one sentence") {
    if (!has_kernels()) return;
    DOCTEST_CHECK(refusal("no device") ==
                  "the CUDA driver finds no device on this machine; use the rasterizer \"cpu\"");
    DOCTEST_CHECK(refusal("empty") ==
                  "the CUDA driver finds no device on this machine; use the rasterizer \"cpu\"");
    DOCTEST_CHECK(
        refusal("old") ==
        "Fake 9000 has compute capability 5.2, but the kernels need 6.0; use the rasterizer \"cpu\"");
    DOCTEST_CHECK(refusal("memory").starts_with("Fake 9000 has no 1 MiB of memory left; "));
    DOCTEST_CHECK(
        refusal("launch").starts_with("the CUDA driver cannot launch gse_blend: something is wrong"));
    const std::string text = refusal("text");
    DOCTEST_CHECK(
        text.starts_with("the CUDA driver cannot translate the kernels for Fake 9000 (ptxas: line 7"));
    DOCTEST_CHECK(text.find('\n') == std::string::npos);
    DOCTEST_CHECK(text.find("CUDA_ERROR_INVALID_PTX") != std::string::npos);
}

DOCTEST_TEST_CASE("a device that computes something else is refused, with figures") {
    if (!has_kernels()) return;
    const std::string said = refusal("result");
    DOCTEST_CAPTURE(said);
    DOCTEST_CHECK(
        said.starts_with("Fake 9000 draws a test scene otherwise than the processor does: picture "));
    DOCTEST_CHECK(said.find("gradients ") != std::string::npos);
    DOCTEST_CHECK(said.find("report these figures") != std::string::npos);
}

DOCTEST_TEST_CASE(
    "without a driver CUDA is refused in one sentence, and the choice by name knows three names") {
    if (!has_kernels()) return;
    try {
        cuda::open_cuda_device("libgse_no_such_driver.so.1");
        DOCTEST_FAIL("a driver that is not there was opened");
    } catch (const Error& error) {
        DOCTEST_CHECK(error.code() == ErrorCode::NotFound);
        DOCTEST_CHECK(
            std::string(error.what()) ==
            "there is no CUDA driver (libgse_no_such_driver.so.1) on this machine; install NVIDIA's "
            "driver, or use the rasterizer \"cpu\"");
    }
    ThreadPool pool(1);
    const std::string usual = make_fast_rasterizer(pool)->name();
    DOCTEST_CHECK(make_rasterizer("cpu", pool)->name() == usual);
    DOCTEST_CHECK(make_rasterizer("auto", pool)->name() == usual);
    DOCTEST_CHECK_THROWS_AS(make_rasterizer("opencl", pool), Error);
    std::string why;
    if (!cuda_usable(&why)) {
        DOCTEST_CHECK(!why.empty());
        DOCTEST_CHECK_THROWS_AS(make_rasterizer("cuda", pool), Error);
    } else {
        DOCTEST_CHECK(make_rasterizer("cuda", pool)->name() == "cuda");
    }
}

DOCTEST_TEST_CASE(
    "sums and sorting on the device are those of the processor, over several levels of blocks") {
    const auto device = cuda::make_emulated_device();
    cuda::DeviceScan scan(*device);
    cuda::DeviceSort sort(*device);
    Random random(3);
    for (const std::size_t count : {1u, 7u, 2047u, 2048u, 2049u, 300000u, 4300000u}) {
        DOCTEST_CAPTURE(count);
        std::vector<std::uint32_t> values(count), expected(count);
        for (auto& value : values) value = static_cast<std::uint32_t>(random.below(40));
        std::exclusive_scan(values.begin(), values.end(), expected.begin(), 0u);
        cuda::DeviceArray<std::uint32_t> array(*device);
        array.upload(values);
        DOCTEST_CHECK(scan.total(array.data(), array.data(), count) == expected.back() + values.back());
        DOCTEST_CHECK(downloaded(*device, array.data(), count) == expected);
        if (count > 300000) continue;  // of which the sort has several levels already
        array.upload(values);
        const auto sorted = sort.sort(array.data(), count, 6);
        std::vector<std::uint32_t> places(count);
        std::iota(places.begin(), places.end(), 0u);
        std::stable_sort(places.begin(), places.end(), [&](auto a, auto b) { return values[a] < values[b]; });
        DOCTEST_CHECK(downloaded(*device, sorted.places, count) == places);
        std::sort(values.begin(), values.end());
        DOCTEST_CHECK(downloaded(*device, sorted.keys, count) == values);
    }
}

DOCTEST_TEST_CASE("sums on the device stop at the largest number instead of beginning anew") {
    const auto device = cuda::make_emulated_device();
    cuda::DeviceScan scan(*device);
    cuda::DeviceArray<std::uint32_t> array(*device);
    array.upload(std::vector<std::uint32_t>(5000, 1u << 20));
    DOCTEST_CHECK(scan.total(array.data(), array.data(), 5000) == cuda::Saturated);
}

}  // namespace cuda_test
