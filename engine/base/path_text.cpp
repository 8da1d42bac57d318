// Percent-encoding of names (RFC 3986, RFC 8089), and forgiving JSON.
#include "engine/base/path_text.h"

#include <fmt/format.h>

#include <charconv>

namespace gse {
namespace {

constexpr std::string_view Scheme = "file:";

bool stays(char letter) {
    return (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') ||
           (letter >= '0' && letter <= '9') ||
           std::string_view("/-._~").find(letter) != std::string_view::npos;
}

}  // namespace

bool is_utf8(std::string_view text) {
    try {
        static_cast<void>(nlohmann::json(text).dump());
        return true;
    } catch (const nlohmann::json::exception&) { return false; }
}

std::string text_of_path(const std::string& path) {
    if (is_utf8(path) && !path.starts_with(Scheme)) return path;
    std::string text(Scheme);
    for (const char letter : path)
        text += stays(letter) ? std::string(1, letter)
                              : fmt::format("%{:02X}", static_cast<unsigned char>(letter));
    return text;
}

std::string path_of_text(const std::string& text) {
    if (!text.starts_with(Scheme)) return text;
    std::string_view rest = std::string_view(text).substr(Scheme.size());
    if (rest.starts_with("///")) rest.remove_prefix(2);
    std::string path;
    for (std::size_t i = 0; i < rest.size(); ++i) {
        unsigned value = 0;
        const char* digits = rest.data() + i + 1;
        const bool coded = rest[i] == '%' && i + 2 < rest.size() &&
                           std::from_chars(digits, digits + 2, value, 16).ptr == digits + 2;
        path += coded ? static_cast<char>(value) : rest[i];
        if (coded) i += 2;
    }
    return path;
}

}  // namespace gse
