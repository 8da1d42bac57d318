// From text to plan: cleaning, words, reading.
#include "engine/language/plan/plan_sentence.h"

#include <algorithm>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "engine/language/plan/grammar/audit.h"
#include "engine/language/plan/grammar/reader.h"
#include "engine/language/plan/words/clean_text.h"
#include "engine/language/plan/words/sentence_words.h"

namespace gse::language::plan {
namespace {

/// Words of the scene and of the source: what a misspelt word stands for before all others.
std::vector<std::string> needed_words(const SceneWords& scene, std::string_view source) {
    std::vector<std::string> words;
    const auto append = [&](const SceneWords& from) {
        for (const auto& thing : from.things) {
            for (std::size_t begin = 0; begin < thing.noun.size();) {
                const std::size_t end = std::min(thing.noun.find(' ', begin), thing.noun.size());
                words.push_back(thing.noun.substr(begin, end - begin));
                begin = end + 1;
            }
            words.insert(words.end(), thing.attributes.begin(), thing.attributes.end());
        }
    };
    append(scene);
    append(scene_words(source));
    return words;
}

constexpr std::size_t ShortSentence = 14;  // words; only those of short sentences are taken for slips
constexpr std::size_t MostSlips = 5;       // words that one word may stand for
constexpr std::size_t StoryLength = 18;  // words; longer sentences may tell a story around what they ask for

bool is_refused_for(const Plan& plan, std::initializer_list<std::string_view> reasons) {
    const auto& step = plan.steps.front();
    return step.operation == Operation::Refuse &&
           std::find(reasons.begin(), reasons.end(), step.text) != reasons.end();
}

/// Tells whether a word of a thing may stand there: behind an article, a description or "wearing".
bool may_name_thing(const std::vector<Word>& words, std::size_t at) {
    const auto is_a = [&](std::size_t index, Class kind) {
        return match(kind, std::span(words).subspan(index, 1)).length > 0;
    };
    const auto names = [&](std::size_t index) {
        return is_a(index, Class::wearing) || is_a(index, Class::holding) || is_a(index, Class::having);
    };
    if (at == 0) return false;
    if (names(at - 1) || is_a(at - 1, Class::colour) || is_a(at - 1, Class::size)) return true;
    if (at + 1 < words.size() && is_a(at + 1, Class::of)) return false;  // "a pile of books" is no pole
    const bool article = is_a(at - 1, Class::article) || is_a(at - 1, Class::number);
    return article && (at == 1 || !is_a(at - 2, Class::relation));  // not "in a row"
}

bool begins_object(const std::vector<Word>& words, std::size_t at) {
    const auto rest = std::span(words).subspan(at);
    return match(Class::article, rest) || match(Class::definite, rest) || match(Class::possessive, rest) ||
           match(Class::pronoun_it, rest) || match(Class::pronoun_person, rest);
}

/// The plan when one word, though it is one, is a slip: "a bear wearing a hate". Nothing where no word makes
/// sense of the sentence.
std::optional<Plan> with_a_slip(const SentenceWords& sentence, const SceneWords& scene,
                                std::string_view source, const std::vector<std::string>& needed,
                                bool towards_scene_only) {
    if (sentence.words.size() > ShortSentence) return std::nullopt;
    auto words = sentence.words;
    for (std::size_t at = 0; at < words.size(); ++at) {
        auto& word = words[at];
        const bool told = std::find(needed.begin(), needed.end(), word.singular) != needed.end();
        const bool joins = has(Class::word_for, word.text) || has(Class::word_out, word.text);
        if (word.mark || word.text.size() < 2 || told || joins || is_grammatical(word.text)) continue;
        const Word typed = word;
        const bool known = std::ranges::binary_search(spellable_words(), std::string_view(typed.text));
        const bool orders = at == 0 && words.size() > 2 && begins_object(words, 1);
        for (auto& other : slips_of(typed.text, needed, MostSlips)) {
            const bool is_needed = std::find(needed.begin(), needed.end(), other) != needed.end();
            const bool thing = has(Class::worn, other) || has(Class::held, other);
            // "biger", "waring": a form that some word could have, and no word of the list
            const bool describes = has(Class::colour, other) ||
                                   (kinds_of(typed.text) == 0 && !known &&
                                    (is_grammatical(other) || has(Class::material, other))) ||
                                   (orders && has(Class::plain_verb, other));  // "putt a hat on it"
            if (!is_needed && (towards_scene_only || (!thing && !describes))) continue;
            if (!is_needed && !describes && !may_name_thing(words, at)) continue;
            word = word_of(std::move(other));
            auto plan = Reader(words, scene, source).read();
            if (!plan.is_refusal()) return plan;
        }
        word = typed;
    }
    return std::nullopt;
}

}  // namespace

/// "entirely blue and entirely green".
bool wants_two_wholes(const std::vector<Word>& words, const Plan& plan) {
    const auto wholly = std::count_if(words.begin(), words.end(),
                                      [](const Word& word) { return has(Class::wholly, word.text); });
    return wholly > 1 && std::any_of(plan.steps.begin(), plan.steps.end(), [](const Step& step) {
               return step.operation == Operation::Recolour && step.text.find(" and ") != std::string::npos;
           });
}

/// Words without what stands between commas and tells why or when: "add, if you have the time, a bench".
std::vector<Word> without_asides(const std::vector<Word>& words) {
    std::vector<Word> left;
    for (std::size_t at = 0; at < words.size(); ++at) {
        const bool comma = words[at].mark && words[at].text == "," && at + 1 < words.size();
        const auto end =
            std::find_if(words.begin() + static_cast<std::ptrdiff_t>(std::min(at + 1, words.size())),
                         words.end(), [](const Word& word) { return word.mark; });
        const bool aside = comma && end != words.end() && end->text == "," &&
                           match(Class::aside, std::span(words).subspan(at + 1));
        if (aside) at = static_cast<std::size_t>(end - words.begin());
        else left.push_back(words[at]);
    }
    return left;
}

Plan plan_sentence(std::string_view sentence, const SceneWords& scene, std::string_view source) {
    const auto clean = clean_text(sentence);
    if (!clean.refused.empty()) return refusal(clean.refused);
    const auto needed = needed_words(scene, source);
    const auto words = sentence_words(clean.text, needed);
    if (!words.refused.empty()) return refusal(words.refused);
    if (words.words.empty()) return refusal(reason::Empty);
    auto plan = Reader(words.words, scene, source).read();
    const bool unread = is_refused_for(plan, {reason::NotASentence, reason::Incomplete});
    if (unread || is_refused_for(plan, {reason::NotInScene}))
        if (auto other = with_a_slip(words, scene, source, needed, !unread)) return *other;
    if (words.words.size() > StoryLength && plan.steps.front().operation == Operation::Refuse) {
        const auto plain = without_asides(words.words);
        auto shorter = plain.size() < words.words.size() ? Reader(plain, scene, source).read() : plan;
        if (!shorter.is_refusal()) return shorter;
        return Reader(words.words, scene, source).read_story();
    }
    if (wants_two_wholes(words.words, plan)) return refusal(reason::Contradiction);
    if (const auto reason = doubt(words.words, scene, plan); !reason.empty()) return refusal(reason);
    return plan;
}

}  // namespace gse::language::plan
