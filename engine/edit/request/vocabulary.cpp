// Known words, near words, and the refusal.
#include "engine/edit/request/vocabulary.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/base/error.h"
#include "engine/base/spelling.h"
#include "engine/edit/target_views/strategies/colour_remap.h"

namespace gse::edit {
namespace {

constexpr double MostDifferent =
    0.4;  // share of the letters: "bears" and "baer" are near "bear", "sign" is near nothing
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

}  // namespace

std::string unknown_word(const std::vector<std::string>& known, const std::string& phrase) {
    if (known.empty()) return {};
    for (const auto& word : words_of(phrase))
        if (std::find(known.begin(), known.end(), word) == known.end()) return word;
    return {};
}

bool knows(const std::vector<std::string>& known, const std::string& phrase) {
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
                                               const std::vector<std::string>& drawn) {
    auto words = known;
    if (!known.empty()) words.insert(words.end(), drawn.begin(), drawn.end());
    return words;
}

/// What can be said in a word's place where something is to be made: words near to it, else all but the names
/// of colours and patterns that are dyed, of which there are many.
static std::string words_to_make(const std::string& word, const std::vector<std::string>& known,
                                 const std::vector<std::string>& drawn) {
    const auto say = promptable_vocabulary(known, drawn);
    if (!nearest_words(word, say).empty()) return words_to_use(word, say);
    const auto dyes = dye_words(known);
    auto shown = known;
    for (const auto& candidate : drawn)
        if (std::find(dyes.begin(), dyes.end(), candidate) == dyes.end()) shown.push_back(candidate);
    return words_to_use(word, shown) + (dyes.empty() ? "" : ", or a colour or pattern by its name");
}

void require_known_words(const EditRequest& request, const std::vector<std::string>& known,
                         const std::vector<std::string>& drawn, bool labelled_by_hand) {
    const auto say = promptable_vocabulary(known, drawn);
    const auto source = unknown_word(known, request.source), target = unknown_word(say, request.target);
    if (!labelled_by_hand && !source.empty())
        throw Error(ErrorCode::InvalidArgument,
                    knows(say, source)
                        ? fmt::format("the model can draw \"{}\" but not find it", source)
                        : fmt::format("the model does not know the word \"{}\" and cannot find it", source),
                    fmt::format("label it by hand instead, or use {}", words_to_use(source, known)));
    if (!target.empty())
        throw Error(ErrorCode::InvalidArgument,
                    fmt::format("the model does not know the word \"{}\" and cannot make it", target),
                    fmt::format("use {}", words_to_make(target, known, drawn)));
}

}  // namespace gse::edit
