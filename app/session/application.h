// The editor behind the window: hands commands to the controllers that do them, and assembles what the panels
// show. Everything here runs on the main thread; work goes to job threads and comes back through the queue.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <utility>

#include "app/session/cost_book.h"
#include "app/session/edit/server_controller.h"
#include "app/session/edit_controller.h"
#include "app/session/export_controller.h"
#include "app/session/file_controller.h"
#include "app/session/label_controller.h"
#include "app/session/model_controller.h"
#include "app/session/place_controller.h"
#include "app/session/preview_host.h"
#include "app/session/search_controller.h"
#include "app/session/state/workspace.h"
#include "app/session/view_controller.h"
#include "ui/model/command.h"
#include "ui/model/view_model.h"

namespace gse::app {

class Application {
public:
    explicit Application(ApplicationOptions options);
    ~Application();
    Application(const Application&) = delete;
    Application& operator=(const Application&) = delete;

    /// Gives a command to its controller. Returns at once; errors are shown, never thrown.
    void run(const ui::Command& command);
    /// Runs what other threads posted, advances clocks, assembles the view model. Call before every frame.
    void update(PreviewHost& preview);
    /// Valid until the next call of run() or update().
    const ui::ViewModel& model() const { return model_; }
    /// Something moves or works: draw frames without waiting for input.
    bool busy() const;
    bool wants_to_quit() const { return quit_; }
    /// Places of the panels; part of settings and project.
    void set_layout(const std::string& json) { workspace_.layout = json; }
    const std::string& layout() const { return workspace_.layout; }
    bool layout_changed() { return std::exchange(workspace_.layout_loaded, false); }
    /// Writes what is not saved to the recovery folder and stops all jobs.
    void shut_down();
    const Document& document() const { return workspace_.document; }
    /// The word the next edit is about: what was clicked, else what the sentence implies for the scene as it
    /// is.
    std::string target() const { return search_.recipe().request.target; }

private:
    using Clock = std::chrono::steady_clock;
    /// A state of a document.
    struct Seen {
        std::uint64_t opened = 0, revision = 0;
        bool operator==(const Seen&) const = default;
    };
    template <class C> void on(const C& command);
    void run_window(const ui::WindowCommand& command);
    void follow_document();
    void forget_undone();
    void show();
    void save_settings();
    void load_settings();

    Workspace workspace_;
    ViewController view_;
    ModelController models_;
    ServerController servers_;
    CostBook costs_;
    SearchController search_;
    EditController edits_;
    LabelController labels_;
    PlaceController places_;
    ExportController exports_;
    FileController files_;
    ui::ViewModel model_;
    std::string keymap_;
    float ui_scale_ = 1;
    float chosen_scale_ = 0;  // by the artist; 0 = as the desktop says
    bool quit_ = false;
    Seen seen_;
    Clock::time_point last_frame_ = Clock::now();
    double frames_per_second_ = 0;
};

}  // namespace gse::app
