// Safetensors reader and writer. Layout: u64 little-endian header length, JSON header, data; data_offsets are
// relative to the data part, tile it without holes, and may be unaligned.
#include "engine/neural/weights/safetensors.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <limits>
#include <span>

#include "engine/base/error.h"
#include "engine/base/json.h"

namespace gse::neural {
namespace {

constexpr std::size_t LengthBytes = 8;
constexpr std::uint64_t MaxHeaderBytes = 100'000'000;  // the official reader's limit

struct TypeName {
    const char* name;
    torch::Dtype dtype;
};
constexpr std::array Types{TypeName{"F32", torch::kFloat32},   TypeName{"F16", torch::kHalf},
                           TypeName{"BF16", torch::kBFloat16}, TypeName{"F64", torch::kFloat64},
                           TypeName{"I64", torch::kInt64},     TypeName{"I32", torch::kInt32},
                           TypeName{"I16", torch::kInt16},     TypeName{"I8", torch::kInt8},
                           TypeName{"U8", torch::kUInt8},      TypeName{"BOOL", torch::kBool}};

[[noreturn]] void malformed(const std::filesystem::path& path, const std::string& what) {
    throw Error(ErrorCode::Malformed, "the safetensors file is damaged: " + what,
                "download or write it again", path);
}

/// The JSON header; checks its length against the file's before it is read.
std::string read_header(const InputFile& file, const std::filesystem::path& path) {
    std::array<std::byte, LengthBytes> raw{};
    if (file.size() < LengthBytes) malformed(path, "it is shorter than its own header length");
    file.read(0, raw);
    std::uint64_t length = 0;
    for (std::size_t i = 0; i < LengthBytes; ++i) length |= std::to_integer<std::uint64_t>(raw[i]) << (8 * i);
    if (length > MaxHeaderBytes || length > file.size() - LengthBytes)
        malformed(path, "its header is longer than the file");
    std::string text(static_cast<std::size_t>(length), '\0');
    file.read(LengthBytes, std::as_writable_bytes(std::span(text)));
    return text;
}

SafetensorsFile::Entry read_entry(const nlohmann::json& json, const std::string& name,
                                  const std::filesystem::path& path) {
    const auto bad = [&](const std::string& what) {
        malformed(path, fmt::format("tensor \"{}\" {}", name, what));
    };
    const auto is_count = [](const nlohmann::json& value) { return value.is_number_unsigned(); };
    if (!json.is_object() || !json.contains("dtype") || !json.contains("shape") ||
        !json.contains("data_offsets"))
        bad("has no dtype, shape or data_offsets");
    SafetensorsFile::Entry entry;
    const auto type =
        std::find_if(Types.begin(), Types.end(), [&](const TypeName& t) { return json["dtype"] == t.name; });
    if (type == Types.end())
        throw Error(ErrorCode::Unsupported,
                    fmt::format("tensor \"{}\" has the number type {}, which cannot be read", name,
                                json["dtype"].dump()),
                    "use a file in F32, F16 or BF16", path);
    entry.dtype = type->dtype;
    std::uint64_t size = torch::elementSize(entry.dtype);
    if (!json["shape"].is_array()) bad("has no shape");
    for (const auto& dimension : json["shape"]) {
        if (!is_count(dimension)) bad("has a dimension that is not a count");
        const auto count = dimension.get<std::uint64_t>();
        if (__builtin_mul_overflow(size, count, &size) || size > (std::uint64_t{1} << 62) ||
            count > (std::uint64_t{1} << 62))
            bad("is impossibly large");
        entry.shape.push_back(static_cast<std::int64_t>(count));
    }
    const auto& offsets = json["data_offsets"];
    if (!offsets.is_array() || offsets.size() != 2 || !is_count(offsets[0]) || !is_count(offsets[1]))
        bad("has no valid data_offsets");
    entry.begin = offsets[0].get<std::size_t>();
    entry.end = offsets[1].get<std::size_t>();
    if (entry.begin > entry.end || entry.end - entry.begin != size)
        bad("has a size that does not fit its shape");
    return entry;
}

// The tensors tile the data part exactly: no overlap, no hole, nothing behind the last.
void check_tiling(const std::map<std::string, SafetensorsFile::Entry>& entries, std::size_t data_size,
                  const std::filesystem::path& path) {
    std::vector<std::pair<std::size_t, std::size_t>> ranges;
    for (const auto& [name, entry] : entries) {
        if (entry.end > data_size) malformed(path, fmt::format("the data of tensor \"{}\" is cut off", name));
        ranges.emplace_back(entry.begin, entry.end);
    }
    std::sort(ranges.begin(), ranges.end());
    std::size_t position = 0;
    for (const auto& [begin, end] : ranges) {
        if (begin < position) malformed(path, "two tensors overlap");
        if (begin > position) malformed(path, "there is a hole between two tensors");
        position = end;
    }
    if (position != data_size) malformed(path, "there are bytes behind the last tensor");
}

const char* type_name(torch::Dtype dtype) {
    for (const auto& type : Types)
        if (type.dtype == dtype) return type.name;
    throw Error(ErrorCode::Unsupported, "a tensor's number type cannot be written to safetensors");
}

std::string make_header(const NamedTensors& tensors, const std::map<std::string, std::string>& metadata) {
    nlohmann::ordered_json header = nlohmann::ordered_json::object();
    if (!metadata.empty()) header["__metadata__"] = metadata;
    std::size_t offset = 0;
    for (const auto& [name, tensor] : tensors) {
        const auto size = static_cast<std::size_t>(tensor.numel()) * tensor.element_size();
        header[name] = {{"dtype", type_name(tensor.scalar_type())},
                        {"shape", std::vector<std::int64_t>(tensor.sizes().begin(), tensor.sizes().end())},
                        {"data_offsets", {offset, offset + size}}};
        offset += size;
    }
    std::string text = header.dump();
    text.resize((text.size() + LengthBytes - 1) / LengthBytes * LengthBytes, ' ');
    return text;
}

}  // namespace

SafetensorsFile::SafetensorsFile(const std::filesystem::path& path) : path_(path), file_(path) {
    const std::string text = read_header(file_, path);
    data_begin_ = LengthBytes + text.size();
    const auto header = try_parse_json(text);
    if (!header.is_object()) malformed(path, "its header is not a JSON object");
    for (const auto& [name, value] : header.items()) {
        if (name == "__metadata__") {
            for (const auto& [key, entry] : value.items())
                if (entry.is_string()) metadata_[key] = entry.get<std::string>();
            continue;
        }
        entries_.emplace(name, read_entry(value, name, path));
    }
    check_tiling(entries_, static_cast<std::size_t>(file_.size()) - data_begin_, path);
}

KeyShapes SafetensorsFile::shapes() const {
    KeyShapes shapes;
    for (const auto& [name, entry] : entries_) shapes.emplace(name, entry.shape);
    return shapes;
}

torch::Tensor SafetensorsFile::read(const Entry& entry) const {
    auto tensor = torch::empty(entry.shape, torch::TensorOptions().dtype(entry.dtype));
    file_.read(data_begin_ + entry.begin,
               {static_cast<std::byte*>(tensor.data_ptr()), entry.end - entry.begin});
    return tensor;
}

torch::Tensor SafetensorsFile::tensor(const std::string& name) const {
    const auto found = entries_.find(name);
    if (found == entries_.end())
        throw Error(ErrorCode::Model, fmt::format("the weights file has no tensor \"{}\"", name), {}, path_);
    return read(found->second);
}

void SafetensorsFile::copy_to(const std::string& name, torch::Tensor target) const {
    const torch::NoGradGuard no_grad;
    const auto found = entries_.find(name + QuantizationScale);
    const auto values = tensor(name);
    if (found == entries_.end() || values.scalar_type() != torch::kInt8) {
        target.copy_(values.view(target.sizes()));
        return;
    }
    const auto scale = read(found->second);
    if (scale.dim() != 1 || values.dim() < 2 || scale.size(0) != values.size(0))
        malformed(path_, fmt::format("the scales of tensor \"{}\" are not one per row", name));
    target.copy_((values.flatten(1).to(torch::kFloat32) * scale.to(torch::kFloat32).unsqueeze(1))
                     .view(target.sizes()));
}

void write_safetensors(const std::filesystem::path& path, const NamedTensors& tensors,
                       const std::map<std::string, std::string>& metadata) {
    const std::string header = make_header(tensors, metadata);
    write_atomically(path, [&](const std::filesystem::path& temporary) {
        std::ofstream stream(temporary, std::ios::binary);
        std::array<char, LengthBytes> length{};
        for (std::size_t i = 0; i < LengthBytes; ++i)
            length[i] = static_cast<char>(header.size() >> (8 * i) & 0xff);
        stream.write(length.data(), LengthBytes);
        stream.write(header.data(), static_cast<std::streamsize>(header.size()));
        for (const auto& [name, tensor] : tensors) {
            const auto plain = tensor.detach().to(torch::kCPU).contiguous();
            stream.write(static_cast<const char*>(plain.data_ptr()),
                         static_cast<std::streamsize>(plain.numel() *
                                                      static_cast<std::int64_t>(plain.element_size())));
        }
        stream.flush();
        if (!stream)
            throw Error(ErrorCode::Unwritable, "the weights cannot be written", "is the disk full?", path);
    });
}

}  // namespace gse::neural
