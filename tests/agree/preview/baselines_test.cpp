// The display modes of the preview on the bundled scene, held against pictures.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <string>

#include "engine/io/scene/scene_file.h"
#include "engine/preview/splat_renderer.h"
#include "tests/agree/preview/device.h"
#include "tests/image_baseline.h"

namespace preview_baselines_test {

using namespace gse;

namespace {

constexpr std::array<const char*, 10> ModeNames{"beauty",    "centres", "rings",  "ellipsoids",
                                                "depth",     "opacity", "labels", "label_weight",
                                                "attention", "changed"};

/// One value per row that grows with the height, 0 at the lowest splat and 1 at the highest.
std::shared_ptr<const std::vector<float>> heights(const GaussianSet& set) {
    const auto positions = set.spans().position;
    std::vector<float> values(set.size());
    float lowest = positions[1], highest = positions[1];
    for (std::size_t row = 0; row < set.size(); ++row) {
        lowest = std::min(lowest, positions[row * 3 + 1]);
        highest = std::max(highest, positions[row * 3 + 1]);
    }
    for (std::size_t row = 0; row < set.size(); ++row)
        values[row] = (highest - positions[row * 3 + 1]) / (highest - lowest);
    return std::make_shared<const std::vector<float>>(std::move(values));
}

}  // namespace

DOCTEST_TEST_CASE("every display mode looks like its baseline") {
    auto* shared = test::test_device();
    if (shared == nullptr) return;
    const auto scene = load_scene_file(test::source_folder() / "assets/scenes/bear/scene.ply");
    preview::SplatRenderer renderer(*shared->device);
    renderer.upload(scene.gaussians);
    renderer.finish_upload();
    renderer.set_values(heights(scene.gaussians));
    preview::FrameRequest request;
    request.camera = Camera::look_at({1.1, -1.2, -1.9}, {0, -0.4, 0}, {0, -1, 0}, 0.8, 256, 192);
    request.display.background = {0.114f, 0.122f, 0.141f};
    Image beauty;
    for (std::size_t mode = 0; mode < ModeNames.size(); ++mode) {
        request.display.mode = static_cast<preview::Mode>(mode);
        request.display.tint_strength = request.display.mode == preview::Mode::Labels ? 0.6f : 0.0f;
        const Image picture = renderer.draw(request);
        test::check_baseline(std::string("preview/") + ModeNames[mode], picture, test::PreviewTolerance, 1);
        if (mode == 0) beauty = picture;
        // Another mode's picture would not pass, so the tolerance tells modes apart.
        if (mode > 0) DOCTEST_CHECK(test::changed_share(picture, beauty, test::PreviewTolerance) > 0.02);
    }
    DOCTEST_CHECK(shared->instance->message_count() == 0);
}

}  // namespace preview_baselines_test
