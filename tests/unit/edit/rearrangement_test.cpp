// Words and numbers of changes of place, size and number, as maps with asserted bounds.
#include "engine/edit/placement/rearrangement.h"

#include <doctest/doctest.h>

#include <cmath>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/edit/placement/free_place.h"
#include "engine/edit/words/change_words.h"
#include "engine/language/plan/plan_sentence.h"
#include "engine/scene/transform/transformed.h"
#include "tests/test_paths.h"
#include "tests/unit/edit/box_rows.h"

namespace rearrangement_test {

namespace {

using namespace gse;
using namespace gse::edit;

const Vec3 Up{0, -1, 0}, Front{0, 0, -1};
constexpr double Exact = 1e-9;  // maps in double, without rows
constexpr double Close = 0.05;  // of a thing 1 high: rows are drawn at random, the outermost do not count
constexpr double Grown = 1.3;   // as the help says

/// Box and foot of a thing without rows: `wide` and `deep` around (x, z), `high` above the ground at
/// `ground`.
ThingFrame plain_thing(double x, double z, double wide, double high, double deep, double ground = 0) {
    ThingFrame thing;
    thing.frame = make_frame(Up, Front);
    thing.box = {{x - wide / 2, ground, z - deep / 2}, {x + wide / 2, ground + high, z + deep / 2}};
    thing.standing = {thing.frame.to_world({x, ground, z}), high, wide, deep};
    return thing;
}

const ThingFrame Bear = plain_thing(1, 2, 0.8, 1.2, 0.6);
const ThingFrame Table = plain_thing(4, 1, 2, 0.7, 1);

/// Box of a thing under a map of the world, in frame coordinates.
Box placed(const ThingFrame& thing, const Affine& map) {
    Box box{{1e9, 1e9, 1e9}, {-1e9, -1e9, -1e9}};
    for (int corner = 0; corner < 8; ++corner) {
        const auto pick = [&](int axis) {
            return (corner >> axis & 1) != 0 ? thing.box.high[axis] : thing.box.low[axis];
        };
        const Vec3 p = thing.frame.to_frame(map(thing.frame.to_world({pick(0), pick(1), pick(2)})));
        box.low = glm::min(box.low, p);
        box.high = glm::max(box.high, p);
    }
    return box;
}

void check_box(const Box& box, const Vec3& low, const Vec3& high) {
    DOCTEST_CHECK(length(box.low - low) <= Exact);
    DOCTEST_CHECK(length(box.high - high) <= Exact);
}

Rearrangement arranged(const std::string& change, const ThingFrame& thing = Bear,
                       const ThingFrame* anchor = nullptr) {
    RearrangeSettings settings;
    settings.change = change;
    return rearrangement(settings, thing, anchor);
}

/// Box of the bear after a change.
Box bear_after(const std::string& change, const ThingFrame* anchor = nullptr) {
    return placed(Bear, arranged(change, Bear, anchor).thing);
}

std::string refusal(const std::string& change, const ThingFrame* anchor = nullptr) {
    try {
        arranged(change, Bear, anchor);
    } catch (const Error& error) {
        DOCTEST_CHECK(error.code() == ErrorCode::InvalidArgument);
        DOCTEST_CHECK(!error.hint().empty());
        return error.message();
    }
    return "";
}

/// Direction in frame coordinates into which the front of a thing turns.
Vec3 front_after(const std::string& change) {
    const Affine map = arranged(change).thing;
    return normalized(Bear.frame.to_frame(map.linear * Bear.frame.front));
}

bool apart(const Box& a, const Box& b) {
    for (int axis = 0; axis < 3; ++axis)
        if (a.high[axis] <= b.low[axis] || b.high[axis] <= a.low[axis]) return true;
    return false;
}

}  // namespace

DOCTEST_TEST_CASE("sizes change by their factor, about the foot") {
    const Vec3 size = Bear.box.size(), foot = Bear.foot();
    struct Case {
        const char* text;
        Vec3 factor;
        bool leaves;
    };
    const double less = 1 / Grown;
    for (const auto& [text, factor, leaves] :
         {Case{"bigger", {Grown, Grown, Grown}, false}, Case{"smaller", {less, less, less}, true},
          Case{"scale 2", {2, 2, 2}, false}, Case{"scale 0.5", {0.5, 0.5, 0.5}, true},
          Case{"taller", {1, Grown, 1}, false}, Case{"shorter", {1, less, 1}, true},
          Case{"taller 2", {1, 2, 1}, false}, Case{"wider", {Grown, 1, 1}, false},
          Case{"narrower", {less, 1, 1}, true}, Case{"thicker", {Grown, 1, Grown}, false},
          Case{"thinner", {less, 1, less}, true}, Case{"longer", {1, Grown, 1}, false}}) {
        DOCTEST_CAPTURE(text);
        const Rearrangement result = arranged(text);
        const Box box = placed(Bear, result.thing);
        DOCTEST_CHECK(length(box.size() - size * factor) <= Exact);
        DOCTEST_CHECK(length(Bear.frame.to_frame(result.thing(Bear.standing.foot)) - foot) <= Exact);
        DOCTEST_CHECK(box.low.y == doctest::Approx(Bear.box.low.y));
        DOCTEST_CHECK(result.leaves_place == leaves);
        DOCTEST_CHECK(result.copies.empty());
        DOCTEST_CHECK(!result.anchor);
    }
    const ThingFrame snake = plain_thing(0, 0, 3, 0.2, 0.2);
    DOCTEST_CHECK(placed(snake, arranged("longer", snake).thing).size().x == doctest::Approx(3 * Grown));
    const Box same = bear_after("same size as", &Table);
    DOCTEST_CHECK(same.size().y == doctest::Approx(2));  // the longest side is as long as the table's
    DOCTEST_CHECK(same.low.y == doctest::Approx(0));
}

DOCTEST_TEST_CASE("moves go to the side of who looks at the front, along the ground") {
    const Vec3 size = Bear.box.size(), centre = Bear.box.centre();
    struct Case {
        const char* text;
        Vec3 by;
    };
    for (const auto& [text, by] :
         {Case{"move left", {-size.x, 0, 0}}, Case{"move right", {size.x, 0, 0}},
          Case{"move up", {0, size.y / 2, 0}}, Case{"move down", {0, -size.y / 2, 0}},
          Case{"move forward", {0, 0, size.z}}, Case{"move back", {0, 0, -size.z}},
          Case{"move left 2 m", {-2, 0, 0}}, Case{"move left 2", {-2, 0, 0}},
          Case{"move up 50 cm", {0, 0.5, 0}}, Case{"move right 50 %", {size.x / 2, 0, 0}}}) {
        DOCTEST_CAPTURE(text);
        const Rearrangement result = arranged(text);
        const Box box = placed(Bear, result.thing);
        DOCTEST_CHECK(length(box.centre() - centre - by) <= Exact);
        DOCTEST_CHECK(length(box.size() - size) <= Exact);
        DOCTEST_CHECK(result.thing.linear == Mat3::identity());
        DOCTEST_CHECK(result.leaves_place);
        DOCTEST_CHECK(result.drop == (by.y == 0));
    }
    // The artist's left: x of a picture taken from the front.
    const Camera camera =
        Camera::look_at(Bear.standing.foot + Front * 5.0, Bear.standing.foot, Up, 0.9, 64, 64);
    const Vec3 moved = arranged("move left").thing(Bear.standing.foot);
    DOCTEST_CHECK(camera.to_camera(moved).x < camera.to_camera(Bear.standing.foot).x);
}

DOCTEST_TEST_CASE("turns bring the front to the artist's left or right") {
    const Vec3 left{-1, 0, 0}, right{1, 0, 0}, back{0, 0, -1};
    const double half = std::sqrt(0.5);
    struct Case {
        const char* text;
        Vec3 front;
    };
    for (const auto& [text, front] :
         {Case{"rotate", right}, Case{"rotate 90", right}, Case{"rotate 180", back},
          Case{"rotate 90 left", left}, Case{"rotate 90 right", right}, Case{"rotate left", left},
          Case{"rotate 45 clockwise", {-half, 0, half}}, Case{"rotate 45 counterclockwise", {half, 0, half}},
          Case{"rotate clockwise", left}, Case{"rotate 360", {0, 0, 1}}, Case{"face left", left},
          Case{"face right", right}, Case{"face back", back}}) {
        DOCTEST_CAPTURE(text);
        DOCTEST_CHECK(length(front_after(text) - front) <= Exact);
        const Rearrangement result = arranged(text);
        DOCTEST_CHECK(length(result.thing(Bear.standing.foot) - Bear.standing.foot) <= Exact);
        DOCTEST_CHECK(result.thing.determinant() == doctest::Approx(1));
    }
}

DOCTEST_TEST_CASE("flipped and mirrored things stay where they are") {
    const Affine flip = arranged("flip").thing, mirror = arranged("mirror").thing;
    check_box(placed(Bear, flip), Bear.box.low, Bear.box.high);
    check_box(placed(Bear, mirror), Bear.box.low, Bear.box.high);
    DOCTEST_CHECK(flip.determinant() == doctest::Approx(1));
    DOCTEST_CHECK(mirror.determinant() == doctest::Approx(-1));
    const Vec3 head = Bear.frame.to_world(Bear.box.high);
    DOCTEST_CHECK(Bear.frame.to_frame(flip(head)).y == doctest::Approx(Bear.box.low.y));
    DOCTEST_CHECK(Bear.frame.to_frame(mirror(head)).x == doctest::Approx(Bear.box.low.x));
}

DOCTEST_TEST_CASE("a thing is put beside, behind, before, on, above or under another") {
    const Box &table = Table.box, &bear = Bear.box;
    const Box left = bear_after("move left of", &Table), right = bear_after("move right of", &Table);
    DOCTEST_CHECK(left.high.x < table.low.x);
    DOCTEST_CHECK(right.low.x > table.high.x);
    const Box behind = bear_after("move behind", &Table), front = bear_after("move in front of", &Table);
    DOCTEST_CHECK(behind.high.z < table.low.z);
    DOCTEST_CHECK(front.low.z > table.high.z);
    for (const Box& box : {left, right, behind, front, bear_after("move beside", &Table)}) {
        DOCTEST_CHECK(apart(box, table));
        DOCTEST_CHECK(box.low.y == doctest::Approx(table.low.y));
        DOCTEST_CHECK(length(box.size() - bear.size()) <= Exact);
        DOCTEST_CHECK(length(box.centre() - table.centre()) < 3);  // close by
    }
    const Box on = bear_after("move on", &Table);
    DOCTEST_CHECK(on.low.y == doctest::Approx(table.high.y));
    DOCTEST_CHECK(on.centre().x == doctest::Approx(table.centre().x));
    DOCTEST_CHECK(bear_after("move above", &Table).low.y > table.high.y);
    DOCTEST_CHECK(bear_after("move in", &Table).centre().z == doctest::Approx(table.centre().z));
    const Box under = bear_after("move under", &Table);
    DOCTEST_CHECK(under.low.y == doctest::Approx(table.low.y));
}

DOCTEST_TEST_CASE("two things change places, foot for foot") {
    const Rearrangement result = arranged("swap with", Bear, &Table);
    DOCTEST_REQUIRE(result.anchor.has_value());
    DOCTEST_CHECK(length(result.thing(Bear.standing.foot) - Table.standing.foot) <= Exact);
    DOCTEST_CHECK(length((*result.anchor)(Table.standing.foot) - Bear.standing.foot) <= Exact);
    DOCTEST_CHECK(result.leaves_place);
}

DOCTEST_TEST_CASE("what cannot be done is refused in a sentence") {
    for (const char* text : {" ", "blue", "move", "move sideways", "move left far", "move left 2 miles",
                             "rotate upside", "scale", "scale x", "scale 2 3", "face", "face me", "smaller 2",
                             "move left nan", "bigger inf", "rotate 90 left now", "flipped"}) {
        DOCTEST_CAPTURE(text);
        DOCTEST_CHECK(refusal(text).find("is no change of place or size") != std::string::npos);
    }
    for (const char* text :
         {"scale 0", "scale -1", "scale 1e9", "move left 1e30", "rotate 1e9", "face up", "face forward",
          "move worn by", "move between", "swap with", "move behind", "same size as"}) {
        DOCTEST_CAPTURE(text);
        DOCTEST_CHECK(refusal(text) != "");
    }
    DOCTEST_CHECK_THROWS_AS(arranged("bigger", ThingFrame{}), Error);
    const ThingFrame nothing;
    DOCTEST_CHECK(refusal("swap with", &nothing) != "");
    DOCTEST_CHECK(number_of_copies("2") == 2);
    DOCTEST_CHECK(number_of_copies("some") == 3);
    for (const char* text : {"", "0", "-1", "1.5", "many", "1000000", "2 3"})
        DOCTEST_CHECK_THROWS_AS(number_of_copies(text), Error);
}

DOCTEST_TEST_CASE("numbers come on top of the words") {
    RearrangeSettings settings;
    DOCTEST_CHECK(rearrangement(settings, Bear).thing.is_identity());
    DOCTEST_CHECK(!rearrangement(settings, Bear).leaves_place);
    settings.move_right = 1, settings.move_up = 2, settings.move_forward = 3;
    const Affine move = rearrangement(settings, Bear).thing;
    check_box(placed(Bear, move), Bear.box.low + Vec3{1, 2, 3}, Bear.box.high + Vec3{1, 2, 3});
    settings = {};
    settings.change = "bigger";
    settings.resize = 2;
    DOCTEST_CHECK(placed(Bear, rearrangement(settings, Bear).thing).size().y ==
                  doctest::Approx(2 * Grown * Bear.box.size().y));
    settings = {};
    settings.turn = 90;
    const Vec3 front = rearrangement(settings, Bear).thing.linear * Bear.frame.front;
    DOCTEST_CHECK(length(Bear.frame.to_frame(front) - Vec3{1, 0, 0}) <= Exact);
    settings = {};
    settings.tilt = 30;
    const auto up_after = [&] {
        return Bear.frame.to_frame(rearrangement(settings, Bear).thing.linear * Bear.frame.up);
    };
    DOCTEST_CHECK(up_after().z == doctest::Approx(0.5));  // leans forward
    DOCTEST_CHECK(placed(Bear, rearrangement(settings, Bear).thing).low.y == doctest::Approx(0));
    settings = {};
    settings.roll = 30;
    DOCTEST_CHECK(up_after().x == doctest::Approx(0.5));  // leans to the right
    settings = {};
    settings.mirror = true;
    DOCTEST_CHECK(rearrangement(settings, Bear).thing.determinant() == doctest::Approx(-1));
}

DOCTEST_TEST_CASE("copies stand beside each other, apart, and clear of others") {
    RearrangeSettings settings;
    settings.copies = 4;
    const auto boxes_of = [&](const std::vector<Vec3>& others) {
        const Rearrangement result = rearrangement(settings, Bear, nullptr, others);
        DOCTEST_CHECK(result.thing.is_identity());
        DOCTEST_CHECK(!result.leaves_place);
        std::vector<Box> boxes{Bear.box};
        for (const Affine& copy : result.copies) boxes.push_back(placed(Bear, copy));
        return boxes;
    };
    const auto check_apart = [](const std::vector<Box>& boxes) {
        for (std::size_t i = 0; i < boxes.size(); ++i)
            for (std::size_t k = 0; k < i; ++k) DOCTEST_CHECK(apart(boxes[i], boxes[k]));
    };
    const auto free = boxes_of({});
    DOCTEST_REQUIRE(free.size() == 4);
    check_apart(free);
    for (const Box& box : free) {
        DOCTEST_CHECK(box.low.z == doctest::Approx(Bear.box.low.z));
        DOCTEST_CHECK(box.low.y == doctest::Approx(0));
    }
    DOCTEST_CHECK(free[1].low.x > Bear.box.high.x);  // to the right first
    Random random(5);
    std::vector<Vec3> wall;  // at the right
    for (int i = 0; i < 400; ++i)
        wall.push_back({random.uniform(1.5, 1.8), random.uniform(0, 2), random.uniform(0, 4)});
    const auto beside = boxes_of(wall);
    check_apart(beside);
    for (const Box& box : beside)
        for (const Vec3& p : wall) DOCTEST_CHECK(!box.has(p));
}

DOCTEST_TEST_CASE("copies stay on the table that carries the thing") {
    std::vector<Vec3> table;
    Random random(5);
    for (int i = 0; i < 4000; ++i)
        table.push_back({random.uniform(-3, 1.5), random.uniform(-0.02, 0), random.uniform(1.5, 2.5)});
    RearrangeSettings settings;
    settings.copies = 3;
    for (const Affine& copy : rearrangement(settings, Bear, nullptr, table).copies) {
        const Box box = placed(Bear, copy);
        DOCTEST_CHECK(box.centre().x > -3);
        DOCTEST_CHECK(box.centre().x < 1.5);
    }
}

DOCTEST_TEST_CASE("copies for which a table has no room stand on the floor beside it") {
    std::vector<Vec3> points;
    Random random(5);
    for (int i = 0; i < 2000; ++i)
        points.push_back({random.uniform(0.5, 1.5), random.uniform(-0.02, 0), random.uniform(1.6, 2.4)});
    for (int i = 0; i < 9000; ++i)
        points.push_back({random.uniform(-6, 8), random.uniform(-0.72, -0.7), random.uniform(-4, 8)});
    RearrangeSettings settings;
    settings.copies = 3;
    const auto copies = rearrangement(settings, Bear, nullptr, points).copies;
    DOCTEST_REQUIRE(copies.size() == 2);
    for (const Affine& copy : copies) {
        const Box box = placed(Bear, copy);
        DOCTEST_CHECK(std::abs(box.low.y + 0.7) < Close);
        DOCTEST_CHECK((box.low.x > 1.5 || box.high.x < 0.5));
    }
}

DOCTEST_TEST_CASE("rows of a thing follow words: from the label to the moved rows") {
    test::BoxRows rows;
    rows.box(-2, 6, -0.01, 0, -3, 3, 6000, false);    // the ground
    rows.box(-0.3, 0.3, 0, 1, -0.2, 0.2, 900, true);  // the thing
    rows.box(3, 5, 0.65, 0.7, -1, 1, 2000, false);    // a table's top
    rows.box(3, 3.1, 0, 0.65, -1, -0.9, 100, false).box(4.9, 5, 0, 0.65, 0.9, 1, 100, false);
    std::vector<std::uint8_t> of_table(rows.bits.size(), 0), none(rows.bits.size(), 0);
    for (std::size_t row = 6900; row < of_table.size(); ++row) of_table[row] = 1;
    const GaussianSet set = rows.set();
    const ThingFrame thing = thing_frame(set, rows.bits, Up, Front);
    const ThingFrame table = thing_frame(set, of_table, Up, Front);
    DOCTEST_CHECK(!thing_frame(set, none, Up, Front).found());
    const auto others = other_points(set, rows.bits, thing.frame);
    RearrangeSettings settings;
    const auto box_after = [&](const char* change) {
        settings.change = change;
        const Affine map = rearrangement(settings, thing, &table, others).thing;
        return thing_frame(transformed(set, rows.bits, map), rows.bits, Up, Front).box;
    };
    const Box bigger = box_after("bigger");
    DOCTEST_CHECK(bigger.size().y == doctest::Approx(Grown).epsilon(Close));
    DOCTEST_CHECK(std::abs(bigger.low.y) < Close);
    const Box left = box_after("move left");
    DOCTEST_CHECK(left.centre().x ==
                  doctest::Approx(thing.box.centre().x - thing.box.size().x).epsilon(0.01));
    DOCTEST_CHECK(std::abs(left.low.y) < Close);
    const Box on = box_after("move on");
    DOCTEST_CHECK(on.low.y == doctest::Approx(0.7).epsilon(Close));
    DOCTEST_CHECK(std::abs(on.centre().x - 4) < Close);
    const Box under = box_after("move behind");
    DOCTEST_CHECK(under.high.z < -1);
    DOCTEST_CHECK(std::abs(under.low.y) < Close);
    DOCTEST_CHECK_THROWS_WITH_AS(
        box_after("move under"),
        "there is no room for it under the other thing; make it smaller first, or put "
        "it beside",
        Error);
    settings.resize = 1;
    settings.change = "";
    settings.tilt = 40;
    const Affine leaning = rearrangement(settings, thing, nullptr, others).thing;
    const Box leans = thing_frame(transformed(set, rows.bits, leaning), rows.bits, Up, Front).box;
    DOCTEST_CHECK(std::abs(leans.low.y) < Close);
}

DOCTEST_TEST_CASE("a rearrangement is one edit of the stack, and its switch takes all of it back") {
    test::BoxRows rows;
    rows.box(-0.3, 0.3, 0, 1, -0.2, 0.2, 50, true).box(2, 3, 0, 1, -0.2, 0.2, 40, false);
    Scene scene;
    scene.gaussians = rows.set();
    const DocumentState state = initial_state(scene, {});
    std::vector<std::uint8_t> of_other(90, 0);
    std::fill(of_other.begin() + 50, of_other.end(), std::uint8_t{1});
    Rearrangement places;
    places.thing = Affine::move_by({2, 0, 0});
    places.anchor = Affine::move_by({-2, 0, 0});
    places.copies = {Affine::move_by({0, 0, 5})};
    EditNode node = rearrangement_edit(state, rows.bits, of_other, places, 4);
    DOCTEST_CHECK(node.delta->changed.size() == 90);
    DOCTEST_CHECK(node.delta->added.size() == 50);
    const DocumentState after = with_stack(state, {node});
    DOCTEST_REQUIRE(after.current.size() == 140);
    const auto x = [](const GaussianSet& set, std::size_t row) { return set.position()[row * 3]; };
    DOCTEST_CHECK(x(after.current, 0) == doctest::Approx(x(state.current, 0) + 2));
    DOCTEST_CHECK(x(after.current, 89) == doctest::Approx(x(state.current, 89) - 2));
    DOCTEST_CHECK(x(after.current, 90) == x(state.current, 0));
    node.enabled = false;
    DOCTEST_CHECK(with_stack(state, {node}).current.shares_all_with(state.current));
    places.copies.clear();
    places.anchor.reset();
    DOCTEST_CHECK(rearrangement_edit(state, rows.bits, {}, places, 4).delta->added.empty());
}

DOCTEST_TEST_CASE("a thing from a table is put on the floor beside the table, not below it") {
    test::BoxRows rows;
    rows.box(-4, 4, -0.01, 0, -4, 4, 9000, false);  // the floor
    rows.box(-1, 1, 0.95, 1, -1, 1, 3000, false);   // a table's top
    rows.box(-0.2, 0.2, 1, 1.5, -0.2, 0.2, 600, true);
    std::vector<std::uint8_t> floor(rows.bits.size(), 0);
    for (std::size_t row = 0; row < 9000; ++row) floor[row] = 1;
    const GaussianSet set = rows.set();
    const ThingFrame vase = thing_frame(set, rows.bits, Up, Front),
                     ground = thing_frame(set, floor, Up, Front);
    RearrangeSettings settings;
    settings.change = "move on";
    const auto others = other_points(set, rows.bits, vase.frame);
    const Affine map = rearrangement(settings, vase, &ground, others).thing;
    const Box box = thing_frame(transformed(set, rows.bits, map), rows.bits, Up, Front).box;
    DOCTEST_CHECK(std::abs(box.low.y) < Close);
    DOCTEST_CHECK((std::abs(box.centre().x) > 1 || std::abs(box.centre().z) > 1));
    DOCTEST_CHECK(std::hypot(box.centre().x, box.centre().z) < 2.5);
}

DOCTEST_TEST_CASE("every change that a plan of the suite of sentences asks for is understood") {
    const auto path = test::shared_folder() / "data/sentences/sentences_dev.tsv";
    if (!test::available(path)) return;
    std::ifstream lines(path);
    std::set<std::string> texts, counts;
    for (std::string line; std::getline(lines, line);) {
        std::vector<std::string> cells;
        std::istringstream row(line);
        for (std::string cell; std::getline(row, cell, '\t');) cells.push_back(cell);
        if (line.empty() || line[0] == '#' || cells.size() < 5) continue;
        namespace plan = language::plan;
        for (const auto& step : plan::plan_sentence(cells[3], plan::scene_words(cells[1]), cells[2]).steps) {
            DOCTEST_CAPTURE(to_string(step));
            if (step.operation == plan::Operation::Duplicate) {
                DOCTEST_CHECK(number_of_copies(step.text) > 1);
                counts.insert(step.text);
            }
            if (step.operation != plan::Operation::Transform) continue;
            DOCTEST_CHECK(placement_change(step.text).needs_anchor() == !step.anchors.empty());
            texts.insert(step.text);
        }
    }
    DOCTEST_CHECK(texts.size() > 15);
    DOCTEST_CHECK(counts.size() > 1);
}

}  // namespace rearrangement_test
