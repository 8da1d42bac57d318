// Facts that a single-file checkpoint and the files beside it state, without torch: prediction, VAE.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace gse::neural {

/// Statements about what a UNet's output means.
struct StatedPrediction {
    std::string type;                // "epsilon" or "v_prediction"; empty = nothing is stated
    std::string source;              // of the type: "model.yaml", "its tensor \"v_pred\"", "its metadata"
    bool zero_terminal_snr = false;  // the noise schedule ends at pure noise
};

/// Statements of a checkpoint. For the type, the first of these counts: "parameterization" of the .yaml
/// beside it, a tensor named "v_pred", "modelspec.prediction_type" or "modelspec.architecture" of the
/// metadata. A configuration of Stable Diffusion without "parameterization" states noise. `header` is
/// safetensors_header() of the checkpoint.
StatedPrediction stated_prediction(const std::filesystem::path& checkpoint, const nlohmann::json& header);

/// How a checkpoint's noise schedule and prediction are taken.
struct CheckpointPrediction {
    bool velocity = false;
    bool zero_terminal_snr = false;
    std::string source;  // as StatedPrediction; empty = the usual one of its structure
};

/// As stated_prediction() says; else velocity for Stable Diffusion 2.x (`second`), and noise for others.
CheckpointPrediction checkpoint_prediction(const std::filesystem::path& checkpoint,
                                           const nlohmann::json& header, bool second);

/// Endings of ldm's configurations: .yaml and .yml, in any case.
bool is_yaml_name(const std::filesystem::path& path);

/// Tells whether the header names tensors of a VAE.
bool has_own_vae(const nlohmann::json& header);

/// Weights of the VAE beside a checkpoint that has none: NAME.vae.safetensors, or the file in a folder "vae"
/// in diffusers layout. Empty = there is none.
std::filesystem::path vae_beside(const std::filesystem::path& checkpoint);

/// Place where vae_beside() looks, for messages.
std::string vae_hint(const std::filesystem::path& checkpoint);

}  // namespace gse::neural
