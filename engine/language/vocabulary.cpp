// Known words, parts of words, near words.
#include "engine/language/vocabulary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <utility>

#include "engine/base/spelling.h"
#include "engine/language/grammar.h"
#include "engine/language/words.h"

namespace gse::language {
namespace {

// Share of the letters: "bears" and "baer" are near "bear", "sign" is near nothing.
constexpr double MostDifferent = 0.4;
constexpr double OfSwapped = 0.3;  // two letters that changed places, whatever the length

/// Spelling distance in which two neighbours that changed places are no more than one slip.
double slip(const std::string& a, const std::string& b) {
    const double distance = spelling_distance(a, b);
    if (a.size() != b.size()) return distance;
    const auto at = static_cast<std::size_t>(std::mismatch(a.begin(), a.end(), b.begin()).first - a.begin());
    std::string swapped = a;
    if (at + 1 < a.size()) std::swap(swapped[at], swapped[at + 1]);
    return swapped == b ? std::min(distance, OfSwapped) : distance;
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
    std::vector<std::pair<double, std::string>> near;
    for (const auto& candidate : known) {
        if (!says_something(candidate)) continue;
        const double distance = slip(word, candidate);
        if (distance <= MostDifferent) near.emplace_back(distance, candidate);
    }
    std::stable_sort(near.begin(), near.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    if (near.size() > most) near.resize(most);
    std::vector<std::string> words;
    for (auto& entry : near) words.push_back(std::move(entry.second));
    return words;
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
