// Noun phrases, their heads and their joints; relations between two of them.
#include "engine/language/grammar.h"

#include <algorithm>
#include <array>

#include "engine/language/words.h"

namespace gse::language {
namespace {

using Terms = std::vector<std::string>;

Relation opposite(Relation relation) {
    switch (relation) {
        case Relation::Above: return Relation::Under;
        case Relation::Under: return Relation::Above;
        case Relation::Left: return Relation::Right;
        case Relation::Right: return Relation::Left;
        case Relation::Behind: return Relation::Before;
        case Relation::Before: return Relation::Behind;
        default: return relation;
    }
}

/// The relation whose preposition begins the noun phrase that ends at `head`; None where another word begins
/// it.
Relation leading_to(const Terms& terms, std::size_t head) {
    for (std::size_t i = head; i > 0; --i)
        if (ends_phrase(terms[i - 1])) return relation_named(terms[i - 1]).value_or(Relation::None);
    return Relation::None;
}

}  // namespace

std::vector<std::string> noun_terms(const std::vector<std::string>& words,
                                    const std::vector<std::string>& phrases) {
    auto whole = compound_prepositions();
    whole.insert(whole.end(), phrases.begin(), phrases.end());
    return terms_of(words, whole);
}

bool ends_phrase(std::string_view term) {
    return is_a(term, WordClass::Joiner | WordClass::Stop) || relation_named(term).has_value();
}

bool is_leading(std::string_view term) { return is_a(term, Leading) || term == Identifier; }

bool is_pronoun(std::string_view term) { return is_a(term, WordClass::Pronoun); }

bool says_something(std::string_view word) {
    return !is_leading(word) && !ends_phrase(word) && !is_a(word, WordClass::Contentless);
}

bool says_worn(const std::vector<std::string>& words, std::size_t i) {
    if (words[i] != "in" || i + 1 >= words.size()) return false;
    return is_a(words[i + 1], WordClass::IndefiniteArticle | WordClass::Possessive) ||
           has_usual_place(words[i + 1]);
}

bool begins_phrase(const std::vector<std::string>& terms, std::size_t i) {
    return i == 0 || ends_phrase(terms[i - 1]);
}

std::string head_of_phrase(const std::vector<std::string>& terms, std::size_t first) {
    while (first < terms.size() && is_leading(terms[first])) ++first;
    std::string head;
    for (std::size_t i = first; i < terms.size() && !ends_phrase(terms[i]); ++i) head = terms[i];
    return head;
}

bool names_thing(const std::vector<std::string>& terms, std::size_t i) {
    do ++i;
    while (i < terms.size() && terms[i].ends_with("ing") && !ends_phrase(terms[i]));
    return i == terms.size() || ends_phrase(terms[i]);
}

bool is_ground(std::string_view word) { return is_a(word, WordClass::Ground); }

bool names_ground(std::string_view phrase) { return is_ground(head_word(phrase)); }

bool names_scene_ground(std::string_view phrase) {
    constexpr std::array<std::string_view, 13> Partial{"water",      "lake",   "sea",     "ocean",  "river",
                                                       "road",       "street", "forest",  "carpet", "sky",
                                                       "background", "rug",    "pavement"};
    const auto head = head_word(phrase);
    return is_ground(head) && std::find(Partial.begin(), Partial.end(), head) == Partial.end();
}

std::string usual_place(std::string_view thing) {
    return std::string(listed_place(head_word(thing)).value_or("top"));
}

bool has_usual_place(std::string_view thing) { return listed_place(head_word(thing)).has_value(); }

Relation relation_of(const std::vector<std::string>& terms, const std::string& source,
                     const std::string& target) {
    const auto place = [&](const std::string& phrase) {
        return static_cast<std::size_t>(std::find(terms.begin(), terms.end(), phrase) - terms.begin());
    };
    const std::size_t from = place(source), to = place(target);
    if (from == to || from == terms.size() || to == terms.size()) return Relation::None;
    if (to < from) return names_thing(terms, to) ? leading_to(terms, from) : Relation::None;
    if (to + 2 < terms.size() && is_pronoun(terms[to + 2]))  // "with a ball beside it"
        if (const auto named = relation_named(terms[to + 1])) return *named;
    return opposite(leading_to(terms, to));
}

std::string place_name(Relation relation) {
    switch (relation) {
        case Relation::Beside: return "beside";
        case Relation::Left: return "left";
        case Relation::Right: return "right";
        case Relation::Behind: return "behind";
        case Relation::Before: return "before";
        case Relation::Under: return "under";
        default: return {};
    }
}

}  // namespace gse::language
