// Files of weights of which only the header counts.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/base/file.h"

namespace gse::test {

/// Tensors of these names and shapes without numbers, and metadata where it is an object.
inline void write_header_file(const std::filesystem::path& path,
                              const std::vector<std::pair<std::string, std::vector<int>>>& tensors,
                              const nlohmann::json& metadata = {}) {
    nlohmann::json header = nlohmann::json::object();
    for (const auto& [name, shape] : tensors)
        header[name] = {{"dtype", "F16"}, {"shape", shape}, {"data_offsets", {0, 0}}};
    if (metadata.is_object()) header["__metadata__"] = metadata;
    const std::string text = header.dump();
    std::string bytes;
    for (int i = 0; i < 8; ++i) bytes.push_back(static_cast<char>((text.size() >> (8 * i)) & 255));
    write_file(path, bytes + text);
}

}  // namespace gse::test
