// Splats chosen by property, hidden, and steps compared, with the application behind it.
#include <algorithm>
#include <cmath>

#include "engine/io/project/load_scene.h"
#include "tests/ui/app/session.h"

namespace selection_test {

using namespace gse;
using namespace gse::test;

namespace {

using Bits = std::vector<std::uint8_t>;

std::size_t count(const Bits& bits) {
    return static_cast<std::size_t>(std::count(bits.begin(), bits.end(), 1));
}

const Bits& labelled(const app::Application& app) {
    const auto& state = app.document().state();
    return *state.labels.at(static_cast<std::size_t>(state.active_label)).bits;
}

std::size_t invisible(const GaussianSet& set) {
    const auto logits = set.opacity_logit();
    return static_cast<std::size_t>(std::count_if(
        logits.begin(), logits.end(), [](float logit) { return std::isinf(logit) && logit < 0; }));
}

/// The sample with a label of its larger splats.
struct Labelled : Session {
    Labelled() {
        open_bear();
        app.run(command::PickRows{large(0.5f)});
        DOCTEST_REQUIRE(until([&] { return app.model().picked.count > 0; }));
        app.run(command::UsePicked{ui::PickedUse::NewLabel});
        app.run(command::DropPicked{});
        app.update(preview);
    }
    static localize::RowChoice large(float threshold) {
        return {localize::RowProperty::Size, {}, threshold, true, false};
    }
};

}  // namespace

DOCTEST_TEST_CASE(
    "colours adjusted by hand are one edit and one step of undo, of what is labelled, until something else "
    "is done") {
    const Place place;
    Labelled session;
    auto& app = session.app;
    const auto before = app.document().state().current;
    const auto at = app.document().position();
    for (const double hue : {20.0, 60.0, 90.0}) {
        app.run(command::AdjustColours{{hue}});
        app.update(session.preview);
        DOCTEST_CHECK(app.model().adjusting);
    }
    DOCTEST_CHECK(app.document().position() == at + 1);
    const auto& state = app.document().state();
    DOCTEST_REQUIRE(state.stack.size() == 1);
    DOCTEST_CHECK(state.stack[0].name == "Colours: hue 90");
    std::size_t outside = 0;
    for (std::size_t row = 0; row < before.size(); ++row)
        outside +=
            labelled(app)[row] == 0 && !same_row(before.spans(), row, state.current.spans(), row) ? 1 : 0;
    DOCTEST_CHECK(outside == 0);
    app.run(command::AdjustColours{{}});  // as it was
    app.update(session.preview);
    DOCTEST_CHECK(app.document().position() == at);
    DOCTEST_CHECK_FALSE(app.model().adjusting);
    app.run(command::AdjustColours{{90}});
    app.run(command::ClearLabel{});
    app.update(session.preview);
    DOCTEST_CHECK_FALSE(app.model().adjusting);
    app.run(command::AdjustColours{{0, 0}});  // a second edit, of everything
    app.update(session.preview);
    DOCTEST_CHECK(app.document().state().stack.size() == 2);
    DOCTEST_CHECK(app.document().state().stack[1].delta->changed.size() >
                  app.document().state().stack[0].delta->changed.size());
}

DOCTEST_TEST_CASE(
    "splats chosen by a property are shown, labelled, taken from a label and deleted; each is one step of "
    "undo") {
    const Place place;
    Session session;
    session.open_bear();
    auto& app = session.app;
    const auto at = app.document().position();
    const std::size_t all = app.document().state().current.size();
    localize::RowChoice choice{localize::RowProperty::Isolation, {}, 0.0f, false, false};
    app.run(command::PickRows{choice});
    DOCTEST_REQUIRE(
        session.until([&] { return app.model().picked.values != nullptr && !app.model().picked.working; }));
    const auto values = *app.model().picked.values;
    auto sorted = values;
    std::sort(sorted.begin(), sorted.end());
    choice.threshold = sorted[all / 2];
    app.run(command::PickRows{choice});
    app.update(session.preview);
    const auto nearer = static_cast<std::size_t>(
        std::count_if(values.begin(), values.end(), [&](float value) { return value <= choice.threshold; }));
    DOCTEST_CHECK(app.model().picked.count == nearer);
    app.update(session.preview);
    DOCTEST_REQUIRE(session.preview.last.values != nullptr);
    DOCTEST_CHECK(std::count(session.preview.last.values->begin(), session.preview.last.values->end(),
                             1.0f) == static_cast<std::ptrdiff_t>(nearer));
    DOCTEST_CHECK(app.document().position() == at);  // looking changes nothing
    choice.above = true;
    app.run(command::PickRows{choice});
    app.update(session.preview);
    const auto chosen = app.model().picked.count;
    DOCTEST_CHECK((chosen > 0 && chosen <= all - nearer + all / 10));
    app.run(command::UsePicked{ui::PickedUse::NewLabel});
    DOCTEST_CHECK(count(labelled(app)) == chosen);
    DOCTEST_CHECK(app.document().names().back().starts_with("Label: above "));
    choice.within_label = true, choice.threshold = sorted[all * 3 / 4];
    app.run(command::PickRows{choice});
    app.update(session.preview);
    const auto within = app.model().picked.count;
    DOCTEST_REQUIRE((within > 0 && within < chosen));
    app.run(command::UsePicked{ui::PickedUse::Remove});
    app.update(session.preview);
    DOCTEST_CHECK(count(labelled(app)) == chosen - within);
    app.run(command::Undo{});
    app.update(session.preview);
    DOCTEST_CHECK(count(labelled(app)) == chosen);
    DOCTEST_CHECK(app.model().picked.count == within);  // follows the label
    app.run(command::UsePicked{ui::PickedUse::Delete});
    DOCTEST_CHECK(app.document().state().current.size() == all - within);
    app.run(command::Undo{});
    DOCTEST_CHECK(app.document().state().current.size() == all);
    app.run(command::DropPicked{});
    app.update(session.preview);
    DOCTEST_CHECK_FALSE(app.model().picked.shown);
}

DOCTEST_TEST_CASE(
    "hiding is for the eye: the document, its revision and the project stay, and picking passes over what is "
    "hidden") {
    const Place place;
    Labelled session;
    auto& app = session.app;
    const auto revision = app.document().revision();
    const auto set = app.document().state().current;
    const auto some = count(labelled(app));
    DOCTEST_REQUIRE(some > 0);
    DOCTEST_REQUIRE(some < set.size());
    const auto faint = invisible(set);
    app.run(command::HideLabel{});
    app.update(session.preview);
    DOCTEST_CHECK(app.model().hidden == some);
    DOCTEST_CHECK(invisible(session.preview.last.set) == faint + some);
    const auto arrays = session.preview.last.set;
    app.update(session.preview);
    DOCTEST_CHECK(session.preview.last.set.shares_all_with(arrays));          // nothing is uploaded anew
    DOCTEST_CHECK(invisible(session.preview.last.original) == faint + some);  // comparisons show as much
    DOCTEST_CHECK(app.document().revision() == revision);
    DOCTEST_CHECK(app.document().state().current.shares_all_with(set));
    app.run(command::PickRows{Labelled::large(0.0f)});
    DOCTEST_REQUIRE(
        session.until([&] { return !app.model().picked.working && app.model().picked.count > 0; }));
    DOCTEST_CHECK(app.model().picked.count == set.size() - some);
    app.run(command::DropPicked{});
    app.run(command::IsolateLabel{});
    app.update(session.preview);
    DOCTEST_CHECK(app.model().hidden == set.size() - some);
    app.run(command::DeleteLabelledSplats{});  // what is seen goes; the rest is still hidden
    app.update(session.preview);
    DOCTEST_CHECK(app.model().hidden == app.document().state().current.size());
    app.run(command::Undo{});
    app.run(command::ShowHidden{});
    app.update(session.preview);
    DOCTEST_CHECK(app.model().hidden == 0);
    DOCTEST_CHECK(session.preview.last.set.shares_all_with(app.document().state().current));
}

DOCTEST_TEST_CASE("an export leaves out what is hidden only when that is said") {
    const Place place;
    Labelled session;
    auto& app = session.app;
    const auto all = app.document().state().current.size(), some = count(labelled(app));
    app.run(command::HideLabel{});
    auto exports = app.model().exports;
    const auto written = [&](const char* name, bool visible_only) {
        exports.scene_path = (place.folder / name).string();
        exports.visible_only = visible_only;
        exports.with_labels = true;
        app.run(command::SetExports{exports});
        app.run(command::ExportScene{});
        DOCTEST_REQUIRE(session.idle());
        return load_scene(exports.scene_path);
    };
    DOCTEST_CHECK(written("all.ply", false).gaussians.size() == all);
    const auto rest = written("rest.ply", true);
    DOCTEST_CHECK(rest.gaussians.size() == all - some);
    DOCTEST_REQUIRE_FALSE(rest.labels.labels.empty());
    DOCTEST_CHECK(count(*rest.labels.labels.front().bits) == 0);  // all that was labelled is hidden
    const auto& toasts = app.model().toasts;
    DOCTEST_CHECK(std::any_of(toasts.begin(), toasts.end(), [](const auto& toast) {
        return toast.text.find("without what is hidden") != std::string::npos;
    }));
    app.run(command::IsolateLabel{});
    app.run(command::DeleteLabelledSplats{});
    app.update(session.preview);
    exports.scene_path = (place.folder / "none.ply").string();
    app.run(command::SetExports{exports});
    app.run(command::ExportScene{});
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_CHECK_FALSE(fs::exists(place.folder / "none.ply"));
    app.run(command::ShowHidden{});
    app.update(session.preview);
    DOCTEST_CHECK_FALSE(app.model().exports.visible_only);  // a choice for what was hidden then
}

DOCTEST_TEST_CASE("any step can be what comparisons show as before") {
    const Place place;
    Labelled session;
    auto& app = session.app;
    const auto opened = app.document().state().current;
    app.run(command::DeleteLabelledSplats{});
    const auto first = app.document().state().current;
    const auto step = app.document().position();
    app.run(command::PickRows{Labelled::large(0.4f)});
    DOCTEST_REQUIRE(
        session.until([&] { return !app.model().picked.working && app.model().picked.count > 0; }));
    app.run(command::UsePicked{ui::PickedUse::Delete});
    app.run(command::DropPicked{});
    app.update(session.preview);
    DOCTEST_CHECK(session.preview.last.original.shares_all_with(opened));
    app.run(command::CompareWith{step});
    app.update(session.preview);
    DOCTEST_CHECK(app.model().comparison == ui::Comparison::Wipe);
    DOCTEST_CHECK(app.model().compared_name == app.document().names()[step]);
    DOCTEST_CHECK(session.preview.last.original.shares_all_with(first));
    app.run(command::Undo{});
    app.run(command::Undo{});  // beyond it: it is compared with all the same
    app.update(session.preview);
    DOCTEST_CHECK(session.preview.last.original.shares_all_with(first));
    DOCTEST_CHECK(session.preview.last.set.shares_all_with(opened));
    app.run(command::CompareWith{step});
    app.update(session.preview);
    DOCTEST_CHECK(app.model().compared_revision == 0);
    DOCTEST_CHECK(app.model().comparison == ui::Comparison::None);
    DOCTEST_CHECK(session.preview.last.original.shares_all_with(opened));
}

DOCTEST_TEST_CASE("toasts of steps take them back, but not what came after") {
    const Place place;
    Labelled session;
    auto& app = session.app;
    const auto before = app.document().state().current;
    const auto undo_button = [&] {
        const auto& toasts = app.model().toasts;
        const auto found = std::find_if(toasts.rbegin(), toasts.rend(),
                                        [](const auto& toast) { return toast.button == "Undo"; });
        DOCTEST_REQUIRE(found != toasts.rend());
        return static_cast<std::size_t>(toasts.rend() - found) - 1;
    };
    app.run(command::DeleteLabelledSplats{});
    app.update(session.preview);
    app.run(command::PressToast{undo_button()});
    DOCTEST_CHECK(app.document().state().current.shares_all_with(before));
    app.run(command::DeleteLabelledSplats{});
    app.run(command::AddLabel{"more"});
    app.update(session.preview);
    const auto revision = app.document().revision();
    app.run(command::PressToast{undo_button()});
    DOCTEST_CHECK(app.document().revision() == revision);  // History leads back
}

}  // namespace selection_test
