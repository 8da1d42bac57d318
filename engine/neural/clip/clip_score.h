// A CLIP folder behind the torch-free interface of engine/edit/interfaces/image_text_encoder.h.
#pragma once

#include <memory>

#include "engine/edit/interfaces/image_text_encoder.h"
#include "engine/neural/clip/clip_model.h"

namespace gse::neural {

/// Folder of the encoder, and what it shares with the model around it.
struct ClipFolder {
    std::filesystem::path path;       // config.json, model.safetensors; may have tokenizer files of its own
    std::filesystem::path tokenizer;  // used when it has none
    std::vector<std::string> known_words;  // words it was trained on: others are left out; empty = all
    torch::Device device = torch::kCPU;
    std::filesystem::path viewpoint = {};  // folder of the classifier that answers viewpoint(); empty = none
};

/// True when a model folder has such an encoder.
bool has_clip(const std::filesystem::path& folder);

/// Vectors are of unit length. Throws Error (NotFound, Malformed, Model) with one sentence.
std::unique_ptr<edit::ImageTextEncoder> load_clip_score(const ClipFolder& folder);

}  // namespace gse::neural
