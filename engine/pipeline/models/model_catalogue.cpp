// Finds models in the usual places of artists and tells their kind from their headers, without loading
// networks.
#include "engine/pipeline/models/model_catalogue.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/safetensors_header.h"
#include "engine/neural/api/checkpoint.h"
#include "engine/neural/api/files/weight_use.h"
#include "engine/pipeline/models/installed.h"
#include "engine/pipeline/models/model_places.h"
#include "engine/pipeline/models/model_words.h"

namespace gse::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t MostModels = 200;

/// Inputs of a UNet beside the four channels of the latents.
void describe_channels(std::uint64_t channels, FoundModel& model) {
    if (channels == 8) model.structure += ", InstructPix2Pix";
    for (const auto& [others, what] :
         {std::pair{5u, "depth-to-image"}, std::pair{7u, "upscaler"}, std::pair{9u, "inpainting"}}) {
        if (channels != others) continue;
        model.structure += fmt::format(" {}", what);
        model.problem = fmt::format("{} models are not supported; use the plain one", what);
    }
}

/// "predicts velocity, up to pure noise (by model.yaml)".
std::string prediction_text(bool velocity, bool zero_terminal_snr, const std::string& source) {
    return fmt::format("predicts {}{}{}", velocity ? "velocity" : "noise",
                       zero_terminal_snr ? ", from pure noise on (zero terminal SNR)" : "",
                       source.empty() ? std::string() : fmt::format(" (by {})", source));
}

/// Prediction by a scheduler_config.json; empty where it says none.
std::string scheduler_prediction_text(const fs::path& path) {
    const auto json = model_json(path);
    const auto text = [&](const char* key) {
        return json.is_object() && json.contains(key) && json[key].is_string() ? json[key].get<std::string>()
                                                                               : std::string();
    };
    const auto type = text("prediction_type");
    if (type != "epsilon" && type != "v_prediction") return {};
    const bool rescaled = json.contains("rescale_betas_zero_snr") && json["rescale_betas_zero_snr"] == true;
    return prediction_text(type == "v_prediction", rescaled, path.filename().string());
}

/// Prediction of a checkpoint: by scheduler_config.json beside it, or as neural::checkpoint_prediction().
std::string checkpoint_prediction_text(const fs::path& path, const nlohmann::json& header, bool second) {
    const auto beside = path.parent_path() / "scheduler_config.json";
    if (fs::exists(beside)) return scheduler_prediction_text(beside);
    const auto found = neural::checkpoint_prediction(path, header, second);
    return prediction_text(found.velocity, found.zero_terminal_snr, found.source);
}

/// Kind of a model, told by its header.
void describe_checkpoint(const fs::path& path, FoundModel& model) {
    neural::WeightKind kind;
    try {
        kind = neural::weight_kind(neural::read_weight_header(path));
    } catch (const Error& error) {
        model.problem = error.message();
        return;
    }
    const auto use = neural::weight_use(kind);
    const bool whole =
        kind.role == neural::WeightRole::Checkpoint || kind.role == neural::WeightRole::DiffusionModel;
    model.structure = whole ? kind.family : neural::kind_text(kind);
    if (whole && !kind.variant.empty())
        model.structure += (kind.variant == "InstructPix2Pix" ? ", " : " ") + kind.variant;
    if (use.how != "--model") {
        model.problem = whole ? use.why : "this is no whole model (" + neural::kind_text(kind) + ")";
        if (use.place == neural::WeightPlace::Server) model.problem += "; a server can use it";
        return;
    }
    const auto header = safetensors_header(path);
    model.prediction = checkpoint_prediction_text(path, header, kind.family == "Stable Diffusion 2.x");
    if (!neural::has_own_vae(header) && neural::vae_beside(path).empty())
        model.problem = "it has no VAE; " + neural::vae_hint(path);
    model.usable = model.problem.empty();
}

void describe_folder(const fs::path& path, FoundModel& model) {
    const nlohmann::json own = model_json(path / "gseditpro.json");
    const nlohmann::json text = model_json(path / "text_encoder/config.json");
    model.structure = own.is_object()                                              ? "starter"
                      : text.is_object() && text.value("hidden_size", 768) >= 1024 ? "Stable Diffusion 2.x"
                                                                                   : "Stable Diffusion 1.x";
    if (own.is_object() && own.contains("name") && own["name"].is_string())
        model.name = own["name"].get<std::string>();
    const nlohmann::json unet = model_json(path / "unet/config.json"),
                         scheduler = model_json(path / "scheduler/scheduler_config.json");
    if (unet.is_object() && unet.contains("in_channels") && unet["in_channels"].is_number_unsigned())
        describe_channels(unet["in_channels"].get<std::uint64_t>(), model);
    if (scheduler.is_object() && scheduler.value("_class_name", "") == std::string("LCMScheduler"))
        model.structure += ", LCM";
    model.prediction = scheduler_prediction_text(path / "scheduler/scheduler_config.json");
    for (const char* part : {"unet", "vae", "text_encoder", "tokenizer"})
        if (!fs::exists(path / part))
            model.problem += (model.problem.empty() ? "missing: " : ", ") + std::string(part);
    std::error_code ignored;
    for (const auto& entry :
         fs::recursive_directory_iterator(path, fs::directory_options::skip_permission_denied, ignored))
        if (entry.is_regular_file(ignored)) model.bytes += entry.file_size(ignored);
    model.usable = model.problem.empty();
}

}  // namespace

FoundModel describe_model(const fs::path& path) {
    FoundModel model;
    model.path = path.string();
    model.name = path.stem().string();
    std::error_code failure;
    try {
        if (!fs::exists(path, failure)) {
            model.problem = "it is not there any more";
        } else if (fs::is_directory(path, failure)) {
            describe_folder(path, model);
        } else {
            model.bytes = fs::file_size(path, failure);
            if (is_safetensors_name(path) || neural::is_gguf_name(path)) describe_checkpoint(path, model);
            else model.problem = "pickled checkpoints are not opened; convert it to .safetensors";
        }
    } catch (const std::exception& error) {
        model.problem = std::string("it cannot be read (") + error.what() + ")";
    }
    return model;
}

namespace {

/// Folders that hold whole models.
std::vector<fs::path> model_folders() {
    std::vector<fs::path> folders;
    for (const auto& place : model_places())
        for (const char* folder : {"", "checkpoints", "diffusers", "Stable-diffusion"})
            folders.push_back(place.folder / folder);
    return folders;
}

}  // namespace

std::vector<FoundModel> find_models(const std::vector<std::string>& also) {
    std::vector<FoundModel> models{describe_model(starter_model_path())};
    const auto add = [&](const fs::path& path) {
        const auto known = [&](const auto& model) { return model.path == path.string(); };
        if (models.size() < MostModels && std::none_of(models.begin(), models.end(), known))
            models.push_back(describe_model(path));
    };
    for (const auto& folder : model_folders()) {
        std::error_code failure;
        for (const auto& entry : fs::directory_iterator(folder, failure)) {
            if (is_checkpoint_name(entry.path()) || fs::exists(entry.path() / "model_index.json", failure))
                add(entry.path());
        }
    }
    for (const auto& path : also) add(path);
    return models;
}

}  // namespace gse::pipeline
