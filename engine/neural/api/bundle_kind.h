// Kinds of text-to-image models: samplers and conditioning differ between them.
#pragma once

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "engine/neural/api/config.h"

namespace gse::neural {

enum class BundleKind {
    Plain,            // Stable Diffusion: many steps, classifier-free guidance
    Lcm,              // latent consistency model: its own levels, fresh noise between them
    Tcd,              // trajectory consistency: the same levels, deterministic
    Turbo,            // distilled by adversarial training: trailing levels, no guidance
    InstructPix2Pix,  // edits a picture by an instruction
};

/// "plain", "lcm", "tcd", "turbo", "ip2p": as gseditpro.json states it, and reports show it; in the order of
/// the kinds.
constexpr std::array BundleKindNames{"plain", "lcm", "tcd", "turbo", "ip2p"};
inline const char* kind_name(BundleKind kind) { return BundleKindNames[static_cast<std::size_t>(kind)]; }
/// Tells whether a few steps are enough, at a guidance scale that is off or built in.
inline bool is_few_step(BundleKind kind) {
    return kind == BundleKind::Lcm || kind == BundleKind::Tcd || kind == BundleKind::Turbo;
}

/// Origin of a model, as far as its names tell.
enum class Origin {
    Unknown,
    Turbo,  // a name says "turbo"
    Other,  // it states where it is from ("_name_or_path"), and no name says "turbo"
};

/// Origin by the name of folder or checkpoint, by "_name_or_path" of a folder's configurations and by the
/// title in the metadata of a checkpoint's `header` (safetensors_header(); null for a folder).
Origin model_origin(const std::filesystem::path& model, const nlohmann::json& header = {});

/// Scheduler of a checkpoint without scheduler_config.json: checkpoint_prediction(), and SD-Turbo's where a
/// name says so. `second`: its structure is that of Stable Diffusion 2.x.
SchedulerConfig checkpoint_scheduler(const std::filesystem::path& checkpoint, const nlohmann::json& header,
                                     bool second);

/// Kind by the configurations and the origin, or by `stated` (of gseditpro.json; empty = nothing). Throws
/// Error (Model) for a UNet that is of no known kind. Throws Error (Malformed) for a statement that is no
/// kind, or contradicts the configurations.
BundleKind bundle_kind(const UNetConfig& unet, const SchedulerConfig& scheduler, std::int64_t latent_channels,
                       const std::string& stated, Origin origin, const std::filesystem::path& path);

}  // namespace gse::neural
