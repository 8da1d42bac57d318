// Costs of past work with each model on this machine, and estimates for the next edit.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/session/model_controller.h"
#include "app/session/state/estimate.h"
#include "app/session/state/workspace.h"

namespace gse::app {

class CostBook {
public:
    CostBook(Workspace& workspace, const ModelController& models) : workspace_(workspace), models_(models) {}

    /// Profiles are kept by model, its parts and the size of pictures.
    std::string key(const edit::EditRequest& request) const;
    CostProfile profile(const edit::EditRequest& request) const;
    /// Takes what a job measured; the rest stays.
    void remember(const std::string& key, const CostProfile& measured);
    PlannedMemory memory() const;

    /// Estimates edits that are made one after another; `edits` must not be empty. Where a server draws, the
    /// work of the model here says nothing of the time: only the server's part is told.
    void estimate(const std::vector<PlannedEdit>& edits, const ServerCost& server);
    void forget_estimate() { estimate_ = {}; }
    /// True when something was measured since the last estimate.
    bool is_stale() const { return stale_; }
    void show(ui::SearchPart& model) const { model.estimate = estimate_; }

    void settings_to_json(nlohmann::json& json) const;
    void settings_from_json(const nlohmann::json& json);

private:
    Workspace& workspace_;
    const ModelController& models_;
    std::map<std::string, CostProfile> profiles_;
    ui::Estimate estimate_;
    bool stale_ = false;
};

}  // namespace gse::app
