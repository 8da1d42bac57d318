// Header of a .safetensors file: names, types and shapes of its tensors, without reading any of them.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

namespace gse {

/// The header as JSON. A discarded value when the file is no such file, cannot be read or is damaged.
nlohmann::json safetensors_header(const std::filesystem::path& path);

}  // namespace gse
