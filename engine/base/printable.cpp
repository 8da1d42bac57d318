// UTF-8 decoding, with escapes for everything but plain text.
#include "engine/base/printable.h"

#include <fmt/format.h>

#include <cstdint>
#include <iterator>

namespace gse {
namespace {

/// A code point and its length in bytes; 0 bytes when the text is not UTF-8.
struct Decoded {
    std::uint32_t code = 0;
    std::size_t bytes = 0;
};

Decoded decode(std::string_view text) {
    const auto first = static_cast<unsigned char>(text[0]);
    if (first < 0x80) return {first, 1};
    const std::size_t bytes = first >= 0xf0 && first < 0xf5   ? 4
                              : first >= 0xe0 && first < 0xf0 ? 3
                              : first >= 0xc2 && first < 0xe0 ? 2
                                                              : 0;
    if (bytes == 0 || bytes > text.size()) return {};
    std::uint32_t code = first & (0x7fu >> bytes);
    for (std::size_t i = 1; i < bytes; ++i) {
        const auto next = static_cast<unsigned char>(text[i]);
        if ((next & 0xc0) != 0x80) return {};
        code = code << 6 | (next & 0x3f);
    }
    const bool too_long = (bytes == 3 && code < 0x800) || (bytes == 4 && code < 0x10000);
    if (too_long || code > 0x10ffff || (code >= 0xd800 && code < 0xe000)) return {};
    return {code, bytes};
}

bool is_control(std::uint32_t code) {
    return code < 0x20 || (code >= 0x7f && code < 0xa0) || code == 0x2028 || code == 0x2029 ||
           (code >= 0x202a && code <= 0x202e) || (code >= 0x2066 && code <= 0x2069);
}

}  // namespace

std::string printable(std::string_view text, bool lines) {
    std::string result;
    result.reserve(text.size());
    while (!text.empty()) {
        const Decoded letter = decode(text);
        const bool kept = letter.bytes > 0 && (!is_control(letter.code) ||
                                               (lines && (letter.code == '\n' || letter.code == '\t')));
        if (kept) result += text.substr(0, letter.bytes);
        else if (letter.bytes > 0 && letter.code > 0xff)
            fmt::format_to(std::back_inserter(result), "\\u{:04x}", letter.code);
        else
            fmt::format_to(std::back_inserter(result), "\\x{:02x}",
                           letter.bytes > 0 ? letter.code : static_cast<unsigned char>(text[0]));
        text.remove_prefix(letter.bytes > 0 ? letter.bytes : 1);
    }
    return result;
}

}  // namespace gse
