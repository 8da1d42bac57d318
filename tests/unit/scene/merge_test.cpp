// One scene put into another: rows, labels, columns and places.
#include "engine/scene/transform/merge.h"

#include <doctest/doctest.h>

#include <cmath>

#include "engine/base/error.h"
#include "engine/base/random.h"
#include "engine/scene/stack_edits.h"
#include "engine/scene/transform/merge_place.h"
#include "engine/scene/transform/transformed.h"
#include "tests/unit/scene/random_sets.h"
#include "tests/unit/scene/seen_blocks.h"

namespace merge_test {

using namespace gse;

namespace {

constexpr double Close = 0.02;  // of the guest's size: few rows at its ends do not count
constexpr double Exact = 1e-5;  // single precision
const Affine Tip = Affine::turn_about({1, 0, 0}, 1.5707963267948966, {});  // brings -y up to -z up

/// Box of rows, y down; `low` and `high` are heights above y = 0.
void add_box(GaussianData& data, Random& random, int count, Vec3 low, Vec3 high) {
    for (int i = 0; i < count; ++i) {
        const std::size_t row = data.size();
        data.resize(row + 1);
        const Vec3 at{random.uniform(low.x, high.x), -random.uniform(low.y, high.y),
                      random.uniform(low.z, high.z)};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            data.position[row * 3 + axis] = static_cast<float>(at[static_cast<int>(axis)]);
            data.log_scale[row * 3 + axis] = -4;
        }
        data.rotation[row * 4] = 1;
        data.opacity_logit[row] = 3;
    }
}

Scene scene_of(GaussianData data) {
    Scene scene;
    scene.gaussians = GaussianSet(std::move(data));
    return scene;
}

/// Ground with a block in the middle.
Scene yard() {
    Random random(3);
    GaussianData data;
    add_box(data, random, 40000, {-5, -0.01, -5}, {5, 0, 5});
    add_box(data, random, 6000, {-1, 0, -1}, {1, 3, 1});
    return scene_of(std::move(data));
}

Scene thing(double size) {
    Random random(8);
    GaussianData data;
    add_box(data, random, 3000, {10, 2, 7}, {10 + 0.5 * size, 2 + size, 7 + 0.5 * size});
    return scene_of(std::move(data));
}

/// Box of the guest's rows in the merged scene, world coordinates, -y up.
std::pair<Vec3, Vec3> guest_box(const Scene& both, std::size_t first) {
    Vec3 low{1e9, 1e9, 1e9}, high = -low;
    for (std::size_t row = first; row < both.gaussians.size(); ++row) {
        const auto p = both.gaussians.position().subspan(row * 3, 3);
        low = glm::min(low, Vec3{p[0], p[1], p[2]});
        high = glm::max(high, Vec3{p[0], p[1], p[2]});
    }
    return {low, high};
}

}  // namespace

DOCTEST_TEST_CASE("rows of both stand one behind the other, labelled, with columns and widened colours") {
    Scene host = scene_of(test::random_data(5, 1, 2));
    const Scene guest = scene_of(test::random_data(3, 2, 4));
    host.info.offset = {1000000, 0, 0};
    host.labels.labels.push_back(make_label("hat", {1, 0, 0, 0, 1}, 0.5f));
    host.extra.push_back(
        {"age", ColumnType::Uint8, std::make_shared<const std::vector<std::byte>>(5, std::byte{7})});
    const Affine place = Affine::move_by({1, 2, 3});
    const Scene both = merged(host, guest, place, "hat");
    DOCTEST_REQUIRE(both.gaussians.size() == 8);
    DOCTEST_CHECK(both.gaussians.sh_degree() == 2);
    DOCTEST_CHECK(both.info.offset == host.info.offset);
    for (std::size_t row = 0; row < 5; ++row)
        DOCTEST_CHECK(same_row(both.gaussians.spans(), row, host.gaussians.spans(), row));
    const GaussianSet moved_guest = transformed(guest.gaussians, place);
    for (std::size_t row = 0; row < 3; ++row)
        DOCTEST_CHECK(same_row(both.gaussians.spans(), 5 + row, moved_guest.spans(), row));
    DOCTEST_REQUIRE(both.labels.labels.size() == 2);
    DOCTEST_CHECK(*both.labels.labels[0].bits == std::vector<std::uint8_t>{1, 0, 0, 0, 1, 0, 0, 0});
    DOCTEST_CHECK(both.labels.labels[1].name == "hat 2");
    DOCTEST_CHECK(*both.labels.labels[1].bits == std::vector<std::uint8_t>{0, 0, 0, 0, 0, 1, 1, 1});
    DOCTEST_CHECK(both.extra.at(0).size() == 8);
    DOCTEST_CHECK(both.extra[0].values->at(4) == std::byte{7});
    DOCTEST_CHECK(both.extra[0].values->at(5) == std::byte{0});
}

