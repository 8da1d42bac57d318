// A loaded text-to-image model behind the torch-free interface of api.h.
#pragma once

#include "engine/neural/api/api.h"

namespace gse::neural {

/// Loads a diffusers folder or a single-file checkpoint (.safetensors) to a device ("cpu", "cuda", "cuda:1").
/// Throws Error (Model, NotFound, Malformed) with one sentence that names the file and, if it is a tensor,
/// its name.
std::unique_ptr<TextToImage> load_model(const std::filesystem::path& path, const ModelOptions& options);
inline std::unique_ptr<TextToImage> load_model(const std::filesystem::path& path, const char* device) {
    return load_model(path, ModelOptions{device});
}

}  // namespace gse::neural
