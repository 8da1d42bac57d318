// Models in use: another one is tried before it takes the place of the one that works. Their settings, LoRAs,
// segmenters and the cache of their answers.
#include "app/session/model_controller.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "app/session/state/json_values.h"
#include "engine/base/disk_cache.h"
#include "engine/base/error.h"
#include "engine/base/json.h"
#include "engine/neural/api/lora_spec.h"
#include "engine/pipeline/inventory/model_inventory.h"
#include "engine/pipeline/models/installed.h"
#include "engine/pipeline/models/model_catalogue.h"
#include "engine/pipeline/models/model_settings.h"
#include "engine/pipeline/models/segmenters.h"

namespace gse::app {
namespace {

namespace command = ui::command;

std::string reason_of(const Error& error) {
    return error.hint().empty() ? error.message() : fmt::format("{}; {}", error.message(), error.hint());
}

/// One sentence about weights that are neither model nor LoRA nor segmenter here.
std::string why_not_used(const ModelFile& file) {
    std::string why = file.use.why;
    if (file.use.place == neural::WeightPlace::Here)
        why = file.use.how == "--taesd" ? "the command line takes it with --taesd"
                                        : "it counts where it lies beside the checkpoint that it belongs to";
    else if (file.use.place == neural::WeightPlace::Server)
        why += "; use it through an image server that has it (Models, Image server)";
    return fmt::format("\"{}\" cannot be used by itself ({}): {}.", file.path.filename().string(), file.kind,
                       why);
}

}  // namespace

ModelController::ModelController(Workspace& workspace, MoveRequest move_request)
    : workspace_(workspace), move_request_(std::move(move_request)),
      cache_(open_answer_cache(load_cache_settings())),
      cache_mb_(static_cast<int>(cache_->most_bytes() >> 20)), cache_bytes_(cached_bytes(cache_->folder())) {}

std::string ModelController::in_use() const { return path_.empty() ? starter_model_path().string() : path_; }

ContentKey ModelController::key() const {
    ContentHash hash;
    hash.texts({path_, settings_.device, settings_.precision});
    hash.texts(loras_);
    return hash.key();
}

void ModelController::keep(std::shared_ptr<neural::TextToImage> model) {
    loaded_ = std::move(model);
    loaded_key_ = key();
}

void ModelController::take_back(const Ticket& ticket, std::shared_ptr<neural::TextToImage> model,
                                const ModelLoad& load, const Error* error) {
    load_ = load;
    measure_cache();
    if (model) {
        loaded_ = std::move(model);
        loaded_key_ = ticket.key;
    } else if (error != nullptr && error->code() != ErrorCode::Cancelled && ticket.on_cpu) {
        drop(ticket.path, *error);
    }
}

void ModelController::measure_cache() { cache_bytes_ = cached_bytes(cache_->folder()); }

JobParameters ModelController::job_of(const std::string& path, const std::vector<std::string>& loras) const {
    JobParameters job;
    job.model = path;
    job.device = settings_.device;
    job.precision = settings_.precision;
    job.lora = loras;
    return job;
}

EditRecipe ModelController::recipe(const edit::EditRequest& request, const std::string& looked_from) const {
    EditRecipe recipe = defaults_;
    recipe.job.scene = workspace_.scene_path;
    recipe.job.activated = !workspace_.document.empty() && workspace_.document.state().info.activated;
    recipe.job.model = path_;
    recipe.job.lora = loras_;
    recipe.job.segmenter = segmenter_path(ui::SegmenterRole::Clicks);
    recipe.job.text_segmenter = segmenter_path(ui::SegmenterRole::Words);
    recipe.request = request;
    recipe.use_dreambooth = settings_.learn_scene;
    recipe.dreambooth = settings_.learning;
    recipe.guidance = settings_.guidance;
    recipe.attention = settings_.attention;
    recipe.job.device = settings_.device;
    recipe.job.rasterizer = settings_.rasterizer;
    recipe.job.precision = settings_.precision;
    recipe.job.threads = settings_.threads;
    recipe.job.front = settings_.front;
    recipe.job.looked_from = looked_from;
    apply_profile(profile_, recipe, changed_settings(recipe, defaults_));
    return recipe;
}

void ModelController::take_recipe(const EditRecipe& recipe) {
    settings_.learn_scene = recipe.use_dreambooth;
    if (recipe.use_dreambooth) settings_.learning = recipe.dreambooth;
    settings_.guidance = recipe.guidance;
    settings_.attention = recipe.attention;
    settings_.device = recipe.job.device;
    settings_.rasterizer = recipe.job.rasterizer;
    settings_.precision = recipe.job.precision;
    settings_.threads = recipe.job.threads;
    settings_.front = recipe.job.front;
    if (recipe.job.model != path_ || recipe.job.lora != loras_)
        try_model(recipe.job.model, recipe.job.lora, false);
}

// The list

void ModelController::list_loras() {
    lora_rows_.clear();
    for (const auto& text : loras_) {
        const auto lora = neural::parse_lora(text);
        lora_rows_.push_back({lora.file.string(), lora.file.stem().string(), lora.strength});
    }
}

/// The row says why; what was in use stays.
void ModelController::refuse(const std::string& path, std::string problem) {
    list_.refuse(path, problem);
    list_.refresh(in_use());
    workspace_.notices.toast(fmt::format("The model \"{}\" cannot be used: {}. \"{}\" stays in use.",
                                         list_.name_of(path), problem, list_.name_of(in_use())),
                             true);
}

void ModelController::use(const std::string& path, const neural::ModelProfile& profile, bool takes_settings) {
    path_ = path == starter_model_path().string() ? std::string() : path;
    list_.accept(path);
    use_profile(profile, takes_settings);
    list_.refresh(in_use());
    workspace_.settings_changed = true;
}

/// Gives fields that the artist has not changed the model's values, unless the settings came with this model.
void ModelController::use_profile(const neural::ModelProfile& profile, bool takes_settings) {
    EditRecipe next;
    apply_profile(profile, next, {});
    if (takes_settings) {
        move_defaults(settings_.learning, defaults_.dreambooth, next.dreambooth);
        move_defaults(settings_.guidance, defaults_.guidance, next.guidance);
        move_defaults(settings_.attention, defaults_.attention, next.attention);
        if (settings_.threads == defaults_.job.threads) settings_.threads = next.job.threads;
        move_request_(defaults_.request, next.request);
    }
    settings_defaults_.learning = next.dreambooth;
    settings_defaults_.guidance = next.guidance;
    settings_defaults_.attention = next.attention;
    settings_defaults_.threads = next.job.threads;
    profile_ = profile;
    defaults_ = std::move(next);
}

// Trying

void ModelController::start() {
    list_.refresh(in_use());
    const auto* row = path_.empty() ? nullptr : list_.find(path_);
    if (row != nullptr && !row->usable) {
        const std::string problem = row->problem;
        refuse(std::exchange(path_, {}), problem);
    }
    take_chosen();
}

void ModelController::take_chosen() {
    try {
        JobParameters job;
        job.model = path_;
        job.lora = loras_;
        use_profile(profile_of(job), true);
        list_loras();
    } catch (const Error& error) {
        if (loras_.empty()) return refuse(std::exchange(path_, {}), reason_of(error));
        drop_loras(error);
    }
}

void ModelController::drop_loras(const Error& error) {
    loras_.clear();
    list_loras();
    workspace_.notices.toast(
        fmt::format("The LoRAs cannot be used any more: {}. The model works without them.", reason_of(error)),
        true);
    take_chosen();
}

void ModelController::try_model(const std::string& path, std::vector<std::string> loras,
                                bool takes_settings) {
    const std::string wanted = path.empty() ? starter_model_path().string() : path;
    if (wanted == in_use()) return loras == loras_ ? list_.refresh(wanted) : try_loras(std::move(loras));
    if (workspace_.jobs->works())
        return workspace_.notices.toast("Another model can be chosen when the job is done.");
    const auto rows = find_models({wanted});
    const auto row =
        std::find_if(rows.begin(), rows.end(), [&](const auto& model) { return model.path == wanted; });
    if (row != rows.end() && !row->usable) return refuse(wanted, row->problem);
    // Headers can be right where weights are not: only what has been loaded is in use.
    const JobParameters job = job_of(wanted, loras);
    neural::ModelProfile profile;
    try {
        profile = profile_of(job);
    } catch (const Error& error) { return refuse(wanted, reason_of(error)); }
    auto model = std::make_shared<std::shared_ptr<neural::TextToImage>>();
    list_.try_out(wanted);
    workspace_.jobs->start_work(
        JobKind::Other,
        {fmt::format("Check the model \"{}\"", row == rows.end() ? wanted : row->name),
         [job, model, cache = cache_](const JobControl& control) {
             control.report("loading the model", 0, 0);
             *model = open_recipe_model(job, cache);
         },
         [this, wanted, model, profile, takes_settings, loras = std::move(loras)](const Error* error) {
             list_.try_out({});
             if (error != nullptr) return refuse(wanted, reason_of(*error));
             loras_ = loras;
             list_loras();
             use(wanted, profile, takes_settings);
             load_ = {};  // what it took was not seen
             keep(*model);
         }});
    list_.refresh(in_use());
}

/// The model in use with other LoRAs; it stays as it was where that fails.
void ModelController::try_loras(std::vector<std::string> loras) {
    if (workspace_.jobs->works())
        return workspace_.notices.toast("LoRAs can be changed when the job is done.");
    const JobParameters job = job_of(path_, loras);
    const auto refuse_loras = [this](const Error& error) {
        const auto file =
            error.path().empty() ? std::string() : fmt::format(" \"{}\"", error.path().filename().string());
        workspace_.notices.toast(
            fmt::format("The LoRA{} cannot be used: {}. The model stays as it was.", file, reason_of(error)),
            true);
    };
    neural::ModelProfile profile;
    try {
        profile = profile_of(job);
    } catch (const Error& error) { return refuse_loras(error); }
    auto model = std::make_shared<std::shared_ptr<neural::TextToImage>>();
    loras_checking_ = true;
    workspace_.jobs->start_work(
        JobKind::Other, {"Merge the LoRAs",
                         [job, model, cache = cache_](const JobControl& control) {
                             control.report("loading the model", 0, 0);
                             *model = open_recipe_model(job, cache);
                         },
                         [this, model, profile, refuse_loras, loras = std::move(loras)](const Error* error) {
                             loras_checking_ = false;
                             if (error != nullptr) return refuse_loras(*error);
                             loras_ = loras;
                             list_loras();
                             use_profile(profile, true);
                             keep(*model);
                             workspace_.settings_changed = true;
                         }});
}

/// A model that was in use and cannot be loaded any more gives way; its LoRAs go first.
void ModelController::drop(const std::string& path, const Error& error) {
    const bool of_lora = std::any_of(loras_.begin(), loras_.end(), [&](const auto& text) {
        return neural::parse_lora(text).file == error.path();
    });
    if (path == path_ && of_lora) return drop_loras(error);
    if (path.empty() || path != path_) return;
    path_.clear();
    take_chosen();
    refuse(path, reason_of(error));
}

// Settings and projects

void ModelController::settings_to_json(nlohmann::json& json) const {
    json["cache_mb"] = cache_mb_;
    json["model"] = path_;
    json["loras"] = loras_;
    json["segmenter"] = segmenter_path(ui::SegmenterRole::Clicks);
    json["text_segmenter"] = segmenter_path(ui::SegmenterRole::Words);
}

void ModelController::settings_from_json(const nlohmann::json& json) {
    path_ = text_of(json, "model");
    loras_ = texts_of(json, "loras");
    segmenters_ = {Segmenter{text_of(json, "segmenter")}, Segmenter{text_of(json, "text_segmenter")}};
}

void ModelController::to_json(nlohmann::json& json) const {
    json["model_settings"] = ui::model_settings_to_json(settings_);
    json["model"] = path_;
    json["loras"] = loras_;
}

void ModelController::from_json(const nlohmann::json& json) {
    if (json.contains("model_settings"))
        settings_ = ui::model_settings_from_json(json["model_settings"], settings_);
    if (json.contains("model"))
        try_model(json["model"].get<std::string>(), texts_of(json, "loras"), !json.contains("request"));
}

void ModelController::show(ui::ModelPart& model) const {
    list_.show(model);
    model.loras = lora_rows_;
    model.loras_checking = loras_checking_;
    for (std::size_t role = 0; role < segmenters_.size(); ++role)
        model.segmenters[role] = {segmenters_[role].path, segmenters_[role].checking};
    model.edits_by_instruction = profile_.bundle == neural::BundleKind::InstructPix2Pix;
    model.model_settings = settings_;
    model.model_settings_defaults = settings_defaults_;
    model.request_defaults = defaults_.request;
    model.cache_mb = cache_mb_;
    model.cache_bytes = cache_bytes_;
}

// Commands

template <> void ModelController::on(const command::SetModelSettings& one) { settings_ = one.settings; }

template <> void ModelController::on(const command::ChooseModel& one) { try_model(one.path, loras_, true); }

template <> void ModelController::on(const command::AddLora& one) {
    auto loras = loras_;
    try {
        const auto found = neural::find_loras({one.text}).front();
        loras.push_back(
            neural::lora_text({std::filesystem::absolute(found.file).lexically_normal(), found.strength}));
    } catch (const Error& error) {
        return workspace_.notices.toast(fmt::format("The LoRA cannot be used: {}.", reason_of(error)), true);
    }
    try_loras(std::move(loras));
}

template <> void ModelController::on(const command::SetLoraStrength& one) {
    if (one.index >= loras_.size()) return;
    auto loras = loras_;
    const double most = neural::MostLoraStrength;
    loras[one.index] = neural::lora_text(
        {neural::parse_lora(loras_[one.index]).file, std::clamp(one.strength, -most, most)});
    if (loras != loras_) try_loras(std::move(loras));
}

template <> void ModelController::on(const command::RemoveLora& one) {
    if (one.index >= loras_.size()) return;
    auto loras = loras_;
    loras.erase(loras.begin() + static_cast<std::ptrdiff_t>(one.index));
    try_loras(std::move(loras));
}

/// Weights are loaded before they count; what is in use stays where that fails.
template <> void ModelController::on(const command::ChooseSegmenter& one) {
    if (workspace_.jobs->works())
        return workspace_.notices.toast("What cuts out masks can be changed when the job is done.");
    auto& segmenter = segmenters_[static_cast<std::size_t>(one.role)];
    const auto use_path = [this, &segmenter](const std::string& chosen) {
        segmenter.path = chosen;
        workspace_.settings_changed = true;
    };
    if (one.path.empty()) return use_path({});
    JobParameters job;
    const auto chosen = (one.role == ui::SegmenterRole::Clicks ? job.segmenter : job.text_segmenter) =
        std::filesystem::absolute(one.path).lexically_normal().string();
    job.device = settings_.device;
    segmenter.checking = true;
    workspace_.jobs->start_work(
        JobKind::Other, {"Check the segmenter",
                         [job, cache = cache_](const JobControl& control) {
                             control.report("loading the segmenter", 0, 0);
                             open_segmenters(job, cache);
                         },
                         [this, use_path, chosen, &segmenter](const Error* error) {
                             segmenter.checking = false;
                             if (error == nullptr) return use_path(chosen);
                             const auto file = std::filesystem::path(chosen).filename().string();
                             workspace_.notices.toast(
                                 fmt::format("\"{}\": {}. What was in use stays.", file, reason_of(*error)),
                                 true);
                         }});
}

template <> void ModelController::on(const command::OpenModel& one) {
    auto path = std::filesystem::absolute(one.path).lexically_normal();
    const auto weights = path / "adapter_model.safetensors";
    std::error_code ignored;
    if (std::filesystem::is_regular_file(weights, ignored)) path = weights;  // a LoRA's folder
    const auto file = describe_model_file(path);
    if (file.use.how == "--model") try_model(path.string(), loras_, true);
    else if (file.use.how == "--lora") on(command::AddLora{neural::lora_text({path, 1})});
    else if (file.use.how == "--segmenter")
        on(command::ChooseSegmenter{ui::SegmenterRole::Clicks, path.string()});
    else if (file.use.how == "--text-segmenter")
        on(command::ChooseSegmenter{ui::SegmenterRole::Words, path.parent_path().string()});
    else workspace_.notices.toast(why_not_used(file), true);
}

template <> void ModelController::on(const command::SetCacheMb& one) {
    cache_mb_ = one.most;
    cache_->resize(bytes_of(CacheSettings{one.most}));
    measure_cache();
    workspace_.settings_changed = true;
}

template <> void ModelController::on(const command::ClearCache&) {
    clear_cache_folder(cache_->folder());
    cache_bytes_ = 0;
}

void ModelController::run(const ui::ModelCommand& command) {
    std::visit([this](const auto& one) { on(one); }, command);
}

}  // namespace gse::app
