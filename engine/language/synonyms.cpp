// Sets of words: the first is the usual one.
#include "engine/language/synonyms.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "engine/language/lexicon.h"
#include "engine/language/words.h"

namespace gse::language {
namespace {

// Words of one synset of WordNet 3.0, and direct kinds and the young that look like the first word.
constexpr std::array<std::string_view, 41> Sets{"dog puppy pup doggy doggie pooch hound",
                                                "cat kitten tomcat",
                                                "bear bruin",
                                                "duck duckling",
                                                "horse mare",
                                                "rabbit bunny",
                                                "pig hog",
                                                "chicken hen",
                                                "man guy gentleman",
                                                "woman lady",
                                                "child kid youngster",
                                                "baby infant",
                                                "ball orb",
                                                "vase urn",
                                                "mushroom toadstool",
                                                "chair armchair",
                                                "sofa couch settee",
                                                "car automobile auto motorcar sedan",
                                                "truck lorry",
                                                "bicycle bike",
                                                "motorcycle motorbike bike",
                                                "airplane plane aeroplane",
                                                "house cottage bungalow",
                                                "hat chapeau",
                                                "crown diadem",
                                                "sunglasses shades",
                                                "glasses spectacles specs eyeglasses",
                                                "fire flame blaze",
                                                "lake pond",
                                                "floor flooring",
                                                "bucket pail",
                                                "bag handbag purse",
                                                "backpack rucksack knapsack",
                                                "rug carpet",
                                                "flower bloom blossom",
                                                "bush shrub",
                                                "television tv telly",
                                                "refrigerator fridge",
                                                "bathtub tub",
                                                "trousers pants",
                                                "moustache mustache"};

std::string singular_of(const std::string& word) {
    if (const auto irregular = irregular_singular(word); !irregular.empty()) return std::string(irregular);
    if (word.ends_with("ies") && word.size() > 4) return word.substr(0, word.size() - 3) + "y";
    for (const std::string_view ending : {"shes", "ches", "xes", "ses"})
        if (word.ends_with(ending)) return word.substr(0, word.size() - 2);
    return word.ends_with("s") && !word.ends_with("ss") ? word.substr(0, word.size() - 1) : word;
}

}  // namespace

std::string known_synonym(const std::string& word, const std::vector<std::string>& known) {
    if (known.empty() || contains(known, word)) return {};
    for (const auto& lemma : {word, singular_of(word)}) {
        for (const auto set : Sets) {
            const auto words = words_of(set);
            if (!contains(words, lemma)) continue;
            const auto found = std::find_if(words.begin(), words.end(),
                                            [&](const auto& other) { return contains(known, other); });
            if (found != words.end()) return *found;
        }
    }
    return {};
}

KnownPhrase in_known_words(const std::string& phrase, const std::vector<std::string>& known) {
    KnownPhrase result;
    std::size_t at = 0;
    const auto is_letter = [](char letter) {
        return (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') || letter == '-';
    };
    while (at < phrase.size()) {
        std::size_t end = at;
        while (end < phrase.size() && is_letter(phrase[end])) ++end;
        const std::string typed = normalised_prompt(phrase.substr(at, end - at));
        const auto other = end > at ? known_synonym(typed, known) : std::string();
        if (other.empty()) {
            end = std::max(end, at + 1);
            result.text += phrase.substr(at, end - at);
        } else {
            result.text += other;
            result.replaced.push_back({typed, other});
        }
        at = end;
    }
    return result;
}

std::string other_word_text(const OtherWord& word) {
    return fmt::format("Looks for \"{}\": \"{}\" is another word for it", word.known, word.typed);
}

}  // namespace gse::language
