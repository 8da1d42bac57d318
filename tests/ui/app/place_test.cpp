// Things that are deleted with their hole healed, or placed by hand, with the application behind it.
#include <algorithm>
#include <cmath>

#include "engine/heal/heal.h"
#include "engine/io/project/load_scene.h"
#include "engine/io/scene/scene_file.h"
#include "engine/pipeline/models/installed.h"
#include "engine/pipeline/scene/placed_shadow.h"
#include "engine/scene/label_ops.h"
#include "tests/ui/app/session.h"

namespace place_test {

using namespace gse;
using namespace gse::test;

namespace {

bool says_error(const app::Application& app) {
    const auto& toasts = app.model().toasts;
    return std::any_of(toasts.begin(), toasts.end(), [](const auto& toast) { return toast.is_error; });
}

enum class LabelledBy { Colour, Search };

/// The sample with a label of its bear's splats: most of them, by colour, or all that a search finds.
struct Labelled : Session {
    explicit Labelled(LabelledBy way = LabelledBy::Colour, const app::ApplicationOptions& options = {})
        : Session(options) {
        open_bear();
        if (way == LabelledBy::Search) app.run(command::Locate{});
        else label_by_colour();
        DOCTEST_REQUIRE(settled());
        DOCTEST_REQUIRE(app.model().labelled > 0);
        app.run(command::UsePlacing{true});
        app.update(preview);
    }
    void label_by_colour() {
        app.run(command::PickRows{{localize::RowProperty::Colour, {0.8f, 0.1f, 0.1f}, 0.25f, false, false}});
        DOCTEST_REQUIRE(until([&] { return app.model().picked.count > 0; }));
        app.run(command::UsePicked{ui::PickedUse::NewLabel});
        app.run(command::DropPicked{});
        app.update(preview);
    }
    const DocumentState& state() const { return app.document().state(); }
    const std::vector<std::uint8_t>& bits() const {
        return *state().labels.at(static_cast<std::size_t>(state().active_label)).bits;
    }
    Vec3 centre() const {
        Vec3 sum;
        double count = 0;
        const auto position = state().current.position();
        for (std::size_t row = 0; row < bits().size(); ++row) {
            if (bits()[row] == 0) continue;
            sum = sum + Vec3{position[row * 3], position[row * 3 + 1], position[row * 3 + 2]};
            count += 1;
        }
        return sum * (1 / count);
    }
    void place(const edit::RearrangeSettings& settings) {
        app.run(command::PlaceThing{settings, false});
        app.update(preview);
    }
};

edit::RearrangeSettings to_the_right(double by) {
    edit::RearrangeSettings settings;
    settings.move_right = by;
    return settings;
}

}  // namespace

DOCTEST_TEST_CASE("a thing that is dragged is one edit and one step of undo, and nothing else changes") {
    const Place place;
    Labelled session;
    auto& app = session.app;
    const auto before = session.state().current;
    const auto bits = session.bits();
    const Vec3 centre = session.centre();
    const auto at = app.document().position();
    DOCTEST_REQUIRE(app.model().placed);
    const Vec3 side = app.model().placed->side;
    session.until([&] { return !session.preview.last.moving; }, 10);
    for (const double by : {0.1, 0.3, 0.5}) session.place(to_the_right(by));
    DOCTEST_CHECK(session.preview.last.moving);  // its resolution may drop, as for the camera
    DOCTEST_CHECK(app.model().placing);
    DOCTEST_CHECK(app.document().position() == at + 1);
    DOCTEST_CHECK(session.state().stack.size() == 1);
    constexpr double Rounding = 1e-4;  // of means of floats
    DOCTEST_CHECK(length(session.centre() - centre - side * 0.5) < Rounding);
    std::size_t elsewhere = 0;
    for (std::size_t row = 0; row < before.size(); ++row)
        elsewhere += bits[row] == 0 && !same_row(before.spans(), row, session.state().current.spans(), row);
    DOCTEST_CHECK(elsewhere == 0);
    session.place({});  // as it was
    DOCTEST_CHECK(app.document().position() == at);
    DOCTEST_CHECK_FALSE(app.model().placing);
    DOCTEST_CHECK(length(session.centre() - centre) < Rounding);
}

namespace {

/// Rows of the ground whose colour differs between two states with the same rows: those that are darker, and
/// those that are lighter, each with its mean position.
struct LightChange {
    std::size_t darker = 0, lighter = 0;
    Vec3 dark{}, light{};

