// Change what is there, put something else in its place, or add something: read off the sentence.
#include <algorithm>
#include <array>

#include "engine/edit/request/relation.h"
#include "engine/edit/search/locate.h"

namespace gse::edit {
namespace {

using Words = std::vector<std::string>;

constexpr std::array<std::pair<const char*, EditMode>, 3> Modes{
    {{"modify", EditMode::Modify}, {"add", EditMode::Add}, {"replace", EditMode::Replace}}};

bool is_among(const Words& words, const std::string& word) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

/// Position of the word in the sentence, -1 = absent.
int word_position(const Words& words, const std::string& word) {
    const auto found = std::find(words.begin(), words.end(), word);
    return found == words.end() ? -1 : static_cast<int>(found - words.begin());
}

bool any_of_between(const Words& words, int begin, int end, const Words& wanted) {
    for (int i = begin + 1; i < end; ++i)
        if (is_among(wanted, words[static_cast<std::size_t>(i)])) return true;
    return false;
}

/// Colours, materials and states: what a thing is like.
bool is_description(const std::string& word) {
    static const Words descriptions{
        "red",   "blue",     "green",  "yellow",  "purple", "orange", "black",  "white",  "pink",
        "brown", "grey",     "gray",   "wooden",  "wood",   "stone",  "golden", "gold",   "silver",
        "metal", "metallic", "bronze", "copper",  "iron",   "steel",  "glass",  "marble", "clay",
        "wax",   "plastic",  "paper",  "leather", "rusty",  "furry",  "shiny",  "old",    "new"};
    return is_among(descriptions, word);
}

/// The last word of a phrase: a top hat is a hat.
std::string last_word(const std::string& phrase) {
    const auto words = words_of(phrase);
    return words.empty() ? std::string() : words.back();
}

bool is_thing(const std::string& phrase) {
    return !phrase.empty() && !is_ground(last_word(phrase)) && !is_description(last_word(phrase));
}

/// The thing whose noun phrase has the term at `at`; empty where that is no thing.
std::string thing_of(const Words& terms, std::size_t at) {
    std::size_t head = at;
    while (head + 1 < terms.size() && !ends_phrase(terms[head + 1])) ++head;
    return is_thing(terms[head]) ? terms[head] : std::string();
}

}  // namespace

const char* mode_name(EditMode mode) {
    return std::find_if(Modes.begin(), Modes.end(), [&](const auto& entry) { return entry.second == mode; })
        ->first;
}

std::optional<EditMode> mode_named(const std::string& name) {
    for (const auto& [known, mode] : Modes)
        if (name == known) return mode;
    return std::nullopt;
}

std::string thing_in_place(const EditRequest& request) {
    const auto terms = noun_terms(request.prompt, {request.source, request.target});
    const auto source = word_position(terms, request.source), target = word_position(terms, request.target);
    if (!is_thing(request.source) || target < 0 || has_word(request.target, request.source)) return {};
    const auto at = static_cast<std::size_t>(target);
    if (source >= 0) {  // "turn the bear into a wooden dog"
        static const Words turned{"into"};
        const auto thing = source < target && any_of_between(terms, source, target, turned)
                               ? thing_of(terms, at)
                               : std::string();
        return thing == request.source ? std::string() : thing;  // "turn the bear into a golden bear"
    }
    static const Words made{"of"};
    if (at > 0 && is_among(made, terms[at - 1])) return {};  // "made of gold"
    if (auto thing = thing_of(terms, at); !thing.empty()) return thing;
    for (const auto& thing :
         things_named(request.prompt))  // the word that is new only says where it is, or how it looks
        if (is_thing(thing)) return thing;
    return {};
}

std::pair<EditMode, std::string> decide_mode(const EditRequest& request,
                                             std::optional<double> target_found_share) {
    constexpr double present_share = 0.3;  // A7
    if (const auto asked = mode_named(request.mode)) return {*asked, "as asked"};
    if (const auto thing = thing_in_place(request); !thing.empty())
        return {EditMode::Replace,
                "the sentence has \"" + thing + "\" in the place of \"" + request.source + "\""};
    if (target_found_share && *target_found_share >= present_share)
        return {EditMode::Modify, "the scene shows \"" + request.target + "\" already"};
    const auto words = terms_of(request.prompt, {request.source, request.target});
    const int source = word_position(words, request.source), target = word_position(words, request.target);
    if (source < 0)
        return {EditMode::Modify, "the sentence says something else of \"" + request.source + "\""};
    if (source == target) return {EditMode::Modify, "source and target are the same word"};
    static const Words joining{"wearing", "with",   "and",  "holding",  "has",  "having", "on",
                               "under",   "beside", "near", "carrying", "plus", "to",     "behind"};
    static const Words turning{"made", "of", "into", "as"};
    const int first = std::min(source, target), last = std::max(source, target);
    bool worn = false;
    for (int i = first + 1; i < last; ++i) worn = worn || says_worn(words, static_cast<std::size_t>(i));
    const bool related = relation_of(request.prompt, request.source, request.target) != Relation::None;
    const bool joined = related || ((worn || any_of_between(words, first, last, joining)) &&
                                    !any_of_between(words, first, last, turning));
    if (joined)
        return {EditMode::Add,
                "the sentence puts \"" + request.target + "\" beside \"" + request.source + "\""};
    return {EditMode::Modify, "\"" + request.target + "\" describes \"" + request.source + "\""};
}

EditMode planned_mode(const EditRequest& request) { return decide_mode(request, std::nullopt).first; }

}  // namespace gse::edit
