// Files of weights of which only the header counts.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/base/file.h"

namespace gse::test {

/// Tensors of these names and shapes without numbers, and metadata where it is an object.
inline void write_header_file(const std::filesystem::path& path,
                              const std::vector<std::pair<std::string, std::vector<int>>>& tensors,
                              const nlohmann::json& metadata = {}, const char* type = "F16") {
    nlohmann::json header = nlohmann::json::object();
    for (const auto& [name, shape] : tensors)
        header[name] = {{"dtype", type}, {"shape", shape}, {"data_offsets", {0, 0}}};
    if (metadata.is_object()) header["__metadata__"] = metadata;
    const std::string text = header.dump();
    std::string bytes;
    for (int i = 0; i < 8; ++i) bytes.push_back(static_cast<char>((text.size() >> (8 * i)) & 255));
    write_file(path, bytes + text);
}

/// Bytes of a GGUF file.
class GgufBytes {
public:
    GgufBytes& number(std::uint64_t value, int bytes) {
        for (int i = 0; i < bytes; ++i) bytes_.push_back(static_cast<char>(value >> (8 * i) & 255));
        return *this;
    }
    GgufBytes& text(const std::string& text) {
        number(text.size(), 8);
        bytes_ += text;
        return *this;
    }
    GgufBytes& magic(std::uint64_t tensors, std::uint64_t statements, std::uint32_t version = 3) {
        bytes_ += "GGUF";
        return number(version, 4).number(tensors, 8).number(statements, 8);
    }
    GgufBytes& statement(const std::string& name, const std::string& value) {
        return text(name).number(8, 4).text(value);
    }
    /// Shape as torch gives it; the file has the fastest dimension first.
    GgufBytes& tensor(const std::string& name, const std::vector<int>& shape, int type, int offset = 0) {
        text(name).number(shape.size(), 4);
        for (auto size = shape.rbegin(); size != shape.rend(); ++size)
            number(static_cast<std::uint64_t>(*size), 8);
        return number(static_cast<std::uint64_t>(type), 4).number(static_cast<std::uint64_t>(offset), 8);
    }
    const std::string& bytes() const { return bytes_; }

private:
    std::string bytes_ = {};
};

}  // namespace gse::test
