// Statements about a checkpoint in ldm's .yaml, its tensors' names and its metadata; the VAE beside it.
#include "engine/neural/api/checkpoint.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <string_view>
#include <vector>

#include "engine/base/file.h"
#include "engine/base/safetensors_header.h"

namespace gse::neural {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t LongestYaml = std::size_t{1} << 20;  // bytes

std::string lowered(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
    return text;
}

}  // namespace

bool is_yaml_name(const fs::path& path) {
    const auto ending = lowered(path.extension().string());
    return ending == ".yaml" || ending == ".yml";
}

namespace {

/// The .yaml of the checkpoint's name; else the only one in a folder of one checkpoint.
fs::path yaml_beside(const fs::path& checkpoint) {
    std::vector<fs::path> configurations;
    std::size_t checkpoints = 0;
    std::error_code failure;
    const auto folder = checkpoint.has_parent_path() ? checkpoint.parent_path() : fs::path(".");
    for (const auto& entry : fs::directory_iterator(folder, failure)) {
        if (!entry.is_regular_file(failure)) continue;
        if (is_yaml_name(entry.path())) configurations.push_back(entry.path());
        else if (is_checkpoint_name(entry.path()) && entry.path().stem().extension() != ".vae") ++checkpoints;
    }
    for (const auto& path : configurations)
        if (path.stem() == checkpoint.stem()) return path;
    return configurations.size() == 1 && checkpoints == 1 ? configurations.front() : fs::path();
}

/// Value of "key: value" anywhere in a .yaml, without quotes and comments.
std::optional<std::string> yaml_value(const std::string& text, std::string_view key) {
    const auto is_word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
    for (std::size_t begin = 0; begin < text.size();) {
        const auto end = std::min(text.find('\n', begin), text.size());
        auto line = text.substr(begin, end - begin);
        begin = end + 1;
        line = line.substr(0, line.find('#'));
        auto at = line.find(key);
        if (at == std::string::npos || (at > 0 && is_word(line[at - 1]))) continue;
        at = line.find_first_not_of("\"' \t", at + key.size());
        if (at == std::string::npos || line[at] != ':') continue;
        at = line.find_first_not_of("\"' \t", at + 1);
        if (at == std::string::npos) continue;
        return lowered(line.substr(at, line.find_first_of("\"' \t\r,}", at) - at));
    }
    return std::nullopt;
}

bool means_true(const std::optional<std::string>& value) { return value == "true" || value == "1"; }

/// Type of a prediction as programs call it; empty for another word.
std::string prediction_named(const std::string& word) {
    const auto plain = lowered(word);
    for (const char* velocity : {"v", "v_prediction", "v-prediction", "vpred", "v_pred", "velocity"})
        if (plain == velocity) return "v_prediction";
    for (const char* noise : {"eps", "epsilon", "noise"})
        if (plain == noise) return "epsilon";
    return {};
}

/// Statements of ldm's configuration. One without "parameterization" predicts noise, which is ldm's default.
StatedPrediction stated_by_yaml(const fs::path& path) {
    StatedPrediction stated;
    const auto text = read_start(path, LongestYaml);
    const auto type = yaml_value(text, "parameterization");
    if (!type && !yaml_value(text, "linear_start")) return stated;  // of something else
    stated.type = type ? prediction_named(*type) : "epsilon";
    if (!stated.type.empty()) stated.source = path.filename().string();
    for (const char* key : {"zero_terminal_snr", "rescale_betas_zero_snr", "ztsnr", "zsnr"})
        stated.zero_terminal_snr |= means_true(yaml_value(text, key));
    return stated;
}

std::string metadata_text(const nlohmann::json& header, const char* key) {
    const auto found = header.find("__metadata__");
    if (found == header.end() || !found->is_object() || !found->contains(key)) return {};
    const auto& value = (*found)[key];
    return value.is_string() ? value.get<std::string>() : std::string();
}

std::string prediction_in_metadata(const nlohmann::json& header) {
    auto type = prediction_named(metadata_text(header, "modelspec.prediction_type"));
    if (!type.empty()) return type;
    const auto architecture = lowered(metadata_text(header, "modelspec.architecture"));
    if (architecture.starts_with("stable-diffusion-v2-768-v")) return "v_prediction";
    return architecture.starts_with("stable-diffusion-v2-512") ? "epsilon" : std::string();
}

}  // namespace

StatedPrediction stated_prediction(const fs::path& checkpoint, const nlohmann::json& header) {
    StatedPrediction stated;
    if (const auto yaml = yaml_beside(checkpoint); !yaml.empty()) stated = stated_by_yaml(yaml);
    if (!header.is_object()) return stated;
    if (stated.type.empty() && header.contains("v_pred")) {
        stated.type = "v_prediction";
        stated.source = "its tensor \"v_pred\"";
    }
    if (stated.type.empty()) {
        stated.type = prediction_in_metadata(header);
        if (!stated.type.empty()) stated.source = "its metadata";
    }
    stated.zero_terminal_snr |=
        header.contains("ztsnr") || lowered(metadata_text(header, "ss_zero_terminal_snr")) == "true";
    return stated;
}

CheckpointPrediction checkpoint_prediction(const fs::path& checkpoint, const nlohmann::json& header,
                                           bool second) {
    const auto stated = stated_prediction(checkpoint, header);
    CheckpointPrediction prediction;
    prediction.source = stated.source;
    prediction.velocity = stated.type.empty() ? second : stated.type == "v_prediction";
    // Noise says nothing of the picture where there is nothing but noise.
    prediction.zero_terminal_snr = stated.zero_terminal_snr && prediction.velocity;
    return prediction;
}

bool has_own_vae(const nlohmann::json& header) {
    return header.is_object() &&
           std::any_of(header.items().begin(), header.items().end(),
                       [](const auto& item) { return item.key().starts_with("first_stage_model."); });
}

fs::path vae_beside(const fs::path& checkpoint) {
    std::error_code failure;
    const auto folder = checkpoint.has_parent_path() ? checkpoint.parent_path() : fs::path(".");
    for (const auto& entry : fs::directory_iterator(folder, failure))
        if (is_safetensors_name(entry.path()) &&
            entry.path().stem().string() == checkpoint.stem().string() + ".vae")
            return entry.path();
    for (const char* name :
         {"diffusion_pytorch_model.safetensors", "diffusion_pytorch_model.fp16.safetensors"})
        if (const auto path = folder / "vae" / name; fs::exists(path, failure)) return path;
    return {};
}

std::string vae_hint(const fs::path& checkpoint) {
    return fmt::format(
        "put the VAE beside it: as {}.vae.safetensors, or as a folder vae with config.json and "
        "diffusion_pytorch_model.safetensors",
        checkpoint.stem().string());
}

}  // namespace gse::neural
