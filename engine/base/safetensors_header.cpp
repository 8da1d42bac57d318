// Layout of the file: length of the header as 64 bits little-endian, the header as JSON, the data.
#include "engine/base/safetensors_header.h"

#include <fstream>
#include <string>

#include "engine/base/json.h"

namespace gse {
namespace {

constexpr std::uint64_t LongestHeader = 64u << 20;

}  // namespace

nlohmann::json safetensors_header(const std::filesystem::path& path) {
    const nlohmann::json none(nlohmann::json::value_t::discarded);
    std::ifstream file(path, std::ios::binary);
    unsigned char raw[8] = {};
    if (!file.read(reinterpret_cast<char*>(raw), sizeof raw)) return none;
    std::uint64_t size = 0;
    for (int i = 7; i >= 0; --i) size = size << 8 | raw[i];
    if (size == 0 || size > LongestHeader) return none;
    std::string text(size, '\0');
    if (!file.read(text.data(), static_cast<std::streamsize>(size))) return none;
    return try_parse_json(text);
}

}  // namespace gse
