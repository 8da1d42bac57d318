// Once warm, rendering and differentiating allocate nothing: every allocation of the program is counted here.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "engine/raster/view_session.h"
#include "tests/agree/raster/scenes.h"

namespace {

std::atomic<std::size_t> allocations{0};

void* take(std::size_t size, std::size_t alignment) {
    allocations.fetch_add(1, std::memory_order_relaxed);
    void* memory = std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
    if (memory == nullptr) throw std::bad_alloc();
    return memory;
}

}  // namespace

void* operator new(std::size_t size) { return take(size == 0 ? 16 : size, 16); }
void* operator new(std::size_t size, std::align_val_t alignment) {
    return take(size, static_cast<std::size_t>(alignment));
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
    return take(size == 0 ? 16 : size, 16);
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }

DOCTEST_TEST_CASE("no allocation once warm") {
    using namespace gse;
    const GaussianData data = test::random_scene({.count = 6000, .seed = 91, .log_scale = -3.5});
    const Camera camera = test::test_camera(100, 80);
    ThreadPool pool(2);
    const auto rasterizer = raster::make_fast_rasterizer(pool);
    raster::ForwardOutput image;
    raster::Gradients gradients;
    const Image d_colour = test::noise_image(camera.width, camera.height, 3, 1);
    const Image mask(camera.width, camera.height, 1, 1.0f);
    std::vector<double> masked(data.size()), total(data.size());
    Image values_image;
    const std::vector<float> values(data.size(), 0.5f);
    std::size_t before = 0;
    for (int round = 0; round < 3; ++round) {
        if (round == 1) before = allocations.load();
        rasterizer->forward(spans(data), camera, {}, image);
        rasterizer->backward(d_colour, {}, 1000, gradients);
        rasterizer->contributions(spans(data), camera, {}, mask, masked, total);
        rasterizer->forward_values(spans(data), camera, {}, values, values_image);
    }
    DOCTEST_CHECK(before > 0);
    DOCTEST_CHECK(allocations.load() == before);
}

DOCTEST_TEST_CASE("no allocation in a view session once its views are prepared") {
    using namespace gse;
    const GaussianData data = test::random_scene({.count = 6000, .seed = 92, .log_scale = -3.5});
    const Camera cameras[] = {test::test_camera(100, 80), test::test_camera(64, 90)};
    const Image d_colours[] = {test::noise_image(100, 80, 3, 1), test::noise_image(64, 90, 3, 1)};
    ThreadPool pool(2);
    const auto rasterizer = raster::make_fast_rasterizer(pool);
    const auto session = rasterizer->view_session(2, std::size_t{64} << 20);
    raster::ForwardOutput image;
    raster::Gradients gradients;
    std::size_t before = 0;
    for (int round = 0; round < 3; ++round) {
        if (round == 1) before = allocations.load();
        for (std::size_t view = 0; view < 2; ++view) {
            session->forward(view, spans(data), 5500, cameras[view], {}, image);
            session->backward(d_colours[view], {}, gradients);
        }
    }
    DOCTEST_CHECK(before > 0);
    DOCTEST_CHECK(allocations.load() == before);
    DOCTEST_CHECK(session->work().continued == 6);
}
