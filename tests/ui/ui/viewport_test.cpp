// Mouse in the viewport: camera, tools, set operations, wipe and flip.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "engine/localize/row_property.h"
#include "engine/scene/framing.h"
#include "tests/ui/support/harness.h"
#include "ui/keys/keys.h"
#include "ui/state/state.h"

namespace gse::test::viewport_test {
namespace {

namespace key = ui::key;

Harness::Options with_depth() { return {1280, 720, 1, Situation::Located, true}; }

ImVec2 in_viewport(const Harness& harness, float x, float y) {
    const auto rect = harness.rect("viewport");
    return {std::floor(rect.x + rect.width * x), std::floor(rect.y + rect.height * y)};
}

Vec3 pixel(const Camera& camera, const Vec3& world) {
    const Vec3 p = camera.to_camera(world);
    return {(camera.fx * p.x / p.z + camera.cx) / camera.width,
            (camera.fy * p.y / p.z + camera.cy) / camera.height, p.z};
}

double turned(const Camera& a, const Camera& b) {
    return std::acos(std::min(1.0, dot(a.forward(), b.forward())));
}

}  // namespace

DOCTEST_TEST_CASE("the viewport asks for its size in pixels once") {
    Harness harness({1280, 720, 1, Situation::Scene, false});
    const auto rect = harness.rect("viewport");
    DOCTEST_CHECK(harness.application.model().viewport_width == static_cast<int>(rect.width));
    DOCTEST_CHECK(harness.application.model().viewport_height == static_cast<int>(rect.height));
    DOCTEST_CHECK(rect.x == std::floor(rect.x));
    harness.application.calls.clear();
    harness.frame(5);
    DOCTEST_CHECK(!harness.application.asked("set_viewport_size"));
}

DOCTEST_TEST_CASE("left drag orbits, right drag pans, middle drag orbits or pans") {
    Harness harness({1280, 720, 1, Situation::Scene, false});
    const auto from = in_viewport(harness, 0.5f, 0.5f), to = in_viewport(harness, 0.6f, 0.55f);
    const auto& camera = harness.application.model().camera;
    Camera before = camera;
    harness.drag(from, to, 0);
    DOCTEST_CHECK(turned(before, camera) > 0.05);
    before = camera;
    harness.drag(from, to, 1);
    DOCTEST_CHECK(turned(before, camera) < 1e-6);
    DOCTEST_CHECK(length(before.centre() - camera.centre()) > 0.01);
    before = camera;
    harness.drag(from, to, 2);
    DOCTEST_CHECK(turned(before, camera) > 0.05);
    before = camera;
    harness.modifiers(true, false, false);
    harness.drag(from, to, 2);
    DOCTEST_CHECK(turned(before, camera) < 1e-6);
}

DOCTEST_TEST_CASE("the wheel zooms to what is under the cursor, then everything rests") {
    Harness harness(with_depth());
    harness.frame(3);
    const auto at = in_viewport(harness, 0.45f, 0.6f);
    const auto rect = harness.rect("viewport");
    const auto& model = harness.application.model();
    const double x = (at.x - rect.x) / rect.width, y = (at.y - rect.y) / rect.height;
    const double depth = model.viewport_depth->at(static_cast<int>(x * model.viewport_depth->width),
                                                  static_cast<int>(y * model.viewport_depth->height), 0);
    DOCTEST_REQUIRE(depth > 0);
    const Camera before = model.camera;
    const Vec3 in_camera{(x * before.width - before.cx) / before.fx * depth,
                         (y * before.height - before.cy) / before.fy * depth, depth};
    const Vec3 point = before.centre() + before.rotation.transposed() * in_camera;
    harness.move(at.x, at.y);
    harness.wheel(3);
    const Vec3 now = pixel(model.camera, point);
    DOCTEST_CHECK(now.z < depth * 0.8);
    DOCTEST_CHECK(now.x == doctest::Approx(x).epsilon(1e-3));
    DOCTEST_CHECK(now.y == doctest::Approx(y).epsilon(1e-3));
    harness.frame(60);
    harness.application.calls.clear();
    harness.frame(20);
    DOCTEST_CHECK(!harness.application.asked("set_camera"));
    DOCTEST_CHECK(!harness.shell.animating());
}

DOCTEST_TEST_CASE("a double click turns around what was hit") {
    Harness harness(with_depth());
    harness.frame(3);
    const auto at = in_viewport(harness, 0.45f, 0.6f);
    const Vec3 before = harness.shell.state().viewport.camera.pose().pivot;
    harness.move(at.x, at.y);
    for (int press = 0; press < 2; ++press) {
        harness.press();
        harness.release();
    }
    harness.frame(60);
    DOCTEST_CHECK(length(harness.shell.state().viewport.camera.pose().pivot - before) > 1e-3);
}

DOCTEST_TEST_CASE("a camera that the application sets is taken over, our own late ones are not") {
    Harness harness({1280, 720, 1, Situation::Scene, false});
    auto& model = harness.application.model();
    const Camera view = harness.application.document().state().views[5].camera;
    model.camera = view;
    harness.frame(2);
    DOCTEST_CHECK(ui::same_view(harness.shell.state().viewport.camera.camera(), view));
    DOCTEST_CHECK(harness.shell.state().viewport.selected_view == 5);
    const Camera old = model.camera;
    harness.drag(in_viewport(harness, 0.5f, 0.5f), in_viewport(harness, 0.7f, 0.5f));
    const Camera newest = harness.shell.state().viewport.camera.camera();
    DOCTEST_CHECK(turned(old, newest) > 0.05);
    DOCTEST_CHECK(ui::same_view(model.camera, newest));
}

DOCTEST_TEST_CASE("keys fly, frame and go home") {
    Harness harness({1280, 720, 1, Situation::Located, false});
    const auto& camera = harness.application.model().camera;
    Vec3 before = camera.centre();
    harness.hold('W', true);
    harness.frame(10);
    harness.hold('W', false);
    DOCTEST_CHECK(dot(camera.centre() - before, camera.forward()) > 0.01);
    before = camera.centre();
    harness.hold('E', true);
    harness.frame(10);
    harness.hold('E', false);
    DOCTEST_CHECK(dot(camera.centre() - before, harness.application.model().orbit.up) > 0.01);
    harness.key('F');
    harness.frame(90);
    // The bear is smaller than the scene with its ground: the camera went nearer.
    DOCTEST_CHECK(harness.shell.state().viewport.camera.pose().distance <
                  harness.application.model().orbit.radius);
    harness.key(ui::key::Home);
    harness.frame(90);
    const auto& state = harness.application.document().state();
    DOCTEST_CHECK(length(harness.shell.state().viewport.camera.pose().pivot -
                         framing_bounds(state.current, *state.labels.at(0).bits).centre()) < 1e-6);
    // With Ctrl they are commands, not flight.
    before = camera.centre();
    harness.modifiers(false, true, false);
    harness.hold('S', true);
    harness.frame(5);
    harness.hold('S', false);
    DOCTEST_CHECK(length(camera.centre() - before) < 1e-12);
}

DOCTEST_TEST_CASE("the brush paints with the operation of the keys") {
    Harness harness({1280, 720, 1, Situation::Located, false});
    const auto from = in_viewport(harness, 0.4f, 0.4f), to = in_viewport(harness, 0.6f, 0.4f);
    auto& application = harness.application;
    harness.key('B');
    DOCTEST_CHECK(harness.shell.state().viewport.tool == ui::Tool::Brush);
    harness.drag(from, to);
    DOCTEST_REQUIRE(!application.regions.empty());
    DOCTEST_CHECK(application.calls.back().ends_with("end"));
    // Without gaps: neighbouring circles overlap, over the whole way.
    float reached = 0;
    std::array<float, 2> last = application.regions.front().circles.front();
    const float scale = application.regions.front().radius_px / application.model().view.brush_px;
    for (const auto& region : application.regions)
        for (const auto& circle : region.circles) {
            DOCTEST_CHECK(std::hypot(circle[0] - last[0], circle[1] - last[1]) < region.radius_px);
            last = circle;
            reached = std::max(reached, circle[0]);
        }
    const auto rect = harness.rect("viewport");
    DOCTEST_CHECK(reached == doctest::Approx((to.x - rect.x) * scale).epsilon(0.05));
    for (const auto operation : harness.application.operations)
        DOCTEST_CHECK(operation == ui::SetOperation::Add);
    harness.application.operations.clear();
    harness.modifiers(false, true, false);
    harness.drag(from, to);
    for (const auto operation : harness.application.operations)
        DOCTEST_CHECK(operation == ui::SetOperation::Remove);
    // An intersection needs the whole stroke: one call.
    for (const bool alt : {true, false}) {
        harness.application.operations.clear();
        harness.modifiers(!alt, !alt, alt);
        harness.drag(from, to);
        DOCTEST_CHECK(harness.application.operations ==
                      std::vector<ui::SetOperation>{ui::SetOperation::Intersect});
    }
    harness.modifiers(false, false, false);
    harness.key(key::Escape);
    DOCTEST_CHECK(harness.shell.state().viewport.tool == ui::Tool::Orbit);
}

DOCTEST_TEST_CASE("a box of the tool that cuts out asks for what is in it, once") {
    Harness harness({1280, 720, 1, Situation::Located, false});
    harness.key('C');
    DOCTEST_CHECK(harness.shell.state().viewport.tool == ui::Tool::CutOut);
    harness.drag(in_viewport(harness, 0.25f, 0.25f), in_viewport(harness, 0.5f, 0.75f));
    const auto& calls = harness.application.calls;
    DOCTEST_CHECK(std::count(calls.begin(), calls.end(), "cut_out 4") == 1);
    DOCTEST_CHECK(harness.application.regions.empty());  // nothing was selected by the box itself
    const auto middle = in_viewport(harness, 0.4f, 0.5f);
    harness.drag(middle, {middle.x + 1, middle.y});  // a click: the thing under it
    DOCTEST_CHECK(std::count(calls.begin(), calls.end(), "cut_out 1") == 1);
    harness.drag(middle, {middle.x + 40, middle.y + 1});  // neither a click nor a box
    DOCTEST_CHECK(calls.back() == "cut_out 1");
    harness.click("tool.cut_out");  // in use already
    DOCTEST_CHECK(harness.shell.state().viewport.tool == ui::Tool::CutOut);
    harness.key(key::Escape);
    DOCTEST_CHECK(harness.shell.state().viewport.tool == ui::Tool::Orbit);
}

DOCTEST_TEST_CASE("who picks a tool that labels, or paints, sees what is labelled") {
    Harness harness(with_depth());
    auto& view = harness.application.model().view;
    view.tint_labels = false;  // as after Apply
    harness.frame(2);
    const auto at = in_viewport(harness, 0.5f, 0.5f);
    harness.move(at.x, at.y);
    harness.key('B');
    harness.frame();
    DOCTEST_CHECK(view.tint_labels);
    harness.key('T');  // it can be switched off again
    harness.frame();
    DOCTEST_CHECK_FALSE(view.tint_labels);
    harness.drag(at, {at.x + 40, at.y});
    DOCTEST_CHECK(view.tint_labels);
    view.tint_labels = false;
    harness.key('B');  // back to the camera
    harness.frame();
    DOCTEST_CHECK_FALSE(view.tint_labels);
}

DOCTEST_TEST_CASE("rectangle and lasso send one polygon in texture pixels") {
    Harness harness({1280, 720, 1, Situation::Located, false});
    const auto rect = harness.rect("viewport");
    auto& application = harness.application;
    // A texture at half the size, as while moving.
    application.model().viewport_width /= 2;
    application.model().viewport_height /= 2;
    harness.click("tool.rectangle");
    harness.drag(in_viewport(harness, 0.25f, 0.25f), in_viewport(harness, 0.5f, 0.75f));
    DOCTEST_REQUIRE(application.regions.size() == 1);
    DOCTEST_REQUIRE(application.regions[0].polygon.size() == 4);
    DOCTEST_CHECK(application.regions[0].polygon[2][0] == doctest::Approx(rect.width * 0.25).epsilon(0.02));
    DOCTEST_CHECK(application.regions[0].polygon[2][1] == doctest::Approx(rect.height * 0.375).epsilon(0.02));
    harness.key('L');
    const auto at = in_viewport(harness, 0.5f, 0.5f);
    harness.move(at.x, at.y);
    harness.press();
    for (int step = 0; step < 20; ++step) {
        const float angle = 0.314f * static_cast<float>(step);
        ImGui::GetIO().MousePos = {at.x + 60 * std::cos(angle), at.y + 60 * std::sin(angle)};
        harness.frame();
    }
    harness.release();
    DOCTEST_REQUIRE(application.regions.size() == 2);
    DOCTEST_CHECK(application.regions[1].polygon.size() > 10);
    // Escape while dragging: nothing is sent.
    harness.press();
    harness.hold(key::Escape, true);
    harness.release();
    harness.hold(key::Escape, false);
    DOCTEST_CHECK(application.regions.size() == 2);
}

DOCTEST_TEST_CASE("painting without a label makes one first") {
    Harness harness({1280, 720, 1, Situation::Scene, false});
    auto state = harness.application.document().state();
    state.labels.clear();
    state.active_label = -1;
    harness.application.document().apply("none", state);
    harness.key('B');
    harness.application.calls.clear();
    harness.drag(in_viewport(harness, 0.4f, 0.4f), in_viewport(harness, 0.5f, 0.4f));
    DOCTEST_REQUIRE(harness.application.calls.size() >= 2);
    DOCTEST_CHECK(harness.application.calls[0] == "add_label label");
    DOCTEST_CHECK(harness.application.calls[1].starts_with("select"));
}

DOCTEST_TEST_CASE("brush size by keys and wheel") {
    Harness harness({1280, 720, 1, Situation::Scene, false});
    const float before = harness.application.model().view.brush_px;
    harness.key(key::RightBracket);
    DOCTEST_CHECK(harness.application.model().view.brush_px > before);
    harness.key(key::LeftBracket);
    DOCTEST_CHECK(harness.application.model().view.brush_px == doctest::Approx(before));
    const auto at = in_viewport(harness, 0.5f, 0.5f);
    harness.move(at.x, at.y);
    harness.modifiers(false, false, true);
    harness.wheel(2);
    DOCTEST_CHECK(harness.application.model().view.brush_px > before);
}

DOCTEST_TEST_CASE("the wipe is dragged, the flip is held") {
    Harness harness({1280, 720, 1, Situation::Scene, false});
    harness.key('V');
    harness.frame(2);
    DOCTEST_CHECK(harness.application.model().comparison == ui::Comparison::Wipe);
    const Camera before = harness.application.model().camera;
    harness.drag(harness.middle("viewport.wipe"), in_viewport(harness, 0.8f, 0.5f));
    DOCTEST_CHECK(harness.application.model().view.wipe == doctest::Approx(0.8).epsilon(0.02));
    DOCTEST_CHECK(ui::same_view(before, harness.application.model().camera));
    harness.hold(key::Grave, true);
    DOCTEST_CHECK(harness.application.model().comparison == ui::Comparison::Original);
    harness.frame(10);
    harness.hold(key::Grave, false);
    DOCTEST_CHECK(harness.application.model().comparison == ui::Comparison::Wipe);
    harness.key('V');
    DOCTEST_CHECK(harness.application.model().comparison == ui::Comparison::None);
}

DOCTEST_TEST_CASE("the mouse over a toast or a menu does not reach the scene") {
    Harness harness({1280, 720, 1, Situation::Scene, false});
    const Camera before = harness.application.model().camera;
    const auto toast = harness.middle("toast.0");
    harness.drag(toast, {toast.x + 40, toast.y});
    DOCTEST_CHECK(ui::same_view(before, harness.application.model().camera));
    harness.click("menu.View");
    harness.move(harness.middle("menu.home").x, harness.middle("menu.home").y);
    harness.wheel(2);
    DOCTEST_CHECK(ui::same_view(before, harness.application.model().camera));
}

DOCTEST_TEST_CASE("cameras are chosen by a click and looked through by two") {
    Harness harness({1280, 720, 1, Situation::Scene, false});
    harness.application.model().view.show_views = true;
    harness.wheel(0);
    const auto at = in_viewport(harness, 0.5f, 0.5f);
    harness.move(at.x, at.y);
    harness.wheel(-8);
    // Some view's centre that is seen now.
    const auto& camera = harness.application.model().camera;
    const auto rect = harness.rect("viewport");
    const auto& views = harness.application.document().state().views;
    for (std::size_t index = 0; index < views.size(); ++index) {
        const Vec3 on = pixel(camera, views[index].camera.centre());
        const auto* toast = harness.find("toast.0");
        if (on.z < 0 || on.x < 0.1 || on.x > 0.6 || on.y < 0.2 || on.y > 0.6 || toast == nullptr) continue;
        const float x = rect.x + static_cast<float>(on.x) * rect.width,
                    y = rect.y + static_cast<float>(on.y) * rect.height;
        harness.click(x, y);
        const int chosen = harness.shell.state().viewport.selected_view;
        DOCTEST_REQUIRE(chosen >= 0);
        harness.application.calls.clear();
        harness.frame(40);
        harness.move(x, y);
        for (int press = 0; press < 2; ++press) {
            harness.press();
            harness.release();
        }
        DOCTEST_CHECK(harness.application.asked("look_through " + std::to_string(chosen)));
        return;
    }
    DOCTEST_CHECK_MESSAGE(false, "no view was in the picture");
}

DOCTEST_TEST_CASE("Left and Right step through the views in a picture that is no square") {
    Harness harness({1280, 720, 1, Situation::Scene, false});
    const auto& views = harness.application.document().state().views;
    DOCTEST_REQUIRE(views.size() > 3);
    const auto rect = harness.rect("viewport");
    DOCTEST_REQUIRE(rect.width / rect.height > 1.1 * views[0].camera.width / views[0].camera.height);
    for (const char* wanted : {"look_through 0", "look_through 1", "look_through 2"}) {
        harness.application.calls.clear();
        harness.key(key::Right);
        DOCTEST_CHECK(harness.application.asked(wanted));
        harness.frame(3);  // the camera comes back
    }
    DOCTEST_CHECK(harness.shell.state().viewport.selected_view == 2);
    harness.application.calls.clear();
    harness.key(key::Left);
    DOCTEST_CHECK(harness.application.asked("look_through 1"));
    harness.frame(3);
    const auto at = in_viewport(harness, 0.4f, 0.7f);  // a camera that was moved looks through none of them
    harness.drag(at, {at.x + 90, at.y}, 1);
    harness.application.model().camera.translation.x += 0.3;
    harness.frame(3);
    DOCTEST_CHECK(harness.shell.state().viewport.selected_view == -1);
}

DOCTEST_TEST_CASE("a click on an axis looks along it, a second one from the other side") {
    Harness harness({1280, 720, 1, Situation::Scene, false});
    const auto& camera = harness.application.model().camera;
    for (const auto& [name, axis] :
         {std::pair{"viewport.axis.x", Vec3{1, 0, 0}}, std::pair{"viewport.axis.z", Vec3{0, 0, 1}},
          std::pair{"viewport.axis.y", Vec3{0, 1, 0}}}) {
        const double distance = harness.shell.state().viewport.camera.pose().distance;
        harness.click(name);
        harness.frame(90);
        DOCTEST_CHECK(dot(camera.forward(), axis) < -0.99);
        DOCTEST_CHECK(harness.shell.state().viewport.camera.pose().distance == doctest::Approx(distance));
        harness.click(name);
        harness.frame(90);
        DOCTEST_CHECK(dot(camera.forward(), axis) > 0.99);
    }
}

DOCTEST_TEST_CASE("each end of an axis is a button, with a tool in hand, too") {
    Harness harness({1280, 720, 1, Situation::Located, false});
    const auto& camera = harness.application.model().camera;
    for (const auto& [name, axis] :
         {std::pair{"viewport.axis.-z", Vec3{0, 0, -1}}, std::pair{"viewport.axis.-x", Vec3{-1, 0, 0}},
          std::pair{"viewport.axis.-y", Vec3{0, -1, 0}}, std::pair{"viewport.axis.x", Vec3{1, 0, 0}}}) {
        harness.click(name);
        harness.frame(90);
        DOCTEST_CAPTURE(name);
        DOCTEST_CHECK(dot(camera.forward(), axis) < -0.99);
    }
    harness.key('B');
    harness.application.calls.clear();
    harness.click("viewport.axis.z");
    harness.frame(90);
    DOCTEST_CHECK(dot(camera.forward(), Vec3{0, 0, 1}) < -0.99);
    DOCTEST_CHECK(!harness.application.asked("select"));
}

DOCTEST_TEST_CASE("Home frames what is labelled, else what stands on the ground, never the lawn") {
    Harness harness({1280, 720, 1, Situation::Located, false});
    auto& model = harness.application.model();
    const auto& pose = harness.shell.state().viewport.camera.pose();
    harness.key(key::Home);
    harness.frame(90);
    const auto& state = harness.application.document().state();
    const Bounds labelled = framing_bounds(state.current, *state.labels.at(0).bits);
    DOCTEST_CHECK(length(pose.pivot - labelled.centre()) < 1e-6);
    const double near = pose.distance;
    auto unlabelled = state;
    unlabelled.active_label = 1;  // empty
    harness.application.document().apply("Choose a label", unlabelled);
    model.labelled = 0;
    harness.key(key::Home);
    harness.frame(90);
    DOCTEST_CHECK(length(pose.pivot - model.home.centre()) < 1e-6);
    DOCTEST_CHECK(pose.distance == doctest::Approx(near).epsilon(0.3));  // the bear, with its hat
    DOCTEST_CHECK(model.home.radius() < 0.7 * model.framing.radius());
}

DOCTEST_TEST_CASE("select by property takes a colour from the picture") {
    Harness harness({1280, 1440, 1, Situation::Located, true});
    harness.shell.show(ui::PanelId::Labels);
    harness.frame(3);
    harness.click("pick.open");
    harness.frame(3);
    harness.click("pick.property.Colour");
    harness.frame(3);
    const auto& state = harness.application.document().state();
    const auto mean = localize::mean_colour(state.current, *state.labels.at(0).bits);
    const auto away = [&](float x, float y) {  // of the colour clicked at from that of the thing
        harness.click("pick.colour.drop");
        harness.frame(2);
        DOCTEST_REQUIRE(harness.shell.state().viewport.tool == ui::Tool::PickColour);
        DOCTEST_CHECK(!harness.application.model().view.tint_labels);  // what is seen is what is taken
        harness.application.calls.clear();
        const auto at = in_viewport(harness, x, y);
        harness.drag(at, at, 0);
        harness.frame(2);
        DOCTEST_CHECK(harness.application.asked("pick_rows colour"));
        DOCTEST_CHECK(harness.shell.state().viewport.tool == ui::Tool::Orbit);
        const auto& colour = harness.shell.state()
                                 .pick.choices[static_cast<std::size_t>(localize::RowProperty::Colour)]
                                 .colour;
        DOCTEST_CHECK(harness.application.model().view.tint_labels);
        const auto rect = harness.rect("viewport");
        const Image* shown = harness.application.picture(harness.application.model().viewport);
        DOCTEST_REQUIRE(shown != nullptr);
        const int column = static_cast<int>(at.x - rect.x), row = static_cast<int>(at.y - rect.y);
        double sum = 0;
        for (std::size_t c = 0; c < 3; ++c)
            DOCTEST_CHECK(colour[c] == shown->at(column, row, static_cast<int>(c)));
        for (std::size_t c = 0; c < 3; ++c) sum += std::abs(static_cast<double>(colour[c]) - mean[c]);
        return sum;
    };
    const Vec3 thing = pixel(harness.application.model().camera,
                             framing_bounds(state.current, *state.labels.at(0).bits).centre());
    const auto& depth = *harness.application.model().viewport_depth;
    int lawn = depth.height - 1;  // the lowest row of the middle column that shows the ground
    while (lawn > 0 && depth.at(depth.width / 2, lawn, 0) <= 0) --lawn;
    const float ground = (static_cast<float>(lawn) - 10) / static_cast<float>(depth.height);
    const double of_lawn = away(0.5f, ground);
    DOCTEST_CHECK(away(static_cast<float>(thing.x), static_cast<float>(thing.y)) != of_lawn);
    harness.click("pick.colour.drop");
    harness.frame(2);
    harness.click("pick.property.Opacity");  // its button is gone
    harness.frame(2);
    DOCTEST_CHECK(harness.shell.state().viewport.tool == ui::Tool::Orbit);
}

}  // namespace gse::test::viewport_test
