// What kind of text-to-image model a bundle is: how it is walked from noise to a picture, and what it is
// told. No torch in it.
#pragma once

#include <array>
#include <filesystem>
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
/// Whether a few steps do, at a guidance that is off or built in.
inline bool is_few_step(BundleKind kind) {
    return kind == BundleKind::Lcm || kind == BundleKind::Tcd || kind == BundleKind::Turbo;
}

/// The kind that the configurations tell, or `stated` (of gseditpro.json; empty = nothing) says. Throws Error
/// (Model) with one sentence for a UNet that is of none of these kinds, (Malformed) for a statement that is
/// no kind or cannot be.
BundleKind bundle_kind(const UNetConfig& unet, const SchedulerConfig& scheduler, std::int64_t latent_channels,
                       const std::string& stated, const std::filesystem::path& path);

}  // namespace gse::neural
