// Unsaved work: kept when the program ends in the middle of an edit, offered again, gone when it was saved or
// given up. Folders that hold scenes; exports that write over nothing.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <limits>

#include "engine/base/file.h"
#include "engine/io/cameras/cameras.h"
#include "engine/io/project/load_scene.h"
#include "engine/io/scene/scene_file.h"
#include "engine/pipeline/scene/scene_tools.h"
#include "tests/ui/app/session.h"

namespace unsaved_test {

using namespace gse;
using namespace gse::test;

namespace {

std::vector<float> colours(const GaussianSet& set) { return {set.sh().begin(), set.sh().end()}; }

/// The bundled scene in a folder of its own, as a file that an artist could have.
fs::path own_scene(const Place& place) {
    const auto file = place.folder / "bear/scene.ply";
    fs::create_directories(file.parent_path());
    fs::copy_file(app::assets_path() / "scenes/bear/scene.ply", file);
    return file;
}

void start_edit(Session& session, int iterations) {
    session.ask_for_blue();
    auto request = session.app.model().request;
    request.iterations = iterations;
    session.app.run(command::SetRequest{request});
    session.app.run(command::Edit{});
    session.app.update(session.preview);
}

void open_and_save(Session& session, const fs::path& scene) {
    session.app.run(command::Open{scene});
    DOCTEST_REQUIRE(session.until([&] { return session.app.model().document != nullptr; }));
    session.app.run(command::SaveProject{fs::path(scene).replace_extension(".gsep")});
    DOCTEST_REQUIRE(session.until([&] { return !session.app.model().project_path.empty(); }));
    session.app.update(session.preview);
    DOCTEST_REQUIRE_FALSE(session.app.model().unsaved);
}

std::size_t count_offered(const app::Application& app) {
    std::size_t count = 0;
    for (const auto& found : app.model().recoverable) count += found.offered ? 1u : 0u;
    return count;
}

}  // namespace

DOCTEST_TEST_CASE(
    "a finished edit that was not applied is unsaved work: kept, offered by name, had back whole") {
    if (!networks()) return;
    const Place place;
    const auto scene = own_scene(place);
    std::vector<float> base, edited;
    {
        Session session;
        open_and_save(session, scene);  // all is saved but the edit
        base = colours(session.app.document().state().current);
        start_edit(session, 30);
        DOCTEST_CHECK(session.app.model().edit_running);
        DOCTEST_CHECK(session.app.model().unsaved);
        DOCTEST_REQUIRE(session.idle());
        DOCTEST_REQUIRE(session.app.model().result_waiting);
        DOCTEST_CHECK(session.app.model().unsaved);
        edited = colours(session.preview.last.set);
        bool left = false;
        session.app.run(command::LeaveEdit{true, [&] { left = true; }});
        DOCTEST_REQUIRE(session.until([&] { return left; }));
        session.app.run(command::Quit{});
        session.app.shut_down();
    }
    Session again;
    DOCTEST_REQUIRE(again.app.model().recoverable.size() == 1);
    const auto found = again.app.model().recoverable[0];
    DOCTEST_CHECK(found.name == "scene.gsep");
    DOCTEST_CHECK(found.facts.starts_with("today "));
    DOCTEST_CHECK(found.running.find("a blue bear on the grass") != std::string::npos);
    DOCTEST_CHECK(found.running.find("not applied") != std::string::npos);
    DOCTEST_REQUIRE(found.thumbnail != nullptr);
    DOCTEST_CHECK(found.thumbnail->width > 100);
    again.app.run(command::Open{scene});  // the same scene: the offer comes along
    DOCTEST_REQUIRE(again.until([&] { return again.app.model().document != nullptr; }));
    DOCTEST_CHECK(count_offered(again.app) == 1);
    again.app.run(command::Recover{found.file});
    DOCTEST_REQUIRE(again.until([&] { return again.app.model().result_waiting; }));
    DOCTEST_CHECK(again.app.model().recoverable.empty());
    DOCTEST_CHECK(again.app.model().unsaved);
    DOCTEST_CHECK(colours(again.app.document().state().current) == base);
    again.app.run(command::ApplyResult{});
    DOCTEST_CHECK(colours(again.app.document().state().current) == edited);
    DOCTEST_REQUIRE(again.app.document().state().stack.size() == 1);
    DOCTEST_CHECK(again.app.document().state().stack[0].name == "a blue bear on the grass");
    DOCTEST_CHECK_FALSE(again.app.document().state().stack[0].recipe.empty());
    again.app.run(command::SaveProject{});
    DOCTEST_REQUIRE(again.until([&] { return !again.app.model().unsaved; }));
    again.until([&] { return find_recoverable().empty() && fs::is_empty(autosave_folder()); }, 10);
    DOCTEST_CHECK(fs::is_empty(autosave_folder()));  // recovered and saved: nothing is offered any more
}

DOCTEST_TEST_CASE("a program that is ended in the middle of an edit loses none of it") {
    if (!networks()) return;
    const Place place;
    const auto scene = own_scene(place);
    int reached = 0;
    {
        Session session;
        open_and_save(session, scene);
        start_edit(session, 5000);
        DOCTEST_REQUIRE(session.until([&] { return session.app.model().snapshots.size() >= 2; }));
        reached = session.app.model().snapshots.back().iteration;
        session.app.shut_down();  // as SIGTERM does: nobody can be asked
    }
    Session again;
    again.app.run(command::Open{scene});  // named on the command line: no start page was seen
    DOCTEST_REQUIRE(again.until([&] { return again.app.model().document != nullptr; }));
    DOCTEST_REQUIRE(count_offered(again.app) == 1);
    DOCTEST_CHECK(again.app.model().recoverable[0].running.find("of 5000") != std::string::npos);
    again.app.run(command::PostponeRecovery{again.app.model().recoverable[0].file});
    DOCTEST_CHECK(count_offered(again.app) == 0);
    again.app.run(command::Open{scene});  // opened again, offered again
    DOCTEST_REQUIRE(again.until([&] { return count_offered(again.app) == 1; }));
    again.app.run(command::Recover{again.app.model().recoverable[0].file});
    DOCTEST_REQUIRE(again.until([&] { return again.app.model().result_waiting; }));
    again.app.run(command::ApplyResult{});
    const auto& name = again.app.document().state().stack.at(0).name;
    DOCTEST_CHECK(name.find("interrupted at iteration") != std::string::npos);
    DOCTEST_CHECK(std::stoi(name.substr(name.find("iteration") + 9)) >= reached);
}

DOCTEST_TEST_CASE("a discarded edit is gone, the scene stays; another scene is opened with the edit kept") {
    if (!networks()) return;
    const Place place;
    const auto scene = own_scene(place);
    const auto other = place.folder / "other.ply";
    fs::copy_file(scene, other);
    Session session;
    open_and_save(session, scene);
    start_edit(session, 5000);
    DOCTEST_REQUIRE(session.until([&] { return session.app.model().snapshots.size() >= 2; }));
    bool left = false;
    session.app.run(command::LeaveEdit{false, [&] { left = true; }});
    DOCTEST_REQUIRE(session.until([&] { return left; }));
    session.app.update(session.preview);
    DOCTEST_CHECK_FALSE(session.app.model().result_waiting);
    // What its search labelled is a step of its own, which stays until it is saved or undone.
    session.app.run(command::SaveProject{fs::path(scene).replace_extension(".gsep")});
    DOCTEST_REQUIRE(session.until([&] { return !session.app.model().unsaved; }, 60));
    DOCTEST_REQUIRE(session.until([&] { return fs::is_empty(autosave_folder()); }, 60));
    // Kept, and another scene opened: it is offered when the first scene is opened again, also in this
    // session.
    start_edit(session, 5000);
    DOCTEST_REQUIRE(session.until([&] { return session.app.model().snapshots.size() >= 2; }));
    session.app.run(command::LeaveEdit{true, [&] { session.app.run(command::Open{other}); }});
    DOCTEST_REQUIRE(session.until([&] { return session.app.model().scene_path == other.string(); }));
    DOCTEST_CHECK(session.app.model().recoverable.size() == 1);
    DOCTEST_CHECK(count_offered(session.app) == 0);
    DOCTEST_CHECK_FALSE(session.app.model().result_waiting);
    session.app.run(command::Open{scene});
    DOCTEST_REQUIRE(session.until([&] { return count_offered(session.app) == 1; }));
    session.app.run(command::DiscardRecovery{session.app.model().recoverable[0].file});
    DOCTEST_CHECK(session.app.model().recoverable.empty());
    DOCTEST_CHECK(fs::is_empty(autosave_folder()));
}

DOCTEST_TEST_CASE("what was given up on purpose is not offered again") {
    const Place place;
    const auto scene = own_scene(place);
    {
        Session session;
        open_and_save(session, scene);
        session.app.run(command::AddLabel{"unsaved"});
        DOCTEST_REQUIRE(session.until(
            [&] { return fs::exists(autosave_folder()) && !fs::is_empty(autosave_folder()); }, 20));
        session.app.run(command::Quit{});  // the window asked before
        session.app.shut_down();
    }
    const Session again;
    DOCTEST_CHECK(again.app.model().recoverable.empty());
}

DOCTEST_TEST_CASE("a folder with a scene and its cameras opens; several scenes are asked about") {
    const Place place;
    const auto scene = own_scene(place);
    const auto folder = scene.parent_path();
    Session session;
    session.app.run(command::OpenSample{});
    DOCTEST_REQUIRE(session.until([&] { return session.app.model().document != nullptr; }));
    save_cameras_json(folder / "cameras.json", orbit_views(session.app.model().orbit, 7, 64, 64));
    session.app.run(command::Open{folder});
    DOCTEST_REQUIRE(session.until([&] { return session.app.model().scene_path == scene.string(); }));
    DOCTEST_CHECK(session.app.document().state().views.size() == 7);
    fs::copy_file(scene, folder / "another.ply");
    session.app.run(command::Open{folder});
    DOCTEST_REQUIRE(session.until([&] { return session.app.model().question.number == 1; }));
    const auto& asked = session.app.model().question;
    DOCTEST_REQUIRE(asked.answers.size() == 3);
    DOCTEST_CHECK(asked.answers[0].text == "another.ply");
    DOCTEST_CHECK(asked.answers[0].listed);
    DOCTEST_CHECK(session.app.model().scene_path == scene.string());
    session.app.run(command::Answer{0});
    session.app.run(command::Answer{0});  // a question is answered once
    DOCTEST_REQUIRE(
        session.until([&] { return session.app.model().scene_path == (folder / "another.ply").string(); }));
    DOCTEST_CHECK(session.app.model().toasts.empty());
}

DOCTEST_TEST_CASE("cameras that are opened are those of the open scene; without one it is said what to do") {
    const Place place;
    Session session;
    auto& app = session.app;
    OrbitParameters around;
    save_cameras_json(place.folder / "cameras.json", orbit_views(around, 7, 64, 64));
    app.run(command::Open{place.folder / "cameras.json"});
    DOCTEST_REQUIRE(session.until([&] { return !app.model().toasts.empty(); }, 10));
    DOCTEST_CHECK(app.model().toasts[0].text.find("open their scene first") != std::string::npos);
    DOCTEST_CHECK(app.model().document == nullptr);
    app.run(command::OpenSample{});
    DOCTEST_REQUIRE(session.until([&] { return app.model().document != nullptr; }));
    save_cameras_json(place.folder / "cameras.json", orbit_views(app.model().orbit, 7, 64, 64));
    const auto before = app.document().state().views.size();
    DOCTEST_REQUIRE(before != 7);
    app.run(command::Open{place.folder / "cameras.json"});
    DOCTEST_REQUIRE(session.until([&] { return app.document().state().views.size() == 7; }, 30));
    app.run(command::Undo{});
    DOCTEST_CHECK(app.document().state().views.size() == before);
    auto elsewhere = orbit_views(app.model().orbit, 7, 64, 64);
    for (auto& view : elsewhere) view.camera.translation.x += 1000;
    save_cameras_json(place.folder / "cameras.json", elsewhere);
    app.run(command::Open{place.folder});  // the folder is as good
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_CHECK(app.document().state().views.size() == before);
    DOCTEST_CHECK(app.model().toasts.back().is_error);
    app.shut_down();
}

DOCTEST_TEST_CASE("an up axis that was chosen is known, written, and undone with orbit and camera") {
    const Place place;
    const auto scene = own_scene(place);
    Session session;
    auto& app = session.app;
    app.run(command::Open{scene});
    DOCTEST_REQUIRE(session.until([&] { return app.model().document != nullptr; }));
    app.update(session.preview);
    const auto orbit = app.model().orbit;
    const auto camera = app.model().camera;
    app.run(command::SetUpAxis{"z"});
    app.update(session.preview);
    DOCTEST_CHECK(app.document().state().info.up_known);
    DOCTEST_CHECK(app.model().orbit.up.z > 0.99);
    DOCTEST_CHECK_FALSE(app.model().camera.rotation == camera.rotation);
    auto exports = app.model().exports;
    exports.scene_path = (place.folder / "upright.ply").string();
    app.run(command::SetExports{exports});
    app.run(command::ExportScene{});
    DOCTEST_REQUIRE(session.idle());
    const auto written = load_scene(place.folder / "upright.ply").info;
    DOCTEST_CHECK(written.up_known);
    DOCTEST_CHECK(written.up.z > 0.99);
    app.run(command::Undo{});
    app.update(session.preview);
    DOCTEST_CHECK(app.model().orbit.up == orbit.up);
    DOCTEST_CHECK(app.model().camera.rotation == camera.rotation);
    app.shut_down();
}

DOCTEST_TEST_CASE("the statistics are those of the scene as it is, after a deletion and its undo too") {
    const Place place;
    Session session;
    auto& app = session.app;
    app.run(command::OpenSample{});
    DOCTEST_REQUIRE(session.until([&] { return app.model().document != nullptr; }));
    const auto count = app.model().statistics.count;
    ui::ScreenRegion stroke;
    stroke.circles = {{160, 120}};
    stroke.radius_px = 20;
    app.run(command::Select{stroke, ui::SetOperation::Add, true});
    app.run(command::DeleteLabelledSplats{});
    const auto left = app.document().state().current.size();
    DOCTEST_REQUIRE(left < count);
    DOCTEST_CHECK(session.until([&] { return app.model().statistics.count == left; }, 10));
    app.run(command::Undo{});
    DOCTEST_CHECK(session.until([&] { return app.model().statistics.count == count; }, 10));
    app.shut_down();
}

DOCTEST_TEST_CASE("every export numbers its files, a scene is replaced only when that is said") {
    const Place place;
    Session session;
    session.app.run(command::Open{own_scene(place)});
    DOCTEST_REQUIRE(session.until([&] { return session.app.model().document != nullptr; }));
    auto exports = session.app.model().exports;
    exports.width = 64;
    exports.height = 48;
    exports.frames = 2;
    exports.picture_path = (place.folder / "shot.png").string();
    exports.film_path = (place.folder / "turn").string();
    exports.scene_path = (place.folder / "out.compressed.ply").string();
    exports.camera_path_path = (place.folder / "path-9.json").string();
    session.app.run(command::SetExports{exports});
    session.app.update(session.preview);
    session.app.run(command::AddCameraKey{});
    for (int time = 0; time < 3; ++time)
        for (const ui::Command& act :
             {ui::Command(command::ExportPicture{}), ui::Command(command::ExportTurntable{})}) {
            session.app.run(act);
            DOCTEST_REQUIRE(session.idle());
        }
    for (const char* name :
         {"shot.png", "shot-2.png", "shot-3.png", "turn/frame_0001.png", "turn-3/frame_0001.png"})
        DOCTEST_CHECK_MESSAGE(fs::exists(place.folder / name), name);
    for (int time = 0; time < 2; ++time) {
        session.app.run(command::ExportCameraPath{false});
        DOCTEST_REQUIRE(session.idle());
    }
    DOCTEST_CHECK(fs::exists(place.folder / "path-10.json"));
    session.app.run(command::ExportScene{});
    DOCTEST_REQUIRE(session.idle());
    const auto first = read_file(place.folder / "out.compressed.ply");
    session.app.run(command::ExportScene{});
    session.app.update(session.preview);
    DOCTEST_REQUIRE(session.app.model().question.answers.size() == 3);
    DOCTEST_CHECK(session.app.model().question.answers[0].text == "Write out-2.compressed.ply");
    session.app.run(command::Answer{0});
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_CHECK(fs::exists(place.folder / "out-2.compressed.ply"));
    DOCTEST_CHECK(read_file(place.folder / "out.compressed.ply") == first);
    // The scene that is open is never replaced.
    exports.scene_path = session.app.model().scene_path;
    session.app.run(command::SetExports{exports});
    session.app.run(command::ExportScene{});
    for (const auto& answer : session.app.model().question.answers) DOCTEST_CHECK_FALSE(answer.dangerous);
}

DOCTEST_TEST_CASE("one piece of news makes one toast") {
    const Place place;
    write_file(place.folder / "scene.ply", "ply\nno scene at all\n");
    Session session;
    for (int time = 0; time < 3; ++time) {
        session.app.run(command::Open{place.folder / "scene.ply"});
        DOCTEST_REQUIRE(session.idle());
        session.app.update(session.preview);
    }
    DOCTEST_CHECK(session.app.model().toasts.size() == 1);
    // A warning of the reader reaches the artist once, not from the log and from the notes.
    const auto scene = own_scene(place);
    Scene broken = load_scene(scene);
    GaussianData data = broken.gaussians.to_data();
    data.position[0] = std::numeric_limits<float>::quiet_NaN();
    broken.gaussians = GaussianSet(std::move(data));
    save_scene(place.folder / "broken.ply", broken);
    session.app.run(command::DismissToast{0});
    session.app.run(command::Open{place.folder / "broken.ply"});
    DOCTEST_REQUIRE(session.until([&] { return session.app.model().document != nullptr; }));
    session.until([] { return false; }, 0.3);
    const auto& toasts = session.app.model().toasts;
    for (std::size_t a = 0; a < toasts.size(); ++a)
        for (std::size_t b = 0; b < toasts.size(); ++b)
            if (a != b) DOCTEST_CHECK(toasts[a].text.find(toasts[b].text) == std::string::npos);
}

}  // namespace unsaved_test
