// An application without its window, in folders of its own, and frames until something holds.
#pragma once

#include <doctest/doctest.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>

#include "app/session/application.h"
#include "tests/test_paths.h"

namespace gse::test {

namespace fs = std::filesystem;
namespace command = ui::command;
namespace command = ui::command;

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
    explicit Session(bool autosave = true)
        : Session(app::ApplicationOptions{.autosave = autosave, .autosave_seconds = 0.2}) {}
    explicit Session(const app::ApplicationOptions& options) : app(options) {
        app.run(command::SetViewportSize{320, 240});
    }
    /// Frames until the condition holds; false after `seconds`, times GSE_PATIENCE: instrumented builds are
    /// that much slower.
    template <class F> bool until(F condition, double seconds = 600) {
        const double patience = std::atof(from_environment("GSE_PATIENCE", "1").c_str());
        const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds * patience);
        while (std::chrono::steady_clock::now() < end) {
            app.update(preview);
            if (condition()) return true;
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
        return false;
    }
    bool idle() {
        return until([&] { return !app.model().job.running && !app.model().file_job.running; });
    }
    /// Until no job has run for a while: one may follow another.
    bool settled() {
        int still = 0;
        return until(
            [&] {
                still = app.model().job.running || app.model().file_job.running ? 0 : still + 1;
                return still > 20;
            },
            600);
    }
    void open_bear() {
        app.run(command::OpenSample{});
        DOCTEST_REQUIRE(until([&] { return app.model().document != nullptr; }));
        ask_for_blue();
    }
    /// A new label "mine" over what a brush of that radius covers in the middle of the viewport.
    void label_the_middle(float radius_px = 20) {
        ui::ScreenRegion stroke;
        stroke.circles = {{160, 120}};
        stroke.radius_px = radius_px;
        app.run(command::AddLabel{"mine"});
        app.run(command::Select{stroke, ui::SetOperation::Add, true});
    }
    void ask_for_blue() {
        auto request = app.model().request;
        request.source = "bear";
        request.prompt = "a blue bear on the grass";
        request.target = "blue";
        request.views = 8;
        request.image_size = 64;
        request.method = "sds";  // goes on for as many steps as a test needs
        request.iterations = 30;
        app.run(command::SetRequest{request});
    }
};

inline bool networks() {
#ifdef GSE_WINDOW
    const bool there = fs::exists(fs::read_symlink("/proc/self/exe").parent_path() / "../libgse_neural.so");
#else
    const bool there = false;
#endif
    if (!there) skip_missing("libgse_neural.so is not there");
    return there;
}

}  // namespace gse::test
