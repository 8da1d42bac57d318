// Formats by their first bytes; the JSON header of safetensors files.
#include "engine/neural/api/files/weight_header.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <span>
#include <string_view>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/json.h"
#include "engine/neural/api/files/gguf_header.h"

namespace gse::neural {
namespace {

constexpr std::uint64_t LengthBytes = 8, LongestHeader = std::uint64_t{16} << 20;
constexpr std::size_t MostDimensions = 8;

[[noreturn]] void broken_safetensors(const std::filesystem::path& path, const std::string& what) {
    throw Error(ErrorCode::Malformed, "the safetensors file is damaged: " + what, "download it again", path);
}

/// The first bytes of a file, zeros behind its end.
std::array<unsigned char, LengthBytes + 1> first_bytes(const InputFile& file) {
    std::array<unsigned char, LengthBytes + 1> bytes{};
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(bytes.size(), file.size()));
    file.read(0, std::as_writable_bytes(std::span(bytes).first(count)));
    return bytes;
}

/// Length of a safetensors header as the file states it.
std::uint64_t stated_length(const std::array<unsigned char, LengthBytes + 1>& bytes) {
    std::uint64_t length = 0;
    for (std::size_t i = 0; i < LengthBytes; ++i) length |= static_cast<std::uint64_t>(bytes[i]) << (8 * i);
    return length;
}

WeightFormat format_of(const InputFile& file) {
    const auto bytes = first_bytes(file);
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (text.starts_with("GGUF")) return WeightFormat::Gguf;
    if (text.starts_with("PK\x03\x04")) return WeightFormat::Pickle;
    if (file.size() > LengthBytes && text[LengthBytes] == '{' &&
        stated_length(bytes) < (std::uint64_t{1} << 40))
        return WeightFormat::Safetensors;
    constexpr unsigned char Protocol = 0x80;  // first order of a pickle, its version behind it
    return bytes[0] == Protocol && bytes[1] >= 2 && bytes[1] <= 5 ? WeightFormat::Pickle
                                                                  : WeightFormat::Other;
}

HeaderTensor read_json_tensor(const nlohmann::json& json, const std::string& name, std::uint64_t& end,
                              const std::filesystem::path& path) {
    const auto bad = [&] {
        broken_safetensors(path, "tensor \"" + name + "\" has no dtype, shape or data_offsets");
    };
    if (!json.is_object() || !json.contains("dtype") || !json["dtype"].is_string() ||
        !json.contains("shape") || !json["shape"].is_array() || json["shape"].size() > MostDimensions ||
        !json.contains("data_offsets") || !json["data_offsets"].is_array() ||
        json["data_offsets"].size() != 2 || !json["data_offsets"][1].is_number_unsigned())
        bad();
    HeaderTensor tensor{json["dtype"].get<std::string>()};
    for (const auto& dimension : json["shape"]) {
        if (!dimension.is_number_unsigned()) bad();
        tensor.shape.push_back(dimension.get<std::uint64_t>());
    }
    end = std::max(end, json["data_offsets"][1].get<std::uint64_t>());
    return tensor;
}

WeightHeader read_safetensors_header(const InputFile& file, const std::filesystem::path& path) {
    const auto length = stated_length(first_bytes(file));
    if (length > file.size() - LengthBytes) broken_safetensors(path, "its header is longer than the file");
    if (length > LongestHeader) broken_safetensors(path, "its header is too long");
    std::string text(static_cast<std::size_t>(length), '\0');
    file.read(LengthBytes, std::as_writable_bytes(std::span(text)));
    const auto json = try_parse_json(text);
    if (!json.is_object()) broken_safetensors(path, "its header is not a JSON object");
    WeightHeader header;
    std::uint64_t end = 0;
    for (const auto& [name, value] : json.items()) {
        if (name != "__metadata__") {
            header.tensors[name] = read_json_tensor(value, name, end, path);
            continue;
        }
        for (const auto& [key, entry] : value.items())
            if (entry.is_string()) header.metadata[key] = entry.get<std::string>();
    }
    const auto there = file.size() - LengthBytes - length;
    header.missing_bytes = end > there ? end - there : 0;
    return header;
}

}  // namespace

bool is_gguf_name(const std::filesystem::path& path) {
    std::string ending = path.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
    return ending == ".gguf";
}

WeightFormat weight_format(const std::filesystem::path& path) { return format_of(InputFile(path)); }

WeightHeader read_weight_header(const std::filesystem::path& path) {
    const InputFile file(path);
    switch (format_of(file)) {
        case WeightFormat::Safetensors: return read_safetensors_header(file, path);
        case WeightFormat::Gguf: return read_gguf_header(file, path);
        case WeightFormat::Pickle:
            throw Error(ErrorCode::Unsupported, "pickled weights can run programs and are not opened",
                        "convert it to .safetensors", path);
        case WeightFormat::Other: break;
    }
    throw Error(ErrorCode::Unsupported, "this is not a file of weights",
                "it may be a page of a failed download", path);
}

}  // namespace gse::neural
