// Tells kinds of models apart, and says what the others are.
#include "engine/neural/api/bundle_kind.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/json.h"
#include "engine/neural/api/checkpoint.h"
#include "engine/neural/api/lora_spec.h"

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

constexpr std::int64_t TurboTextWidth = 1024, TurboSampleSize = 64;  // of SD-Turbo, as of SD 2.x base
constexpr std::size_t LongestConfig = std::size_t{1} << 20;          // bytes

/// SD-Turbo walks so. Plain models are told to as well.
bool walks_as_turbo(const SchedulerConfig& scheduler) {
    const bool euler = scheduler.class_name == "EulerDiscreteScheduler" ||
                       scheduler.class_name == "EulerAncestralDiscreteScheduler";
    return euler && scheduler.timestep_spacing == "trailing" && scheduler.prediction_type == "epsilon" &&
           !scheduler.rescale_betas_zero_snr;
}

/// SD-Turbo has the structure of SD 2.x base, and no configuration that plain models of it cannot have.
bool is_turbo(const UNetConfig& unet, const SchedulerConfig& scheduler, Origin origin) {
    if (!walks_as_turbo(scheduler) || origin == Origin::Other) return false;
    return origin == Origin::Turbo || (unet.cross_attention_dim == TurboTextWidth &&
                                       unet.use_linear_projection && unet.sample_size == TurboSampleSize);
}

bool says_turbo(const std::string& name) { return says_word(name, "turbo") || says_word(name, "sdturbo"); }

/// Name of the model's file or folder, and that of its repository in a cache of downloads
/// (models--OWNER--NAME/snapshots/REVISION).
std::vector<std::string> own_names(const std::filesystem::path& model) {
    auto path = std::filesystem::absolute(model).lexically_normal();
    if (!path.has_filename()) path = path.parent_path();
    std::vector<std::string> names{path.filename().string()};
    for (const auto& part : path)
        if (part.string().starts_with("models--")) names.push_back(part.string());
    return names;
}

/// "_name_or_path" of a configuration; empty where there is none.
std::string stated_origin(const std::filesystem::path& config) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(config, ignored)) return {};
    const auto json = try_parse_json(read_start(config, LongestConfig));
    const char* key = "_name_or_path";
    return json.is_object() && json.contains(key) && json[key].is_string() ? json[key].get<std::string>()
                                                                           : std::string();
}

}  // namespace

Origin model_origin(const std::filesystem::path& model, const nlohmann::json& header) {
    auto names = own_names(model);
    bool stated = false;
    const auto add = [&](const std::string& name) {
        if (name.empty()) return;
        stated = true;
        names.push_back(name);
    };
    std::error_code ignored;
    if (std::filesystem::is_directory(model, ignored))
        for (const char* config : {"model_index.json", "unet/config.json"})
            add(stated_origin(model / config));
    if (const auto found = header.find("__metadata__"); header.is_object() && found != header.end())
        if (found->contains("modelspec.title") && (*found)["modelspec.title"].is_string())
            add((*found)["modelspec.title"].get<std::string>());
    if (std::any_of(names.begin(), names.end(), says_turbo)) return Origin::Turbo;
    return stated ? Origin::Other : Origin::Unknown;
}

SchedulerConfig checkpoint_scheduler(const std::filesystem::path& checkpoint, const nlohmann::json& header,
                                     bool second) {
    SchedulerConfig scheduler;
    const auto prediction = checkpoint_prediction(checkpoint, header, second);
    const bool stated_velocity = prediction.velocity && !prediction.source.empty();
    if (second && !stated_velocity && model_origin(checkpoint, header) == Origin::Turbo) {
        scheduler.class_name = "EulerDiscreteScheduler";
        scheduler.timestep_spacing = "trailing";
        return scheduler;
    }
    if (prediction.velocity) scheduler.prediction_type = "v_prediction";
    if (prediction.zero_terminal_snr) {
        scheduler.rescale_betas_zero_snr = true;
        scheduler.timestep_spacing = "trailing";  // the walk begins at pure noise
    }
    return scheduler;
}

BundleKind bundle_kind(const UNetConfig& unet, const SchedulerConfig& scheduler, std::int64_t latent_channels,
                       const std::string& stated, Origin origin, const std::filesystem::path& path) {
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
    return is_turbo(unet, scheduler, origin) ? BundleKind::Turbo : BundleKind::Plain;
}

}  // namespace gse::neural
