// An artist's session driven through the application: open, locate, correct, edit, pause, cancel, apply,
// undo, export, save, reopen, recover.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <thread>

#include "app/application.h"
#include "app/film.h"
#include "engine/io/image_file.h"
#include "engine/io/scene_io.h"
#include "engine/scene/label_ops.h"

namespace {

using namespace gse;
namespace fs = std::filesystem;
using namespace std::chrono_literals;

/// A viewport that paints nothing and remembers what was wanted.
class NoPreview : public app::PreviewHost {
public:
    void want(const app::PictureRequest& request) override { last = request; }
    app::PictureState state() override { return {}; }
    app::PictureRequest last;
};

/// A folder of its own for settings, autosaves and results.
struct Place {
    fs::path folder;
    Place() {
        folder = fs::temp_directory_path() / ("gse_session_" + std::to_string(getpid()));
        fs::remove_all(folder);
        fs::create_directories(folder);
        setenv("GSE_CONFIG_DIR", (folder / "config").c_str(), 1);
        setenv("GSE_STATE_DIR", (folder / "state").c_str(), 1);
    }
    ~Place() {
        std::error_code ignored;
        fs::remove_all(folder, ignored);
    }
};

struct Session {
    NoPreview preview;
    app::Application app;
    explicit Session(bool autosave = true) : app({.autosave = autosave, .autosave_seconds = 0.2}) {
        app.set_viewport_size(320, 240);
    }
    /// Frames until the condition holds; false after `seconds`.
    template <class F>
    bool until(F condition, double seconds = 120) {
        const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
        while (std::chrono::steady_clock::now() < end) {
            app.update(preview);
            if (condition()) return true;
            std::this_thread::sleep_for(5ms);
        }
        return false;
    }
    bool idle() {
        return until([&] { return !app.model().job.running && !app.model().file_job.running; });
    }
    void open_bear() {
        app.open_sample();
        DOCTEST_REQUIRE(until([&] { return app.model().document != nullptr; }));
        auto request = app.model().request;
        request.source = "bear";
        request.prompt = "a blue bear on the grass";
        request.target = "blue";
        request.views = 8;
        request.image_size = 64;
        request.iterations = 30;
        app.set_request(request);
    }
};

bool networks() {
#ifdef GSE_WINDOW
    const bool there = fs::exists(fs::read_symlink("/proc/self/exe").parent_path() / "../libgse_neural.so");
#else
    const bool there = false;
#endif
    if (!there) DOCTEST_MESSAGE("[skip] this build has no networks");
    return there;
}

}  // namespace

