// Depth of a JSON text and the place of an error, found without parsing.
#include "engine/base/json.h"

#include <algorithm>

namespace gse {

bool json_depth_fits(std::string_view text) {
    int depth = 0;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char letter = text[i];
        if (letter == '"') {
            for (++i; i < text.size() && text[i] != '"'; ++i)
                if (text[i] == '\\') ++i;
        } else if (letter == '[' || letter == '{') {
            if (++depth > DeepestJson) return false;
        } else if (letter == ']' || letter == '}') {
            --depth;
        }
    }
    return true;
}

std::string place_in_text(std::string_view text, std::size_t byte) {
    const std::string_view before = text.substr(0, std::min(text.size(), byte > 0 ? byte - 1 : 0));
    const auto line = std::count(before.begin(), before.end(), '\n') + 1;
    const std::size_t start = before.rfind('\n') + 1;  // npos + 1 = 0
    return "line " + std::to_string(line) + ", column " + std::to_string(before.size() - start + 1);
}

}  // namespace gse
