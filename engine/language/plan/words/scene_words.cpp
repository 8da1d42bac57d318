// Reading the words of a scene.
#include "engine/language/plan/words/scene_words.h"

#include <algorithm>

#include "engine/language/plan/words/lexicon.h"

namespace gse::language::plan {
namespace {

std::vector<Word> words_of(std::string_view phrase) {
    std::vector<Word> words;
    std::string word;
    for (const char letter : std::string(phrase) + " ") {
        if (letter != ' ') {
            word += static_cast<char>(letter >= 'A' && letter <= 'Z' ? letter - 'A' + 'a' : letter);
            continue;
        }
        if (!word.empty())
            words.push_back(word_of(std::string(meaning(Class::spelling, word).value_or(word))));
        word.clear();
    }
    return words;
}

bool describes(std::string_view word) {
    return has(Class::colour, word) || has(Class::material, word) || has(Class::material_surface, word) ||
           has(Class::size, word) || has(Class::state, word) || has(Class::pattern_plain, word) ||
           has(Class::shade, word) || has(Class::article, word) || has(Class::definite, word);
}

SceneThing thing_of(std::string_view phrase) {
    const auto words = words_of(phrase);
    SceneThing thing;
    std::size_t at = 0;
    for (; at + 1 < words.size() && describes(words[at].text); ++at) {
        const auto rest = std::span(words).subspan(at);
        if (match(Class::compound, rest).length > 1 || match(Class::worn, rest).length > 1) break;
        if (!has(Class::article, words[at].text) && !has(Class::definite, words[at].text))
            thing.attributes.push_back(words[at].text);
    }
    for (; at < words.size(); ++at) thing.noun += (thing.noun.empty() ? "" : " ") + words[at].text;
    thing.is_ground = has(Class::ground, thing.noun);
    return thing;
}

}  // namespace

std::optional<std::size_t> SceneWords::ground() const {
    for (std::size_t i = 0; i < things.size(); ++i)
        if (things[i].is_ground) return i;
    return std::nullopt;
}

std::optional<std::size_t> SceneWords::only_thing() const {
    std::optional<std::size_t> only;
    for (std::size_t i = 0; i < things.size(); ++i) {
        if (things[i].is_ground || things[i].is_worn) continue;
        if (only) return std::nullopt;
        only = i;
    }
    return only;
}

SceneWords scene_words(std::string_view list) {
    SceneWords scene;
    for (std::size_t begin = 0; begin <= list.size();) {
        const std::size_t end = std::min(list.find_first_of(";,\n", begin), list.size());
        auto thing = thing_of(list.substr(begin, end - begin));
        const auto last = thing.noun.rfind(' ');
        const bool is_clothes = has(Class::worn, thing.noun) ||
                                has(Class::worn, thing.noun.substr(last == std::string::npos ? 0 : last + 1));
        thing.is_worn = is_clothes && !scene.things.empty() && !thing.is_ground;
        if (!thing.noun.empty()) scene.things.push_back(std::move(thing));
        begin = end + 1;
    }
    return scene;
}

}  // namespace gse::language::plan