DOCTEST_TEST_CASE("open, locate, correct, edit, apply, undo, save and reopen") {
    if (!networks()) return;
    const Place place;
    std::size_t applied_rows = 0;
    std::vector<float> applied_colours;
    {
        Session session;
        session.open_bear();
        auto& app = session.app;
        const auto base = app.document().state().current;
        app.locate();
        DOCTEST_REQUIRE(session.idle());
        DOCTEST_CHECK(app.model().job.error.empty());
        DOCTEST_CHECK(app.model().attention.size() == 8);
        const auto active = static_cast<std::size_t>(app.document().state().active_label);
        DOCTEST_REQUIRE(active < app.document().state().labels.size());
        DOCTEST_CHECK(app.document().state().labels[active].name == "bear");
        const auto found = count_labelled(app.document().state().labels[active]);
        DOCTEST_CHECK(found > 100);
        DOCTEST_CHECK(found < base.size());

        // A brush stroke takes away what lies under it, and undo gives it back.
        ui::ScreenRegion stroke;
        stroke.circles = {{160, 120}};
        stroke.radius_px = 25;
        app.select(stroke, ui::SetOperation::Remove, true);
        const auto corrected = count_labelled(app.document().state().labels[active]);
        DOCTEST_CHECK(corrected < found);
        app.undo();
        DOCTEST_CHECK(count_labelled(app.document().state().labels[active]) == found);
        app.redo();
        DOCTEST_CHECK(count_labelled(app.document().state().labels[active]) == corrected);

        app.edit();
        DOCTEST_REQUIRE(session.idle());
        DOCTEST_CHECK(app.model().job.error.empty());
        DOCTEST_REQUIRE(app.model().result_waiting);
        DOCTEST_CHECK(app.model().losses.size() == 30);
        DOCTEST_CHECK_FALSE(session.preview.last.set.shares_all_with(base));  // the waiting result is shown
        const auto label = *app.document().state().labels[active].bits;
        app.apply_result();
        const auto& state = app.document().state();
        DOCTEST_REQUIRE(state.stack.size() == 1);
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
        app.set_edit_enabled(state.stack[0].id, false);
        DOCTEST_CHECK(app.document().state().current.shares_all_with(base));
        app.undo();
        applied_rows = app.document().state().current.size();
        applied_colours.assign(app.document().state().current.sh().begin(),
                               app.document().state().current.sh().end());
        app.save_project(place.folder / "bear.gsep");
        DOCTEST_REQUIRE(session.idle());
        session.until([&] { return !app.model().unsaved; }, 5);
        DOCTEST_CHECK_FALSE(app.model().unsaved);
        app.shut_down();
    }
    Session again;
    DOCTEST_CHECK(again.app.model().recoverable.empty());
    again.app.open(place.folder / "bear.gsep");
    DOCTEST_REQUIRE(again.until([&] { return again.app.model().document != nullptr; }));
    const auto& current = again.app.document().state().current;
    DOCTEST_REQUIRE(current.size() == applied_rows);
    DOCTEST_CHECK(
        std::equal(current.sh().begin(), current.sh().end(), applied_colours.begin(), applied_colours.end()));
    DOCTEST_CHECK(again.app.model().request.prompt == "a blue bear on the grass");
}

DOCTEST_TEST_CASE("a running edit pauses, shows snapshots, is cancelled and keeps what it reached") {
    if (!networks()) return;
    const Place place;
    Session session;
    session.open_bear();
    auto request = session.app.model().request;
    request.iterations = 5000;
    session.app.set_request(request);
    session.app.edit();
    DOCTEST_REQUIRE(session.until([&] { return session.app.model().snapshots.size() >= 2; }));
    session.app.pause(true);
    session.app.update(session.preview);
    const auto standing = session.app.model().losses.size();
    std::this_thread::sleep_for(600ms);
    session.app.update(session.preview);
    DOCTEST_CHECK(session.app.model().losses.size() <= standing + 1);  // the step under way may end
    DOCTEST_CHECK(session.app.model().job.paused);
    session.app.pause(false);
    DOCTEST_REQUIRE(session.until([&] { return session.app.model().losses.size() > standing + 3; }));
    // A brush stroke corrects the label of the running edit: what it takes away is as it was in the next snapshot.
    ui::ScreenRegion stroke;
    stroke.circles = {{160, 120}};
    stroke.radius_px = 25;
    DOCTEST_REQUIRE(session.app.document().state().active_label >= 0);   // the edit's own search shows what it found
    const auto active = static_cast<std::size_t>(session.app.document().state().active_label);
    const auto before = *session.app.document().state().labels[active].bits;
    session.app.select(stroke, ui::SetOperation::Remove, true);
    const auto corrected = *session.app.document().state().labels[active].bits;
    DOCTEST_REQUIRE(corrected != before);
    const auto taken = session.app.model().losses.size() + 40;
    DOCTEST_REQUIRE(session.until([&] { return session.app.model().losses.size() > taken; }));
    session.app.cancel();
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_REQUIRE(session.app.model().result_waiting);
    session.app.update(session.preview);
    const auto& shown = session.preview.last.set;
    const auto& base = session.app.document().state().current;
    std::size_t outside = 0;
    for (std::size_t row = 0; row < std::min(base.size(), shown.size()); ++row)
        outside += before[row] != 0 && corrected[row] == 0 && shown.sh()[row * 3] != base.sh()[row * 3] ? 1 : 0;
    DOCTEST_CHECK(outside == 0);
    DOCTEST_CHECK(session.app.model().gate.pictures.size() == 4);   // what the model makes of it was shown first
    session.app.branch_from_snapshot(0);
    session.app.apply_result();
    DOCTEST_CHECK(session.app.document().state().stack.size() == 1);
    session.app.undo();
    DOCTEST_CHECK(session.app.document().state().stack.empty());
}

