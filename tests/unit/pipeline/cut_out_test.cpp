// Things cut out of the picture by a box around them.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "engine/base/random.h"
#include "engine/edit/grabcut_segmenter.h"
#include "engine/pipeline/cut_out.h"

namespace {

using namespace gse;
using namespace gse::pipeline;

constexpr std::size_t BallRows = 3000, WallRows = 6000;

/// A red ball of radius 0.5 in front of a green wall; the ball's rows come first.
GaussianSet ball_and_wall() {
    Random random(4);
    GaussianData data;
    data.resize(BallRows + WallRows);
    for (std::size_t row = 0; row < BallRows + WallRows; ++row) {
        const bool ball = row < BallRows;
        float* at = &data.position[row * 3];
        if (ball) {
            const double z = random.uniform(-1, 1), turn = random.uniform(0, 6.2832), r = std::sqrt(1 - z * z);
            at[0] = static_cast<float>(0.5 * r * std::cos(turn)), at[1] = static_cast<float>(0.5 * r * std::sin(turn)), at[2] = static_cast<float>(0.5 * z);
        } else {
            at[0] = static_cast<float>(random.uniform(-2, 2)), at[1] = static_cast<float>(random.uniform(-2, 2)), at[2] = 1.5f;
        }
        for (int axis = 0; axis < 3; ++axis) data.log_scale[row * 3 + static_cast<std::size_t>(axis)] = ball ? -3.2f : -2.8f;
        data.rotation[row * 4] = 1;
        data.opacity_logit[row] = 4;
        data.sh[row * 3] = ball ? 1.5f : -1.2f;
        data.sh[row * 3 + 1] = ball ? -1.2f : 1.0f;
        data.sh[row * 3 + 2] = -1.2f;
    }
    return GaussianSet(std::move(data));
}

/// A box around the ball and some of the wall.
CutOutRequest around_ball() {
    CutOutRequest request;
    request.camera = Camera::look_at({0, 0, -3}, {0, 0, 0}, {0, -1, 0}, 0.9, 900, 700);
    const double half = 0.62 * request.camera.fx / 3;   // the ball's outline is at 0.5 / sqrt(8.75)
    const auto cx = request.camera.cx, cy = request.camera.cy;
    for (const auto& [x, y] : {std::pair{-1.0, -1.0}, std::pair{1.0, -1.0}, std::pair{1.0, 1.0}, std::pair{-1.0, 1.0}})
        request.area.polygon.push_back({static_cast<float>(cx + x * half), static_cast<float>(cy + y * half)});
    return request;
}

std::size_t count(const std::vector<std::uint8_t>& rows, std::size_t begin, std::size_t end) {
    return static_cast<std::size_t>(std::count(rows.begin() + static_cast<std::ptrdiff_t>(begin), rows.begin() + static_cast<std::ptrdiff_t>(end), std::uint8_t{1}));
}

class Fails final : public edit::Segmenter {
public:
    Mask segment(const Image& image, const std::vector<edit::PointPrompt>&, const std::optional<edit::BoxPrompt>& box, const Image&) override {
        DOCTEST_CHECK(box.has_value());
        return Mask(image.width, image.height);
    }
    std::string name() const override { return "nothing"; }
};

}  // namespace

DOCTEST_TEST_CASE("a box around a thing selects its front, or all of it, and not what is behind") {
    if (!edit::grabcut_available()) return;
    const auto set = ball_and_wall();
    auto request = around_ball();
    const auto front = cut_out(set, request, nullptr);
    DOCTEST_CHECK(count(front, 0, BallRows) > BallRows / 3);       // nearly half of it faces the camera
    DOCTEST_CHECK(count(front, 0, BallRows) < BallRows * 2 / 3);
    DOCTEST_CHECK(count(front, BallRows, front.size()) < count(front, 0, BallRows) / 20);   // at the soft outline
    request.front_only = false;
    const auto through = cut_out(set, request, nullptr);
    DOCTEST_CHECK(count(through, 0, BallRows) > BallRows * 9 / 10);
    // Without the mask the box would have taken the wall beside the ball, too.
    const auto box = rows_in_area(set, request.camera, request.area);
    DOCTEST_CHECK(count(through, BallRows, through.size()) < count(box, BallRows, box.size()));
}

DOCTEST_TEST_CASE("where nothing is cut out the box counts, and a box of nothing selects nothing") {
    const auto set = ball_and_wall();
    auto request = around_ball();
    request.front_only = false;
    Fails fails;
    DOCTEST_CHECK(cut_out(set, request, &fails) == rows_in_area(set, request.camera, request.area));
    request.area.polygon = {{10, 10}, {10, 10}, {10, 10}};
    DOCTEST_CHECK(cut_out(set, request, nullptr) == std::vector<std::uint8_t>(set.size(), 0));
    request.area.polygon.clear();
    DOCTEST_CHECK(cut_out(set, request, nullptr) == std::vector<std::uint8_t>(set.size(), 0));
}
