// Splitting sentences into words and finding phrases in them.
#include "engine/language/words.h"

#include <unicode/uchar.h>
#include <unicode/utf8.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <utility>

namespace gse::language {
namespace {

constexpr unsigned char FirstOfUtf8 = 0x80;  // bytes from here on are parts of characters beyond ASCII

struct Mark {
    std::string_view utf8, plain;
};

/// Typographic marks of text processors and of web pages, and their plain counterparts.
constexpr Mark Marks[] = {{"\u2019", "'"},
                          {"\u2018", " "},
                          {"\u201c", " "},
                          {"\u201d", " "},
                          {"\u201e", " "},
                          {"\u00ab", " "},
                          {"\u00bb", " "},
                          {"\u2026", " "},
                          {"\u2013", " "},
                          {"\u2014", " "},
                          // blanks and the separators of lines and paragraphs
                          {"\u00a0", " "},
                          {"\u1680", " "},
                          {"\u2000", " "},
                          {"\u2001", " "},
                          {"\u2002", " "},
                          {"\u2003", " "},
                          {"\u2004", " "},
                          {"\u2005", " "},
                          {"\u2006", " "},
                          {"\u2007", " "},
                          {"\u2008", " "},
                          {"\u2009", " "},
                          {"\u200a", " "},
                          {"\u2028", " "},
                          {"\u2029", " "},
                          {"\u202f", " "},
                          {"\u205f", " "},
                          {"\u3000", " "}};

/// Bytes of the character at `at` when nothing is seen of it (zero-width space, joiners, soft hyphen, marks
/// of direction, byte order mark); else 0.
std::size_t invisible_bytes(std::string_view text, std::size_t at) {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(text.data());
    const auto length = static_cast<std::int64_t>(text.size());
    auto next = static_cast<std::int64_t>(at);
    UChar32 code = 0;
    U8_NEXT(bytes, next, length, code);
    const bool invisible = code >= 0 && u_hasBinaryProperty(code, UCHAR_DEFAULT_IGNORABLE_CODE_POINT) != 0;
    return invisible ? static_cast<std::size_t>(next) - at : 0;
}

std::string plain_marks(std::string_view text) {
    std::string plain;
    plain.reserve(text.size());
    for (std::size_t at = 0; at < text.size();) {
        if (static_cast<unsigned char>(text[at]) >= FirstOfUtf8) {
            const auto* mark = std::find_if(std::begin(Marks), std::end(Marks), [&](const Mark& each) {
                return text.substr(at).starts_with(each.utf8);
            });
            const std::size_t skipped =
                mark != std::end(Marks) ? mark->utf8.size() : invisible_bytes(text, at);
            if (mark != std::end(Marks)) plain += mark->plain;
            at += skipped;
            if (skipped > 0) continue;
        }
        plain += text[at++];
    }
    return plain;
}

/// "The bear's hat" is about the bear.
void drop_possessive(std::string& word) {
    if (word.size() > 2 && word.ends_with("'s")) word.resize(word.size() - 2);
    while (!word.empty() && word.back() == '\'') word.pop_back();
    word.erase(0, std::min(word.find_first_not_of('\''), word.size()));
}

}  // namespace

std::vector<Token> tokens_of(std::string_view text) {
    std::vector<Token> tokens;
    std::string word;
    for (const char letter : plain_marks(text) + " ") {
        const auto byte = static_cast<unsigned char>(letter);
        if (std::isalnum(byte) != 0 || byte >= FirstOfUtf8 || letter == '-' || letter == '\'') {
            word += static_cast<char>(byte < FirstOfUtf8 ? std::tolower(byte) : byte);
            continue;
        }
        drop_possessive(word);
        if (!word.empty()) tokens.push_back({std::move(word), true});
        word.clear();
        if (std::isspace(byte) == 0) tokens.push_back({{letter}, false});
    }
    return tokens;
}

std::vector<std::string> words_of(std::string_view text) {
    std::vector<std::string> words;
    for (auto& token : tokens_of(text))
        if (token.is_word || token.text == Identifier) words.push_back(std::move(token.text));
    return words;
}

std::string joined(const std::vector<std::string>& words) {
    std::string text;
    for (const auto& word : words) text += (text.empty() ? "" : " ") + word;
    return text;
}

std::string normalised_prompt(std::string_view text) { return joined(words_of(text)); }

std::string without_identifier(std::string_view text) {
    auto words = words_of(text);
    std::erase(words, Identifier);
    return joined(words);
}

std::size_t position_of(const std::vector<std::string>& words, std::string_view phrase) {
    const auto wanted = words_of(phrase);
    if (wanted.empty()) return words.size();
    return static_cast<std::size_t>(std::search(words.begin(), words.end(), wanted.begin(), wanted.end()) -
                                    words.begin());
}

std::size_t position_of(std::string_view text, std::string_view phrase) {
    return position_of(words_of(text), phrase);
}

bool has_phrase(std::string_view text, std::string_view phrase) {
    const auto words = words_of(text);
    return position_of(words, phrase) < words.size();
}

std::vector<std::string> terms_of(const std::vector<std::string>& words,
                                  const std::vector<std::string>& phrases) {
    std::vector<std::vector<std::string>> wanted;
    for (const auto& phrase : phrases) wanted.push_back(words_of(phrase));
    std::stable_sort(wanted.begin(), wanted.end(),
                     [](const auto& a, const auto& b) { return a.size() > b.size(); });
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

std::string head_word(std::string_view phrase) {
    auto words = words_of(phrase);
    return words.empty() ? std::string() : std::move(words.back());
}

std::vector<std::string> phrases_of(std::string_view list) {
    if (list.find(',') == std::string_view::npos) return words_of(list);
    std::vector<std::string> phrases;
    for (std::size_t begin = 0; begin <= list.size();) {
        const std::size_t end = std::min(list.find(',', begin), list.size());
        auto phrase = normalised_prompt(list.substr(begin, end - begin));
        if (!phrase.empty()) phrases.push_back(std::move(phrase));
        begin = end + 1;
    }
    return phrases;
}

bool contains(const std::vector<std::string>& words, std::string_view word) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

}  // namespace gse::language
