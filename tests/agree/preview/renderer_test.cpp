// The renderer around the picture: skipping, slices, new scenes, picking, depth, far worlds.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <cmath>

#include "engine/preview/splat_renderer.h"
#include "tests/agree/preview/device.h"
#include "tests/agree/raster/scenes.h"

namespace renderer_test {

using namespace gse;

namespace {

bool render(vulkan::Device& device, preview::SplatRenderer& renderer, const preview::FrameRequest& request,
            double upload_ms = 1e9) {
    bool drawn = false;
    device.run([&](vk::raii::CommandBuffer& commands) {
        drawn = renderer.render(static_cast<VkCommandBuffer>(*commands), request, upload_ms);
    });
    return drawn;
}

preview::FrameRequest small_request() {
    preview::FrameRequest request;
    request.camera = test::test_camera(96, 64);
    return request;
}

bool all_finite(const Image& image) {
    for (const float value : image.data)
        if (!std::isfinite(value)) return false;
    return true;
}

double largest_difference(const Image& a, const Image& b) {
    if (a.data.size() != b.data.size()) return INFINITY;
    double worst = 0;
    for (std::size_t i = 0; i < a.data.size(); ++i)
        worst = std::max(worst, std::abs(static_cast<double>(a.data[i]) - b.data[i]));
    return worst;
}

}  // namespace

DOCTEST_TEST_CASE("a frame is drawn only when something changed") {
    auto* shared = test::test_device();
    if (shared == nullptr) return;
    auto& device = *shared->device;
    preview::SplatRenderer renderer(device);
    auto request = small_request();
    const GaussianSet set{test::random_scene({.count = 200})};
    renderer.upload(set);
    DOCTEST_CHECK(render(device, renderer, request));
    DOCTEST_CHECK(!render(device, renderer, request));
    request.camera.translation.x += 0.01;
    DOCTEST_CHECK(render(device, renderer, request));
    request.display.mode = preview::Mode::Rings;
    DOCTEST_CHECK(render(device, renderer, request));
    DOCTEST_CHECK(!render(device, renderer, request));
    renderer.set_values(std::make_shared<std::vector<float>>(set.size(), 0.5f));
    DOCTEST_CHECK(render(device, renderer, request));
    request.want_depth = true;
    DOCTEST_CHECK(render(device, renderer, request));
    request.want_depth = false;  // more than is wanted is there
    DOCTEST_CHECK(!render(device, renderer, request));
    renderer.upload(set);  // the same arrays
    DOCTEST_CHECK(render(device, renderer, request));
    renderer.invalidate();
    DOCTEST_CHECK(render(device, renderer, request));
    DOCTEST_CHECK(shared->instance->message_count() == 0);
}

DOCTEST_TEST_CASE("an upload goes slice by slice and the old scene stays until it is complete") {
    auto* shared = test::test_device();
    if (shared == nullptr) return;
    auto& device = *shared->device;
    const GaussianSet small{test::random_scene({.count = 100, .seed = 5})};
    const GaussianSet large{test::random_scene({.count = 60000, .seed = 6, .log_scale = -4})};
    preview::SplatRenderer renderer(device);
    const auto request = small_request();
    renderer.upload(small);
    const Image before = renderer.draw(request);
    renderer.upload(large);
    int frames = 0;
    for (; renderer.uploading(); ++frames) {
        render(device, renderer, request, 0);  // one slice a frame
        if (renderer.uploading()) DOCTEST_CHECK(renderer.size() == 100);
    }
    DOCTEST_CHECK(frames > 3);
    DOCTEST_CHECK(renderer.size() == 60000);
    const Image after = renderer.draw(request);
    preview::SplatRenderer fresh(device);
    fresh.upload(large);
    DOCTEST_CHECK(largest_difference(after, fresh.draw(request)) == 0);
    DOCTEST_CHECK(largest_difference(after, before) > 0.1);

    // Only the colours are other ones: the rest is shared with the scene shown.
    GaussianData recoloured = large.to_data();
    for (float& value : recoloured.sh) value = -value;
    const GaussianSet changed{recoloured};
    renderer.upload(changed);
    const Image second = renderer.draw(request);
    fresh.upload(changed);
    DOCTEST_CHECK(largest_difference(second, fresh.draw(request)) == 0);
    DOCTEST_CHECK(shared->instance->message_count() == 0);
}

DOCTEST_TEST_CASE(
    "of a scene whose rows have changed in part only those are sent, and the picture is that of a fresh "
    "upload") {
    auto* shared = test::test_device();
    if (shared == nullptr) return;
    auto& device = *shared->device;
    const GaussianSet first{test::random_scene({.count = 30000, .seed = 7, .log_scale = -3.5})};
    const auto request = small_request();
    for (const bool stage : {false, true}) {
        preview::SplatRenderer renderer(device, {.always_stage = stage}), fresh(device);
        renderer.upload(first);
        renderer.draw(request);
        const std::uint64_t whole = renderer.sent_bytes();
        GaussianSet shown = first;
        for (const int part : {0, 1, 2, 3, 4, 5}) {
            GaussianData data = shown.to_data();
            for (std::size_t row = static_cast<std::size_t>(part); row < data.size();
                 row += part == 5 ? 1 : 97) {  // scattered; then all
                if (part == 0 || part == 5) data.position[row * 3 + 1] += 0.05f;
                if (part == 1) data.log_scale[row * 3] += 0.2f;
                if (part == 2) data.rotation[row * 4 + 2] += 0.3f;
                if (part == 3) data.opacity_logit[row] = row % 2 == 0 ? -8.0f : std::nanf("");
                if (part == 4) data.sh[row * (data.sh.size() / data.size()) + 1] += 0.4f;
            }
            const std::uint64_t before = renderer.sent_bytes();
            shown = GaussianSet{data};
            renderer.upload(shown);
            render(device, renderer, request, 0);  // begun, and replaced by the same
            renderer.upload(shown);
            const Image picture = renderer.draw(request);
            const std::uint64_t sent = renderer.sent_bytes() - before;
            if (part < 5) DOCTEST_CHECK(sent < whole / 20);
            DOCTEST_CHECK(sent > 0);
            fresh.upload(GaussianSet{});
            fresh.draw(request);
            fresh.upload(shown);
            DOCTEST_CHECK(largest_difference(picture, fresh.draw(request)) == 0);
        }
        const std::uint64_t before = renderer.sent_bytes();
        renderer.upload(GaussianSet{shown.to_data()});  // other arrays, the same values
        renderer.draw(request);
        DOCTEST_CHECK(renderer.sent_bytes() == before);
    }
    DOCTEST_CHECK(shared->instance->message_count() == 0);
}

DOCTEST_TEST_CASE("picking finds the splat and its depth, and the depth picture agrees") {
    auto* shared = test::test_device();
    if (shared == nullptr) return;
    auto& device = *shared->device;
    for (const bool portable : {false, true}) {
        GaussianData data = test::random_scene({.count = 40, .seed = 3, .opacity = 4, .opacity_spread = 0.1});
        const GaussianSet set{data};
        preview::SplatRenderer renderer(device, {.portable_blend = portable});
        renderer.upload(set);
        auto request = small_request();
        request.want_depth = true;
        render(device, renderer, request);
        const auto depth = renderer.depth();
        DOCTEST_REQUIRE(depth != nullptr);
        int hits = 0;
        for (std::size_t row = 0; row < set.size(); ++row) {
            const Vec3 p = request.camera.to_camera(
                {data.position[row * 3], data.position[row * 3 + 1], data.position[row * 3 + 2]});
            const int x = static_cast<int>(request.camera.fx * p.x / p.z + request.camera.cx);
            const int y = static_cast<int>(request.camera.fy * p.y / p.z + request.camera.cy);
            const auto pick = renderer.pick(x, y);
            if (x < 0 || y < 0 || x >= 96 || y >= 64) {
                DOCTEST_CHECK(!pick.has_value());
                continue;
            }
            DOCTEST_REQUIRE(pick.has_value());
            DOCTEST_CHECK(pick->depth <= p.z * (1 + 1e-5));  // nothing behind an opaque centre wins
            if (pick->row != row) continue;
            ++hits;
            DOCTEST_CHECK(pick->depth == doctest::Approx(p.z).epsilon(1e-5));
            DOCTEST_CHECK(depth->at(x, y, 0) == doctest::Approx(p.z).epsilon(0.25));
        }
        DOCTEST_CHECK(hits > 5);
        DOCTEST_CHECK(!renderer.pick(-1, 0).has_value());
    }
    DOCTEST_CHECK(shared->instance->message_count() == 0);
}

DOCTEST_TEST_CASE("a world far from the origin keeps its detail") {
    auto* shared = test::test_device();
    if (shared == nullptr) return;
    GaussianData data = test::random_scene({.count = 300, .seed = 4, .sh_degree = 0});
    // Steps of 1/16 are exact in float at 1e6, so that both scenes are the same but for the place.
    for (float& value : data.position) value = std::round(value * 16) / 16;
    const GaussianSet near_set{data};
    for (std::size_t row = 0; row < data.size(); ++row) data.position[row * 3] += 1e6f;
    const GaussianSet far_set{data};
    auto request = small_request();
    preview::SplatRenderer renderer(*shared->device);
    renderer.upload(near_set);
    const Image near_picture = renderer.draw(request);
    renderer.upload(far_set);
    request.camera.translation = request.camera.translation - request.camera.rotation * Vec3{1e6, 0, 0};
    DOCTEST_CHECK(largest_difference(renderer.draw(request), near_picture) <= 2.01 / 255);
}

DOCTEST_TEST_CASE("hostile values give finite pictures") {
    auto* shared = test::test_device();
    if (shared == nullptr) return;
    GaussianData data = test::random_scene({.count = 64, .seed = 9});
    const float hostile[] = {NAN, INFINITY, -INFINITY, 1e30f, -1e30f, 0.0f, 88.0f, -88.0f};
    for (std::size_t row = 0; row < data.size(); ++row) {
        const float value = hostile[row % 8];
        switch (row / 8) {
            case 0: data.position[row * 3] = value; break;
            case 1: data.log_scale[row * 3 + 1] = value; break;
            case 2: data.rotation[row * 4] = value; break;
            case 3: data.opacity_logit[row] = value; break;
            case 4: data.sh[row * data.sh_stride() + 5] = value; break;
            case 5:
                for (int k = 0; k < 3; ++k) data.log_scale[row * 3 + static_cast<std::size_t>(k)] = value;
                break;
            default: break;
        }
    }
    for (const auto mode :
         {preview::Mode::Beauty, preview::Mode::Centres, preview::Mode::Rings, preview::Mode::Ellipsoids})
        for (const bool portable : {false, true}) {
            preview::SplatRenderer renderer(*shared->device, {.portable_blend = portable});
            renderer.upload(GaussianSet{data});
            auto request = small_request();
            request.display.mode = mode;
            DOCTEST_CHECK(all_finite(renderer.draw_light(request)));
        }
    DOCTEST_CHECK(shared->instance->message_count() == 0);
}

DOCTEST_TEST_CASE("many splats that fill the picture are all binned") {
    auto* shared = test::test_device();
    if (shared == nullptr) return;
    // 3000 faint splats over 70 x 40 tiles: far more turns of a loop than llvmpipe makes.
    const GaussianSet set{test::random_scene(
        {.count = 3000, .seed = 12, .sh_degree = 0, .log_scale = 2, .opacity = -4.5, .opacity_spread = 0.1})};
    auto request = small_request();
    request.camera = test::test_camera(560, 320);
    preview::SplatRenderer fine(*shared->device), portable(*shared->device, {.portable_blend = true});
    fine.upload(set);
    portable.upload(set);
    const Image light = fine.draw_light(request);
    const auto statistics = fine.statistics();
    DOCTEST_CHECK(statistics.unfinished_rows == 0);
    DOCTEST_CHECK(statistics.dropped_pairs == 0);
    if (shared->device->info().timestamp_ns > 0) DOCTEST_CHECK(statistics.device_ms > 0);
    DOCTEST_CHECK(statistics.pairs > 1'500'000);
    raster::ForwardOutput truth;
    ThreadPool pool(2);
    raster::make_fast_rasterizer(pool)->forward(set.spans(), request.camera, {}, truth);
    double worst = 0, other = 0;
    const Image second = portable.draw_light(request);
    for (std::size_t i = 0; i < truth.alpha.data.size(); ++i) {
        worst = std::max(worst, std::abs(static_cast<double>(light.data[i * 6 + 3]) - truth.alpha.data[i]));
        other = std::max(other, std::abs(static_cast<double>(second.data[i * 6 + 3]) - truth.alpha.data[i]));
    }
    DOCTEST_CHECK(worst < 2e-3);
    DOCTEST_CHECK(other < 2e-3);
}

}  // namespace renderer_test
