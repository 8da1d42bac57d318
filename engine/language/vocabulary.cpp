// Known words, parts of words, near words.
#include "engine/language/vocabulary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/spelling.h"
#include "engine/language/grammar.h"
#include "engine/language/words.h"

namespace gse::language {
namespace {

constexpr std::size_t LeastSpelt = 3;  // letters of a word that may be misspelt: shorter ones are others

/// Tells whether one letter was typed wrong, left out or added, or two neighbours changed places.
bool one_letter_away(const std::string& a, const std::string& b) {
    if (std::min(a.size(), b.size()) < LeastSpelt) return false;
    const double letters = spelling_distance(a, b) * static_cast<double>(std::max(a.size(), b.size()));
    if (std::lround(letters) <= 1) return true;
    if (a.size() != b.size()) return false;
    const auto at = static_cast<std::size_t>(std::mismatch(a.begin(), a.end(), b.begin()).first - a.begin());
    std::string swapped = a;
    if (at + 1 < a.size()) std::swap(swapped[at], swapped[at + 1]);
    return swapped == b;
}

/// The word and what it may be the plural of: "berries" gives "berry" among others.
std::vector<std::string> lemmas_of(const std::string& word) {
    std::vector<std::string> lemmas{word};
    if (const auto singular = irregular_singular(word); !singular.empty()) lemmas.emplace_back(singular);
    const auto without = [&](std::string_view ending, std::string_view instead) {
        if (word.size() > ending.size() + 1 && word.ends_with(ending))
            lemmas.push_back(word.substr(0, word.size() - ending.size()) + std::string(instead));
    };
    if (!word.ends_with("ss")) without("s", "");
    without("es", "");
    without("ies", "y");
    without("ves", "f");
    without("ves", "fe");
    return lemmas;
}

bool same_lemma(const std::string& a, const std::string& b) {
    const auto of_a = lemmas_of(a), of_b = lemmas_of(b);
    return std::any_of(of_a.begin(), of_a.end(), [&](const auto& lemma) { return contains(of_b, lemma); });
}

/// Adds the known words that `wanted` accepts, in the order of the vocabulary.
template <class Wanted>
void add_known(std::vector<std::string>& words, const std::vector<std::string>& known, Wanted&& wanted) {
    for (const auto& candidate : known)
        if (says_something(candidate) && !contains(words, candidate) && wanted(candidate))
            words.push_back(candidate);
}

/// Known words of the same meaning as one of the lemmas; where there are none, those of the same kind.
std::vector<std::string> kindred_words(const std::string& word, const std::vector<std::string>& known) {
    std::vector<std::string> words;
    for (const auto& lemma : lemmas_of(word))
        for (const auto group : kindred_groups(lemma)) {
            const auto listed = words_of(group);
            add_known(words, known, [&](const auto& candidate) { return contains(listed, candidate); });
        }
    return words;
}

std::string quoted(const std::vector<std::string>& words) {
    std::string text;
    for (std::size_t i = 0; i < words.size(); ++i)
        text += fmt::format("{}\"{}\"", i == 0 ? "" : i + 1 == words.size() ? " or " : ", ", words[i]);
    return text;
}

/// "rose" and "red" of "rose-red".
std::vector<std::string> parts_of(const std::string& word) {
    std::vector<std::string> parts(1);
    for (const char letter : word) {
        if (letter != '-' && letter != '\'') parts.back() += letter;
        else if (!parts.back().empty()) parts.emplace_back();
    }
    if (parts.back().empty()) parts.pop_back();
    return parts;
}

}  // namespace

VocabularyMatch match_word(const std::string& word, const std::vector<std::string>& known) {
    if (contains(known, word)) return {{word}, {}};
    VocabularyMatch match;
    for (auto& part : parts_of(word)) (contains(known, part) ? match.kept : match.left_out).push_back(part);
    if (match.kept.empty()) match.left_out = {word};
    return match;
}

std::string filter_to_vocabulary(std::string_view sentence, const std::vector<std::string>& known,
                                 std::string_view signs) {
    std::string result;
    const auto append = [&](const std::string& kept) {
        if (!result.empty()) result += ' ';
        result += kept;
    };
    for (const auto& token : tokens_of(sentence)) {
        if (token.is_word) {
            for (const auto& word : match_word(token.text, known).kept) append(word);
            continue;
        }
        if (signs.find(token.text) != std::string_view::npos) append(token.text);
        if (token.text == "," && !result.empty() && result.back() != ',') result += ',';
    }
    if (!result.empty() && result.back() == ',') result.pop_back();
    return result;
}

std::string unknown_word(const std::vector<std::string>& known, std::string_view phrase) {
    if (known.empty()) return {};
    for (auto& word : words_of(phrase))
        if (!contains(known, word)) return std::move(word);
    return {};
}

bool vocabulary_contains(const std::vector<std::string>& known, std::string_view phrase) {
    return known.empty() || (!words_of(phrase).empty() && unknown_word(known, phrase).empty());
}

std::vector<std::string> nearest_words(const std::string& word, const std::vector<std::string>& known,
                                       std::size_t most) {
    std::vector<std::string> words;
    add_known(words, known, [&](const auto& candidate) { return same_lemma(word, candidate); });
    if (words.empty()) words = kindred_words(word, known);
    if (words.empty())
        add_known(words, known, [&](const auto& candidate) { return one_letter_away(word, candidate); });
    if (words.size() > most) words.resize(most);
    return words;
}

std::vector<std::string> things_among(std::vector<std::string> known) {
    std::erase_if(known, [](const auto& word) { return is_a(word, Description); });
    return known;
}

std::string words_to_use(const std::string& word, const std::vector<std::string>& known) {
    const auto near = nearest_words(word, known);
    if (!near.empty()) return quoted(near);
    std::string all;
    for (const auto& candidate : known)
        if (says_something(candidate)) all += (all.empty() ? "" : ", ") + candidate;
    return fmt::format("a word it knows: {}", all);
}

std::vector<std::string> promptable_vocabulary(const std::vector<std::string>& known,
                                               const std::vector<std::string>& generated) {
    auto words = known;
    if (!known.empty()) words.insert(words.end(), generated.begin(), generated.end());
    return words;
}

}  // namespace gse::language
