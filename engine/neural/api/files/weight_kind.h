// Kind of a file of weights by the names, shapes and number types in its header: a model, a part of one, or
// what changes one.
#pragma once

#include <string>

#include "engine/neural/api/files/weight_header.h"

namespace gse::neural {

/// Part that the weights play.
enum class WeightRole {
    Unknown,
    Checkpoint,      // a whole model: denoiser and text encoder
    DiffusionModel,  // the denoiser alone
    Lora,
    Vae,
    TinyVae,  // TAESD
    TextEncoder,
    ImageEncoder,
    ControlNet,
    IpAdapter,
    Upscaler,
    Embedding,
    Segmenter,
};

/// "checkpoint", "diffusion model", "LoRA", ...; "unknown weights".
const char* role_name(WeightRole role);

struct WeightKind {
    WeightRole role = WeightRole::Unknown;
    std::string family = {};   // "Stable Diffusion 1.x", "FLUX.1", "T5-XXL"; empty = not known
    std::string variant = {};  // "inpainting", "LoHa"; empty = the plain one
    std::string numbers = {};  // "fp16", "fp8", "GGUF Q4_K": those that most of it is in
    bool readable = true;      // the numbers are such that are read here
};

/// Kind of a file. Names decide, then shapes; statements in the metadata only where those tell nothing.
WeightKind weight_kind(const WeightHeader& header);

/// "LoRA of SDXL, fp16".
std::string kind_text(const WeightKind& kind);

}  // namespace gse::neural
