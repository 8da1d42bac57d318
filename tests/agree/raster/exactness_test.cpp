// Results must not depend on the number of threads, on what was rendered before, or on which rows want
// gradients.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>

#include "engine/raster/cuda/emulated_device.h"
#include "engine/raster/fast_frame.h"
#include "tests/agree/raster/scenes.h"

namespace exactness_test {

using namespace gse;
using namespace gse::raster;

namespace {

struct Results {
    ForwardOutput image;
    Gradients gradients;
    std::vector<double> masked, total;
};

Results run(Rasterizer& rasterizer, const GaussianData& data, const Camera& camera, std::size_t first_row) {
    Results results;
    const Image d_colour = test::noise_image(camera.width, camera.height, 3, 1);
    const Image d_alpha = test::noise_image(camera.width, camera.height, 1, 2);
    rasterizer.forward(spans(data), camera, {}, results.image);
    rasterizer.backward(d_colour, d_alpha, first_row, results.gradients);
    results.masked.resize(data.size());
    results.total.resize(data.size());
    rasterizer.contributions(spans(data), camera, {}, d_alpha, results.masked, results.total);
    return results;
}

bool identical(const Results& a, const Results& b) {
    return test::identical(a.image, b.image) && test::identical(a.gradients, b.gradients) &&
           a.masked == b.masked && a.total == b.total;
}

template <class Values> Values tail(const Values& all, std::size_t begin) {
    return {all.begin() + static_cast<std::ptrdiff_t>(begin), all.end()};
}

}  // namespace

DOCTEST_TEST_CASE("bit-identical for any number of threads and when repeated") {
    // Enough rows for several chunks of rows and parts of the depth order.
    const GaussianData data = test::random_scene({.count = 20000, .seed = 51, .log_scale = -3.8});
    const GaussianData other = test::random_scene({.count = 700, .seed = 52});
    const Camera camera = test::test_camera(150, 110);
    for (const std::string& kernels : raster::usable_kernels()) {
        DOCTEST_CAPTURE(kernels);
        ThreadPool one(1);
        const Results expected = run(*raster::make_fast_rasterizer(one, kernels), data, camera, 0);
        for (const unsigned threads : {2u, 3u, 8u}) {
            DOCTEST_CAPTURE(threads);
            ThreadPool pool(threads);
            const auto rasterizer = raster::make_fast_rasterizer(pool, kernels);
            DOCTEST_CHECK(identical(run(*rasterizer, data, camera, 0), expected));
            run(*rasterizer, other, test::test_camera(64, 48),
                100);  // leaves other numbers in the scratch memory
            DOCTEST_CHECK(identical(run(*rasterizer, data, camera, 0), expected));
        }
    }
}

DOCTEST_TEST_CASE("a restriction to rows gives exactly the tail of the full gradient") {
    const GaussianData data = test::random_scene({.count = 5000, .seed = 61, .log_scale = -3.2});
    const Camera camera = test::test_camera(90, 75);
    ThreadPool pool(2);
    std::vector<std::unique_ptr<Rasterizer>> all;
    all.push_back(make_plain_rasterizer());
    for (const std::string& kernels : raster::usable_kernels())
        all.push_back(raster::make_fast_rasterizer(pool, kernels));
    all.push_back(raster::cuda::make_emulated_cuda_rasterizer());
    for (const auto& rasterizer : all) {
        DOCTEST_CAPTURE(rasterizer->name());
        const Gradients full = run(*rasterizer, data, camera, 0).gradients;
        const std::size_t stride = data.sh_stride();
        for (const std::size_t first : {1u, 999u, 1024u, 3100u, 4999u, 5000u}) {
            DOCTEST_CAPTURE(first);
            const Gradients part = run(*rasterizer, data, camera, first).gradients;
            Gradients expected;
            expected.position = tail(full.position, first * 3);
            expected.log_scale = tail(full.log_scale, first * 3);
            expected.rotation = tail(full.rotation, first * 4);
            expected.opacity_logit = tail(full.opacity_logit, first);
            expected.sh = tail(full.sh, first * stride);
            expected.mean2d_norm = tail(full.mean2d_norm, first);
            expected.visible = tail(full.visible, first);
            DOCTEST_CHECK(test::identical(part, expected));
        }
    }
}

DOCTEST_TEST_CASE("gradients that go past the caches are those that do not") {
    // 450,000 rows: coefficients and slots are more than Frame keeps in caches, those of the last rows are
    // not.
    const GaussianData data = test::random_scene({.count = 450000, .seed = 81, .log_scale = -5});
    const std::size_t stride = data.sh_stride(), first = data.size() - 3001;
    const Camera camera = test::test_camera(480, 360);
    ThreadPool pool(2);
    for (const std::string& kernels : raster::usable_kernels()) {
        DOCTEST_CAPTURE(kernels);
        const auto rasterizer = raster::make_fast_rasterizer(pool, kernels);
        const Results full = run(*rasterizer, data, camera, 0);
        DOCTEST_REQUIRE(full.gradients.sh.size() * sizeof(float) > CachedBytes);
        DOCTEST_REQUIRE(full.image.pairs * sizeof(PartialSlot) > CachedBytes);
        const Gradients part = run(*rasterizer, data, camera, first).gradients;
        DOCTEST_CHECK(part.sh == tail(full.gradients.sh, first * stride));
        DOCTEST_CHECK(part.position == tail(full.gradients.position, first * 3));
        DOCTEST_CHECK(part.rotation == tail(full.gradients.rotation, first * 4));
        DOCTEST_CHECK(part.visible == tail(full.gradients.visible, first));
        std::size_t unseen = 0;
        for (std::size_t row = 0; row < data.size(); ++row) {
            if (full.gradients.visible[row] != 0) continue;
            ++unseen;
            const auto begin = full.gradients.sh.begin() + static_cast<std::ptrdiff_t>(row * stride);
            if (std::any_of(begin, begin + static_cast<std::ptrdiff_t>(stride),
                            [](float value) { return value != 0.0f; }))
                DOCTEST_FAIL("row " << row);
        }
        DOCTEST_CHECK(unseen > 1000);
    }
}

DOCTEST_TEST_CASE("rows that were not drawn get exact zeros") {
    GaussianData data = test::random_scene({.count = 300, .seed = 71});
    for (std::size_t row = 0; row < data.size(); row += 3) data.opacity_logit[row] = -20.0f;
    const Camera camera = test::test_camera(64, 64);
    ThreadPool pool(2);
    for (const std::string& kernels : raster::usable_kernels()) {
        const auto rasterizer = raster::make_fast_rasterizer(pool, kernels);
        const Gradients g = run(*rasterizer, data, camera, 0).gradients;
        std::size_t seen = 0;
        for (std::size_t row = 0; row < data.size(); ++row) {
            seen += g.visible[row];
            if (row % 3 != 0) continue;
            DOCTEST_CHECK(g.visible[row] == 0);
            DOCTEST_CHECK(g.position[row * 3] == 0.0f);
            DOCTEST_CHECK(g.opacity_logit[row] == 0.0f);
            DOCTEST_CHECK(g.sh[row * data.sh_stride()] == 0.0f);
        }
        DOCTEST_CHECK(seen > 100);
    }
}

/// Sets GSE_CPU while it lives; an empty name leaves the choice to the program.
class ForcedCpu {
public:
    explicit ForcedCpu(const std::string& name) {
        if (const char* old = std::getenv("GSE_CPU")) old_ = old;
        name.empty() ? unsetenv("GSE_CPU") : setenv("GSE_CPU", name.c_str(), 1);
    }
    ~ForcedCpu() { old_.empty() ? unsetenv("GSE_CPU") : setenv("GSE_CPU", old_.c_str(), 1); }
    ForcedCpu(const ForcedCpu&) = delete;
    ForcedCpu& operator=(const ForcedCpu&) = delete;

private:
    std::string old_;
};

DOCTEST_TEST_CASE("GSE_CPU forces an instruction set and refuses what it does not know") {
    ThreadPool pool(1);
    const auto name_under = [&pool](const char* forced_name) {
        const ForcedCpu forced(forced_name);
        return raster::make_fast_rasterizer(pool)->name();
    };
    DOCTEST_CHECK(name_under("scalar") == "scalar");
    DOCTEST_CHECK(name_under("") == raster::usable_kernels().front());  // the best is the default
    DOCTEST_CHECK_THROWS_AS(name_under("sse9"), Error);
}

}  // namespace exactness_test
