// Splitting sentences into words and finding phrases in them.
#include "engine/edit/request/words.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>
#include <utility>

namespace gse::edit {

namespace {

/// Typographic marks of a text processor, in UTF-8, and what they count as: its apostrophes as the plain one,
/// blanks, dashes, dots and quotation marks as gaps.
std::string plain_marks(std::string text) {
    constexpr std::array<std::pair<std::string_view, char>, 11> marks{{{"\u2019", '\''},
                                                                       {"\u2018", ' '},
                                                                       {"\u201c", ' '},
                                                                       {"\u201d", ' '},
                                                                       {"\u201e", ' '},
                                                                       {"\u00ab", ' '},
                                                                       {"\u00bb", ' '},
                                                                       {"\u2026", ' '},
                                                                       {"\u2013", ' '},
                                                                       {"\u2014", ' '},
                                                                       {"\u00a0", ' '}}};
    for (const auto& [mark, letter] : marks)
        for (auto at = text.find(mark); at != std::string::npos; at = text.find(mark, at))
            text.replace(at, mark.size(), 1, letter);
    return text;
}

/// "The bear's hat" is about the bear.
void drop_possessive(std::string& word) {
    if (word.size() > 2 && word.ends_with("'s")) word.resize(word.size() - 2);
    while (!word.empty() && word.back() == '\'') word.pop_back();
    word.erase(0, std::min(word.find_first_not_of('\''), word.size()));
}

}  // namespace

std::vector<std::string> words_of(const std::string& sentence) {
    std::vector<std::string> words;
    std::string word;
    for (const char letter : plain_marks(sentence) + " ") {
        const auto byte = static_cast<unsigned char>(letter);
        const bool part_of_word = std::isalnum(byte) != 0 || byte >= 0x80 || letter == '-' || letter == '\'';
        if (part_of_word) {
            word += static_cast<char>(byte < 0x80 ? std::tolower(byte) : byte);
            continue;
        }
        drop_possessive(word);
        if (!word.empty()) words.push_back(std::move(word));
        word.clear();
        if (Identifier.front() == letter) words.push_back(Identifier);
    }
    return words;
}

std::string joined(const std::vector<std::string>& words) {
    std::string text;
    for (const auto& word : words) text += (text.empty() ? "" : " ") + word;
    return text;
}

std::string as_told(const std::string& sentence) { return joined(words_of(sentence)); }

std::string without_identifier(const std::string& sentence) {
    auto words = words_of(sentence);
    std::erase(words, Identifier);
    return joined(words);
}

bool has_word(const std::string& sentence, const std::string& phrase) {
    return first_word(sentence, phrase) < words_of(sentence).size();
}

std::size_t first_word(const std::string& sentence, const std::string& phrase) {
    const auto words = words_of(sentence), wanted = words_of(phrase);
    if (wanted.empty()) return words.size();
    return static_cast<std::size_t>(std::search(words.begin(), words.end(), wanted.begin(), wanted.end()) -
                                    words.begin());
}

std::vector<std::string> terms_of(const std::string& sentence, const std::vector<std::string>& phrases) {
    std::vector<std::vector<std::string>> wanted;
    for (const auto& phrase : phrases) wanted.push_back(words_of(phrase));
    std::stable_sort(wanted.begin(), wanted.end(),
                     [](const auto& a, const auto& b) { return a.size() > b.size(); });
    const auto words = words_of(sentence);
    std::vector<std::string> terms;
    for (auto at = words.begin(); at != words.end();) {
        const auto here = std::find_if(wanted.begin(), wanted.end(), [&](const auto& phrase) {
            return phrase.size() > 1 && static_cast<std::size_t>(words.end() - at) >= phrase.size() &&
                   std::equal(phrase.begin(), phrase.end(), at);
        });
        terms.push_back(here == wanted.end() ? *at : joined(*here));
        at += here == wanted.end() ? 1 : static_cast<std::ptrdiff_t>(here->size());
    }
    return terms;
}

bool is_ground(const std::string& word) {
    static const std::vector<std::string> grounds{
        "grass",  "sand",   "snow",   "water",    "tiles",   "floor",    "lake",      "ground",
        "lawn",   "meadow", "field",  "beach",    "sea",     "ocean",    "river",     "ice",
        "street", "road",   "gravel", "mud",      "soil",    "earth",    "carpet",    "rug",
        "desert", "forest", "sky",    "pavement", "asphalt", "concrete", "background"};
    return std::find(grounds.begin(), grounds.end(), word) != grounds.end();
}

bool names_ground(const std::string& phrase) {
    const auto words = words_of(phrase);
    return !words.empty() && is_ground(words.back());
}

std::vector<std::string> phrases_of(const std::string& list) {
    if (list.find(',') == std::string::npos) return words_of(list);
    std::vector<std::string> phrases;
    for (std::size_t begin = 0; begin <= list.size();) {
        const std::size_t end = std::min(list.find(',', begin), list.size());
        auto phrase = as_told(list.substr(begin, end - begin));
        if (!phrase.empty()) phrases.push_back(std::move(phrase));
        begin = end + 1;
    }
    return phrases;
}

}  // namespace gse::edit