DOCTEST_TEST_CASE("work that was not saved is found again, a running edit included") {
    if (!networks()) return;
    const Place place;
    Session session;
    session.open_bear();
    auto request = session.app.model().request;
    request.iterations = 5000;
    session.app.set_request(request);
    session.app.edit();
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
    session.app.cancel();
    DOCTEST_REQUIRE(session.idle());
}

DOCTEST_TEST_CASE("pictures, films, scenes and camera paths are written; mistakes are told") {
    const Place place;
    Session session;
    session.app.open_sample();
    DOCTEST_REQUIRE(session.until([&] { return session.app.model().document != nullptr; }));
    auto exports = session.app.model().exports;
    exports.width = 96;
    exports.height = 64;
    exports.frames = 4;
    exports.transparent = true;
    exports.picture_path = (place.folder / "shot.png").string();
    exports.film_path = (place.folder / "turn").string();
    exports.scene_path = (place.folder / "out.spz").string();
    exports.camera_path_path = (place.folder / "path.json").string();
    session.app.set_exports(exports);
    session.app.update(session.preview);
    session.app.export_picture();
    DOCTEST_REQUIRE(session.idle());
    const Image shot = read_image(place.folder / "shot.png");
    DOCTEST_CHECK(shot.width == 96);
    DOCTEST_CHECK(shot.channels == 4);
    DOCTEST_CHECK(shot.data[3] == 0);  // the corner shows nothing
    DOCTEST_CHECK(read_png_text(place.folder / "shot.png").count("Recipe") == 1);
    session.app.export_turntable();
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_CHECK(fs::exists(place.folder / "turn/frame_0003.png"));
    for (const char* film : {"turn.mp4", "turn.webm"}) {
        exports.film_path = (place.folder / film).string();
        exports.before_after = true;
        session.app.set_exports(exports);
        session.app.export_turntable();
        DOCTEST_REQUIRE(session.idle());
        DOCTEST_CHECK(session.app.model().file_job.error.empty());
        DOCTEST_CHECK(fs::file_size(place.folder / film) > 500);
    }
    session.app.export_scene();
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_CHECK(load_scene(place.folder / "out.spz").gaussians.size() ==
                  session.app.document().state().current.size());
    session.app.add_camera_key();
    session.app.add_camera_key();
    session.app.export_camera_path(false);
    DOCTEST_REQUIRE(session.idle());
    const auto keys = app::load_camera_path(place.folder / "path.json", 320, 240);
    DOCTEST_REQUIRE(keys.size() == 2);
    DOCTEST_CHECK(length(keys[1].camera.centre() - session.app.model().camera.centre()) < 1e-9);
    DOCTEST_CHECK(app::path_cameras(keys, 10, 64, 64).size() == 21);

    exports.film_path = (place.folder / "turn.avi").string();
    session.app.set_exports(exports);
    session.app.export_turntable();
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_CHECK(session.app.model().file_job.error.find(".webm") != std::string::npos);
    session.app.open(place.folder / "nothing.ply");
    DOCTEST_REQUIRE(session.idle());
    session.app.update(session.preview);
    DOCTEST_CHECK(session.app.model().toasts.back().is_error);
    DOCTEST_CHECK(session.app.model().document != nullptr);  // the open scene stays
}
