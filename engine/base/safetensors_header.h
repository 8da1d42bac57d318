// Header of a .safetensors file: names, types and shapes of its tensors, without reading any of them. Endings
// of files of weights.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

namespace gse {

/// The header as JSON. A discarded value when the file is no such file, cannot be read or is damaged.
nlohmann::json safetensors_header(const std::filesystem::path& path);

/// Endings of safetensors files: .safetensors and .sft, in any case.
bool is_safetensors_name(const std::filesystem::path& path);
/// Endings of whole models in one file: those of safetensors files, and .ckpt in any case.
bool is_checkpoint_name(const std::filesystem::path& path);
/// Endings of pickled weights: .ckpt, .pt, .pth and .bin, in any case.
bool is_pickle_name(const std::filesystem::path& path);

}  // namespace gse
