// Layout: "GGUF", version, number of tensors and of statements; statements (name, type, value); tensors
// (name, dimensions, type, place). Numbers are little-endian.
#include "engine/neural/api/files/gguf_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "engine/base/error.h"

namespace gse::neural {
namespace {

constexpr std::uint64_t LongestName = 1 << 12, LongestText = 1 << 20;  // bytes
constexpr std::uint32_t MostGgufDimensions = 8;
constexpr std::uint64_t MostTensors = 1 << 18;
constexpr int DeepestList = 4;
constexpr std::uint64_t DefaultAlignment = 32;

// Types of statements.
constexpr std::uint32_t TextValue = 8, ListValue = 9, ThirtyTwoBits = 4;
/// Bytes of a statement's value by its type; 0 = text, list.
constexpr std::array<std::uint64_t, 13> ValueBytes{1, 1, 2, 2, 4, 4, 4, 1, 0, 0, 8, 8, 8};

/// Number types of tensors: numbers per block, and bytes of one.
struct TensorType {
    std::uint32_t number;
    const char* name;
    std::uint64_t block, bytes;
};
constexpr std::array TensorTypes{
    TensorType{0, "F32", 1, 4},       TensorType{1, "F16", 1, 2},       TensorType{2, "Q4_0", 32, 18},
    TensorType{3, "Q4_1", 32, 20},    TensorType{6, "Q5_0", 32, 22},    TensorType{7, "Q5_1", 32, 24},
    TensorType{8, "Q8_0", 32, 34},    TensorType{10, "Q2_K", 256, 84},  TensorType{11, "Q3_K", 256, 110},
    TensorType{12, "Q4_K", 256, 144}, TensorType{13, "Q5_K", 256, 176}, TensorType{14, "Q6_K", 256, 210},
    TensorType{24, "I8", 1, 1},       TensorType{25, "I16", 1, 2},      TensorType{26, "I32", 1, 4},
    TensorType{27, "I64", 1, 8},      TensorType{28, "F64", 1, 8},      TensorType{30, "BF16", 1, 2}};

[[noreturn]] void broken_gguf(const std::filesystem::path& path, const std::string& what) {
    throw Error(ErrorCode::Malformed, "the GGUF file is damaged: " + what, "download it again", path);
}

/// Reads on from the beginning of a file, and never beyond a header's most bytes.
class Cursor {
public:
    Cursor(const InputFile& file, const std::filesystem::path& path)
        : file_(file), path_(path), end_(std::min(file.size(), LongestGgufHeader)) {}

    std::uint64_t at() const { return at_; }
    void skip(std::uint64_t bytes) {
        if (bytes > end_ - at_) broken_gguf(path_, "its header is cut off");
        at_ += bytes;
    }
    std::uint64_t number(std::uint64_t bytes) {
        std::uint64_t value = 0;
        const auto begin = piece(bytes);
        for (std::uint64_t i = 0; i < bytes; ++i)
            value |= static_cast<std::uint64_t>(static_cast<unsigned char>(buffer_[begin + i])) << (8 * i);
        return value;
    }
    std::uint32_t word() { return static_cast<std::uint32_t>(number(4)); }
    std::string text(std::uint64_t longest) {
        const auto length = number(8);
        if (length > longest) broken_gguf(path_, "a name in it is too long");
        std::string text(static_cast<std::size_t>(length), '\0');
        for (std::uint64_t done = 0; done < length;) {
            const auto part = std::min<std::uint64_t>(length - done, PieceBytes);
            const auto begin = piece(part);
            text.replace(done, part, buffer_, begin, part);
            done += part;
        }
        return text;
    }

private:
    static constexpr std::uint64_t PieceBytes = 1 << 16;

    /// Place in the buffer of the next `bytes` bytes, at most PieceBytes.
    std::size_t piece(std::uint64_t bytes) {
        const auto from = at_;
        skip(bytes);
        if (from < begin_ || at_ > begin_ + buffer_.size()) {
            begin_ = from;
            buffer_.resize(static_cast<std::size_t>(std::min(PieceBytes, end_ - from)));
            file_.read(begin_, std::as_writable_bytes(std::span(buffer_)));
        }
        return static_cast<std::size_t>(from - begin_);
    }

