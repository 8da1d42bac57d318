// Labels that the pictures' edges cut, and labels that lie whole in them.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "engine/localize/frame_cut.h"

namespace frame_cut_test {

namespace {

using namespace gse;

constexpr int Side = 64;
constexpr double Cut = 0.1;  // of a border: more is a cut, and a label that lies whole has none at all

/// A column of 1200 rows, 0.4 wide and 2 high around the origin (up is -y), on a floor of 800 rows.
struct Column {
    GaussianSet set;
    std::vector<std::uint8_t> whole;
};

Column column() {
    constexpr std::size_t Rows = 2000, OfColumn = 1200;
    GaussianData data;
    data.resize(Rows);
    Column result;
    for (std::size_t row = 0; row < Rows; ++row) {
        const bool inside = row < OfColumn;
        const double angle = 2.399963 * static_cast<double>(row);  // the golden angle spreads them evenly
        const double rank = static_cast<double>(inside ? row : row - OfColumn);
        const double reach = inside ? 0.2 : 0.2 + 2.3 * std::sqrt(rank / (Rows - OfColumn));
        data.position[row * 3] = static_cast<float>(reach * std::cos(angle));
        data.position[row * 3 + 1] = static_cast<float>(inside ? 1 - 2 * rank / OfColumn : 1);
        data.position[row * 3 + 2] = static_cast<float>(reach * std::sin(angle));
        data.opacity_logit[row] = 3;
        data.rotation[row * 4] = 1;
        result.whole.push_back(inside ? 1 : 0);
    }
    result.set = GaussianSet(std::move(data));
    return result;
}

/// Cameras around: `cut` of them look at the foot from near by and do not show the upper half.
std::vector<Camera> cameras(int count, int cut) {
    std::vector<Camera> result;
    for (int i = 0; i < count; ++i) {
        OrbitParameters orbit;
        orbit.elevation = 0.1;
        orbit.radius = i < cut ? 1.8 : 5;
        orbit.centre = i < cut ? Vec3{0, 0.8, 0} : Vec3{0, 0, 0};
        result.push_back(orbit_camera(orbit, 2 * std::numbers::pi * i / count, Side, Side));
    }
    return result;
}

/// The rows of the column in the first camera's picture.
std::vector<std::uint8_t> seen_part(const Column& scene, const Camera& camera) {
    auto bits = scene.whole;
    for (std::size_t row = 0; row < bits.size(); ++row) {
        const float* at = &scene.set.position()[row * 3];
        const Vec3 seen = camera.to_camera({at[0], at[1], at[2]});
        if (camera.fy * seen.y / seen.z + camera.cy < 0) bits[row] = 0;
    }
    return bits;
}

}  // namespace

DOCTEST_TEST_CASE("a label that most pictures' edges cut is flagged, by the number of those pictures") {
    const auto scene = column();
    constexpr int Views = 12;
    const auto part = seen_part(scene, cameras(Views, Views).front());
    for (int cut = 0; cut <= Views; ++cut) {
        const auto found = localize::frame_cut(scene.set.spans(), part, cameras(Views, cut));
        DOCTEST_CAPTURE(cut);
        DOCTEST_CHECK(found.border > 0);
        DOCTEST_CHECK((found.share() > Cut) == (2 * cut > Views));
        if (2 * cut <= Views) DOCTEST_CHECK(found.beyond == 0);
    }
}

DOCTEST_TEST_CASE("a label that lies whole in the pictures has no cut border, wherever it ends") {
    const auto scene = column();
    const auto views = cameras(12, 0);
    for (const auto& label : {scene.whole, seen_part(scene, cameras(12, 12).front())}) {
        const auto found = localize::frame_cut(scene.set.spans(), label, views);
        DOCTEST_CHECK(found.border > 0);
        DOCTEST_CHECK(found.beyond == 0);
    }
}

DOCTEST_TEST_CASE("a label without a border, or without a picture, is not cut") {
    const auto scene = column();
    const auto views = cameras(12, 12);
    const std::vector<std::uint8_t> none(scene.whole.size(), 0), all(scene.whole.size(), 1);
    DOCTEST_CHECK(localize::frame_cut(scene.set.spans(), none, views).border == 0);
    DOCTEST_CHECK(localize::frame_cut(scene.set.spans(), all, views).border == 0);
    DOCTEST_CHECK(localize::frame_cut(scene.set.spans(), scene.whole, {}).share() == 0);
}

DOCTEST_TEST_CASE("a cut does not follow the number of threads, nor rows that cannot be seen") {
    auto scene = column();
    const auto views = cameras(12, 12);
    const auto part = seen_part(scene, views.front());
    ThreadPool pool{2};
    const auto alone = localize::frame_cut(scene.set.spans(), part, views);
    const auto together = localize::frame_cut(scene.set.spans(), part, views, {}, &pool);
    DOCTEST_CHECK(together.border == alone.border);
    DOCTEST_CHECK(together.beyond == alone.beyond);
    GaussianData data;
    data.resize(2);
    data.opacity_logit[1] = -9;
    const GaussianSet faint(std::move(data));
    const std::vector<std::uint8_t> first{1, 0};
    DOCTEST_CHECK(localize::frame_cut(faint.spans(), first, views).border == 0);
}

}  // namespace frame_cut_test
