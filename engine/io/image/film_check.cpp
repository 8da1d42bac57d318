// Walks the outermost boxes of MP4 and the outermost elements of WebM.
#include "engine/io/image/film_check.h"

#include <bit>
#include <cstdint>
#include <string_view>

namespace gse::io {
namespace {

constexpr std::uint32_t EbmlHeader = 0x1a45dfa3, WebmSegment = 0x18538067;

std::uint64_t big_endian(std::span<const std::byte> bytes) {
    std::uint64_t value = 0;
    for (const std::byte byte : bytes) value = value << 8 | static_cast<std::uint64_t>(byte);
    return value;
}

bool mp4_is_whole(std::span<const std::byte> bytes) {
    bool has_index = false;
    while (!bytes.empty()) {
        if (bytes.size() < 8) return false;
        std::uint64_t size = big_endian(bytes.first(4));
        if (size == 1 && bytes.size() >= 16) size = big_endian(bytes.subspan(8, 8));
        if (size < 8 || size > bytes.size()) return false;
        has_index |= std::string_view(reinterpret_cast<const char*>(bytes.data()) + 4, 4) == "moov";
        bytes = bytes.subspan(static_cast<std::size_t>(size));
    }
    return has_index;
}

/// Element of a WebM file. The size is all ones while it is not known.
struct Element {
    std::uint64_t id = 0, size = 0;
    std::size_t header = 0;
    bool known = false;
};

bool read_element(std::span<const std::byte> bytes, Element& element) {
    if (bytes.size() < 5) return false;
    element.id = big_endian(bytes.first(4));
    const auto first = static_cast<std::uint8_t>(bytes[4]);
    const auto length = static_cast<std::size_t>(std::countl_zero(first)) + 1;
    if (length > 8 || bytes.size() < 4 + length) return false;
    const std::uint64_t limit = (std::uint64_t{1} << (7 * length)) - 1;
    element.size = big_endian(bytes.subspan(4, length)) & limit;
    element.known = element.size != limit;
    element.header = 4 + length;
    return true;
}

bool webm_is_whole(std::span<const std::byte> bytes) {
    Element header, segment;
    if (!read_element(bytes, header) || !header.known || header.size > bytes.size() - header.header)
        return false;
    bytes = bytes.subspan(header.header + static_cast<std::size_t>(header.size));
    return read_element(bytes, segment) && segment.id == WebmSegment && segment.known &&
           segment.size == bytes.size() - segment.header;
}

}  // namespace

bool film_is_whole(std::span<const std::byte> bytes) {
    if (bytes.size() < 8) return false;
    return big_endian(bytes.first(4)) == EbmlHeader ? webm_is_whole(bytes) : mp4_is_whole(bytes);
}

}  // namespace gse::io