DOCTEST_TEST_CASE("an edit adds the other scene, with a label of its own, and its switch takes it away") {
    const Scene host = scene_of(test::random_data(5, 1, 2)), guest = scene_of(test::random_data(3, 2, 4));
    const DocumentState state = initial_state(host, {});
    const Affine place = Affine::scale_about(2, {});
    EditNode node = merge_of(state, guest, place, "luigi", 3);
    const DocumentState after = with_edit(state, node, "luigi", true);
    DOCTEST_CHECK(test::bits_equal(after.current, merged(host, guest, place, "luigi").gaussians));
    DOCTEST_REQUIRE(after.labels.size() == 1);
    DOCTEST_CHECK(after.labels[0].name == "luigi");
    DOCTEST_CHECK(*after.labels[0].bits == std::vector<std::uint8_t>{0, 0, 0, 0, 0, 1, 1, 1});
    node.enabled = false;
    DOCTEST_CHECK(test::bits_equal(with_stack(state, {node}).current, state.current));
}

DOCTEST_TEST_CASE("a scene stands on the ground of the other, near the middle and clear of what is there") {
    const Scene host = yard();
    const Scene guest = thing(2);
    const MergePlace place = merge_place(host, guest);
    const auto [low, high] = guest_box(merged(host, guest, place.placement, "x"), host.gaussians.size());
    DOCTEST_CHECK(std::abs(high.y) < 2 * Close);                         // its foot, -y up
    DOCTEST_CHECK(high.y - low.y == doctest::Approx(2).epsilon(Close));  // its own size suits
    const bool clear = low.x > 0.9 || high.x < -0.9 || low.z > 0.9 || high.z < -0.9;
    DOCTEST_CHECK(clear);
    DOCTEST_CHECK(std::hypot((low.x + high.x) / 2, (low.z + high.z) / 2) < 3);
    DOCTEST_CHECK(place.notes.size() == 1);
}

DOCTEST_TEST_CASE("a size that does not suit becomes a third of the scene's, and a given one stays") {
    const Scene host = yard();
    for (const double size : {0.01, 500.0}) {
        const MergePlace place = merge_place(host, thing(size));
        const double factor = std::cbrt(place.placement.determinant());
        DOCTEST_CHECK(factor * size == doctest::Approx(10.0 / 3).epsilon(0.06));  // both boxes are trimmed
        DOCTEST_CHECK(place.notes.size() == 2);
        MergeWishes wishes;
        wishes.scale = 1.5;
        DOCTEST_CHECK(std::cbrt(merge_place(host, thing(size), wishes).placement.determinant()) ==
                      doctest::Approx(1.5));
    }
}