    const InputFile& file_;
    const std::filesystem::path& path_;
    std::uint64_t at_ = 0, begin_ = 0, end_;
    std::string buffer_ = {};
};

/// Passes over a value.
void skip_value(Cursor& cursor, std::uint32_t type, int depth, const std::filesystem::path& path) {
    if (type >= ValueBytes.size() || depth > DeepestList) broken_gguf(path, "it states something unknown");
    if (type == TextValue) return cursor.skip(cursor.number(8));
    if (type != ListValue) return cursor.skip(ValueBytes[type]);
    const auto inner = cursor.word();
    const auto count = cursor.number(8);
    if (count > LongestGgufHeader) broken_gguf(path, "a list in it is too long");
    const bool plain = inner < ValueBytes.size() && ValueBytes[inner] > 0;
    if (plain) return cursor.skip(count * ValueBytes[inner]);
    for (std::uint64_t i = 0; i < count; ++i) skip_value(cursor, inner, depth + 1, path);
}

HeaderTensor read_gguf_tensor(Cursor& cursor, std::uint64_t& end, const std::filesystem::path& path) {
    const auto dimensions = cursor.word();
    if (dimensions > MostGgufDimensions) broken_gguf(path, "a tensor in it has too many dimensions");
    HeaderTensor tensor;
    std::uint64_t numbers = 1;
    for (std::uint32_t i = 0; i < dimensions; ++i) {
        tensor.shape.push_back(cursor.number(8));
        if (__builtin_mul_overflow(numbers, tensor.shape.back(), &numbers) ||
            numbers > (std::uint64_t{1} << 48))
            broken_gguf(path, "a tensor in it is impossibly large");
    }
    std::reverse(tensor.shape.begin(), tensor.shape.end());
    const auto type = cursor.word();
    const auto offset = cursor.number(8);
    const auto known = std::find_if(TensorTypes.begin(), TensorTypes.end(),
                                    [&](const TensorType& each) { return each.number == type; });
    tensor.type = known != TensorTypes.end() ? known->name : fmt::format("type {}", type);
    const auto bytes = known != TensorTypes.end() ? numbers / known->block * known->bytes : 0;
    if (offset < (std::uint64_t{1} << 60)) end = std::max(end, offset + bytes);
    return tensor;
}

}  // namespace

WeightHeader read_gguf_header(const InputFile& file, const std::filesystem::path& path) {
    Cursor cursor(file, path);
    cursor.skip(4);  // "GGUF"
    const auto version = cursor.word();
    if (version < 2 || version > 3)
        throw Error(ErrorCode::Unsupported, fmt::format("this is version {} of GGUF", version),
                    "versions 2 and 3 are read", path);
    const auto tensors = cursor.number(8), statements = cursor.number(8);
    if (tensors > MostTensors) broken_gguf(path, "it has too many tensors");
    WeightHeader header{WeightFormat::Gguf};
    std::uint64_t alignment = DefaultAlignment;
    for (std::uint64_t i = 0; i < statements; ++i) {
        const auto name = cursor.text(LongestName);
        const auto type = cursor.word();
        if (type == TextValue && name.starts_with("general."))
            header.metadata[name] = cursor.text(LongestText);
        else if (type == ThirtyTwoBits && name == "general.alignment") alignment = cursor.word();
        else skip_value(cursor, type, 0, path);
    }
    std::uint64_t end = 0;
    for (std::uint64_t i = 0; i < tensors; ++i) {
        const auto name = cursor.text(LongestName);
        header.tensors[name] = read_gguf_tensor(cursor, end, path);
    }
    if (alignment > 0 && tensors > 0) end += (cursor.at() + alignment - 1) / alignment * alignment;
    header.missing_bytes = end > file.size() ? end - file.size() : 0;
    return header;
}

}  // namespace gse::neural
