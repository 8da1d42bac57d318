// Scalars, lists and text tokens of PLY bodies.
#include "engine/io/formats/ply/ply_body.h"

#include <fmt/core.h>

#include <array>
#include <bit>
#include <charconv>
#include <cstdlib>
#include <string>

#include "engine/base/check.h"
#include "engine/base/error.h"
#include "engine/io/bytes/byte_reader.h"

namespace gse::io {
namespace {

std::uint16_t swapped(std::uint16_t v) { return __builtin_bswap16(v); }
std::uint32_t swapped(std::uint32_t v) { return __builtin_bswap32(v); }
std::uint64_t swapped(std::uint64_t v) { return __builtin_bswap64(v); }

/// Unsigned integer of the scalar's size, in the machine's byte order.
template <class U> U load_ordered(const std::byte* source, bool big_endian) {
    const U value = load_scalar<U>(source);
    return big_endian ? swapped(value) : value;
}

bool is_space(char letter) { return letter == ' ' || (letter >= '\t' && letter <= '\r'); }

/// Float of a decimal text. Values beyond its range become infinite or zero as in C.
float parse_float(std::string_view token) {
    std::string_view digits = token;
    if (digits.size() > 1 && digits.front() == '+') digits.remove_prefix(1);
    float value = 0;
    const auto [end, failure] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (failure == std::errc::result_out_of_range && end == digits.data() + digits.size())
        return std::strtof(std::string(digits).c_str(), nullptr);
    if (failure != std::errc{} || end != digits.data() + digits.size())
        throw Error(ErrorCode::Malformed, fmt::format("the PLY body holds \"{}\" where a number belongs",
                                                      std::string(token.substr(0, 24))));
    return value;
}

}  // namespace

float load_ply_scalar(const std::byte* source, PlyType type, bool big_endian) {
    switch (type) {
        case PlyType::Int8: return static_cast<float>(load_scalar<std::int8_t>(source));
        case PlyType::Uint8: return static_cast<float>(load_scalar<std::uint8_t>(source));
        case PlyType::Int16:
            return static_cast<float>(
                static_cast<std::int16_t>(load_ordered<std::uint16_t>(source, big_endian)));
        case PlyType::Uint16: return static_cast<float>(load_ordered<std::uint16_t>(source, big_endian));
        case PlyType::Int32:
            return static_cast<float>(
                static_cast<std::int32_t>(load_ordered<std::uint32_t>(source, big_endian)));
        case PlyType::Uint32: return static_cast<float>(load_ordered<std::uint32_t>(source, big_endian));
        case PlyType::Float32: return std::bit_cast<float>(load_ordered<std::uint32_t>(source, big_endian));
        case PlyType::Float64:
            return static_cast<float>(std::bit_cast<double>(load_ordered<std::uint64_t>(source, big_endian)));
    }
    return 0;
}

PlyBody::PlyBody(std::span<const std::byte> bytes, const PlyHeader& header)
    : bytes_(bytes), header_(&header), offset_(header.body_offset) {}

void PlyBody::seek(const PlyElement& element) {
    const std::vector<PlyElement>& elements = header_->elements;
    while (true) {
        GSE_CHECK(next_element_ < elements.size());
        if (&elements[next_element_] == &element) break;
        skip(elements[next_element_++]);
    }
    ++next_element_;
    // A text value takes at least one digit and, but for the last, one blank.
    const bool ascii = header_->encoding == PlyEncoding::Ascii;
    const std::uint64_t least = ascii ? 2 * element.properties.size() : element.least_row_bytes();
    const std::uint64_t available = remaining() + (ascii ? 1 : 0);
    if (saturating_product(element.count, least) > available)
        throw Error(
            ErrorCode::Malformed,
            fmt::format("the PLY header promises {} rows of \"{}\" but the file has room for {} at most",
                        element.count, element.name, least > 0 ? available / least : 0),
            "the file is cut off or damaged; get it again");
}

void PlyBody::skip(const PlyElement& element) {
    if (element.properties.empty()) return;
    if (header_->encoding != PlyEncoding::Ascii && !element.has_list()) {
        if (saturating_product(element.count, element.row_bytes()) > remaining()) throw_truncated();
        offset_ += static_cast<std::size_t>(element.count) * element.row_bytes();
        return;
    }
    for (std::uint64_t row = 0; row < element.count; ++row) read_row(element, {});
}

void PlyBody::read_row(const PlyElement& element, std::span<float> values) {
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
        const PlyProperty& property = element.properties[i];
        float value = 0;
        if (!property.is_list) {
            value = read_scalar(property.type);
        } else {
            const std::uint64_t size = read_list_size(property.count_type);
            if (header_->encoding == PlyEncoding::Ascii) {
                for (std::uint64_t item = 0; item < size; ++item) next_token();
            } else {
                const std::uint64_t bytes = saturating_product(size, ply_type_size(property.type));
                if (bytes > remaining()) throw_truncated();
                offset_ += static_cast<std::size_t>(bytes);
            }
        }
        if (!values.empty()) values[i] = value;
    }
}

std::span<const std::byte> PlyBody::take_rows(const PlyElement& element) {
    GSE_CHECK(header_->encoding != PlyEncoding::Ascii && !element.has_list());
    if (saturating_product(element.count, element.row_bytes()) > remaining()) throw_truncated();
    const std::size_t size = static_cast<std::size_t>(element.count) * element.row_bytes();
    const auto rows = bytes_.subspan(offset_, size);
    offset_ += size;
    return rows;
}

bool PlyBody::has_rest() const {
    if (header_->encoding != PlyEncoding::Ascii) return remaining() > 0;
    for (std::size_t i = offset_; i < bytes_.size(); ++i)
        if (!is_space(static_cast<char>(bytes_[i]))) return true;
    return false;
}

float PlyBody::read_scalar(PlyType type) {
    if (header_->encoding == PlyEncoding::Ascii) return parse_float(next_token());
    const std::size_t size = ply_type_size(type);
    if (size > remaining()) throw_truncated();
    const std::byte* source = bytes_.data() + offset_;
    offset_ += size;
    return load_ply_scalar(source, type, header_->encoding == PlyEncoding::BigEndian);
}

std::uint64_t PlyBody::read_list_size(PlyType type) {
    // Exact up to 2^24; longer lists are rounded and fail the size check.
    const float size = read_scalar(type);
    if (!(size >= 0) || size > 4294967295.0f * 2)
        throw Error(ErrorCode::Malformed, "the PLY body holds a list with a negative or absurd length");
    return static_cast<std::uint64_t>(size);
}

std::string_view PlyBody::next_token() {
    const char* text = reinterpret_cast<const char*>(bytes_.data());
    while (offset_ < bytes_.size() && is_space(text[offset_])) ++offset_;
    const std::size_t begin = offset_;
    while (offset_ < bytes_.size() && !is_space(text[offset_])) ++offset_;
    if (begin == offset_) throw_truncated();
    return {text + begin, offset_ - begin};
}

void PlyBody::throw_truncated() const {
    throw Error(ErrorCode::Malformed, "the PLY body ends before all the rows that its header promises",
                "the file is cut off or damaged; get it again");
}

}  // namespace gse::io
