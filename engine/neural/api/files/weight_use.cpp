// One table of what is loaded here; everything else is for servers, or of no use.
#include "engine/neural/api/files/weight_use.h"

#include <fmt/format.h>

#include "engine/base/error.h"

namespace gse::neural {
namespace {

/// The structure that is loaded here; widths may be of any size.
bool is_stable_diffusion(const WeightKind& kind) {
    return kind.family.starts_with("Stable Diffusion") && kind.family != "Stable Diffusion 3";
}

bool makes_films(const WeightKind& kind) {
    for (const char* family : {"Wan", "Hunyuan Video", "LTX Video", "Mochi", "Cosmos"})
        if (kind.family == family) return true;
    return false;
}

/// Reason that lies in the numbers; empty where they can be read.
std::string unreadable(const WeightKind& kind) {
    if (kind.readable) return {};
    if (kind.numbers.starts_with("GGUF")) return "GGUF files are not loaded here";
    if (kind.numbers == "fp8") return "8-bit floats (fp8) are not loaded here";
    return fmt::format("numbers in {} are not loaded here", kind.numbers);
}

WeightUse model_use(const WeightKind& kind) {
    if (makes_films(kind)) return {WeightPlace::Nowhere, "", "it makes films"};
    if (const auto why = unreadable(kind); !why.empty()) return {WeightPlace::Server, "", why};
    if (!is_stable_diffusion(kind))
        return {WeightPlace::Server, "", "only Stable Diffusion 1.x and 2.x are loaded here"};
    if (!kind.variant.empty() && kind.variant != "InstructPix2Pix")
        return {WeightPlace::Server, "",
                fmt::format("{} models are not supported; use the plain one", kind.variant)};
    if (kind.role == WeightRole::DiffusionModel)
        return {WeightPlace::Server, "", "it is the denoiser alone, without a text encoder"};
    return {WeightPlace::Here, "--model"};
}

WeightUse lora_use(const WeightKind& kind) {
    if (kind.family.empty()) return {WeightPlace::Nowhere, "", "its layers belong to no model that is known"};
    if (makes_films(kind)) return {WeightPlace::Nowhere, "", "its model makes films"};
    if (!is_stable_diffusion(kind))
        return {WeightPlace::Server, "", "only LoRAs of Stable Diffusion 1.x and 2.x are loaded here"};
    if (!kind.variant.empty())
        return {WeightPlace::Server, "", fmt::format("{} is not loaded here, plain LoRA is", kind.variant)};
    if (const auto why = unreadable(kind); !why.empty()) return {WeightPlace::Server, "", why};
    return {WeightPlace::Here, "--lora"};
}

WeightUse segmenter_use(const WeightKind& kind) {
    if (kind.family == "CLIPSeg") return {WeightPlace::Here, "--text-segmenter"};
    if (kind.family == "SAM") return {WeightPlace::Here, "--segmenter"};
    return {WeightPlace::Nowhere, "", "only SAM, MobileSAM and CLIPSeg are loaded here"};
}

}  // namespace

WeightUse weight_use(const WeightKind& kind) {
    switch (kind.role) {
        case WeightRole::Checkpoint:
        case WeightRole::DiffusionModel: return model_use(kind);
        case WeightRole::Lora: return lora_use(kind);
        case WeightRole::Segmenter: return segmenter_use(kind);
        case WeightRole::Vae:
            if (kind.family == "Stable Diffusion" && kind.readable)
                return {WeightPlace::Here, "beside a checkpoint"};
            return {WeightPlace::Server, "", "it is a part of models that are not loaded here"};
        case WeightRole::TinyVae:
            if (kind.family == "Stable Diffusion") return {WeightPlace::Here, "--taesd"};
            return {WeightPlace::Nowhere, "", "it is a part of models that are not loaded here"};
        case WeightRole::TextEncoder:
        case WeightRole::ImageEncoder:
            return {WeightPlace::Server, "", "it is a part of models that are not loaded here"};
        case WeightRole::ControlNet:
        case WeightRole::IpAdapter:
        case WeightRole::Upscaler:
        case WeightRole::Embedding: return {WeightPlace::Nowhere, "", "edits do not use it"};
        case WeightRole::Unknown: break;
    }
    return {WeightPlace::Nowhere, "", "its tensors have names of no model that is known"};
}

void refuse_foreign_model(const std::filesystem::path& path) {
    WeightKind kind;
    try {
        kind = weight_kind(read_weight_header(path));
    } catch (const Error&) { return; }  // the reader of the model says better what is wrong
    // The reader of a UNet of this structure says in detail what is wrong with it.
    const bool ours = is_stable_diffusion(kind) &&
                      (kind.role == WeightRole::Checkpoint || kind.role == WeightRole::DiffusionModel);
    if (kind.readable && (ours || kind.role == WeightRole::Unknown)) return;
    auto use = weight_use(kind);
    if (kind.role == WeightRole::Unknown) use = {WeightPlace::Server, "", unreadable(kind)};
    if (use.place == WeightPlace::Here) use.why = "it is no whole model; its option is " + use.how;
    throw Error(ErrorCode::InvalidArgument,
                fmt::format("this file ({}) cannot be the model here: {}", kind_text(kind), use.why),
                use.place == WeightPlace::Server ? "use it through a server that has it (--server URL)"
                                                 : "name a whole checkpoint of Stable Diffusion 1.x or 2.x",
                path);
}

}  // namespace gse::neural
