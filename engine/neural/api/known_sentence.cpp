// Words one by one.
#include "engine/neural/api/known_sentence.h"

#include <algorithm>
#include <cctype>

namespace gse::neural {
namespace {

constexpr unsigned char FirstOfUtf8 = 0x80;  // bytes from here on are parts of letters beyond ASCII

}  // namespace

std::string filter_to_vocabulary(const std::string& sentence, const std::vector<std::string>& known,
                                 const std::string& signs) {
    std::string result, word;
    const auto append = [&](const std::string& kept) {
        if (!result.empty()) result += ' ';
        result += kept;
    };
    const auto end_word = [&] {
        if (std::find(known.begin(), known.end(), word) != known.end()) append(word);
        word.clear();
    };
    for (const char letter : sentence + ' ') {
        const auto byte = static_cast<unsigned char>(letter);
        if (byte >= FirstOfUtf8 || std::isalnum(byte) != 0) {
            word += byte >= FirstOfUtf8 ? letter : static_cast<char>(std::tolower(byte));
            continue;
        }
        end_word();
        if (signs.find(letter) != std::string::npos) append({letter});
        if (letter == ',' && !result.empty() && result.back() != ',') result += ',';
    }
    if (!result.empty() && result.back() == ',') result.pop_back();
    return result;
}

}  // namespace gse::neural
