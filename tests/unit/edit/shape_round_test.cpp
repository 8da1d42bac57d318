// The outline of a new thing in a redrawn picture.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "engine/edit/shape_round.h"

namespace {

using namespace gse;

constexpr int Side = 64;
constexpr double Core = 10, Reach = 30;   // attention is 1 within the first radius and falls evenly to 0 at the second

double radius_at(int x, int y) { return std::hypot(x + 0.5 - Side / 2, y + 0.5 - Side / 2); }

class SlopingAttention : public edit::AttentionSource {
public:
    explicit SlopingAttention(double threshold) : threshold_(threshold) {}
    std::vector<Image> locate(const edit::AttentionQuery&) override {
        Image map(Side, Side, 1);
        for (int y = 0; y < Side; ++y)
            for (int x = 0; x < Side; ++x)
                map.at(x, y, 0) = static_cast<float>(std::clamp((Reach - radius_at(x, y)) / (Reach - Core), 0.0, 1.0));
        return {map};
    }
    double threshold() const override { return threshold_; }
    int image_size() const override { return Side; }

private:
    double threshold_;
};

/// Radius of the disc that has as many pixels as the outline covers.
double outline_radius(double threshold) {
    const edit::EditPlan plan;
    edit::EditRequest request;
    request.prompt = "a cat on the grass";
    SlopingAttention attention(threshold);
    const edit::ShapeFinder finder(plan, request, "cat", attention, nullptr);
    edit::RoundView view;
    view.mask = Mask(Side, Side);
    std::fill(view.mask.data.begin(), view.mask.data.end(), std::uint8_t{1});
    view.backdrop.picture = Image(Side, Side, 3);
    Image picture(Side, Side, 3, 0.5f), outline;
    DOCTEST_REQUIRE(finder.take_out(view, picture, 1, &outline));
    double covered = 0;
    for (const float share : outline.data) covered += share;
    DOCTEST_CHECK(picture.at(Side / 2, Side / 2, 0) == 0.5f);   // the thing stays,
    DOCTEST_CHECK(picture.at(1, 1, 0) == 0.0f);                 // what is beyond it becomes the backdrop
    return std::sqrt(covered / 3.141592653589793);
}

double radius_of(double attention) { return Reach - attention * (Reach - Core); }

}  // namespace

DOCTEST_TEST_CASE("the faint rim of the attention is not of the new thing") {
    constexpr double pixel = 1;   // of the grid on which the attention is thresholded, and of the softened rim
    for (const double threshold : {0.3, 0.5, 0.7}) {
        const double radius = outline_radius(threshold);
        DOCTEST_CHECK(radius < radius_of(threshold));
        DOCTEST_CHECK(radius > Core - pixel);
        DOCTEST_CHECK(radius == doctest::Approx(radius_of(std::min(1.2 * threshold, (1 + threshold) / 2))).epsilon(0.1));
    }
}

DOCTEST_TEST_CASE("however high the threshold, something of the thing is left") {
    for (const double threshold : {0.85, 0.95, 0.99}) DOCTEST_CHECK(outline_radius(threshold) > Core - 2);
}
