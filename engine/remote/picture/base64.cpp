// Base64 (RFC 4648, section 4).
#include "engine/remote/picture/base64.h"

#include <array>
#include <cstdint>

#include "engine/base/error.h"

namespace gse::remote {
namespace {

constexpr std::string_view Alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
constexpr std::size_t LongestPrefix = 64;

constexpr std::array<std::int8_t, 256> values_of_letters() {
    std::array<std::int8_t, 256> values{};
    for (auto& value : values) value = -1;
    for (std::size_t i = 0; i < Alphabet.size(); ++i)
        values[static_cast<unsigned char>(Alphabet[i])] = static_cast<std::int8_t>(i);
    return values;
}
constexpr auto LetterValues = values_of_letters();

Error bad_base64() {
    return {ErrorCode::Malformed, "the picture in the server's answer is damaged (its base64 is broken)",
            "ask again; if it stays so, the server or a proxy is at fault"};
}

std::string_view without_prefix(std::string_view text) {
    if (!text.starts_with("data:")) return text;
    const auto comma = text.substr(0, LongestPrefix).find(',');
    if (comma == std::string_view::npos || !text.substr(0, comma).ends_with(";base64")) throw bad_base64();
    return text.substr(comma + 1);
}

std::uint32_t letters_value(std::string_view letters) {
    std::uint32_t bits = 0;
    for (const char letter : letters) {
        const int value = LetterValues[static_cast<unsigned char>(letter)];
        if (value < 0) throw bad_base64();
        bits = bits << 6 | static_cast<std::uint32_t>(value);
    }
    return bits;
}

}  // namespace

std::string base64_encoded(std::span<const std::byte> bytes) {
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const auto at = [&](std::size_t k) {
            return i + k < bytes.size() ? std::to_integer<std::uint32_t>(bytes[i + k]) : 0u;
        };
        const std::uint32_t bits = at(0) << 16 | at(1) << 8 | at(2);
        text += Alphabet[bits >> 18];
        text += Alphabet[bits >> 12 & 63];
        text += i + 1 < bytes.size() ? Alphabet[bits >> 6 & 63] : '=';
        text += i + 2 < bytes.size() ? Alphabet[bits & 63] : '=';
    }
    return text;
}

std::vector<std::byte> base64_decoded(std::string_view text) {
    text = without_prefix(text);
    if (text.empty() || text.size() % 4 != 0) throw bad_base64();
    const std::size_t padding = text.ends_with("==") ? 2u : text.ends_with("=") ? 1u : 0u;
    std::vector<std::byte> bytes;
    bytes.reserve(text.size() / 4 * 3);
    for (std::size_t i = 0; i < text.size(); i += 4) {
        const std::size_t letters = i + 4 == text.size() ? 4 - padding : 4;
        const std::uint32_t bits = letters_value(text.substr(i, letters)) << 6 * (4 - letters);
        for (std::size_t k = 0; k + 1 < letters; ++k)
            bytes.push_back(static_cast<std::byte>(bits >> (16 - 8 * k) & 255));
        const bool unused_bits =
            letters < 4 && (bits >> (24 - 8 * (letters - 1)) << (24 - 8 * (letters - 1))) != bits;
        if (unused_bits) throw bad_base64();
    }
    return bytes;
}

}  // namespace gse::remote
