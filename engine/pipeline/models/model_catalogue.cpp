// Finds models in the usual places of artists and tells their kind from their headers, without loading
// networks.
#include "engine/pipeline/models/model_catalogue.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/safetensors_header.h"
#include "engine/neural/api/checkpoint.h"
#include "engine/pipeline/models/installed.h"
#include "engine/pipeline/models/model_words.h"

namespace gse::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t MostModels = 200;

std::uint64_t shape_at(const nlohmann::json& header, const char* key, std::size_t from_end,
                       std::uint64_t fallback) {
    if (!header.contains(key) || !header[key].contains("shape") || header[key]["shape"].size() <= from_end)
        return fallback;
    return header[key]["shape"][header[key]["shape"].size() - 1 - from_end].get<std::uint64_t>();
}

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

/// Kind of a model, told by its keys and by the width of the cross-attention.
void describe_checkpoint(const fs::path& path, FoundModel& model) {
    const nlohmann::json header = safetensors_header(path);
    if (!header.is_object()) {
        model.problem = "this is not a safetensors file";
        return;
    }
    const auto has_prefix = [&](const char* prefix) {
        return std::any_of(header.items().begin(), header.items().end(),
                           [&](const auto& item) { return item.key().rfind(prefix, 0) == 0; });
    };
    if (has_prefix("conditioner.embedders.1")) {
        model.structure = "Stable Diffusion XL";
        model.problem = "SDXL is not supported; use a Stable Diffusion 1.x or 2.x checkpoint";
        return;
    }
    if (!header.contains("model.diffusion_model.input_blocks.0.0.weight")) {
        model.structure = has_prefix("lora_") ? "LoRA" : "unknown";
        model.problem = "this is no whole model (a LoRA, a VAE or a text encoder alone cannot edit)";
        return;
    }
    const auto width = shape_at(
        header, "model.diffusion_model.input_blocks.2.1.transformer_blocks.0.attn2.to_k.weight", 0, 0);
    model.structure = width == 1024 ? "Stable Diffusion 2.x" : "Stable Diffusion 1.x";
    model.prediction = checkpoint_prediction_text(path, header, width == 1024);
    describe_channels(shape_at(header, "model.diffusion_model.input_blocks.0.0.weight", 2, 4), model);
    if (model.problem.empty() && !neural::has_own_vae(header) && neural::vae_beside(path).empty())
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
            if (is_safetensors_name(path)) describe_checkpoint(path, model);
            else model.problem = "pickled checkpoints are not opened; convert it to .safetensors";
        }
    } catch (const std::exception& error) {
        model.problem = std::string("it cannot be read (") + error.what() + ")";
    }
    return model;
}

namespace {

/// Folders of other programs and the user's own list (GSE_MODELS, separated by colons).
std::vector<fs::path> model_folders() {
    std::vector<fs::path> folders;
    if (const char* own = std::getenv("GSE_MODELS")) {
        std::string text(own);
        for (std::size_t at = 0; at <= text.size();) {
            const auto end = std::min(text.find(':', at), text.size());
            if (end > at) folders.emplace_back(text.substr(at, end - at));
            at = end + 1;
        }
    }
    if (const char* home = std::getenv("HOME"))
        for (const char* place :
             {"ComfyUI/models/checkpoints", "ComfyUI/models/diffusers",
              "stable-diffusion-webui/models/Stable-diffusion", ".local/share/gseditpro/models"})
            folders.push_back(fs::path(home) / place);
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
