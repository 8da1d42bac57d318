// Exports: pictures, films, scenes, viewpoints and camera paths, all on the file thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/session/edit_controller.h"
#include "app/session/label_controller.h"
#include "app/session/search_controller.h"
#include "app/session/state/workspace.h"
#include "app/session/view_controller.h"

namespace gse::app {

class ExportController {
public:
    ExportController(Workspace& workspace, ViewController& view, SearchController& search,
                     EditController& edits)
        : workspace_(workspace), view_(view), search_(search), edits_(edits) {}

    void run(const ui::ExportCommand& command);
    /// A choice for what is hidden ends with it. Once per frame.
    void refresh();
    void show(ui::ExportPart& model) const;
    /// Another document is open: it has no camera path yet.
    void take_document();

    const ui::ExportSettings& settings() const { return settings_; }
    void set_settings(const ui::ExportSettings& settings) { settings_ = settings; }
    /// Another number for each camera path: it is part of the project.
    std::uint64_t keys_number() const { return keys_number_; }

    void to_json(nlohmann::json& json) const;
    void from_json(const nlohmann::json& json);

private:
    template <class C> void on(const C& command);
    std::filesystem::path place_for(const std::string& name) const;
    std::filesystem::path free_place(const std::string& name) const;
    bool something_to_export();
    GaussianSet exported(const GaussianSet& set, const Stage& stage) const;
    ExtraColumns exported_columns(const Stage& stage) const;
    std::string said_of_export() const;
    OrbitParameters orbit(const GaussianSet& shown) const;
    raster::Settings render_settings() const;
    void export_as_shown(float em_px);
    void write_scene(const std::filesystem::path& path);
    void start(const char* what, const std::filesystem::path& path,
               std::function<void(const JobControl&)> work, const std::string& said, bool can_pause = false);

    Workspace& workspace_;
    ViewController& view_;
    SearchController& search_;
    EditController& edits_;
    ui::ExportSettings settings_;
    std::vector<CameraKey> keys_;
    std::uint64_t keys_number_ = 0, hidden_seen_ = 0;
};

}  // namespace gse::app
