// Places of keys to letters.
#include "engine/window/key_names.h"

#include <string_view>

namespace gse::window {
namespace {

// Codes of their keys, as of letters and digits, are their ASCII.
constexpr std::string_view Marks = "',-./;=[\\]`";

}  // namespace

int written_key(int key, const char* name) {
    if (name == nullptr) return key;
    const std::string_view text = name;
    if (text.size() != 1) return key;  // no ASCII
    const char letter = text[0];
    if (letter >= 'a' && letter <= 'z') return letter - 'a' + 'A';
    const bool mark = Marks.find(letter) != std::string_view::npos;
    return (letter >= 'A' && letter <= 'Z') || mark ? letter : key;
}

}  // namespace gse::window
