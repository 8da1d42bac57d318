// Layout of the file: length of the header as 64 bits little-endian, the header as JSON, the data.
#include "engine/base/safetensors_header.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <string>
#include <string_view>

#include "engine/base/json.h"

namespace gse {
namespace {

constexpr std::uint64_t LongestHeader = 64u << 20;

template <std::size_t Count>
bool ends_in(const std::filesystem::path& path, const std::array<std::string_view, Count>& endings) {
    std::string ending = path.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
    return std::find(endings.begin(), endings.end(), ending) != endings.end();
}

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

bool is_safetensors_name(const std::filesystem::path& path) {
    return ends_in(path, std::array<std::string_view, 2>{".safetensors", ".sft"});
}

bool is_checkpoint_name(const std::filesystem::path& path) {
    return is_safetensors_name(path) || ends_in(path, std::array<std::string_view, 1>{".ckpt"});
}

bool is_pickle_name(const std::filesystem::path& path) {
    return ends_in(path, std::array<std::string_view, 4>{".ckpt", ".pt", ".pth", ".bin"});
}

}  // namespace gse
