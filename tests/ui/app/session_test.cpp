// An artist's session driven through the application: open, locate, correct, edit, pause, cancel, apply,
// undo, export, save, reopen, recover.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <thread>

#include "app/session/application.h"
#include "engine/base/file.h"
#include "engine/io/cameras/cameras.h"
#include "engine/io/image/image_file.h"
#include "engine/io/project/load_scene.h"
#include "engine/pipeline/report/film.h"
#include "engine/scene/label_ops.h"
#include "tests/ui/app/session.h"

namespace session_test {

using namespace gse;
using namespace gse::test;
using namespace std::chrono_literals;

namespace {

/// The job that command line, evaluation and benches make of what is typed in the window.
pipeline::EditJob job_of(const app::Application& app) {
    pipeline::EditRecipe recipe;
    recipe.request = app.model().request;
    Scene scene;
    scene.gaussians = app.document().state().current;
    scene.info = app.document().state().info;
    return {recipe, {scene, app.document().state().views, pipeline::load_recipe_model(recipe.job)}, {}};
}

}  // namespace

DOCTEST_TEST_CASE("open, locate, correct, edit, apply, undo, save and reopen") {
    if (!networks()) return;
    const Place place;
    const std::string sentence = "A blue bear, on the grass.";
    std::size_t applied_rows = 0;
    std::vector<float> applied_colours;
    {
        Session session;
        session.open_bear();
        auto& app = session.app;
        const auto base = app.document().state().current;
        auto typed = app.model().request;
        typed.source = "Bear";
        typed.prompt = sentence;
        typed.target.clear();  // guessed
        app.run(command::SetRequest{typed});
        auto same = job_of(app);
        same.locate();
        app.run(command::Locate{});
        DOCTEST_REQUIRE(session.idle());
        DOCTEST_CHECK(app.model().job.error.empty());
        DOCTEST_CHECK(app.model().attention.size() == 8);
        const auto active = static_cast<std::size_t>(app.document().state().active_label);
        DOCTEST_REQUIRE(active < app.document().state().labels.size());
        DOCTEST_CHECK(app.document().state().labels[active].name == "bear");
        DOCTEST_REQUIRE(app.model().search.front);
        DOCTEST_CHECK(std::abs(std::remainder(*app.model().search.front, 360)) <
                      45);  // the bear looks at the first view
        DOCTEST_CHECK(*app.document().state().labels[active].bits == *same.located().label.bits);
        const auto searches = app.model().search.number;
        const auto found = count_labelled(app.document().state().labels[active]);
        DOCTEST_CHECK(found > 100);
        DOCTEST_CHECK(found < base.size());

        // A brush stroke takes away what lies under it, and undo gives it back.
        ui::ScreenRegion stroke;
        stroke.circles = {{160, 120}};
        stroke.radius_px = 5;  // part of the bear, which is small in the home view
        app.run(command::Select{stroke, ui::SetOperation::Remove, true});
        const auto corrected = count_labelled(app.document().state().labels[active]);
        DOCTEST_CHECK(corrected < found);
        app.run(command::Undo{});
        DOCTEST_CHECK(count_labelled(app.document().state().labels[active]) == found);
        app.run(command::Redo{});
        DOCTEST_CHECK(count_labelled(app.document().state().labels[active]) == corrected);

        app.run(command::Edit{});
        DOCTEST_REQUIRE(session.idle());
        DOCTEST_CHECK(app.model().job.error.empty());
        DOCTEST_REQUIRE(app.model().result_waiting);
        DOCTEST_CHECK(app.model().losses.size() == 30);
        DOCTEST_CHECK(app.model().search.number == searches);  // what was found is used, not looked for again
        DOCTEST_CHECK_FALSE(session.preview.last.set.shares_all_with(base));  // the waiting result is shown
        const auto label = *app.document().state().labels[active].bits;
        app.run(command::ApplyResult{});
        const auto& state = app.document().state();
        DOCTEST_REQUIRE(state.stack.size() == 1);
        DOCTEST_CHECK(nlohmann::ordered_json::parse(state.stack[0].recipe)["request"] ==
                      fields_to_json(same.recipe().request.plain()));
        DOCTEST_CHECK(state.stack[0].changed_outside_label == 0);
        // What the label leaves out has not moved by a bit; that includes what the brush took away.
        std::size_t changed_outside = 0, kept = 0;
        for (std::size_t row = 0; row < state.current.size(); ++row) {
            const auto id = (*state.row_ids)[row];
            if (id >= base.size() || label[id] != 0) continue;
            ++kept;
            for (std::size_t c = 0; c < 3; ++c)
                changed_outside += state.current.sh()[row * 3 + c] != base.sh()[id * 3 + c] ||
                                   state.current.position()[row * 3 + c] != base.position()[id * 3 + c];
        }
        DOCTEST_CHECK(changed_outside == 0);
        DOCTEST_CHECK(kept == base.size() - corrected);
        app.run(command::SetEditEnabled{state.stack[0].id, false});
        DOCTEST_CHECK(app.document().state().current.shares_all_with(base));
        app.run(command::Undo{});
        // Of what is applied, more or less can be seen: a drag is one step, and the step can be undone.
        const auto position = app.document().position();
        app.run(command::SetEditStrength{app.document().state().stack[0].id, 0.5, false});
        const auto half = app.document().state().current;
        app.run(command::SetEditStrength{app.document().state().stack[0].id, 0.25, true});
        DOCTEST_CHECK(app.document().position() == position + 1);
        DOCTEST_CHECK_FALSE(app.document().state().current.shares_all_with(half));
        app.run(command::Undo{});
        DOCTEST_CHECK(app.document().state().stack[0].strength == 1);
        applied_rows = app.document().state().current.size();
        applied_colours.assign(app.document().state().current.sh().begin(),
                               app.document().state().current.sh().end());
        app.run(command::SaveProject{place.folder / "bear.gsep"});
        DOCTEST_REQUIRE(session.idle());
        session.until([&] { return !app.model().unsaved; }, 5);
        DOCTEST_CHECK_FALSE(app.model().unsaved);
        app.shut_down();
    }
    Session again;
    DOCTEST_CHECK(again.app.model().recoverable.empty());
    again.app.run(command::Open{place.folder / "bear.gsep"});
    DOCTEST_REQUIRE(again.until([&] { return again.app.model().document != nullptr; }));
    const auto& current = again.app.document().state().current;
    DOCTEST_REQUIRE(current.size() == applied_rows);
    DOCTEST_CHECK(
        std::equal(current.sh().begin(), current.sh().end(), applied_colours.begin(), applied_colours.end()));
    DOCTEST_CHECK(again.app.model().request.prompt == sentence);  // as it was typed
}

DOCTEST_TEST_CASE(
    "the word that is new is read off the scene when it is searched, and the edit takes that search") {
    if (!networks()) return;
    Session session;
    session.open_bear();
    auto& app = session.app;
    auto typed = app.model().request;
    typed.source = "bear";
    typed.prompt = "a red bear on the snow";
    typed.target.clear();
    typed.method = "sds";
    typed.iterations = 2;
    app.run(command::SetRequest{typed});
    DOCTEST_CHECK(app.target() == "red");  // all that the sentence alone can say
    app.run(command::Locate{});
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_CHECK(app.model().read_target == "snow");  // the bear is red already
    typed.source = "grass";
    typed.prompt = "a bear on the snow";
    app.run(command::SetRequest{typed});
    DOCTEST_CHECK(app.target() == "snow");  // what things stand on for what they stood on
    app.run(command::Locate{});
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_CHECK(app.model().read_target == "snow");
    DOCTEST_CHECK(app.target() == "snow");
    DOCTEST_CHECK(app.model().request.target.empty());  // still for the pictures to say
    const auto searches = app.model().search.number;
    app.run(command::Edit{});
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_CHECK(app.model().search.number == searches);
    DOCTEST_REQUIRE(app.model().result_waiting);
    app.run(command::ApplyResult{});
    const auto recipe = nlohmann::ordered_json::parse(app.document().state().stack[0].recipe);
    DOCTEST_CHECK(recipe["request"]["target"] == "snow");
    // Another sentence: what was read of the last one says nothing of it.
    typed.prompt = "a bear on the sand";
    app.run(command::SetRequest{typed});
    session.until([&] { return app.model().read_target.empty(); }, 5);
    DOCTEST_CHECK(app.model().read_target.empty());
    DOCTEST_CHECK(app.target() == "sand");  // the bear was said already
    typed.prompt = "a blue bear on the snow";
    typed.source = "bear";
    app.run(command::SetRequest{typed});
    app.run(command::Edit{});  // without a search before: it reads the word too, and says so
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_CHECK(app.model().read_target == "blue");
    app.shut_down();
}

DOCTEST_TEST_CASE("a running edit pauses, shows snapshots, is cancelled and keeps what it reached") {
    if (!networks()) return;
    const Place place;
    Session session;
    session.open_bear();
    auto request = session.app.model().request;
    request.iterations = 5000;
    session.app.run(command::SetRequest{request});
    session.app.run(command::Edit{});
    DOCTEST_REQUIRE(session.until([&] { return session.app.model().snapshots.size() >= 2; }));
    session.app.run(command::Pause{true});
    session.app.update(session.preview);
    const auto standing = session.app.model().losses.size();
    std::this_thread::sleep_for(600ms);
    session.app.update(session.preview);
    DOCTEST_CHECK(session.app.model().losses.size() <= standing + 1);  // the step under way may end
    DOCTEST_CHECK(session.app.model().job.paused);
    session.app.run(command::Pause{false});
    DOCTEST_REQUIRE(session.until([&] { return session.app.model().losses.size() > standing + 3; }));
    // A brush stroke corrects the label of the running edit: what it takes away is as it was in the next
    // snapshot.
    ui::ScreenRegion stroke;
    stroke.circles = {{160, 120}};
    stroke.radius_px = 5;  // part of the bear, which is small in the home view
    // The edit's own search shows what it found.
    DOCTEST_REQUIRE(session.app.document().state().active_label >= 0);
    const auto active = static_cast<std::size_t>(session.app.document().state().active_label);
    const auto before = *session.app.document().state().labels[active].bits;
    session.app.run(command::Select{stroke, ui::SetOperation::Remove, true});
    const auto corrected = *session.app.document().state().labels[active].bits;
    DOCTEST_REQUIRE(corrected != before);
    const auto taken = session.app.model().losses.size() + 40;
    DOCTEST_REQUIRE(session.until([&] { return session.app.model().losses.size() > taken; }));
    session.app.run(command::Cancel{});
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_REQUIRE(session.app.model().result_waiting);
    session.app.update(session.preview);
    const auto& shown = session.preview.last.set;
    const auto& base = session.app.document().state().current;
    std::size_t outside = 0;
    for (std::size_t row = 0; row < std::min(base.size(), shown.size()); ++row)
        outside +=
            before[row] != 0 && corrected[row] == 0 && shown.sh()[row * 3] != base.sh()[row * 3] ? 1 : 0;
    DOCTEST_CHECK(outside == 0);
    // The model's pictures were shown first.
    DOCTEST_CHECK(session.app.model().gate.pictures.size() == 4);
    session.app.run(command::TakeSnapshot{session.app.model().snapshots.front().iteration});
    session.app.run(command::ApplyResult{});
    DOCTEST_CHECK(session.app.document().state().stack.size() == 1);
    session.app.run(command::Undo{});
    DOCTEST_CHECK(session.app.document().state().stack.empty());
}

DOCTEST_TEST_CASE(
    "a branch goes on from a snapshot with the settings as they are now, also out of a running edit") {
    if (!networks()) return;
    const Place place;
    Session session;
    session.open_bear();
    auto& app = session.app;
    auto request = app.model().request;
    request.iterations = 5000;
    app.run(command::SetRequest{request});
    app.run(command::Edit{});
    DOCTEST_REQUIRE(session.until([&] { return app.model().snapshots.size() >= 3; }));
    const int from = app.model().snapshots[1].iteration;
    request = app.model().request;
    request.iterations = from;
    app.run(command::SetRequest{request});
    app.run(command::BranchFromSnapshot{from});  // nothing would be left to do: the edit is not even stopped
    app.update(session.preview);
    DOCTEST_CHECK(app.model().job.running);
    DOCTEST_CHECK(app.model().toasts.back().text.find("iterations") != std::string::npos);
    request.iterations = from + 12;
    request.guidance_weight = 0.5;
    app.run(command::SetRequest{request});
    app.run(command::BranchFromSnapshot{from});
    DOCTEST_REQUIRE(session.until([&] { return app.model().result_waiting; }));
    DOCTEST_CHECK(app.model().losses.back().iteration == from + 11);
    for (std::size_t i = 1; i < app.model().losses.size();
         ++i)  // the curve goes through, without what was given up
        DOCTEST_CHECK(app.model().losses[i].iteration > app.model().losses[i - 1].iteration);
    DOCTEST_CHECK(app.model().snapshots.back().iteration <= from + 12);
    app.run(command::BranchFromSnapshot{from - 1000000});  // before all of them: nothing happens
    DOCTEST_CHECK(app.model().result_waiting);
    // Out of the finished edit, once more.
    request.iterations = from + 20;
    app.run(command::SetRequest{request});
    app.run(command::BranchFromSnapshot{from});
    DOCTEST_REQUIRE(session.settled());
    DOCTEST_CHECK(app.model().losses.back().iteration == from + 19);
    DOCTEST_REQUIRE(app.model().result_waiting);
    app.run(command::ApplyResult{});
    DOCTEST_REQUIRE(app.document().state().stack.size() == 1);
    DOCTEST_CHECK(app.document().state().stack[0].changed_outside_label == 0);
    const auto revision = app.document().revision();
    app.run(command::BranchFromSnapshot{from});  // they were states of another scene
    DOCTEST_CHECK_FALSE(app.model().job.running);
    DOCTEST_CHECK(app.document().revision() == revision);
}

DOCTEST_TEST_CASE("a threshold drag is one step of undo with its value, and undo restores the request too") {
    if (!networks()) return;
    const Place place;
    Session session;
    session.open_bear();
    auto& app = session.app;
    app.run(command::Locate{});
    DOCTEST_REQUIRE(session.settled());
    const auto at = app.document().position();
    const auto bits = [&] {
        const auto& state = app.document().state();
        return *state.labels[static_cast<std::size_t>(state.active_label)].bits;
    };
    const auto found = bits();
    const double stated = app.model().attention_threshold;
    DOCTEST_CHECK(stated > 0);
    const auto drag = [&](std::initializer_list<double> values) {
        for (const double value : values) {
            app.run(command::SetAttentionThreshold{value, false});
            session.until([] { return false; }, 0.05);
        }
        app.run(command::SetAttentionThreshold{*(values.end() - 1), true});
        DOCTEST_REQUIRE(session.settled());
    };
    drag({0.6, 0.75, 0.85, 0.9});  // the bear is found whole with any up to 0.8
    DOCTEST_CHECK(app.document().position() == at + 1);
    DOCTEST_CHECK(app.document().names().back() == "Attention threshold 0.900");
    const auto strict = bits();
    DOCTEST_CHECK(strict != found);
    drag({0.5, 0.3});
    DOCTEST_CHECK(app.document().position() == at + 2);  // another drag, another step
    const auto wide = bits();
    DOCTEST_CHECK(wide != strict);
    DOCTEST_CHECK(app.model().request.attention_threshold == 0.3);
    const auto masks = app.model().attention[0].mask_picture;
    app.run(command::Undo{});
    DOCTEST_CHECK(bits() == strict);
    DOCTEST_CHECK(app.model().request.attention_threshold == 0.9);
    DOCTEST_REQUIRE(session.settled());
    DOCTEST_CHECK(app.model().attention[0].mask_picture != masks);  // the evidence follows
    DOCTEST_CHECK(app.document().position() == at + 1);             // and makes no step of its own
    app.run(command::Undo{});
    DOCTEST_CHECK(bits() == found);
    DOCTEST_CHECK(app.model().request.attention_threshold == 0);  // as the model states
    DOCTEST_REQUIRE(session.settled());
    DOCTEST_CHECK(app.model().attention_threshold == stated);
    app.run(command::Redo{});
    DOCTEST_CHECK(app.model().request.attention_threshold == 0.9);
    DOCTEST_REQUIRE(session.settled());
    // The label's own threshold is what the recipe calls label_threshold.
    const double threshold = app.model().request.label_threshold;
    app.run(command::SetLabelThreshold{0.5f, false});
    app.run(command::SetLabelThreshold{0.55f, true});
    DOCTEST_CHECK(app.document().position() == at + 2);
    DOCTEST_CHECK(app.document().names().back() == "Threshold 0.55");
    DOCTEST_CHECK(app.model().request.label_threshold == 0.55);
    app.run(command::SetLabelThreshold{0.6f, true});
    DOCTEST_CHECK(app.document().position() == at + 3);
    app.run(command::Undo{});
    app.run(command::Undo{});
    DOCTEST_CHECK(app.model().request.label_threshold == threshold);
}

DOCTEST_TEST_CASE("a model that cannot be used is never in use: its row says why, the last good one stays") {
    if (!networks()) return;
    const Place place;
    Session session;
    session.open_bear();
    auto& app = session.app;
    const auto starter = app::starter_model_path();
    const auto chosen = [&] {
        std::string paths;
        for (const auto& row : app.model().models)
            if (row.chosen) paths += row.path;
        return paths;
    };
    const auto row_of = [&](const fs::path& path) {
        for (const auto& row : app.model().models)
            if (row.path == path.string()) return row;
        return ui::ModelView{};
    };
    DOCTEST_CHECK(chosen() == starter.string());
    const auto words = app.model().known_words;
    // A folder without weights, and one whose weights are cut off: only loading it tells.
    const fs::path empty = place.folder / "empty model", cut = place.folder / "cut model";
    fs::create_directories(empty);
    fs::copy(starter, cut, fs::copy_options::recursive);
    const auto weights = cut / "unet/diffusion_pytorch_model.safetensors";
    fs::permissions(weights, fs::perms::owner_all);
    fs::resize_file(weights, fs::file_size(weights) / 2);
    for (const auto& bad : {empty, cut, place.folder / "not there"}) {
        app.run(command::ChooseModel{bad.string()});
        DOCTEST_REQUIRE(session.settled());
        DOCTEST_CHECK(chosen() == starter.string());
        DOCTEST_CHECK_FALSE(row_of(bad).usable);
        DOCTEST_CHECK(row_of(bad).problem.size() > 8);
        DOCTEST_CHECK(app.model().toasts.back().is_error);
        DOCTEST_CHECK(app.model().toasts.back().text.find("stays in use") != std::string::npos);
        DOCTEST_CHECK(app.model().known_words == words);
    }
    // A whole copy is taken; once it is gone, the one that comes with the program works again.
    const fs::path good = place.folder / "good model";
    fs::copy(starter, good, fs::copy_options::recursive);
    app.run(command::ChooseModel{good.string()});
    DOCTEST_REQUIRE(session.settled());
    DOCTEST_CHECK(chosen() == good.string());
    app.shut_down();
    fs::remove_all(good);
    Session again;
    DOCTEST_CHECK(again.app.model().models.front().chosen);
}

DOCTEST_TEST_CASE("a search is known after a restart, unless the cache was cleared or is off") {
    if (!networks()) return;
    const Place place;
    const ScratchFolder folder;
    setenv("GSE_CACHE_DIR", folder.path().c_str(), 1);
    std::vector<std::uint8_t> label;
    const auto start = [&](auto before) {  // one start of the program: its network passes
        Session session;
        auto& app = session.app;
        before(app);
        session.open_bear();
        auto request = app.model().request;
        request.source = "bear";
        request.prompt = "a blue bear on the grass";
        request.target = "blue";
        app.run(command::SetRequest{request});
        app.run(command::Locate{});
        DOCTEST_REQUIRE(session.idle());
        DOCTEST_CHECK(app.model().job.error.empty());
        const auto& state = app.document().state();
        const auto& found = *state.labels[static_cast<std::size_t>(state.active_label)].bits;
        if (label.empty()) label = found;
        DOCTEST_CHECK(found == label);
        const auto& cost = app.model().cost;
        app.shut_down();
        return cost.unet + cost.encoder + cost.decoder;
    };
    const auto nothing = [](app::Application&) {};
    const auto first = start(nothing);
    DOCTEST_CHECK(first > 0);
    DOCTEST_CHECK(start([](app::Application& app) { DOCTEST_CHECK(app.model().cache_bytes > 0); }) == 0);
    DOCTEST_CHECK(start([](app::Application& app) { app.run(command::ClearCache{}); }) == first);
    DOCTEST_CHECK(start([](app::Application& app) { app.run(command::SetCacheMb{0}); }) == first);
    // It is remembered.
    DOCTEST_CHECK(start([](app::Application& app) { DOCTEST_CHECK(app.model().cache_mb == 0); }) == first);
    DOCTEST_CHECK(fs::is_empty(folder.path() / "answers"));
    setenv("GSE_CACHE_DIR", "/dev/null", 1);
}

DOCTEST_TEST_CASE(
    "settings of view and export are there again after a restart, what belongs to one scene is not") {
    const Place place;
    {
        Session session;
        auto& app = session.app;
        auto view = app.model().view;
        view.background = "#ffffff", view.fov_degrees = 70, view.move_speed = 3, view.show_hud = false;
        view.mode = 4;
        app.run(command::SetViewSettings{view});
        auto exports = app.model().exports;
        exports.width = 640, exports.height = 360, exports.frames = 48;
        exports.picture_path = "/somewhere/else.png";
        app.run(command::SetExports{exports});
        app.shut_down();
    }
    const ui::ViewModel untouched;
    Session again;
    const auto& model = again.app.model();
    DOCTEST_CHECK(model.view.background == "#ffffff");
    DOCTEST_CHECK(model.view.fov_degrees == 70);
    DOCTEST_CHECK(model.view.move_speed == 3);
    DOCTEST_CHECK_FALSE(model.view.show_hud);
    DOCTEST_CHECK(model.view.mode == 0);
    DOCTEST_CHECK(model.exports.width == 640);
    DOCTEST_CHECK(model.exports.frames == 48);
    DOCTEST_CHECK(model.exports.picture_path == untouched.exports.picture_path);
}

DOCTEST_TEST_CASE("a scale for one start is not kept, a chosen one is") {
    const Place place;
    const auto scale_of = [](float for_this_start) {
        app::Application app({.autosave = false, .ui_scale = for_this_start, .desktop_scale = 1.25f});
        return app.model().ui_scale;
    };
    DOCTEST_CHECK(scale_of(0) == 1.25f);  // as the desktop says
    {
        app::Application app({.autosave = false, .ui_scale = 2});
        DOCTEST_CHECK(app.model().ui_scale == 2);
        app.shut_down();  // writes the settings
    }
    DOCTEST_CHECK(scale_of(0) == 1.25f);
    {
        app::Application app({.autosave = false});
        app.run(command::SetUiScale{1.5f});
    }
    DOCTEST_CHECK(scale_of(0) == 1.5f);
    DOCTEST_CHECK(scale_of(3) == 3);
    DOCTEST_CHECK(scale_of(0) == 1.5f);
}

DOCTEST_TEST_CASE("work that was not saved is found again, a running edit included") {
    if (!networks()) return;
    const Place place;
    Session session;
    session.open_bear();
    auto request = session.app.model().request;
    request.iterations = 5000;
    session.app.run(command::SetRequest{request});
    session.app.run(command::Edit{});
    DOCTEST_REQUIRE(session.until([&] { return session.app.model().snapshots.size() >= 2; }));
    const auto folder = autosave_folder();
    DOCTEST_REQUIRE(session.until(
        [&] {
            if (!fs::exists(folder)) return false;
            for (const auto& entry : fs::directory_iterator(folder))
                if (entry.path().extension() == ".gsep") {
                    const auto project = load_project(entry.path());
                    if (project.state.stack.size() == 1) return true;
                }
            return false;
        },
        30));
    session.app.run(command::Cancel{});
    DOCTEST_REQUIRE(session.idle());
}

DOCTEST_TEST_CASE("pictures, films, scenes and camera paths are written; mistakes are told") {
    const Place place;
    Session session;
    session.app.run(command::OpenSample{});
    DOCTEST_REQUIRE(session.until([&] { return session.app.model().document != nullptr; }));
    auto exports = session.app.model().exports;
    exports.as_shown = false;
    exports.width = 96;
    exports.height = 64;
    exports.frames = 4;
    exports.transparent = true;
    exports.picture_path = (place.folder / "shot.png").string();
    exports.film_path = (place.folder / "turn").string();
    exports.scene_path = (place.folder / "out.spz").string();
    exports.camera_path_path = (place.folder / "path.json").string();
    exports.format_choices["spz_version"] = 4;
    session.app.run(command::SetExports{exports});
    session.app.update(session.preview);
    session.app.run(command::ExportPicture{});
    DOCTEST_REQUIRE(session.idle());
    const Image shot = read_image(place.folder / "shot.png");
    DOCTEST_CHECK(shot.width == 96);
    DOCTEST_CHECK(shot.channels == 4);
    DOCTEST_CHECK(shot.data[3] == 0);  // the corner shows nothing
    DOCTEST_CHECK(read_png_text(place.folder / "shot.png").count("Recipe") == 1);
    DOCTEST_CHECK(read_png_text(place.folder / "shot.png").at("parameters").find("Seed: ") !=
                  std::string::npos);
    session.app.run(command::ExportTurntable{});
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_CHECK(fs::exists(place.folder / "turn/frame_0003.png"));
    for (const char* film : {"turn.mp4", "turn.webm"}) {
        exports.film_path = (place.folder / film).string();
        exports.before_after = true;
        session.app.run(command::SetExports{exports});
        session.app.run(command::ExportTurntable{});
        DOCTEST_REQUIRE(session.idle());
        DOCTEST_CHECK(session.app.model().file_job.error.empty());
        DOCTEST_CHECK(fs::file_size(place.folder / film) > 500);
    }
    session.app.run(command::ExportScene{});
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_CHECK(load_scene(place.folder / "out.spz").gaussians.size() ==
                  session.app.document().state().current.size());
    DOCTEST_CHECK(read_file(place.folder / "out.spz").starts_with("NGSP"));  // only version 4 begins so
    const auto& views = session.app.document().state().views;
    for (const char* name : {"cameras.json", "transforms.json"}) {
        exports.viewpoints_path = (place.folder / name).string();
        session.app.run(command::SetExports{exports});
        session.app.run(command::ExportViewpoints{});
        DOCTEST_REQUIRE(session.idle());
        const auto written = load_cameras(place.folder / name);
        DOCTEST_REQUIRE(written.size() == views.size());
        DOCTEST_CHECK(length(written[0].camera.centre() - views[0].camera.centre()) < 1e-9);
    }
    session.app.run(command::AddCameraKey{});
    session.app.run(command::AddCameraKey{});
    session.app.run(command::ExportCameraPath{false});
    DOCTEST_REQUIRE(session.idle());
    const auto keys = app::load_camera_path(place.folder / "path.json", 320, 240);
    DOCTEST_REQUIRE(keys.size() == 2);
    DOCTEST_CHECK(length(keys[1].camera.centre() - session.app.model().camera.centre()) < 1e-9);
    DOCTEST_CHECK(app::path_cameras(keys, 10, 64, 64).size() == 21);

    exports.film_path = (place.folder / "turn.avi").string();
    session.app.run(command::SetExports{exports});
    session.app.run(command::ExportTurntable{});
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_CHECK(session.app.model().file_job.error.find(".webm") != std::string::npos);
    session.app.run(command::Open{place.folder / "nothing.ply"});
    DOCTEST_REQUIRE(session.idle());
    session.app.update(session.preview);
    DOCTEST_CHECK(session.app.model().toasts.back().is_error);
    DOCTEST_CHECK(session.app.model().document != nullptr);  // the open scene stays
}

}  // namespace session_test
