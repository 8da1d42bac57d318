// Files and recovery: opening, saving, recipes out of pictures, autosaves, and leaving a running edit.
#pragma once

#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/session/edit_controller.h"
#include "app/session/export_controller.h"
#include "app/session/files/opened_work.h"
#include "app/session/files/recent_files.h"
#include "app/session/files/recovery.h"
#include "app/session/files/saved_project.h"
#include "app/session/files/scene_counter.h"
#include "app/session/label_controller.h"
#include "app/session/model_controller.h"
#include "app/session/search_controller.h"
#include "app/session/state/workspace.h"
#include "app/session/view_controller.h"

namespace gse::app {

class FileController {
public:
    /// All that a project holds of.
    struct Parts {
        ViewController& view;
        ModelController& models;
        ServerController& servers;
        SearchController& search;
        EditController& edits;
        LabelController& labels;
        ExportController& exports;
    };
    FileController(Workspace& workspace, const Parts& parts);

    void run(const ui::FileCommand& command);
    /// Writes an autosave where one is due, and leaves an edit that has stopped. Once per frame.
    void refresh();
    void show(ui::DocumentPart& model) const;
    /// Writes what is not saved to the recovery folder. `asked`: the artist said what becomes of it.
    void shut_down(bool asked);
    bool leaving() const { return leaving_.has_value(); }
    /// True while the splats are to be counted once nothing moves any more.
    bool counts_later() const { return !workspace_.document.empty() && counter_.behind(); }

private:
    /// The edit is being stopped.
    struct Leaving {
        bool keep = false;
        std::function<void()> then;
    };
    template <class C> void on(const C& command);
    void open(const std::filesystem::path& path, const ReadingOptions& options = {});
    void offer_activated(const std::filesystem::path& path);
    void open_recipe(const std::filesystem::path& picture);
    void open_cameras(const std::filesystem::path& path);
    void take_cameras(const std::string& name, std::vector<View> views,
                      const std::vector<std::string>& notes);
    void start_reading(const std::string& title, WorkToOpen work);
    void tell_link(const std::filesystem::path& project);
    void take(OpenedWork opened);
    void take_lost(const WorkToOpen& work, const OpenedWork& opened);
    void forget_document();
    void take_parts(std::optional<PendingResult> pending);
    void ask_which(const std::filesystem::path& folder, const std::vector<std::filesystem::path>& files);
    std::filesystem::path default_project_path() const;
    std::shared_ptr<ProjectData> project_data() const;
    void parts_from_json(const nlohmann::json& json);
    bool unsaved() const;
    Recovery::Moment moment() const;
    std::function<std::shared_ptr<const Image>()> thumbnail() const;
    std::function<std::shared_ptr<const Image>()> picture_of(const GaussianSet& set) const;
    void write_autosave(std::function<void()> then);
    void leave_when_stopped();

    Workspace& workspace_;
    Parts parts_;
    Recovery recovery_;
    SavedProject project_;
    SceneCounter counter_;
    SceneSource source_;
    nlohmann::json unknown_ = nlohmann::json::object();
    RecentFiles recent_;
    nlohmann::json kept_edit_;        // of an edit that was stopped before its first step
    std::optional<Leaving> leaving_;  // waits for the edit to stop
    bool embeds_ = false;             // the project holds its scene
    WorkToOpen lost_;                 // whose scene is to be found; no path = none is
    ui::LostScene lost_view_;
};

}  // namespace gse::app
