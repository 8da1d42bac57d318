// Which model is in use: another one is tried before it takes the place of the one that works.
#include <fmt/format.h>

#include <algorithm>

#include "app/session/application.h"
#include "engine/base/error.h"
#include "engine/neural/api/lora_spec.h"
#include "engine/pipeline/models/model_catalogue.h"
#include "engine/pipeline/models/model_settings.h"
#include "engine/pipeline/models/segmenters.h"

namespace gse::app {
namespace {

std::string reason_of(const Error& error) {
    return error.hint().empty() ? error.message() : fmt::format("{}; {}", error.message(), error.hint());
}

}  // namespace

std::vector<std::string> texts_of(const nlohmann::json& json, const char* key) {
    std::vector<std::string> texts;
    if (json.contains(key) && json[key].is_array())
        for (const auto& entry : json[key])
            if (entry.is_string()) texts.push_back(entry.get<std::string>());
    return texts;
}

std::string Application::model_in_use() const {
    return model_path_.empty() ? starter_model_path().string() : model_path_;
}

void Application::list_models() {
    std::vector<std::string> tried;
    for (const auto& [path, problem] : model_problems_) tried.push_back(path);
    tried.push_back(model_in_use());
    model_.models.clear();
    for (const auto& model : find_models(tried)) {
        auto& row = model_.models.emplace_back(ui::ModelView{.name = model.name,
                                                             .path = model.path,
                                                             .structure = model.structure,
                                                             .bytes = model.bytes,
                                                             .usable = model.usable,
                                                             .problem = model.problem});
        row.chosen = row.path == model_in_use();
        row.checking = row.path == model_tried_;
        const auto found = model_problems_.find(row.path);
        if (found == model_problems_.end() || found->second.empty()) continue;
        row.usable = false;
        row.problem = found->second;
    }
    model_.known_words = model_words(model_in_use());
    model_.drawn_words = drawn_words(model_in_use());
}

/// The row says why; what was in use stays.
void Application::refuse_model(const std::string& path, std::string problem) {
    model_problems_[path] = problem;
    list_models();
    const auto named = [&](const std::string& wanted) {
        const auto row = std::find_if(model_.models.begin(), model_.models.end(),
                                      [&](const auto& model) { return model.path == wanted; });
        return row == model_.models.end() || row->name.empty() ? wanted : row->name;
    };
    toast(fmt::format("The model \"{}\" cannot be used: {}. \"{}\" stays in use.", named(path), problem,
                      named(model_in_use())),
          true);
}

void Application::use_model(const std::string& path, const neural::ModelProfile& profile,
                            bool takes_settings) {
    model_path_ = path == starter_model_path().string() ? std::string() : path;
    model_problems_.erase(path);
    use_profile(profile, takes_settings);
    list_models();
    save_settings();
}

/// What the artist has not changed takes the model's values, unless the settings came with this model.
void Application::use_profile(const neural::ModelProfile& profile, bool takes_settings) {
    EditRecipe next;
    apply_profile(profile, next, {});
    if (takes_settings) {
        auto& settings = model_.model_settings;
        move_defaults(settings.learning, defaults_.dreambooth, next.dreambooth);
        move_defaults(settings.guidance, defaults_.guidance, next.guidance);
        move_defaults(settings.attention, defaults_.attention, next.attention);
        if (settings.threads == defaults_.job.threads) settings.threads = next.job.threads;
        move_defaults(model_.request, defaults_.request, next.request);
    }
    model_.request_defaults = next.request;
    auto& standard = model_.model_settings_defaults;
    standard.learning = next.dreambooth;
    standard.guidance = next.guidance;
    standard.attention = next.attention;
    standard.threads = next.job.threads;
    model_.edits_by_instruction = profile.bundle == neural::BundleKind::InstructPix2Pix;
    profile_ = profile;
    defaults_ = std::move(next);
}

/// The model that was in use when the program was last left.
void Application::take_chosen_model() {
    try {
        JobParameters job;
        job.model = model_path_;
        job.lora = loras_;
        use_profile(profile_of(job), true);
        list_loras();
    } catch (const Error& error) {
        if (!loras_.empty()) {
            loras_.clear();
            list_loras();
            toast(fmt::format("The LoRAs cannot be used any more: {}. The model works without them.",
                              reason_of(error)),
                  true);
            return take_chosen_model();
        }
        refuse_model(std::exchange(model_path_, {}), reason_of(error));
    }
}

void Application::choose_model(const std::string& path) { try_model(path, loras_, true); }

void Application::try_model(const std::string& path, std::vector<std::string> loras, bool takes_settings) {
    const std::string wanted = path.empty() ? starter_model_path().string() : path;
    if (wanted == model_in_use()) return loras == loras_ ? list_models() : try_loras(std::move(loras));
    if (work_.running()) return toast("Another model can be chosen when the job is done.");
    const auto rows = find_models({wanted});
    const auto row =
        std::find_if(rows.begin(), rows.end(), [&](const auto& model) { return model.path == wanted; });
    if (row != rows.end() && !row->usable) return refuse_model(wanted, row->problem);
    // Headers can be right where weights are not: only what has been loaded is in use.
    JobParameters job;
    job.model = wanted;
    job.device = model_.model_settings.device;
    job.precision = model_.model_settings.precision;
    job.lora = loras;
    neural::ModelProfile profile;
    try {
        profile = profile_of(job);
    } catch (const Error& error) { return refuse_model(wanted, reason_of(error)); }
    auto model = std::make_shared<std::shared_ptr<neural::TextToImage>>();
    model_tried_ = wanted;
    model_problems_.try_emplace(wanted);
    work_.start(
        {fmt::format("Check the model \"{}\"", row == rows.end() ? wanted : row->name),
         [job, model, cache = cache_](const JobControl& control) {
             control.report("loading the model", 0, 0);
             *model = open_recipe_model(job, cache);
         },
         [this, wanted, model, profile, takes_settings, loras = std::move(loras)](const Error* error) {
             model_tried_.clear();
             if (error != nullptr) return refuse_model(wanted, reason_of(*error));
             loras_ = loras;
             list_loras();
             use_model(wanted, profile, takes_settings);
             text_model_ = *model;
             model_load_ = {};  // what it took was not seen
             text_model_key_ = model_key();
         }});
    list_models();
}

void Application::list_loras() {
    model_.loras.clear();
    for (const auto& text : loras_) {
        const auto lora = neural::parse_lora(text);
        model_.loras.push_back({lora.file.string(), lora.file.stem().string(), lora.strength});
    }
}

/// The model in use with other LoRAs; it stays as it was where that fails.
void Application::try_loras(std::vector<std::string> loras) {
    if (work_.running()) return toast("LoRAs can be changed when the job is done.");
    JobParameters job;
    job.model = model_path_;
    job.device = model_.model_settings.device;
    job.precision = model_.model_settings.precision;
    job.lora = loras;
    const auto refuse = [this](const Error& error) {
        const auto file =
            error.path().empty() ? std::string() : fmt::format(" \"{}\"", error.path().filename().string());
        toast(
            fmt::format("The LoRA{} cannot be used: {}. The model stays as it was.", file, reason_of(error)),
            true);
    };
    neural::ModelProfile profile;
    try {
        profile = profile_of(job);
    } catch (const Error& error) { return refuse(error); }
    auto model = std::make_shared<std::shared_ptr<neural::TextToImage>>();
    model_.loras_checking = true;
    work_.start({"Merge the LoRAs",
                 [job, model, cache = cache_](const JobControl& control) {
                     control.report("loading the model", 0, 0);
                     *model = open_recipe_model(job, cache);
                 },
                 [this, model, profile, refuse, loras = std::move(loras)](const Error* error) {
                     model_.loras_checking = false;
                     if (error != nullptr) return refuse(*error);
                     loras_ = loras;
                     list_loras();
                     use_profile(profile, true);
                     text_model_ = *model;
                     text_model_key_ = model_key();
                     save_settings();
                 }});
}

void Application::add_lora(const std::string& text) {
    auto loras = loras_;
    try {
        const auto found = neural::find_loras({text}).front();
        loras.push_back(
            neural::lora_text({std::filesystem::absolute(found.file).lexically_normal(), found.strength}));
    } catch (const Error& error) {
        return toast(fmt::format("The LoRA cannot be used: {}.", reason_of(error)), true);
    }
    try_loras(std::move(loras));
}

void Application::set_lora_strength(std::size_t index, double strength) {
    if (index >= loras_.size()) return;
    auto loras = loras_;
    const double most = neural::MostLoraStrength;
    loras[index] =
        neural::lora_text({neural::parse_lora(loras_[index]).file, std::clamp(strength, -most, most)});
    if (loras != loras_) try_loras(std::move(loras));
}

void Application::remove_lora(std::size_t index) {
    if (index >= loras_.size()) return;
    auto loras = loras_;
    loras.erase(loras.begin() + static_cast<std::ptrdiff_t>(index));
    try_loras(std::move(loras));
}

/// Weights are loaded before they count; what is in use stays where that fails.
void Application::choose_segmenter(ui::SegmenterRole role, const std::string& path) {
    if (work_.running()) return toast("What cuts out masks can be changed when the job is done.");
    const bool by_clicks = role == ui::SegmenterRole::Clicks;
    auto& shown = model_.segmenters[static_cast<std::size_t>(role)];
    const auto use = [this, by_clicks, &shown](const std::string& chosen) {
        shown.path = (by_clicks ? segmenter_path_ : text_segmenter_path_) = chosen;
        save_settings();
    };
    if (path.empty()) return use({});
    JobParameters job;
    const auto chosen = (by_clicks ? job.segmenter : job.text_segmenter) =
        std::filesystem::absolute(path).lexically_normal().string();
    job.device = model_.model_settings.device;
    shown.checking = true;
    work_.start({"Check the segmenter",
                 [job, cache = cache_](const JobControl& control) {
                     control.report("loading the segmenter", 0, 0);
                     open_segmenters(job, cache);
                 },
                 [this, use, chosen, &shown](const Error* error) {
                     shown.checking = false;
                     if (error == nullptr) return use(chosen);
                     const auto file = std::filesystem::path(chosen).filename().string();
                     toast(fmt::format("\"{}\": {}. What was in use stays.", file, reason_of(*error)), true);
                 }});
}

/// A model that was in use and cannot be loaded any more gives way to the one that comes with the program.
/// LoRAs go first.
void Application::drop_model(const std::string& path, const Error& error) {
    const bool of_lora = std::any_of(loras_.begin(), loras_.end(), [&](const auto& text) {
        return neural::parse_lora(text).file == error.path();
    });
    if (path == model_path_ && of_lora) {
        loras_.clear();
        list_loras();
        take_chosen_model();
        return toast(fmt::format("The LoRAs cannot be used any more: {}. The model works without them.",
                                 reason_of(error)),
                     true);
    }
    if (path.empty() || path != model_path_) return;
    model_path_.clear();
    take_chosen_model();
    refuse_model(path, reason_of(error));
}

void Application::set_cache_mb(int most) {
    model_.cache_mb = most;
    cache_->resize(bytes_of(CacheSettings{most}));
    model_.cache_bytes = cached_bytes(cache_->folder());
    save_settings();
}

void Application::clear_cache() {
    clear_cache_folder(cache_->folder());
    model_.cache_bytes = 0;
}

}  // namespace gse::app
