// Names without regard to capitals: other systems do not tell "Images" and "images" apart.
#pragma once

#include <string>
#include <string_view>

namespace gse::io {

/// ASCII letters in lower case; all other bytes as they are.
inline std::string lower_case(std::string_view text) {
    std::string lower(text);
    for (char& c : lower)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return lower;
}

/// ASCII letters in capitals; all other bytes as they are.
inline std::string upper_case(std::string_view text) {
    std::string upper(text);
    for (char& c : upper)
        if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
    return upper;
}

}  // namespace gse::io
