// Handles of the labelled thing: each drag asks for its kind of change, in steps while Ctrl is held.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "tests/ui/support/harness.h"
#include "ui/state/state.h"

namespace gizmo_test {

using namespace gse;
using namespace gse::test;
namespace key = ui::key;

namespace {

struct Placing {
    Harness harness{{1280, 720, 1, Situation::Located, false}};

    Placing() {
        harness.key('G');
        harness.frame(2);
    }
    ImVec2 middle(const char* name) {
        const auto rect = harness.rect(name);
        return {rect.x + rect.width / 2, rect.y + rect.height / 2};
    }
    const edit::RearrangeSettings& values() { return harness.shell.state().by_hand.place.values; }
    /// Drags a handle away from the middle, or by a given way.
    void drag(const char* name, float x, float y) {
        const ImVec2 from = middle(name);
        harness.drag(from, {from.x + x, from.y + y});
    }
    /// Drags an arrow along itself.
    void pull(const char* name, float pixels) {
        const ImVec2 from = middle(name), centre = middle("gizmo.ground");
        const float x = from.x - centre.x, y = from.y - centre.y, length = std::hypot(x, y);
        harness.drag(from, {from.x + x / length * pixels, from.y + y / length * pixels});
    }
};

}  // namespace

DOCTEST_TEST_CASE("each handle changes its own numbers") {
    Placing placing;
    DOCTEST_REQUIRE(placing.harness.application.asked("use_placing on"));
    placing.pull("gizmo.side", 40);
    const double right = placing.values().move_right;
    DOCTEST_CHECK(right > 0);
    DOCTEST_CHECK(placing.values().move_up == 0);
    placing.pull("gizmo.up", 30);
    DOCTEST_CHECK(placing.values().move_up > 0);
    DOCTEST_CHECK(placing.values().move_right == right);
    placing.drag("gizmo.size", 20, -20);
    DOCTEST_CHECK(placing.values().resize > 1);
    placing.drag("gizmo.turn", 25, 10);
    DOCTEST_CHECK(placing.values().turn != 0);
    DOCTEST_CHECK(placing.harness.application.asked("place_thing"));
}

DOCTEST_TEST_CASE("the end of a drag, and no frame before it, is told as its last change") {
    Placing placing;
    const auto ends = [&] {
        const auto& calls = placing.harness.application.calls;
        return std::count_if(calls.begin(), calls.end(), [](const std::string& call) {
            return call.starts_with("place_thing") && call.ends_with(" end");
        });
    };
    const ImVec2 from = placing.middle("gizmo.side");
    placing.harness.move(from.x, from.y);
    placing.harness.press();
    placing.harness.move(from.x + 30, from.y);
    DOCTEST_CHECK(placing.harness.application.asked("place_thing"));
    DOCTEST_CHECK(ends() == 0);
    placing.harness.release();
    placing.harness.frame(3);
    DOCTEST_CHECK(ends() == 1);
}

DOCTEST_TEST_CASE("the thing follows the mouse over the ground") {
    Placing placing;
    placing.drag("gizmo.ground", 60, 30);
    DOCTEST_CHECK(placing.values().move_up == 0);
    DOCTEST_CHECK(std::hypot(placing.values().move_right, placing.values().move_forward) > 0);
}

DOCTEST_TEST_CASE("with Ctrl a drag goes in steps") {
    Placing placing;
    placing.harness.modifiers(false, true, false);
    placing.pull("gizmo.side", 43);
    placing.drag("gizmo.turn", 31, 17);
    constexpr double Step = 0.1, Rounding = 1e-9;  // a tenth of the thing's height, which is 1
    const double steps = placing.values().move_right / Step;
    DOCTEST_CHECK(std::abs(steps - std::round(steps)) < Rounding);
    DOCTEST_CHECK(std::abs(std::remainder(placing.values().turn, 15)) < Rounding);
    placing.harness.modifiers(false, false, false);
}

DOCTEST_TEST_CASE("beside the handles the mouse turns the view; Esc puts them away") {
    Placing placing;
    const auto before = placing.harness.application.model().camera;
    const auto picture = placing.harness.rect("viewport");
    const ImVec2 corner{picture.x + picture.width * 0.9f, picture.y + picture.height * 0.5f};
    placing.harness.drag(corner, {corner.x - 50, corner.y});
    DOCTEST_CHECK(placing.values() == edit::RearrangeSettings{});
    DOCTEST_CHECK_FALSE(placing.harness.application.model().camera == before);
    placing.harness.key(key::Escape);
    placing.harness.frame(2);
    DOCTEST_CHECK(placing.harness.application.asked("use_placing off"));
}

DOCTEST_TEST_CASE("after another step the numbers begin anew") {
    Placing placing;
    placing.pull("gizmo.side", 40);
    DOCTEST_REQUIRE(placing.values().move_right > 0);
    placing.harness.frame(2);
    placing.harness.application.model().placing = false;  // as after an undo
    placing.harness.frame(2);
    DOCTEST_CHECK(placing.values() == edit::RearrangeSettings{});
}

DOCTEST_TEST_CASE("the heal brush asks once, when its stroke is whole, and labels nothing") {
    Harness harness({1280, 720, 1, Situation::Located, false});
    harness.key('J');
    DOCTEST_CHECK(harness.shell.state().viewport.tool == ui::Tool::Heal);
    harness.application.calls.clear();
    const auto picture = harness.rect("viewport");
    const ImVec2 from{picture.x + picture.width * 0.4f, picture.y + picture.height * 0.6f};
    harness.drag(from, {from.x + 60, from.y});
    const auto& calls = harness.application.calls;
    DOCTEST_CHECK(std::count_if(calls.begin(), calls.end(), [](const std::string& call) {
                      return call.starts_with("heal_stroke");
                  }) == 1);
    DOCTEST_CHECK_FALSE(harness.application.asked("select"));
    DOCTEST_CHECK_FALSE(harness.application.asked("add_label"));
}

}  // namespace gizmo_test
