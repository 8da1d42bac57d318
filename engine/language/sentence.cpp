// Reading a sentence: noun phrases, what it was before the edit, and which kind of edit it asks for.
#include "engine/language/sentence.h"

#include <algorithm>
#include <utility>

#include "engine/language/grammar.h"
#include "engine/language/words.h"

namespace gse::language {
namespace {

using Terms = std::vector<std::string>;

/// Position of the term, -1 = absent.
int position_in(const Terms& terms, const std::string& term) {
    const auto found = std::find(terms.begin(), terms.end(), term);
    return found == terms.end() ? -1 : static_cast<int>(found - terms.begin());
}

/// Tells whether a term strictly between two positions is of one of the classes.
bool any_between(const Terms& terms, int begin, int end, WordClass classes) {
    for (int i = begin + 1; i < end; ++i)
        if (is_a(terms[static_cast<std::size_t>(i)], classes)) return true;
    return false;
}

bool is_thing(const std::string& phrase) {
    const auto head = head_word(phrase);
    return !phrase.empty() && !is_ground(head) && !is_a(head, Description);
}

/// The thing whose noun phrase has the term at `at`; empty where that is no thing.
std::string thing_of(const Terms& terms, std::size_t at) {
    std::size_t head = at;
    while (head + 1 < terms.size() && !ends_phrase(terms[head + 1])) ++head;
    return is_thing(terms[head]) ? terms[head] : std::string();
}

std::string replacement_in(const Sentence& sentence, const Terms& terms, const std::string& source,
                           const std::string& target) {
    const auto from = position_in(terms, source), to = position_in(terms, target);
    if (!is_thing(source) || to < 0 || has_phrase(target, source)) return {};
    const auto at = static_cast<std::size_t>(to);
    if (from >= 0) {  // "turn the bear into a wooden dog"
        const bool turned = from < to && std::find(terms.begin() + from + 1, terms.begin() + to, "into") !=
                                             terms.begin() + to;
        const auto thing = turned ? thing_of(terms, at) : std::string();
        return thing == source ? std::string() : thing;  // "turn the bear into a golden bear"
    }
    if (at > 0 && terms[at - 1] == "of") return {};  // "made of gold"
    if (auto thing = thing_of(terms, at); !thing.empty()) return thing;
    for (auto& thing : sentence.things())  // the word that is new only says where it is, or how it looks
        if (is_thing(thing)) return thing;
    return {};
}

/// Range of the terms that bring the target: its description alone, or with the words that join it to the
/// source.
std::pair<std::size_t, std::size_t> bringing(const Terms& terms, std::size_t source, std::size_t target) {
    const auto joins = [&](std::size_t i) { return ends_phrase(terms[i]); };
    std::size_t first = target, last = target + 1;
    if (source < target) {
        while (first > source + 1 && !joins(first)) --first;
        while (first > source + 1 && joins(first - 1)) --first;
        while (last < terms.size() && !joins(last)) ++last;
        if (last + 1 < terms.size() && is_pronoun(terms[last + 1])) last += 2;  // "beside it"
    } else if (last < source && source < terms.size() &&
               names_thing(terms, target)) {  // "a ball beside" a bear
        while (first > 0 && !joins(first - 1)) --first;
        for (last = source; !joins(last - 1);) --last;
    }
    return {first, last};
}

std::string before_of(Terms terms, const std::string& source_phrase, const std::string& target_phrase) {
    const auto place = [&](const std::string& phrase) {
        return static_cast<std::size_t>(std::find(terms.begin(), terms.end(), phrase) - terms.begin());
    };
    const auto erase = [&](std::size_t first, std::size_t last) {
        terms.erase(terms.begin() + static_cast<std::ptrdiff_t>(first),
                    terms.begin() + static_cast<std::ptrdiff_t>(last));
    };
    const std::size_t target = place(target_phrase), source = place(source_phrase);
    if (target < terms.size() && (source == terms.size() || source == target)) {
        terms[target] = source_phrase;
        std::size_t first = target;  // what describes the new thing says nothing of the old one
        while (source == terms.size() && first > 0 && !ends_phrase(terms[first - 1]) &&
               !is_leading(terms[first - 1]))
            --first;
        erase(first, target);
    } else if (target < terms.size()) {
        const auto [first, last] = bringing(terms, source, target);
        erase(first, last);
    }
    return joined(terms);
}

std::vector<NounPhrase> phrases_in(const Terms& terms) {
    std::vector<NounPhrase> found;
    for (std::size_t begin = 0; begin < terms.size(); ++begin) {
        if (!begins_phrase(terms, begin)) continue;
        NounPhrase phrase{begin, begin == 0 ? std::string() : terms[begin - 1], {}, {}};
        std::size_t i = begin;
        while (i < terms.size() && is_leading(terms[i])) ++i;
        for (; i < terms.size() && !ends_phrase(terms[i]); ++i) {
            if (!phrase.head.empty()) phrase.attributes.push_back(std::move(phrase.head));
            phrase.head = terms[i];
        }
        if (!phrase.head.empty()) found.push_back(std::move(phrase));
    }
    return found;
}

}  // namespace

Sentence::Sentence(std::string_view prompt) : words_(words_of(prompt)), prompt_(joined(words_)) {}

bool Sentence::contains(std::string_view phrase) const { return position_of(phrase) < words_.size(); }

std::size_t Sentence::position_of(std::string_view phrase) const {
    return language::position_of(words_, phrase);
}

std::vector<std::string> Sentence::terms(const std::vector<std::string>& phrases) const {
    return noun_terms(words_, phrases);
}

std::vector<NounPhrase> Sentence::noun_phrases(const std::vector<std::string>& phrases) const {
    return phrases_in(terms(phrases));
}

std::vector<std::string> Sentence::things(const std::vector<std::string>& phrases) const {
    const auto all = terms(phrases);
    std::vector<std::string> things;
    for (auto& phrase : phrases_in(all)) {
        if (is_a(phrase.joint, WordClass::Turning) || is_a(all[phrase.begin], WordClass::Turning)) continue;
        if (!language::contains(things, phrase.head)) things.push_back(std::move(phrase.head));
    }
    return things;
}

EditSentence::EditSentence(Sentence sentence, std::string source, std::string target)
    : sentence_(std::move(sentence)), source_(std::move(source)), target_(std::move(target)) {
    const auto terms = sentence_.terms({source_, target_});
    before_ = before_of(terms, source_, target_);
    replacement_ = replacement_in(sentence_, terms, source_, target_);
    relation_ = relation_of(terms, source_, target_);
}

std::vector<std::string> EditSentence::things_before(const std::vector<std::string>& phrases) const {
    return Sentence(before_).things(phrases);
}

EditSentence EditSentence::with_target(std::string target) const {
    return {sentence_, source_, std::move(target)};
}

EditSentence EditSentence::reworded(std::string_view prompt, std::string target) const {
    return {Sentence(prompt), source_, std::move(target)};
}

std::pair<EditMode, std::string> decide_mode(const EditSentence& words, std::optional<EditMode> asked,
                                             std::optional<double> target_found_share) {
    constexpr double present_share = 0.3;  // METHOD.md, The sentence
    const auto &source = words.source(), &target = words.target();
    if (asked) return {*asked, "as asked"};
    if (!words.replacement().empty())
        return {EditMode::Replace,
                "the sentence has \"" + words.replacement() + "\" in the place of \"" + source + "\""};
    if (target_found_share && *target_found_share >= present_share)
        return {EditMode::Modify, "the scene shows \"" + target + "\" already"};
    const auto terms = terms_of(words.sentence().words(), {source, target});
    const int from = position_in(terms, source), to = position_in(terms, target);
    if (from < 0 && names_ground(source) && to >= 0 && is_thing(target) &&
        !thing_of(terms, static_cast<std::size_t>(to)).empty())
        return {EditMode::Add, "the sentence puts \"" + target + "\" on \"" + source + "\""};
    if (from < 0) return {EditMode::Modify, "the sentence says something else of \"" + source + "\""};
    if (from == to) return {EditMode::Modify, "source and target are the same word"};
    const int first = std::min(from, to), last = std::max(from, to);
    bool worn = false;
    for (int i = first + 1; i < last; ++i) worn = worn || says_worn(terms, static_cast<std::size_t>(i));
    const bool joined =
        words.relation() != Relation::None || ((worn || any_between(terms, first, last, WordClass::Beside)) &&
                                               !any_between(terms, first, last, WordClass::Turning));
    if (joined) return {EditMode::Add, "the sentence puts \"" + target + "\" beside \"" + source + "\""};
    return {EditMode::Modify, "\"" + target + "\" describes \"" + source + "\""};
}

const std::string& new_thing(const EditSentence& words, EditMode mode) {
    return mode == EditMode::Replace && !words.replacement().empty() ? words.replacement() : words.target();
}

std::string instance_prompt(const EditSentence& words) {
    const bool identified = words.sentence().contains(Identifier) && !has_phrase(words.source(), Identifier);
    return "a photo of a " + (identified ? Identifier + " " : std::string()) + words.source();
}

std::string instruction_for(const Sentence& sentence, const std::string& source) {
    auto words = sentence.words();
    std::erase(words, Identifier);
    if (!words.empty() && is_a(words.front(), Article)) words.erase(words.begin());
    const auto result = joined(words);
    return source.empty() ? "make it " + result : "turn the " + source + " into " + result;
}

}  // namespace gse::language
