// Copies and exchanges: "another bear", "two bears", "a copy of the bear", "swap the cars".
#include <algorithm>

#include "engine/language/plan/grammar/reader.h"

namespace gse::language::plan {

/// "another bear, a green one, next to it", "two more bears".
void Reader::add_another(const Phrase& phrase, const Target& target, const std::string& noun) {
    Cursor ahead = c_;
    Phrase colour;
    const bool told = !phrase.attributes.empty() || (ahead.take_mark(',') && ahead.take_phrase(colour) &&
                                                     colour.noun.empty() && !colour.attributes.empty());
    if (told) {
        Phrase second = phrase;
        if (phrase.attributes.empty()) {
            second.attributes = colour.attributes;
            c_.at = ahead.at;
        }
        second.noun = noun;
        const auto made = d_.add(second, "beside", {target});
        c_.take_mark(',');
        nested(made, target);
    } else if (c_.peek(Class::relation) && !c_.is(Class::word_in) &&
               !c_.is(Class::word_on)) {  // "a second bear to the left of it"
        Phrase second = phrase;
        second.noun = noun;
        const auto made = d_.add(second, "beside", {target});
        nested(made, target);
    } else {
        const int more = phrase.count.empty() || phrase.count == "some" ? 1 : std::atoi(phrase.count.c_str());
        d_.duplicate(target, phrase.plural && phrase.count.empty() ? "some"
                             : phrase.count == "some"              ? "some"
                                                                   : std::to_string(more + 1));
        nested(target, target);
        Cursor place = c_;
        Phrase where;
        if (place.take(Class::relation) && place.take_phrase(where) && d_.resolve(where).found())
            c_.at = place.at;
    }
}

/// "small boats around the boat", "a baby bear next to the bear": new ones.
bool Reader::beside_its_like(const Phrase& phrase, const Target& target) {
    Cursor around = c_;
    Phrase where;
    const auto relation = around.take(Class::relation);
    if (!relation || !around.take_phrase(where) || !where.definite || where.naming != Naming::Thing ||
        where.noun.empty() || !around.at_end_of_clause() || !target.thing ||
        !(d_.resolve(where).reference == target.reference))
        return false;
    c_.at = around.at;
    Phrase more = phrase;
    more.noun = d_.scene().things[*target.thing].noun;
    d_.mention(d_.add(more, relation.value, {target}));
    return true;
}

/// "two copies of the bear": so many more.
bool Reader::copies(const Phrase& phrase) {
    Cursor ahead = c_;
    Phrase model;
    if (!has(Class::copy_name, phrase.noun) || !ahead.take(Class::of) || !ahead.take_phrase(model))
        return false;
    const auto target = model.naming == Naming::It ? d_.pronoun(Naming::It) : d_.resolve(model);
    if (!target.thing || d_.scene().things[*target.thing].is_ground) return false;
    c_.at = ahead.at;
    d_.mention(target);
    add_another(phrase, target, d_.scene().things[*target.thing].noun);
    return true;
}

/// "another bear", "two bears", "one more bear": copies of what is there.
bool Reader::one_more(const Phrase& phrase) {
    if (copies(phrase)) return true;
    const bool ordinal =
        std::any_of(phrase.attributes.begin(), phrase.attributes.end(),
                    [](const Attribute& each) { return each.typed == "third" || each.typed == "fourth"; });
    if (!phrase.another && !ordinal && (phrase.count.empty() || phrase.count == "all") && !phrase.plural)
        return false;
    const auto found = d_.things_named(phrase);
    if (found.empty() || d_.scene().things[found.front()].is_ground || phrase.owner || phrase.definite)
        return false;
    const auto& noun = d_.scene().things[found.front()].noun;
    const auto same = std::count_if(d_.scene().things.begin(), d_.scene().things.end(),
                                    [&](const SceneThing& thing) { return thing.noun == noun; });
    if (same > 1 && (phrase.another || ordinal) && phrase.count.empty() && ends_well()) {
        Phrase all = phrase;  // "add a third chair" to two
        all.count = "all";
        all.attributes.clear();
        const auto target = d_.resolve(all);
        if (target.found()) d_.duplicate(target, std::to_string(same + 1));
        return target.found();
    }
    if (same > 1 && phrase.count == std::to_string(same) && !phrase.attributes.empty() && !phrase.another) {
        for (const auto index : found) apply_all({d_.target_of_thing(index)}, phrase.attributes);
        return true;  // "two red cars" of two
    }
    if (const int count = std::atoi(phrase.count.c_str()); same > 1 && count > same && ends_well()) {
        Phrase all = phrase;  // "three chairs" of two
        all.count = "all";
        all.attributes.clear();
        const auto target = d_.resolve(all);
        if (target.found()) d_.duplicate(target, phrase.count);
        return target.found();
    }
    if (same > 1) return false;
    if (phrase.typed == noun && !phrase.another && phrase.count.empty()) return false;  // "autumn trees"
    if (has(Class::pair_noun, noun)) return false;
    if (!phrase.another && phrase.noun != noun && noun.find(phrase.noun) == std::string::npos &&
        !are_synonyms(noun, phrase.noun))
        return false;
    const auto target = d_.target_of_thing(found.front());
    d_.mention(target);
    if (phrase.another) {
        add_another(phrase, target, noun);
        return true;
    }
    if (beside_its_like(phrase, target)) return true;
    apply_all({target}, phrase.attributes);
    described_ = target;
    d_.duplicate(target, phrase.count.empty() ? "some" : phrase.count);
    posts(target);
    return true;
}

bool Reader::duplicate_clause() {
    if (!c_.take(Class::verb_duplicate)) return false;
    Targets targets;
    if (!objects(targets)) return c_.done() && reason_.empty() ? fail(reason::Incomplete) : false;
    std::string count = "2";
    if (const auto times = c_.take(Class::times))
        count = std::to_string(std::atoi(std::string(times.value).c_str()) + 1);
    else if (c_.word(1).text == "times" && !c_.word().text.empty() &&
             std::isdigit(static_cast<unsigned char>(c_.word().text[0])) != 0) {
        count = std::to_string(std::atoi(c_.word().text.c_str()) + 1);
        c_.at += 2;
    }
    for (const auto& target : targets) d_.duplicate(target, count);
    return true;
}

/// "a red car and a green car" of two cars: how the other one is.
bool Reader::describe_other(const Phrase& phrase) {
    const auto& things = d_.scene().things;  // "a red car and a green car" of two cars
    const auto& noun = things[*described_->thing].noun;
    Targets others;
    for (std::size_t i = 0; i < things.size(); ++i)
        if (i != *described_->thing && things[i].noun == noun && noun == phrase.noun)
            others.push_back(d_.target_of_thing(i));
    if (others.size() == 1) {
        apply_all(others, phrase.attributes);
        return true;
    }
    return false;
}

/// "a yellow car and a blue car" of two cars: the first is the other one; nothing where no such things are
/// there.
std::optional<bool> Reader::describe_one_of(const Phrase& phrase) {
    const auto all = d_.things_named(phrase);
    if (described_ || phrase.another || all.size() < 2) return std::nullopt;
    Cursor list = c_;
    Phrase kept;
    const auto found = list.take(Class::conjunction) && list.take_phrase(kept) ? d_.resolve(kept) : Target{};
    if (all.size() != 2 || !found.thing || !list.at_end_of_clause()) return fail(reason::Ambiguous);
    c_.at = list.at;
    return apply_all({d_.target_of_thing(all[0] == *found.thing ? all[1] : all[0])}, phrase.attributes);
}

/// "replace red with yellow": of what is red.
bool Reader::swaps_colours() {
    Cursor ahead = c_;
    Attribute old, made;
    if (!ahead.take_attribute(old, false) || old.quality != Quality::Colour) return false;
    const bool joint = ahead.is(Class::word_with) || ahead.is(Class::word_by) || ahead.is(Class::word_for) ||
                       ahead.is(Class::word_to);
    if (!joint && !ahead.peek(Class::into)) return false;
    ++ahead.at;
    ahead.take(Class::article);
    if (!ahead.take_attribute(made, false) || made.quality != Quality::Colour || !ahead.at_end_of_clause())
        return false;
    Targets coloured;
    const auto& things = d_.scene().things;
    for (std::size_t i = 0; i < things.size(); ++i)
        if (std::find(things[i].attributes.begin(), things[i].attributes.end(), old.value) !=
            things[i].attributes.end())
            coloured.push_back(d_.target_of_thing(i));
    if (coloured.empty()) return false;
    c_.at = ahead.at;
    return apply_all(coloured, {made});
}

/// "(make the cars) change places".
bool Reader::swaps_places(const Targets& targets) {
    Cursor ahead = c_;
    if (!ahead.take(Class::swap_places) || !ahead.at_end_of_clause()) return false;
    c_.at = ahead.at;
    return swap_all(targets);
}

/// Swaps two things, or the two of one kind.
bool Reader::swap_all(const Targets& targets) {
    if (targets.size() == 2) {
        d_.move(targets[0], "swap with", targets[1]);
        return true;
    }
    if (targets.size() != 1 || targets[0].reference.links[0].count != "all") return false;
    Targets two;  // "swap the cars"
    for (std::size_t i = 0; i < d_.scene().things.size(); ++i)
        if (d_.scene().things[i].noun == targets[0].reference.root()) two.push_back(d_.target_of_thing(i));
    if (two.size() != 2 || two[0].reference == two[1].reference) return fail(reason::Ambiguous);
    d_.move(two[0], "swap with", two[1]);
    return true;
}

bool Reader::swap_clause() {
    if (!c_.take(Class::verb_swap)) return false;
    if (swaps_colours()) return true;
    Cursor positions = c_;
    positions.take(Class::definite);
    if (positions.is(Class::word_positions) || positions.is(Class::word_places) ||
        positions.is(Class::word_position) || positions.is(Class::word_place)) {
        ++positions.at;
        if (positions.take(Class::of)) c_.at = positions.at;
    }
    Targets targets;
    const std::size_t start = c_.at;
    Phrase quality;
    Cursor of = c_;
    if (of.take_phrase(quality) && quality.owner && !is_part(quality))
        return fail(reason::NotASentence);  // "the colors of"
    if (!objects(targets)) return false;
    if (ends_well() && swap_all(targets)) return true;
    if (!reason_.empty()) return false;
    if (targets.size() == 1 && (c_.is(Class::word_with) || c_.is(Class::word_and))) {
        Cursor ahead = c_;
        ++ahead.at;
        Phrase other;
        if (ahead.take_phrase(other)) {
            const auto found = d_.resolve(other);
            if (found.thing && !(found.reference == targets[0].reference) && !other.indefinite) {
                c_.at = ahead.at;
                d_.move(targets[0], "swap with", found);
                return true;
            }
        }
    }
    c_.at = start;
    return false;
}

/// "replace the bear and the grass with a cat and snow": one by one; a single thing takes the place of all.
bool Reader::become_each(const Targets& targets, const Phrase& first) {
    std::vector<Phrase> things{first};
    Cursor list = c_;
    for (Phrase next; (list.take_mark(','), list.take(Class::conjunction), list.at > c_.at) &&
                      !starts_verb(list.at - c_.at) && list.take_phrase(next) && !next.noun.empty();) {
        things.push_back(next);
        c_.at = list.at;
    }
    if (things.size() == targets.size()) {
        for (std::size_t i = 0; i < things.size(); ++i)
            if (!become({targets[i]}, things[i])) return false;
        return true;
    }
    if (things.size() > 1) return fail(reason::NotASentence);
    if (!first.indefinite || first.plural) return become(targets, first);
    if (!become({targets.front()}, first)) return false;
    for (std::size_t i = 1; i < targets.size(); ++i) d_.remove(targets[i]);
    return true;
}

/// "(replace it with two dogs) and a cat": the further ones stand beside the first.
void Reader::add_beside() {
    Cursor more = c_;
    while (more.take_mark(','), more.take(Class::conjunction), more.at > c_.at) {
        Phrase next;
        Cursor behind = more;
        const bool is_new = !starts_verb(more.at - c_.at) && behind.take_phrase(next) && next.indefinite &&
                            is_thing(next) && !is_worn(next) && !d_.resolve(next).found() && ends_at(behind);
        if (!is_new || !d_.last()) break;
        d_.add(next, "beside", {*d_.last()});
        c_.at = more.at = behind.at;
    }
}

}  // namespace gse::language::plan
