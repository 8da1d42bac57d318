// Handles of the labelled thing: each drag asks for its kind of change, in steps while Ctrl is held.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
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

namespace {

/// A camera four units from the thing, at an angle to its side.
Camera from_around(double degrees, double height) {
    const Vec3 middle{0, -0.5, 0};
    const double angle = degrees * std::numbers::pi / 180;
    const Vec3 eye = middle + Vec3{-4 * std::cos(angle), -height, 4 * std::sin(angle)};
    return Camera::look_at(eye, middle, {0, -1, 0}, 0.87, 640, 480);
}

/// Middle of the placed thing.
Vec3 middle_of(const ui::PlacedThing& thing, const edit::RearrangeSettings& values) {
    return thing.foot + thing.side * values.move_right + thing.front * values.move_forward +
           thing.up * (values.move_up + thing.height * values.resize / 2);
}

}  // namespace

DOCTEST_TEST_CASE("no drag throws the thing out of the picture, far away or behind the eye") {
    constexpr double Edge = 1;          // pixels
    constexpr double FarthestDrag = 3;  // of the eye's distance
    int drags = 0;
    for (const double degrees : {2.0, 25.0, 90.0, 185.0, 300.0})
        for (const double height : {0.3, 1.5})
            for (const char* handle : {"gizmo.side", "gizmo.up", "gizmo.front", "gizmo.ground"})
                for (const ImVec2 corner : {ImVec2{-50, -50}, {1400, 300}, {700, 900}, {500, 60}}) {
                    Placing placing;
                    auto& model = placing.harness.application.model();
                    model.camera = from_around(degrees, height);
                    placing.harness.frame(3);
                    if (placing.harness.find(handle) == nullptr) continue;
                    const Camera& camera = model.camera;
                    const double eye = length(camera.centre() - middle_of(*model.placed, {}));
                    placing.harness.drag(placing.middle(handle), corner);
                    ++drags;
                    DOCTEST_CAPTURE(degrees);
                    DOCTEST_CAPTURE(height);
                    DOCTEST_CAPTURE(std::string(handle));
                    DOCTEST_CAPTURE(corner.x);
                    const Vec3 moved = middle_of(*model.placed, placing.values());
                    DOCTEST_CHECK(length(moved - middle_of(*model.placed, {})) <= 1.01 * FarthestDrag * eye);
                    const Vec3 at = camera.to_camera(moved);
                    DOCTEST_REQUIRE(at.z > 0);
                    const double x = camera.fx * at.x / at.z + camera.cx,
                                 y = camera.fy * at.y / at.z + camera.cy;
                    DOCTEST_CHECK((x >= -Edge && x <= camera.width + Edge));
                    DOCTEST_CHECK((y >= -Edge && y <= camera.height + Edge));
                }
    DOCTEST_CHECK(drags > 120);
}

DOCTEST_TEST_CASE(
    "the thing stays under the mouse along an arrow, and one that points at the eye is not shown") {
    Placing placing;
    auto& model = placing.harness.application.model();
    model.camera = from_around(40, 1);
    placing.harness.frame(3);
    const ImVec2 from = placing.middle("gizmo.side"), centre = placing.middle("gizmo.ground");
    const float x = from.x - centre.x, y = from.y - centre.y;
    placing.harness.drag(from, {from.x + x * 1.5f, from.y + y * 1.5f});
    placing.harness.frame(2);
    const ImVec2 now = placing.middle("gizmo.ground");  // has followed by as much
    constexpr float Pixels = 12;  // where it was grabbed and where it has come to, the perspective differs
    DOCTEST_CHECK(std::abs(now.x - centre.x - x * 1.5f) < Pixels);
    DOCTEST_CHECK(std::abs(now.y - centre.y - y * 1.5f) < Pixels);

    Placing end_on;
    end_on.harness.application.model().camera = from_around(0, 0.3);
    end_on.harness.frame(3);
    DOCTEST_CHECK(end_on.harness.find("gizmo.side") == nullptr);
    DOCTEST_CHECK(end_on.harness.find("gizmo.up") != nullptr);
    DOCTEST_CHECK(end_on.harness.find("gizmo.front") != nullptr);
}

DOCTEST_TEST_CASE("while a finished edit waits, no handle is shown or dragged, and the hint says why") {
    Placing placing;
    const ImVec2 from = placing.middle("gizmo.side");
    placing.harness.application.model().result_waiting = true;
    placing.harness.frame(2);
    DOCTEST_CHECK(placing.harness.find("gizmo.side") == nullptr);
    placing.harness.application.calls.clear();
    placing.harness.drag(from, {from.x + 60, from.y});
    DOCTEST_CHECK_FALSE(placing.harness.application.asked("place_thing"));
    DOCTEST_CHECK(placing.values() == edit::RearrangeSettings{});
    placing.harness.application.model().result_waiting = false;
    placing.harness.frame(2);
    DOCTEST_CHECK(placing.harness.find("gizmo.side") != nullptr);
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
