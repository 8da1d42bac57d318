// Models in use: another one is tried before it takes the place of the one that works. Their settings, LoRAs,
// segmenters and the cache of their answers.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/engine_names.h"
#include "app/session/model_list.h"
#include "app/session/state/workspace.h"
#include "engine/base/content_hash.h"
#include "engine/neural/api/model_profile.h"
#include "engine/pipeline/models/recipe_model.h"
#include "engine/pipeline/recipe/recipe.h"
#include "ui/model/model_settings.h"

namespace gse::app {

class ModelController {
public:
    /// Fields of the request that nobody chose go from the one model's values to the other's.
    using MoveRequest = std::function<void(const edit::EditRequest& before, const edit::EditRequest& after)>;
    struct Ticket {
        ContentKey key;
        std::string path;
        bool on_cpu = true;
    };
    ModelController(Workspace& workspace, MoveRequest move_request);

    void run(const ui::ModelCommand& command);
    void show(ui::ModelPart& model) const;

    /// The model that was in use when the program was last left; what cannot be used any more gives way.
    void start();
    /// Tries a model with LoRAs; what is in use stays where that fails. `takes_settings`: settings that
    /// nobody chose take the model's values.
    void try_model(const std::string& path, std::vector<std::string> loras, bool takes_settings);
    const ui::ModelSettings& settings() const { return settings_; }
    void set_settings(const ui::ModelSettings& settings) { settings_ = settings; }
    const std::string& path() const { return path_; }  // empty = the starter model
    const std::vector<std::string>& loras() const { return loras_; }
    const std::string& segmenter_path(ui::SegmenterRole role) const {  // empty = none
        return segmenters_[static_cast<std::size_t>(role)].path;
    }
    std::string in_use() const;  // a path in any case
    const ModelList& list() const { return list_; }
    const edit::ModelTraits& traits() const { return profile_.traits; }
    /// The recipe of a request with the model and its settings, the profile's values filled in.
    EditRecipe recipe(const edit::EditRequest& request, const std::string& looked_from) const;

    // The loaded model
    ContentKey key() const;  // of everything that the loaded model depends on
    const std::shared_ptr<neural::TextToImage>& loaded() const { return loaded_; }
    bool loaded_fits() const { return loaded_ != nullptr && loaded_key_ == key(); }
    const ModelLoad& load() const { return load_; }
    /// Facts about a job when it began.
    Ticket ticket() const { return {key(), path_, settings_.device == "cpu"}; }
    /// The model that a job loaded stays in memory; one that it could not load (null) gives way.
    void take_back(const Ticket& ticket, std::shared_ptr<neural::TextToImage> model, const ModelLoad& load,
                   const Error* error);
    const std::shared_ptr<DiskCache>& cache() const { return cache_; }
    void measure_cache();

    void settings_to_json(nlohmann::json& json) const;  // of the program
    void settings_from_json(const nlohmann::json& json);
    void to_json(nlohmann::json& json) const;  // of a project
    void from_json(const nlohmann::json& json);
    /// Another document is open: the direction of its front is not that of the last one.
    void take_document() { settings_.front = settings_defaults_.front; }
    /// The settings of a recipe, its model and its LoRAs.
    void take_recipe(const EditRecipe& recipe);

private:
    /// Weights of one role, tried before they count.
    struct Segmenter {
        std::string path;  // empty = none
        bool checking = false;
    };
    template <class C> void on(const C& command);
    void list_loras();
    void refuse(const std::string& path, std::string problem);
    void use(const std::string& path, const neural::ModelProfile& profile, bool takes_settings);
    void use_profile(const neural::ModelProfile& profile, bool takes_settings);
    void keep(std::shared_ptr<neural::TextToImage> model);
    void drop(const std::string& path, const Error& error);
    void take_chosen();
    void drop_loras(const Error& error);
    void try_loras(std::vector<std::string> loras);
    JobParameters job_of(const std::string& path, const std::vector<std::string>& loras) const;

    Workspace& workspace_;
    MoveRequest move_request_;
    ui::ModelSettings settings_, settings_defaults_;
    std::string path_;                // in use; empty = the starter model
    std::vector<std::string> loras_;  // FILE or FILE:strength, merged into the model in use
    bool loras_checking_ = false;
    std::array<Segmenter, 2> segmenters_;  // by SegmenterRole
    neural::ModelProfile profile_;         // of the model in use
    EditRecipe defaults_;                  // what settings are that nobody chose
    ModelList list_;
    std::vector<ui::LoraView> lora_rows_;
    std::shared_ptr<neural::TextToImage> loaded_;
    ContentKey loaded_key_;
    ModelLoad load_;  // of the model in memory
    std::shared_ptr<DiskCache> cache_;
    int cache_mb_ = 0;
    std::uint64_t cache_bytes_ = 0;
};

}  // namespace gse::app
