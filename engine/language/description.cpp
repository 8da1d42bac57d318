// A colour word before a thing, where the sentence has none.
#include "engine/language/description.h"

#include "engine/language/grammar.h"
#include "engine/language/vocabulary.h"
#include "engine/language/words.h"

namespace gse::language {
namespace {

bool is_vowel(char letter) { return std::string_view("aeiou").find(letter) != std::string_view::npos; }

bool is_described(const std::vector<std::string>& words, const std::string& thing) {
    const auto at = position_of(words, thing);
    if (at >= words.size()) return true;
    if (at > 0 && (says_something(words[at - 1]) || words[at - 1] == "in" || words[at - 1] == "on"))
        return true;                                 // "in flames": a state
    const auto after = at + words_of(thing).size();  // "wings of gold", "a hat made of wood"
    return after < words.size() && (words[after] == "of" || words[after] == "made");
}

}  // namespace

bool is_described(std::string_view sentence, const std::string& thing) {
    return is_described(words_of(sentence), thing);
}

std::string described_as(const std::string& sentence, const std::string& thing, const std::string& colour) {
    auto words = words_of(sentence);
    const auto at = position_of(words, thing);
    if (at >= words.size() || colour.empty()) return sentence;
    if (at > 0 && is_a(words[at - 1], WordClass::IndefiniteArticle))
        words[at - 1] = is_vowel(colour.front()) ? "an" : "a";
    words.insert(words.begin() + static_cast<std::ptrdiff_t>(at), colour);
    return joined(words);
}

std::string with_usual_colour(const std::string& sentence, const std::string& thing,
                              const std::vector<std::string>& sayable,
                              const std::map<std::string, std::string>& usual_colours) {
    const auto usual = usual_colours.find(thing);
    if (sayable.empty() || usual == usual_colours.end() || !vocabulary_contains(sayable, usual->second))
        return sentence;
    auto told = words_of(sentence);  // less what says nothing to the model ("big")
    for (auto at = position_of(told, thing); at > 0 && at < told.size() && says_something(told[at - 1]) &&
                                             !vocabulary_contains(sayable, told[at - 1]);
         --at)
        told.erase(told.begin() + static_cast<std::ptrdiff_t>(at - 1));
    return is_described(told, thing) ? sentence : described_as(sentence, thing, usual->second);
}

}  // namespace gse::language
