// Defaults of an edit's settings that a model states, read from its small files and headers, without torch.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/edit/interfaces/model_traits.h"
#include "engine/neural/api/bundle_kind.h"
#include "engine/neural/api/lora_spec.h"

namespace gse::neural {

/// Sizes and structure of a model, as far as its settings depend on them.
enum class ModelKind {
    Small,        // the starter and its like; also what is no model
    Sd1,          // Stable Diffusion 1.x
    Sd2,          // Stable Diffusion 2.x base, 512 pixels, predicts noise
    Sd2Velocity,  // Stable Diffusion 2.x, 768 pixels, predicts velocity
};

/// Facts about a model before it is loaded.
struct ModelNature {
    ModelKind size = ModelKind::Small;
    BundleKind kind = BundleKind::Plain;
    bool embeds_guidance = false;  // its UNet is told the guidance scale (LCM)
};

/// The default of one setting.
struct ProfileEntry {
    std::string part;  // "request", "guidance", "attention", "dreambooth" or "job"
    std::string field;
    nlohmann::ordered_json value;
    std::string source;  // "model" or "file gseditpro.json"
};

struct ModelProfile {
    ModelKind kind = ModelKind::Small;
    BundleKind bundle = BundleKind::Plain;
    std::vector<ProfileEntry>
        entries;  // one per field; those of a small model are the settings' own defaults
    edit::ModelTraits traits;
};

/// Size of a model folder or checkpoint. A broken model counts as small; loading it says what is wrong.
ModelKind model_kind(const std::filesystem::path& model);

/// Size and kind of a model. A distilled LoRA turns a plain model into one of few steps.
ModelNature model_nature(const std::filesystem::path& model, const std::vector<LoraSpec>& loras = {});

/// Settings by kind, and over them "profile" of gseditpro.json beside the weights: {"request": {"image_size":
/// 512}, ...}. Throws Error (Malformed) that names setting and file: unknown, of the wrong type, or out of
/// range.
ModelProfile model_profile(const std::filesystem::path& model, const std::vector<LoraSpec>& loras = {});

}  // namespace gse::neural
