// Scalars, lists and text tokens of PLY bodies.
#include "engine/io/formats/ply/ply_body.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <string>
#include <type_traits>
#include <utility>

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

/// Float or double of a decimal text. Values beyond its range become infinite or zero as in C.
template <class T> T parse_number(std::string_view token) {
    std::string_view digits = token;
    if (digits.size() > 1 && digits.front() == '+') digits.remove_prefix(1);
    T value = 0;
    const auto [end, failure] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (failure == std::errc::result_out_of_range && end == digits.data() + digits.size()) {
        const std::string text(digits);
        if constexpr (std::is_same_v<T, float>) return std::strtof(text.c_str(), nullptr);
        else return std::strtod(text.c_str(), nullptr);
    }
    if (failure != std::errc{} || end != digits.data() + digits.size())
        throw Error(ErrorCode::Malformed, fmt::format("the PLY body holds \"{}\" where a number belongs",
                                                      std::string(token.substr(0, 24))));
    return value;
}

}  // namespace

namespace {

/// The scalar as `To`. Whole numbers are converted from their own type.
template <class To> To load_as(const std::byte* source, PlyType type, bool big) {
    switch (type) {
        case PlyType::Int8: return static_cast<To>(load_scalar<std::int8_t>(source));
        case PlyType::Uint8: return static_cast<To>(load_scalar<std::uint8_t>(source));
        case PlyType::Int16:
            return static_cast<To>(static_cast<std::int16_t>(load_ordered<std::uint16_t>(source, big)));
        case PlyType::Uint16: return static_cast<To>(load_ordered<std::uint16_t>(source, big));
        case PlyType::Int32:
            return static_cast<To>(static_cast<std::int32_t>(load_ordered<std::uint32_t>(source, big)));
        case PlyType::Uint32: return static_cast<To>(load_ordered<std::uint32_t>(source, big));
        case PlyType::Float32:
            return static_cast<To>(std::bit_cast<float>(load_ordered<std::uint32_t>(source, big)));
        case PlyType::Float64:
            return static_cast<To>(std::bit_cast<double>(load_ordered<std::uint64_t>(source, big)));
    }
    return 0;
}

}  // namespace

float load_ply_scalar(const std::byte* source, PlyType type, bool big_endian) {
    return load_as<float>(source, type, big_endian);
}

double load_ply_double(const std::byte* source, PlyType type, bool big_endian) {
    return load_as<double>(source, type, big_endian);
}

PlyRowShape row_shape(const PlyHeader& header, const PlyElement& element) {
    PlyRowShape shape;
    const bool ascii = header.encoding == PlyEncoding::Ascii;
    for (const PlyProperty& property : element.properties) {
        const bool wide = ascii && property.type != PlyType::Float32;
        shape.types.push_back(wide ? PlyType::Float64 : property.type);
        shape.offsets.push_back(shape.stride);
        if (!property.is_list) shape.stride += ply_type_size(shape.types.back());
    }
    shape.big_endian = header.encoding == PlyEncoding::BigEndian && !element.has_list();
    return shape;
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
    element_offset_ = offset_;
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
    for (std::uint64_t row = 0; row < element.count; ++row) skip_row(element);
}

void PlyBody::skip_list(const PlyProperty& property) {
    const std::uint64_t size = read_list_size(property.count_type);
    if (header_->encoding == PlyEncoding::Ascii) {
        for (std::uint64_t item = 0; item < size; ++item) next_token();
        return;
    }
    const std::uint64_t bytes = saturating_product(size, ply_type_size(property.type));
    if (bytes > remaining()) throw_truncated();
    offset_ += static_cast<std::size_t>(bytes);
}

void PlyBody::skip_row(const PlyElement& element) {
    for (const PlyProperty& property : element.properties)
        if (property.is_list) skip_list(property);
        else read_scalar(property.type);
}

void PlyBody::read_row(const PlyElement& element, const PlyRowShape& shape, std::byte* row) {
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
        const PlyProperty& property = element.properties[i];
        std::byte* target = row + shape.offsets[i];
        if (property.is_list) {
            skip_list(property);
        } else if (header_->encoding == PlyEncoding::Ascii) {
            const std::string_view token = next_token();
            const auto put = [&](auto value) { std::memcpy(target, &value, sizeof value); };
            if (property.type == PlyType::Float32) put(parse_number<float>(token));
            else put(parse_number<double>(token));
        } else {
            const auto scalar = take_scalar(property.type);
            if (header_->encoding == PlyEncoding::BigEndian)
                std::reverse_copy(scalar.begin(), scalar.end(), target);
            else std::copy(scalar.begin(), scalar.end(), target);
        }
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

std::size_t PlyBody::words_left() const {
    std::size_t words = 0;
    bool inside = false;
    for (std::size_t i = offset_; i < bytes_.size(); ++i) {
        const bool blank = is_space(static_cast<char>(bytes_[i]));
        words += !blank && !inside ? 1 : 0;
        inside = !blank;
    }
    return words;
}

std::size_t PlyBody::lines_of_element() const {
    std::size_t lines = 0;
    bool filled = false;
    for (std::size_t i = element_offset_; i < bytes_.size(); ++i) {
        const char letter = static_cast<char>(bytes_[i]);
        if (letter == '\n' || letter == '\r') filled = false;
        else if (!is_space(letter) && !std::exchange(filled, true)) ++lines;
    }
    return lines;
}

std::span<const std::byte> PlyBody::take_scalar(PlyType type) {
    const std::size_t size = ply_type_size(type);
    if (size > remaining()) throw_truncated();
    const auto scalar = bytes_.subspan(offset_, size);
    offset_ += size;
    return scalar;
}

double PlyBody::read_scalar(PlyType type) {
    if (header_->encoding == PlyEncoding::Ascii) return parse_number<double>(next_token());
    return load_ply_double(take_scalar(type).data(), type, header_->encoding == PlyEncoding::BigEndian);
}

std::uint64_t PlyBody::read_list_size(PlyType type) {
    const double size = read_scalar(type);
    if (!(size >= 0) || size > 4294967295.0 * 2)
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
