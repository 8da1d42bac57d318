// Prepositions and what they say of source and target.
#include "engine/edit/request/relation.h"

#include <algorithm>
#include <cstddef>
#include <map>

#include "engine/edit/request/request.h"

namespace gse::edit {
namespace {

using Words = std::vector<std::string>;

const std::map<std::string, Relation>& prepositions() {
    static const std::map<std::string, Relation> all{{"on", Relation::Above},
                                                     {"above", Relation::Above},
                                                     {"over", Relation::Above},
                                                     {"atop", Relation::Above},
                                                     {"on top of", Relation::Above},
                                                     {"upon", Relation::Above},
                                                     {"beside", Relation::Beside},
                                                     {"near", Relation::Beside},
                                                     {"by", Relation::Beside},
                                                     {"next to", Relation::Beside},
                                                     {"close to", Relation::Beside},
                                                     {"alongside", Relation::Beside},
                                                     {"left of", Relation::Left},
                                                     {"to the left of", Relation::Left},
                                                     {"on the left of", Relation::Left},
                                                     {"right of", Relation::Right},
                                                     {"to the right of", Relation::Right},
                                                     {"on the right of", Relation::Right},
                                                     {"behind", Relation::Behind},
                                                     {"in back of", Relation::Behind},
                                                     {"in front of", Relation::Before},
                                                     {"before", Relation::Before},
                                                     {"under", Relation::Under},
                                                     {"below", Relation::Under},
                                                     {"beneath", Relation::Under},
                                                     {"underneath", Relation::Under}};
    return all;
}

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
Relation leading_to(const Words& terms, std::size_t head) {
    for (std::size_t i = head; i > 0; --i)
        if (ends_phrase(terms[i - 1])) return relation_named(terms[i - 1]).value_or(Relation::None);
    return Relation::None;
}

}  // namespace

const std::vector<std::string>& compound_prepositions() {
    static const Words all = [] {
        Words compounds;
        for (const auto& entry : prepositions())
            if (entry.first.find(' ') != std::string::npos) compounds.push_back(entry.first);
        return compounds;
    }();
    return all;
}

std::optional<Relation> relation_named(const std::string& preposition) {
    const auto found = prepositions().find(preposition);
    return found == prepositions().end() ? std::nullopt : std::optional(found->second);
}

bool names_thing(const std::vector<std::string>& terms, std::size_t i) {
    do ++i;
    while (i < terms.size() && terms[i].ends_with("ing") && !ends_phrase(terms[i]));
    return i == terms.size() || ends_phrase(terms[i]);
}

Relation relation_of(const std::string& sentence, const std::string& source, const std::string& target) {
    const Words terms = noun_terms(sentence, {source, target});
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

}  // namespace gse::edit
