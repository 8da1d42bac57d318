// State that belongs to a scene or an edit goes with it. After another scene was opened the window shows what
// a new window shows, after an undo what it showed before.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <functional>
#include <map>

#include "engine/base/fields.h"
#include "engine/io/image/image_file.h"
#include "tests/ui/app/session.h"

namespace stale_test {

using namespace gse;
using namespace gse::test;

namespace {

/// Contents of the window by the name of the field. A new field of the view model breaks the build here: it
/// is shown, or it is said why it belongs to no scene.
using Shown = std::map<std::string, std::string>;

std::string text_of(const auto& settings) { return fields_to_json(settings).dump(); }

void show(Shown& shown, const ui::DocumentPart& part) {
    const auto& [document, opened, statistics, scene_path, project_path, suggested, unsaved, saved_at, recent,
                 recent_pictures, recoverable, embeds, linked, lost] = part;
    static_cast<void>(opened), static_cast<void>(recent),
        static_cast<void>(recent_pictures);  // of the window
    shown["document.steps"] = document == nullptr ? "none" : fmt::format("{}", document->names().size());
    shown["document.splats"] = fmt::format("{}", statistics.count);
    shown["document.paths"] = fmt::format("{} {} {}", scene_path, project_path, suggested);
    shown["document.unsaved"] = fmt::format("{}", unsaved);
    shown["document.saved_at"] = saved_at;
    shown["document.link"] = fmt::format("{} {} {}", embeds, linked, lost.project);
    shown["document.recoverable"] = fmt::format("{}", recoverable.size());
}

void show(Shown& shown, const ui::ViewportPart& part) {
    const auto& [picture, original, width, height, depth, camera, orbit, home, framing, colour, milliseconds,
                 renderer, hidden, view, comparison, pictures, compared_revision, compared_name] = part;
    static_cast<void>(picture), static_cast<void>(original), static_cast<void>(depth);  // of the device
    static_cast<void>(milliseconds), static_cast<void>(renderer), static_cast<void>(colour);
    shown["view.size"] = fmt::format("{} {}", width, height);
    shown["view.camera"] = fmt::format("{} {}", camera.translation.x, camera.translation.z);
    shown["view.orbit"] = fmt::format("{} {} {}", orbit.radius, home.high.x, framing.high.x);
    shown["view.pictures"] = fmt::format("{}", pictures.size());
    shown["view.hidden"] = fmt::format("{}", hidden);
    shown["view.settings"] = text_of(view);
    shown["view.comparison"] =
        fmt::format("{} {} {}", static_cast<int>(comparison), compared_revision, compared_name);
}

void show(Shown& shown, const ui::SearchPart& part) {
    const auto& [request, said, made, words_read, read_target, reach, by_hand, estimate, attention, word,
                 mode, threshold, arriving, voting, corrected, search, server_search] = part;
    static_cast<void>(estimate);  // of this machine
    shown["search.request"] = text_of(request);
    shown["search.words"] = fmt::format("{} {} {} {}", said.size(), made.size(), words_read, read_target);
    shown["search.scope"] =
        fmt::format("{} {} {} {} {}", reach.label, reach.splats, reach.by_label, reach.corrected, by_hand);
    shown["search.server"] = server_search;
    shown["search.views"] = fmt::format("{}", attention.size());
    shown["search.what"] = fmt::format("{} {} {}", word, mode, threshold);
    shown["search.state"] = fmt::format("{} {} {}", arriving, voting, corrected);
    shown["search.outcome"] =
        fmt::format("{} {} {} {} {}", search.confidence.value, static_cast<int>(search.problem),
                    search.message, search.remedy, search.front.value_or(-1));
}

void show(Shown& shown, const ui::EditPart& part) {
    const auto& [running, gate, rounds, targets_wait, cost, losses, snapshots, shown_snapshot, waiting,
                 splats, changed_outside, psnr, seconds, verdict, results, shown_result, variations] = part;
    shown["edit.running"] = fmt::format("{} {} {}", running, targets_wait, waiting);
    shown["edit.gate"] = fmt::format("{} {} {}", gate.pictures.size(), gate.verdict, gate.warns);
    shown["edit.rounds"] = fmt::format("{}", rounds.size());
    shown["edit.cost"] = fmt::format("{} {} {}", cost.unet, cost.encoder, cost.tflop);
    shown["edit.losses"] = fmt::format("{}", losses.size());
    shown["edit.snapshots"] = fmt::format("{} {}", snapshots.size(), shown_snapshot);
    shown["edit.result"] = fmt::format("{} {} {} {}", splats, changed_outside, psnr, seconds);
    shown["edit.verdict"] = fmt::format("{} {}", verdict.text, verdict.stopped_at);
    shown["edit.results"] = fmt::format("{} {} {}", results.size(), shown_result, variations.size());
}

void show(Shown& shown, const ui::LabelPart& part) {
    const auto& [labelled, picked, adjusting] = part;
    shown["label.labelled"] = fmt::format("{}", labelled);
    shown["label.picked"] = fmt::format("{} {} {}", picked.shown, picked.count, picked.values != nullptr);
    shown["label.adjusting"] = fmt::format("{}", adjusting);
}

void show(Shown& shown, const ui::PlacePart& part) {
    const auto& [placed, placing] = part;
    shown["place.placed"] = fmt::format("{} {}", placed ? placed->height : -1, placing);
}

void show(Shown& shown, const ui::ExportPart& part) {
    const auto& [exports, keys] = part;
    shown["exports.settings"] = text_of(exports);
    shown["exports.keys"] = fmt::format("{}", keys.size());
}

void show(Shown& shown, const ui::NoticePart& part) {
    const auto& [question, log, toasts] = part;
    static_cast<void>(log);  // of the window: all that was said in it
    shown["notices.question"] = question.title + question.text;
    for (const auto& toast : toasts) shown["notices.toasts"] += toast.text + "\n";
}

void show(Shown& shown, const ui::WindowPart& part) {
    const auto& [job, file_job, cannot_edit, frames, keymap, scale] = part;
    static_cast<void>(frames), static_cast<void>(keymap), static_cast<void>(scale);
    shown["window.job"] =
        fmt::format("{} {} {} {} {}", job.title, job.stage, job.outcome, job.error, job.step);
    shown["window.file_job"] = fmt::format("{} {}", file_job.title, file_job.error);
    shown["window.cannot_edit"] = cannot_edit;
}

Shown shown_by(Session& session) {
    session.app.update(session.preview);
    const auto& model = session.app.model();
    Shown shown;
    const auto show_all = [&](const auto&... parts) { (show(shown, parts), ...); };
    show_all(static_cast<const ui::DocumentPart&>(model), static_cast<const ui::ViewportPart&>(model),
             static_cast<const ui::SearchPart&>(model), static_cast<const ui::EditPart&>(model),
             static_cast<const ui::LabelPart&>(model), static_cast<const ui::PlacePart&>(model),
             static_cast<const ui::ExportPart&>(model), static_cast<const ui::NoticePart&>(model),
             static_cast<const ui::WindowPart&>(model));
    for (const auto& text : model.server.choice.target_picture) shown["server.pictures"] += text;
    shown["server.here"] = fmt::format("{}", model.server.here.size());
    shown["server.drawing"] = fmt::format("{}", model.drawing.preview != nullptr);
    shown["models.front"] = model.model_settings.front;  // the rest is of the program
    return shown;
}

/// Fields that differ, one a line.
std::string differences(const Shown& now, const Shown& before) {
    std::string text;
    for (const auto& [name, value] : now)
        if (!before.contains(name) || before.at(name) != value)
            text += fmt::format("{}: \"{}\", was \"{}\"\n", name, value,
                                before.contains(name) ? before.at(name) : "not there");
    for (const auto& [name, value] : before)
        if (!now.contains(name)) text += fmt::format("{}: gone, was \"{}\"\n", name, value);
    return text;
}

fs::path scene_in(const Place& place, const std::string& name) {
    const auto file = place.folder / name / "scene.ply";
    fs::create_directories(file.parent_path());
    fs::copy_file(app::assets_path() / "scenes/bear/scene.ply", file);
    return file;
}

void open(Session& session, const fs::path& scene) {
    const auto before = session.app.model().opened;
    session.app.run(command::Open{scene});
    DOCTEST_REQUIRE(session.until([&] { return session.app.model().opened != before; }));
    DOCTEST_REQUIRE(session.settled());
}

ui::ScreenRegion stroke_over_the_middle() {
    ui::ScreenRegion stroke;
    stroke.circles = {{160, 120}};
    stroke.radius_px = 20;
    return stroke;
}

void edit_quickly(Session& session) {
    session.ask_for_blue();
    auto request = session.app.model().request;
    request.iterations = 3;
    session.app.run(command::SetRequest{request});
    session.app.run(command::Locate{});
    DOCTEST_REQUIRE(session.idle());
    session.app.run(command::Edit{});
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_REQUIRE(session.app.model().result_waiting);
}

/// A picture for a view, as an artist chooses it.
void use_picture(Session& session, const fs::path& file) {
    write_png(file, Image(64, 64, 3));
    auto choice = session.app.model().server.choice;
    choice.target_picture = {"ring_00=" + file.string()};
    session.app.run(command::SetServer{choice});
    DOCTEST_CHECK(session.app.model().server.choice.target_picture.size() == 1);
}

/// Leaves behind whatever an artist can in a scene without an edit.
void leave_traces(Session& session, const Place& place) {
    auto& app = session.app;
    use_picture(session, place.folder / "own.png");
    app.run(command::AddLabel{"mine"});
    app.run(command::Select{stroke_over_the_middle(), ui::SetOperation::Add, true});
    app.run(command::HideLabel{});
    app.update(session.preview);
    ColourAdjustment adjustment;
    adjustment.brightness = 1.4;
    app.run(command::AdjustColours{adjustment});
    app.run(command::PickRows{{localize::RowProperty::Opacity, {}, 0.5f, false, false}});
    app.run(command::SetComparison{ui::Comparison::Wipe});
    app.run(command::CompareWith{0});
    app.run(command::AddCameraKey{});
    auto exports = app.model().exports;
    exports.scene_path = (place.folder / "elsewhere.ply").string();
    exports.visible_only = true;
    app.run(command::SetExports{exports});
    auto view = app.model().view;
    view.mode = static_cast<int>(ui::DisplayMode::Changed);
    view.wipe = 0.25f;
    app.run(command::SetViewSettings{view});
    auto settings = app.model().model_settings;
    settings.front = "45";
    app.run(command::SetModelSettings{settings});
    auto request = app.model().request;
    request.source = "bear";
    request.prompt = "a golden bear";
    request.target = "golden";
    request.instruction = "make the bear golden";
    request.mode = "modify";
    app.run(command::SetRequest{request});
    app.run(command::SaveProject{place.folder / "first.gsep"});
    DOCTEST_REQUIRE(session.idle());
}

/// The window that opens the scene alone.
Shown fresh(const fs::path& scene) {
    Session session(false);
    open(session, scene);
    const auto shown = shown_by(session);
    session.app.shut_down();
    return shown;
}

/// Requests have settings that were chosen for a quick test: they are the artist's and stay.
void keep_settings_out(Shown& shown) {
    auto request = nlohmann::json::parse(shown["search.request"]);
    nlohmann::json words;
    for (const char* word : {"source", "prompt", "target", "instruction", "mode", "excluded_views"})
        words[word] = request.at(word);
    shown["search.request"] = words.dump();
}

}  // namespace

DOCTEST_TEST_CASE("another scene is shown as a new window shows it, whatever was done in the last one") {
    const Place place;
    const auto first = scene_in(place, "first"), second = scene_in(place, "second");
    auto expected = fresh(second);
    keep_settings_out(expected);
    Session session(false);
    open(session, first);
    leave_traces(session, place);
    DOCTEST_CHECK(differences(shown_by(session), expected).find("saved_at") != std::string::npos);
    open(session, second);
    auto shown = shown_by(session);
    keep_settings_out(shown);
    DOCTEST_CHECK(differences(shown, expected) == "");
    session.app.shut_down();
}

DOCTEST_TEST_CASE("nothing of an edit, its search or its failure is left in another scene") {
    if (!networks()) return;
    const Place place;
    const auto first = scene_in(place, "first"), second = scene_in(place, "second");
    auto expected = fresh(second);
    keep_settings_out(expected);
    const std::function<void(Session&)> ends[] = {
        [](Session& session) { session.app.run(command::ApplyResult{}); },
        [](Session& session) { session.app.run(command::DiscardResult{}); }, [](Session&) {},  // it waits
        [](Session& session) {
            session.app.run(command::DiscardResult{});
            auto request = session.app.model().request;
            request.source = "car";
            session.app.run(command::SetRequest{request});
            session.app.run(command::Locate{});
            DOCTEST_REQUIRE(session.idle());
        }};
    for (const auto& end : ends) {
        Session session(false);
        open(session, first);
        edit_quickly(session);
        end(session);
        open(session, second);
        auto shown = shown_by(session);
        keep_settings_out(shown);
        DOCTEST_CHECK(differences(shown, expected) == "");
        session.app.shut_down();
    }
}

DOCTEST_TEST_CASE("an undone edit takes its pictures, curves, status and notices along; so does its search") {
    if (!networks()) return;
    const Place place;
    Session session(false);
    auto& app = session.app;
    open(session, scene_in(place, "first"));
    session.ask_for_blue();
    auto begun = shown_by(session);
    keep_settings_out(begun);
    edit_quickly(session);
    app.run(command::ApplyResult{});
    DOCTEST_REQUIRE(session.settled());
    const auto located = app.document().position() - 1;
    DOCTEST_CHECK_FALSE(app.model().losses.empty());
    app.run(command::Undo{});
    auto shown = shown_by(session);
    DOCTEST_CHECK(app.model().losses.empty());
    DOCTEST_CHECK(app.model().snapshots.empty());
    DOCTEST_CHECK(app.model().gate.pictures.empty());
    DOCTEST_CHECK(app.model().job.title.empty());
    DOCTEST_CHECK(app.model().cost.unet == 0);
    DOCTEST_CHECK_FALSE(app.model().attention.empty());  // the search is not undone
    DOCTEST_REQUIRE(app.document().position() == located);
    while (app.document().can_undo()) app.run(command::Undo{});
    shown = shown_by(session);
    keep_settings_out(shown);
    auto expected = begun;
    // A new target is guessed for the next sentence, what undo can bring back is counted, and the tint stays.
    for (const auto& toast : app.model().toasts) {
        DOCTEST_CHECK_FALSE(toast.is_error);
        DOCTEST_CHECK(toast.button.empty());
    }
    for (const char* other :
         {"document.steps", "search.request", "document.unsaved", "view.settings", "notices.toasts"}) {
        expected.erase(other);
        shown.erase(other);
    }
    DOCTEST_CHECK(differences(shown, expected) == "");
    app.run(command::Redo{});
    app.update(session.preview);
    DOCTEST_CHECK_FALSE(app.model().attention.empty());  // its label is back, and its evidence
    DOCTEST_CHECK(app.model().attention_word == "bear");
    session.app.shut_down();
}

DOCTEST_TEST_CASE("words that were typed before a scene is open are for that scene") {
    const Place place;
    Session session(false);
    session.ask_for_blue();
    open(session, scene_in(place, "first"));
    DOCTEST_CHECK(session.app.model().request.prompt == "a blue bear on the grass");
    session.app.shut_down();
}

}  // namespace stale_test
