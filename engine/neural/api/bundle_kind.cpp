// Tells kinds of models apart, and says what the others are.
#include "engine/neural/api/bundle_kind.h"

#include <fmt/format.h>

#include "engine/base/error.h"

namespace gse::neural {
namespace {

/// Kind of a UNet by the number of channels that it takes beside the latents.
std::string other_model(std::int64_t in, std::int64_t out, std::int64_t latents) {
    if (out == latents && in == 2 * latents + 1)
        return fmt::format(
            "this is an inpainting model: its UNet takes a mask and the masked picture beside the latents "
            "({} channels)",
            in);
    if (out == latents && in == latents + 1)
        return fmt::format(
            "this is a depth-to-image model: its UNet takes a depth map beside the latents ({} channels)",
            in);
    if (out == latents && in == latents + 3)
        return fmt::format(
            "this is an upscaler: its UNet takes a small picture beside the latents ({} channels)", in);
    return fmt::format(
        "the UNet takes {} channels and gives {}, but the VAE has {}: this is neither a text-to-image model "
        "nor "
        "InstructPix2Pix",
        in, out, latents);
}

bool is_euler(const std::string& name) {
    return name == "EulerDiscreteScheduler" || name == "EulerAncestralDiscreteScheduler";
}

}  // namespace

BundleKind bundle_kind(const UNetConfig& unet, const SchedulerConfig& scheduler, std::int64_t latent_channels,
                       const std::string& stated, const std::filesystem::path& path) {
    const bool edits = unet.in_channels == 2 * latent_channels && unet.out_channels == latent_channels;
    if (!edits && (unet.in_channels != latent_channels || unet.out_channels != latent_channels))
        throw Error(
            ErrorCode::Model, other_model(unet.in_channels, unet.out_channels, latent_channels),
            "use Stable Diffusion 1.x or 2.x, an LCM or Turbo model of that structure, or InstructPix2Pix",
            path);
    if (!stated.empty()) {
        for (std::size_t i = 0; i < BundleKindNames.size(); ++i) {
            const auto kind = static_cast<BundleKind>(i);
            if (stated == kind_name(kind) && (kind == BundleKind::InstructPix2Pix) == edits) return kind;
        }
        throw Error(ErrorCode::Malformed,
                    fmt::format("\"kind\" is \"{}\", which this model {}", stated,
                                edits ? "is not: it is ip2p" : "cannot be"),
                    "state plain, lcm, tcd, turbo or ip2p, or leave it out", path);
    }
    if (edits) return BundleKind::InstructPix2Pix;
    if (unet.time_cond_proj_dim > 0 || scheduler.class_name == "LCMScheduler") return BundleKind::Lcm;
    if (scheduler.class_name == "TCDScheduler") return BundleKind::Tcd;
    // SD-Turbo has nothing of its own but this.
    if (is_euler(scheduler.class_name) && scheduler.timestep_spacing == "trailing") return BundleKind::Turbo;
    return BundleKind::Plain;
}

}  // namespace gse::neural