    LightChange(const GaussianSet& before, const GaussianSet& after, const std::vector<std::uint8_t>& thing) {
        const auto stride = before.sh().size() / before.size();
        for (std::size_t row = 0; row < before.size(); ++row) {
            const auto p = before.position().subspan(row * 3, 3);
            const float change = after.sh()[row * stride] - before.sh()[row * stride];
            if (thing[row] != 0 || change == 0) continue;
            (change < 0 ? dark : light) = (change < 0 ? dark : light) + Vec3{p[0], p[1], p[2]};
            ++(change < 0 ? darker : lighter);
        }
        dark = dark * (1.0 / std::max<double>(1, static_cast<double>(darker)));
        light = light * (1.0 / std::max<double>(1, static_cast<double>(lighter)));
    }
};

/// The sample with its bear labelled by a search, and what it was before anything was dragged.
struct Shadowed : Labelled {
    GaussianSet before;
    std::vector<std::uint8_t> marked;
    std::size_t at = 0;  // in the history
    ui::PlacedThing thing;

    explicit Shadowed(const app::ApplicationOptions& options = {})
        : Labelled(LabelledBy::Search, options), before(state().current), marked(bits()),
          at(app.document().position()) {
        DOCTEST_REQUIRE(app.model().placed);
        thing = *app.model().placed;
    }
    LightChange change_from(const GaussianSet& other) const { return {other, state().current, marked}; }
    LightChange change() const { return change_from(before); }
    /// Distance of a place to the right of where the bear stood.
    double right(const Vec3& where) const { return dot(where - thing.foot, thing.side); }
    void check_one_step() const {
        DOCTEST_CHECK(app.document().position() == at + 1);
        DOCTEST_CHECK(state().stack.size() == 1);
    }
};

}  // namespace

DOCTEST_TEST_CASE(
    "the shadow comes while a drag rests, and follows as it goes on, in the same step of undo") {
    if (!networks()) return;
    const Place place;
    Shadowed session;
    auto& app = session.app;
    session.place(to_the_right(1.0));
    DOCTEST_CHECK(session.change().darker == 0);  // nothing is measured yet
    DOCTEST_REQUIRE(
        session.until([&] { return session.change().darker > 0; }, 60));  // the drag has not ended
    const double there = session.right(session.change().dark);
    session.place(to_the_right(1.3));
    DOCTEST_REQUIRE(session.change().darker > 0);                        // at once
    DOCTEST_CHECK(session.right(session.change().dark) - there > 0.15);  // of 0.3
    session.check_one_step();
    const auto dragged = session.state().current;
    app.run(command::PlaceThing{to_the_right(1.3)});
    app.update(session.preview);
    DOCTEST_CHECK(session.change_from(dragged).darker == 0);  // its end changes nothing
    DOCTEST_CHECK(session.change_from(dragged).lighter == 0);
    app.run(command::Undo{});
    app.update(session.preview);
    DOCTEST_CHECK(session.state().current.shares_all_with(session.before));
}

DOCTEST_TEST_CASE("in a large scene the shadow waits for every rest of a drag, in the same step of undo") {
    if (!networks()) return;
    const Place place;
    Shadowed session({.most_shaded_while_dragging = 1});
    auto& app = session.app;
    session.place(to_the_right(1.0));
    DOCTEST_REQUIRE(session.until([&] { return session.change().darker > 0; }, 60));
    const double there = session.right(session.change().dark);
    app.run(command::PlaceThing{to_the_right(1.3), false});
    DOCTEST_CHECK(session.change().darker == 0);  // it moves without its shadow
    DOCTEST_REQUIRE(session.until([&] { return session.change().darker > 0; }, 60));
    DOCTEST_CHECK(session.right(session.change().dark) - there > 0.15);  // of 0.3
    session.check_one_step();
    app.run(command::Undo{});
    app.update(session.preview);
    DOCTEST_CHECK(session.state().current.shares_all_with(session.before));
}

DOCTEST_TEST_CASE("where a drag has ended, the thing's shadow has gone along, in the same step of undo") {
    if (!networks()) return;
    const Place place;
    Shadowed session;
    auto& app = session.app;
    session.place(to_the_right(1.2));
    const auto dragged = session.state().current;
    DOCTEST_CHECK(session.change().darker == 0);
    app.run(command::PlaceThing{to_the_right(1.2)});
    DOCTEST_REQUIRE(session.until([&] { return session.change().darker > 0; }, 60));
    session.check_one_step();
    DOCTEST_CHECK(app.model().placing);
    const LightChange change = session.change();
    DOCTEST_REQUIRE(change.lighter > 0);
    DOCTEST_CHECK(session.right(change.dark) - session.right(change.light) > 0.6);  // of 1.2
    std::size_t moved_back = 0;  // the thing itself is where the drag has left it
    for (std::size_t row = 0; row < session.marked.size(); ++row)
        moved_back +=
            session.marked[row] != 0 && !same_row(dragged.spans(), row, session.state().current.spans(), row);
    DOCTEST_CHECK(moved_back == 0);

    session.place(to_the_right(1.0));
    DOCTEST_CHECK(session.change().darker > 0);  // measured already
    app.run(command::HealPlace{});
    app.update(session.preview);
    DOCTEST_REQUIRE(session.state().stack.size() == 2);
    app.run(command::Undo{});
    app.run(command::Undo{});
    app.update(session.preview);
    DOCTEST_CHECK(session.state().current.shares_all_with(session.before));
}

DOCTEST_TEST_CASE("the shadow of a thing that is put back where it stood changes nothing") {
    if (!networks()) return;
    const Place place;
    Labelled session(LabelledBy::Search);
    const auto& set = session.state().current;
    const auto healed = heal::remove_and_heal({set, session.bits(), session.state().info.up, {}});
    const std::vector<Affine> here{Affine{}};
    const auto light = pipeline::light_after(set, session.bits(), healed.shadow_measured, here, true);
    DOCTEST_CHECK(std::all_of(light.begin(), light.end(), [](const Vec3& one) { return one == Vec3(1); }));
    const auto copied = pipeline::light_after(set, session.bits(), healed.shadow_measured, here, false);
    DOCTEST_CHECK(std::any_of(copied.begin(), copied.end(), [](const Vec3& one) { return one.x < 0.9; }));
}

DOCTEST_TEST_CASE("copies join the label; a change that cannot be made is said and changes nothing") {
    const Place place;
    Labelled session;
    const auto rows = session.state().current.size();
    const auto labelled = session.app.model().labelled;
    edit::RearrangeSettings settings;
    settings.copies = 2;
    session.place(settings);
    DOCTEST_CHECK(session.state().current.size() == rows + labelled);
    DOCTEST_CHECK(session.until(  // counted once nothing moves any more
        [&] { return session.app.model().statistics.count == rows + labelled; }, 30));
    session.app.run(command::Undo{});
    session.app.update(session.preview);
    settings = {};
    settings.change = "sideways";
    session.place(settings);
    DOCTEST_CHECK(session.state().current.size() == rows);
    DOCTEST_CHECK(session.state().stack.empty());
    DOCTEST_CHECK(says_error(session.app));
}

DOCTEST_TEST_CASE("delete and heal is one edit; undo brings the thing back") {
    const Place place;
    Labelled session;
    auto& app = session.app;
    const auto before = session.state().current;
    const auto at = app.document().position();
    app.run(command::HealLabelledSplats{});
    DOCTEST_REQUIRE(session.idle());
    app.update(session.preview);
    DOCTEST_REQUIRE(session.state().stack.size() == 1);
    DOCTEST_CHECK(session.state().stack[0].name == "Delete and heal");
    DOCTEST_CHECK(app.document().position() == at + 1);
    DOCTEST_CHECK(std::count(session.bits().begin(), session.bits().end(), std::uint8_t{1}) == 0);
    app.run(command::Undo{});
    app.update(session.preview);
    DOCTEST_CHECK(session.state().current.shares_all_with(before));
}

DOCTEST_TEST_CASE("the place that a thing has left is healed behind it") {
    const Place place;
    Labelled session;
    auto& app = session.app;
    app.run(command::HealPlace{});  // nothing was placed
    app.update(session.preview);
    DOCTEST_CHECK(session.state().stack.empty());
    session.place(to_the_right(2));
    const Vec3 centre = session.centre();
    app.run(command::HealPlace{});
    DOCTEST_REQUIRE(session.idle());
    app.update(session.preview);
    DOCTEST_REQUIRE(session.state().stack.size() == 2);  // the shadow that it has left, at least
    DOCTEST_CHECK(session.state().stack[1].name == "Heal the place");
    DOCTEST_CHECK(session.state().stack[1].delta->changed.empty());
    constexpr double Rounding = 1e-4;  // of means of floats
    DOCTEST_CHECK(length(session.centre() - centre) < Rounding);
}

DOCTEST_TEST_CASE("a brush heals what it is painted over, without a label, as one step of undo") {
    const Place place;
    Session session;
    session.open_bear();
    auto& app = session.app;
    const auto before = app.document().state().current;
    const auto at = app.document().position();
    ui::ScreenRegion stroke;
    const auto& camera = app.model().camera;
    stroke.circles = {{static_cast<float>(camera.width) * 0.5f, static_cast<float>(camera.height) * 0.85f}};
    stroke.radius_px = 12;
    app.run(command::HealStroke{stroke});
    DOCTEST_REQUIRE(session.idle());
    app.update(session.preview);
    DOCTEST_REQUIRE(app.document().state().stack.size() == 1);
    const auto& delta = *app.document().state().stack[0].delta;
    DOCTEST_CHECK(delta.removed.size() > 0);
    DOCTEST_CHECK(delta.changed.empty());
    DOCTEST_CHECK(app.document().state().labels.empty());
    DOCTEST_CHECK(app.document().position() == at + 1);
    app.run(command::Undo{});
    app.update(session.preview);
    DOCTEST_CHECK(app.document().state().current.shares_all_with(before));
}

namespace {

void put_in(Session& session, const fs::path& guest) {
    session.app.run(command::PutIn{guest});
    DOCTEST_REQUIRE(session.idle());
    session.app.update(session.preview);
}

}  // namespace

DOCTEST_TEST_CASE("a scene that is put in is labelled by its name, placed, and taken out by undo") {
    const Place place;
    Session session;
    session.open_bear();
    auto& app = session.app;
    const auto rows = app.document().state().current.size();
    const fs::path guest = pipeline::assets_path() / "scenes/bear/scene.ply";
    app.run(command::UsePlacing{true});
    put_in(session, guest);
    const auto& state = app.document().state();
    DOCTEST_CHECK(state.current.size() == 2 * rows);
    DOCTEST_REQUIRE(state.active_label >= 0);
    DOCTEST_CHECK(state.labels.at(static_cast<std::size_t>(state.active_label)).name == "bear");
    DOCTEST_CHECK(app.model().labelled == rows);
    DOCTEST_CHECK(app.model().placed);
    put_in(session, "/nowhere/guitar.ply");
    DOCTEST_CHECK(app.document().state().current.size() == 2 * rows);
    DOCTEST_CHECK(says_error(app));
    app.run(command::Undo{});
    app.update(session.preview);
    DOCTEST_CHECK(app.document().state().current.size() == rows);
}

namespace {

/// Scene file "guitar.ply": the red splats of the sample alone, and all of one colour.
fs::path guest_file(const fs::path& folder) {
    Scene scene = load_scene(pipeline::assets_path() / "scenes/bear/scene.ply");
    const auto stride = scene.gaussians.sh().size() / scene.gaussians.size();
    std::vector<unsigned char> keep(scene.gaussians.size());
    for (std::size_t row = 0; row < keep.size(); ++row) {
        const float* sh = &scene.gaussians.sh()[row * stride];
        keep[row] = sh[0] > sh[1] + 0.5f ? 1 : 0;
    }
    GaussianData data = scene.gaussians.filtered(keep).to_data();
    for (std::size_t row = 0; row < data.size(); ++row)
        for (std::size_t channel = 0; channel < 3; ++channel)
            data.sh[row * stride + channel] = channel == 0 ? 0.5f : 0.0f;
    scene.gaussians = GaussianSet(std::move(data));
    scene.extra = {};
    const fs::path path = folder / "guitar.ply";
    save_scene(path, scene);
    return path;
}

const NamedLabel* label_called(const DocumentState& state, const std::string& name) {
    for (const auto& label : state.labels)
        if (label.name == name) return &label;
    return nullptr;
}

/// The rows of the state that the label does not mark.
GaussianSet others(const DocumentState& state, const NamedLabel& label) {
    std::vector<unsigned char> keep(state.current.size());
    for (std::size_t row = 0; row < keep.size(); ++row) keep[row] = (*label.bits)[row] == 0 ? 1 : 0;
    return state.current.filtered(keep);
}

bool equal_rows(const GaussianSet& a, const GaussianSet& b) {
    bool equal = a.size() == b.size();
    for (std::size_t row = 0; equal && row < a.size(); ++row)
        equal = same_row(a.spans(), row, b.spans(), row);
    return equal;
}

/// Asks for the sentence about the guitar, quickly.
void ask(app::Application& app, const std::string& prompt) {
    auto request = app.model().request;
    request.source = "guitar";
    request.prompt = prompt;
    request.target.clear();
    request.method = "views";
    request.edited_views = 2;
    app.run(command::SetRequest{request});
}

/// Makes the edit and applies it.
void edit_and_apply(Session& session, const std::string& prompt) {
    auto& app = session.app;
    ask(app, prompt);
    app.update(session.preview);
    DOCTEST_CHECK(app.model().scope.by_label);
    DOCTEST_CHECK(app.model().scope.label == "guitar");
    app.run(command::Edit{});
    DOCTEST_REQUIRE(session.settled());
    DOCTEST_REQUIRE(app.model().result_waiting);
    app.run(command::ApplyResult{});
    app.update(session.preview);
}

}  // namespace

DOCTEST_TEST_CASE("a scene that is put in is edited by its name, saved, exported in one file, and undone") {
    if (!networks()) return;
    const Place place;
    const fs::path guest = guest_file(place.folder), project = place.folder / "both.gsep";
    Session session;
    session.open_bear();
    auto& app = session.app;
    const auto host = app.document().state().current;
    put_in(session, guest);
    const auto together = app.document().state().current;
    app.run(command::UsePlacing{true});
    app.update(session.preview);
    app.run(command::PlaceThing{to_the_right(0.2)});
    DOCTEST_REQUIRE(session.settled());  // it has no shadow that would go along
    DOCTEST_CHECK(app.document().state().stack.back().changed_outside_label == 0);
    app.run(command::HealPlace{});
    app.update(session.preview);
    DOCTEST_CHECK(app.document().state().stack.size() == 2);
    app.run(command::Undo{});
    app.update(session.preview);
    DOCTEST_REQUIRE(app.document().state().current.shares_all_with(together));
    edit_and_apply(session, "make the guitar blue");
    const DocumentState blue = app.document().state();
    DOCTEST_REQUIRE(label_called(blue, "guitar") != nullptr);
    DOCTEST_CHECK(equal_rows(others(blue, *label_called(blue, "guitar")), host));
    edit_and_apply(session, "make the guitar smaller");
    const DocumentState state = app.document().state();
    DOCTEST_REQUIRE(state.stack.size() == 3);
    const NamedLabel* guitar = label_called(state, "guitar");
    DOCTEST_REQUIRE(guitar != nullptr);
    DOCTEST_CHECK(count_labelled(*guitar) > 0);
    app.run(command::SaveProject{project});
    DOCTEST_REQUIRE(session.idle());

    Session again;
    again.app.run(command::Open{project});
    DOCTEST_REQUIRE(again.until([&] { return again.app.model().document != nullptr; }));
    const auto& read = again.app.document().state();
    DOCTEST_CHECK(equal_rows(read.current, state.current));
    DOCTEST_REQUIRE(label_called(read, "guitar") != nullptr);
    auto exports = again.app.model().exports;
    exports.scene_path = (place.folder / "both.ply").string();
    exports.with_labels = true;
    again.app.run(command::SetExports{exports});
    again.app.run(command::ExportScene{});
    DOCTEST_REQUIRE(again.idle());
    const Scene written = load_scene(place.folder / "both.ply");
    DOCTEST_CHECK(equal_rows(written.gaussians, state.current));
    DOCTEST_REQUIRE(written.labels.labels.size() == 1);
    DOCTEST_CHECK(written.labels.labels[0].name == "guitar");

    app.run(command::Undo{});
    app.run(command::Undo{});
    app.update(session.preview);
    DOCTEST_CHECK(app.document().state().current.shares_all_with(together));
    app.run(command::Undo{});
    app.update(session.preview);
    DOCTEST_CHECK(app.document().state().current.shares_all_with(host));
}

DOCTEST_TEST_CASE("a sentence may name what was put in as the other thing") {
    if (!networks()) return;
    const Place place;
    const fs::path guest = guest_file(place.folder);
    Session session;
    session.open_bear();
    auto& app = session.app;
    put_in(session, guest);
    app.run(command::UsePlacing{true});
    app.update(session.preview);
    app.run(command::PlaceThing{to_the_right(1.5)});  // it was put in front of the bear
    DOCTEST_REQUIRE(session.settled());
    ask(app, "move the bear to the left of the guitar");
    auto request = app.model().request;
    request.source = "bear";
    app.run(command::SetRequest{request});
    app.update(session.preview);
    app.run(command::Edit{});
    DOCTEST_REQUIRE(session.settled());
    for (const auto& toast : app.model().toasts) DOCTEST_INFO(toast.text);
    DOCTEST_CHECK_FALSE(says_error(app));
    DOCTEST_CHECK(app.model().result_waiting);
}

}  // namespace place_test