DOCTEST_TEST_CASE("the foot comes to the place that is given, turned about its upright axis") {
    const Scene host = yard(), guest = thing(2);
    MergeWishes wishes;
    wishes.at = Vec3{3, -1, 2};
    wishes.turn = 90;
    const MergePlace place = merge_place(host, guest, wishes);
    const auto [low, high] = guest_box(merged(host, guest, place.placement, "x"), host.gaussians.size());
    DOCTEST_CHECK(std::abs((low.x + high.x) / 2 - 3) < 2 * Close);
    DOCTEST_CHECK(std::abs(high.y + 1) < 2 * Close);
    DOCTEST_CHECK(std::abs((low.z + high.z) / 2 - 2) < 2 * Close);
    // Counter-clockwise from above: with -y up, what pointed along x points along z.
    DOCTEST_CHECK(length(place.placement.linear * Vec3{1, 0, 0} - Vec3{0, 0, 1}) < Exact);
    DOCTEST_CHECK(place.notes.empty());
}

DOCTEST_TEST_CASE("a scene with another up stands upright in the other") {
    const Scene host = yard(), guest = thing(2);
    Scene lying = guest;
    lying.gaussians = transformed(guest.gaussians, Tip);
    lying.info.up = Tip.linear * guest.info.up;
    MergeWishes wishes;
    wishes.at = Vec3{0, 0, 0};
    const auto upright = [&](const Scene& other) {
        return guest_box(merged(host, other, merge_place(host, other, wishes).placement, "x"),
                         host.gaussians.size());
    };
    const auto [low, high] = upright(guest);
    const auto [low_of_lying, high_of_lying] = upright(lying);
    DOCTEST_CHECK(length(low - low_of_lying) < Close);
    DOCTEST_CHECK(length(high - high_of_lying) < Close);
    // A scene that is merged with its own up keeps its rows' colours and shapes.
    const Affine same = merge_place(host, guest, wishes).placement;
    DOCTEST_CHECK(transformed(guest.gaussians, same).buffers().rotation ==
                  guest.gaussians.buffers().rotation);
}

DOCTEST_TEST_CASE("beside a host without a ground, and nothing to see") {
    Random random(3);
    GaussianData pole;
    add_box(pole, random, 3000, {0, 0, 0}, {0.1, 4, 0.1});
    const Scene host = scene_of(std::move(pole)), guest = thing(2);
    const MergePlace place = merge_place(host, guest);
    const auto [low, high] = guest_box(merged(host, guest, place.placement, "x"), host.gaussians.size());
    DOCTEST_CHECK((low.x > 0.1 - Close || high.x < Close));
    DOCTEST_CHECK(std::abs(high.y) < 0.2);
    DOCTEST_CHECK_THROWS_AS(merge_place(scene_of({}), guest), Error);
    DOCTEST_CHECK_THROWS_AS(merge_place(host, scene_of({})), Error);
}

DOCTEST_TEST_CASE("a view of the host says where the other scene stands, unless a place is given") {
    const Scene host = yard(), guest = thing(1);
    MergeWishes wishes;
    wishes.seen = test::seen({{{-5, 0, -5}, {5, 0.1, 5}}, {{-1, -3, -1}, {1, 0, 1}}}, {0, -3, -7}, {0, -1, 0},
                             {0, -1, 0});
    const MergePlace place = merge_place(host, guest, wishes);
    DOCTEST_REQUIRE(place.notes.size() == 1);
    DOCTEST_CHECK(place.notes[0] == "it stands near the middle of the view");
    const auto [low, high] = guest_box(merged(host, guest, place.placement, "x"), host.gaussians.size());
    DOCTEST_CHECK(std::abs(high.y) < 2 * Close);  // its foot, -y up
    DOCTEST_CHECK(std::abs(low.x + high.x) < 0.5);
    DOCTEST_CHECK(high.z < -1 + Close);  // in front of the block
    wishes.at = Vec3{3, 0, 3};
    DOCTEST_CHECK(merge_place(host, guest, wishes).notes.empty());
    wishes.at.reset();
    wishes.seen = SeenSurface{};  // nothing is seen
    DOCTEST_CHECK(merge_place(host, guest, wishes).placement == merge_place(host, guest).placement);
}

}  // namespace merge_test
