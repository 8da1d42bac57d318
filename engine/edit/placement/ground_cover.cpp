// One picture from straight above.
#include "engine/edit/placement/ground_cover.h"

#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "engine/base/check.h"
#include "engine/edit/placement/region_frame.h"

namespace gse::edit {
namespace {

constexpr double GroundHeight = 0.25;  // of a figure's height, up from the foot: a ground is not quite level
constexpr double ViewDistance = 20;    // radii: from so far the picture is all but a parallel projection
constexpr int Side = 64;               // pixels
constexpr std::size_t StandingRows = 200000;  // that tell where a scene stands

}  // namespace

double ground_cover(const GaussianSet& set, std::span<const std::uint8_t> bits, const UprightBounds& standing,
                    const Vec3& up, raster::Rasterizer& rasterizer) {
    GSE_CHECK_EQ(bits.size(), set.size());
    if (!standing.found()) return 0;
    const double figure = figure_height(standing), inner = 0.5 * standing.width(), outer = inner + figure;
    const Vec3 above = normalized(up), foot = standing.foot;
    std::vector<float> opacity(
        set.size(), -std::numeric_limits<float>::infinity());  // of the ground alone: all else is not seen
    bool any = false;
    for (std::size_t row = 0; row < opacity.size(); ++row) {
        const auto p = set.position().subspan(row * 3, 3);
        const Vec3 from = Vec3{p[0], p[1], p[2]} - foot;
        const double height = dot(from, above), way = length(from - above * height);
        if (bits[row] != 0 || !(height <= GroundHeight * figure && way <= 2 * outer))
            continue;  // nor what is not a number
        opacity[row] = set.opacity_logit()[row];
        any = true;
    }
    if (!any) return 0;
    auto buffers = set.buffers();
    buffers.opacity_logit = std::make_shared<const std::vector<float>>(std::move(opacity));
    const GaussianSet rows(std::move(buffers));  // a copy of its rows would be most of the scene
    const auto across = make_frame(above, {}).front;
    const auto camera = Camera::look_at(foot + above * (ViewDistance * outer), foot, across,
                                        2 * std::atan(1 / ViewDistance), Side, Side);
    raster::ForwardOutput output;
    rasterizer.forward(rows.spans(), camera, {}, output);
    double covered = 0;
    int pixels = 0;
    for (int y = 0; y < Side; ++y)
        for (int x = 0; x < Side; ++x) {
            const double way = std::hypot(x + 0.5 - Side / 2, y + 0.5 - Side / 2) * outer / (Side / 2);
            if (way < inner || way > outer) continue;
            covered += output.alpha.at(x, y, 0);
            ++pixels;
        }
    return pixels > 0 ? covered / pixels : 0;
}

UprightBounds standing_of_scene(const GaussianSet& set, const Vec3& up) {
    std::vector<std::uint8_t> some(set.size(), 0);
    const std::size_t step = 1 + set.size() / StandingRows;
    for (std::size_t row = 0; row < some.size(); row += step) some[row] = 1;
    return standing_alone(set, some, up, {});
}

double ground_of_scene(const GaussianSet& set, const UprightBounds& whole, const Vec3& up,
                       raster::Rasterizer& rasterizer) {
    const Vec3 above = normalized(up);
    const std::size_t step = 1 + set.size() / StandingRows;
    std::vector<std::uint8_t> rises(set.size(), 0), some(set.size(), 0);
    for (std::size_t row = 0; row < rises.size(); ++row) {
        const auto p = set.position().subspan(row * 3, 3);
        rises[row] = dot(Vec3{p[0], p[1], p[2]} - whole.foot, above) > GroundHeight * whole.height ? 1 : 0;
        if (row % step == 0) some[row] = rises[row];
    }
    auto risen = standing_alone(set, some, up, {});
    const double lifted = dot(risen.foot - whole.foot, above);  // above the ground that the scene would have
    risen.foot = risen.foot - above * lifted;
    risen.height += lifted;
    return ground_cover(set, rises, risen, up, rasterizer);
}

}  // namespace gse::edit
