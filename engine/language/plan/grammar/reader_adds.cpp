// Orders that add things and copies.
#include <algorithm>

#include "engine/language/plan/grammar/reader.h"

namespace gse::language::plan {

/// "on its head", "in its hand": worn, held, or on that part; false where `where` is none.
bool Reader::place_on_body(const Phrase& phrase, const Target& thing, Target body, const Phrase& where,
                           std::string_view relation) {
    const bool holds = relation == "in" && has(Class::hand, word_of(where.typed).singular) &&
                       !is_worn(phrase) && d_.can_wear(body);
    if (!on_bearer(where, body)) return false;
    const bool worn = is_worn(phrase) && d_.can_wear(body);
    Target whole = body;
    whole.reference.links = {body.reference.links.back()};
    const std::string_view how = worn ? "worn by" : holds ? "held by" : relation.empty() ? "on" : relation;
    d_.set_anchor(thing, how, worn || holds ? whole : body);
    return true;
}

/// "between the statue and the vase", "between the bear and the camera".
bool Reader::place_between(const Target& thing, const Target& anchor) {
    Phrase second;
    if (!c_.take_phrase(second)) return fail(reason::Incomplete);
    if (has(Class::seen_by, second.noun) && d_.things_named(second).empty()) {
        d_.set_anchor(thing, "in front of", anchor);
        return true;
    }
    const bool is_new = second.indefinite && is_thing(second) && !d_.resolve(second).found();
    const auto other = is_new ? d_.add(second, "beside", {anchor}) : expect(second);
    if (!other.found()) return false;
    d_.set_anchors(thing, "between", {anchor, other});
    return true;
}

/// Puts the new thing beside, on or into what `where` names; `relation`: empty = "to".
bool Reader::place_at(const Phrase& phrase, const Target& thing, const Target& bearer, const Phrase& where,
                      std::string_view relation) {
    const auto focus = d_.focus();
    const bool to = relation.empty();
    Target anchor =
        where.naming == Naming::It || where.naming == Naming::Person
            ? (bearer.found() && bearer.kind == Target::Kind::There ? bearer : d_.pronoun(where.naming, true))
            : d_.resolve(where);
    if (where.naming == Naming::They && bearer.found()) anchor = bearer;
    Target body = where.owner || !where.possessive ? focus : bearer;
    const bool bears =
        body.found() && (!where.possessive || d_.can_wear(body) || !has(Class::body_place, where.noun));
    if (!bears) body = d_.pronoun(Naming::Person);
    if (place_on_body(phrase, thing, body, where, relation)) return true;
    if (anchor.kind == Target::Kind::Ambiguous) return fail(reason::Ambiguous);
    if (!anchor.found() && relation == "in" && has(Class::backdrop, where.noun) && focus.found()) {
        d_.set_anchor(thing, "behind", focus);  // "in the background"
        return true;
    }
    if (!anchor.found()) {
        if (is_ground(where) && !where.definite) {
            d_.ground(where);
            return true;
        }
        missing_ = anchor.word.empty() ? where.noun : anchor.word;
        return fail(reason::NotInScene);
    }
    if (relation == "between" && c_.take(Class::conjunction)) return place_between(thing, anchor);
    const bool on_body =
        (to || relation == "on" || relation == "around") && is_worn(phrase) && d_.can_wear(anchor);
    std::string_view how = on_body ? std::string_view("worn by")
                           : to    ? (is_held(phrase) && d_.can_wear(anchor) ? std::string_view("held by")
                                      : anchor.is_scene()                    ? std::string_view("in")
                                      : d_.is_animate(anchor)                ? std::string_view("beside")
                                                                             : std::string_view("on"))
                                   : relation;
    const bool floor = !phrase.has_determiner() || has(Class::ground_name, phrase.noun);
    if (relation == "under" && is_ground(phrase) && floor && anchor.thing && d_.last_is(thing)) {
        d_.drop_last();  // "put gravel under the bear"
        d_.ground(phrase);
        return true;
    }
    d_.set_anchor(thing, how, anchor);
    if (anchor.thing)
        apply_all({anchor},
                  where.attributes.empty() || where.definite ? std::vector<Attribute>{} : where.attributes);
    return true;
}

/// "on the bear's left": the relation, and whose side it is; empty for other places.
std::string_view Reader::take_side(Target& whose) {
    Cursor ahead = c_;
    Phrase owner;
    if (!ahead.is(Class::word_on) && !ahead.is(Class::word_to) && !ahead.is(Class::word_at)) return {};
    ++ahead.at;
    if (!ahead.take_phrase(owner) || owner.owner || !ahead.is_owner_mark()) return {};
    ++ahead.at;
    const auto side = ahead.take(Class::side).value;
    if (side != "left" && side != "right") return {};
    if (ahead.word().text == "side") ++ahead.at;
    whose = d_.resolve(owner);
    if (!whose.found() || !(ahead.at_end_of_clause() || ahead.peek(Class::conjunction))) return {};
    c_.at = ahead.at;
    return side == "left" ? "left of" : "right of";
}

/// "(a tree) to the left": of what the sentence is about.
bool Reader::place_aside(const Target& thing) {
    Target whose;
    if (const auto relation = take_side(whose); !relation.empty()) {
        d_.set_anchor(thing, relation, whose);
        return true;
    }
    const auto side = c_.peek(Class::direction);
    const bool aside = side.length > c_.peek(Class::relation).length && !c_.peek(Class::of, side.length) &&
                       (side.value == "left" || side.value == "right");
    if (!aside) return false;
    c_.at += side.length;
    if (d_.focus().found()) d_.set_anchor(thing, side.value == "left" ? "left of" : "right of", d_.focus());
    return true;
}

/// A new thing and its place.
bool Reader::place_new(const Phrase& phrase, Targets& made) {
    if (!is_thing(phrase)) return false;
    const auto focus = d_.focus();
    const bool last = d_.last() && d_.last()->found() && !d_.is_removed(*d_.last());
    const auto bearer = last ? *d_.last() : focus;  // "remove the grass and add a chair behind it"
    const bool wears = is_worn(phrase) && d_.can_wear(focus) && !has(Class::ground, phrase.noun);
    Target thing = wears ? d_.add(phrase, "worn by", {focus}) : d_.add(phrase, "in", {d_.scene_target()});
    if (thing.kind == Target::Kind::There) {
        nested(thing, focus);
        return true;
    }
    made.push_back(thing);
    bool placed = false;  // at a thing of the scene
    while (true) {
        const std::size_t start = c_.at;
        while (c_.take(Class::emerging) || c_.take(Class::pose)) {}
        if (c_.is(Class::word_down) && c_.peek(Class::relation, 1)) ++c_.at;  // "set it down beside"
        if (place_aside(thing)) continue;
        if (c_.peek(Class::rather_than).length > c_.peek(Class::relation).length) break;  // "in place of"
        auto relation = c_.take(Class::relation);
        const bool to = !relation && (c_.is(Class::word_to) || c_.is(Class::word_for));
        if (to) ++c_.at;
        if (!relation && !to) {
            c_.at = start;
            break;
        }
        Phrase where;
        const std::size_t before = c_.at;
        if (!c_.take_phrase(where)) {
            c_.at = before;
            if (c_.at_end_of_clause() || c_.peek(Class::conjunction)) {
                if (focus.found() && relation)
                    d_.set_anchor(thing, relation.value == "in" ? std::string_view("beside") : relation.value,
                                  focus);
                continue;
            }
            c_.at = start;
            return fail(reason::Incomplete);
        }
        const auto there = d_.resolve(where);
        const bool which = !to && placed && there.thing && where.definite;  // "the wall behind him"
        if (which) continue;
        if (!place_at(phrase, thing, bearer, where, relation ? relation.value : std::string_view()))
            return false;
        placed = where.definite && there.thing && !d_.scene().things[*there.thing].is_ground;
    }
    d_.mention(thing);
    nested(thing, bearer);
    while (c_.peek(Class::having) && !c_.peek(Class::conjunction)) {
        const std::size_t start = c_.at;
        if (!post(thing)) {
            c_.at = start;
            break;
        }
    }
    return true;
}

/// "(add) fog", "(put) snow".
bool Reader::add_surroundings(const Phrase& phrase) {
    if (const auto weather = meaning(Class::environment, phrase.noun);
        weather && (c_.at_end_of_clause() || c_.peek(Class::conjunction))) {
        d_.environment(std::string(*weather));
        return true;
    }
    if (!is_ground(phrase) || phrase.has_determiner() || !c_.done() || !d_.things_named(phrase).empty() ||
        has(Class::thing, phrase.noun) || is_worn(phrase))
        return false;
    d_.ground(phrase);
    return true;
}

/// "(apply) a coat of gold to the bear".
bool Reader::add_paint(const Phrase& phrase) {
    if (!has(Class::colour_word, phrase.noun) || phrase.attributes.empty()) return false;
    Cursor onto = c_;
    Phrase what;
    const bool placed = (onto.take(Class::to) || onto.take(Class::relation)) && onto.take_phrase(what);
    const auto target = placed ? d_.resolve(what) : d_.focus();
    if (!target.found() || !onto.at_end_of_clause()) return false;
    c_.at = onto.at;
    return apply_all({target}, phrase.attributes);
}

/// "remove it and put a tree there", "(put) a pig in its place"; nothing where it stands in no place of
/// another.
std::optional<bool> Reader::add_in_place(const Phrase& phrase, const Target& found) {
    if (found.found()) return std::nullopt;
    if (c_.is(Class::word_there) && d_.removed_last()) {
        ++c_.at;
        return become({*d_.removed_last()}, phrase);
    }
    Target place;
    if (stands_where(place) || in_place_of(place)) return become({place}, phrase);
    return std::nullopt;
}

/// "(put) a flower pattern on the vase".
bool Reader::add_pattern(const Phrase& phrase) {
    Cursor place = c_;
    Phrase where;
    const auto relation = place.take(Class::relation);
    const bool placed = (relation || place.take(Class::to)) && place.take_phrase(where);
    const auto named = placed ? d_.resolve(where) : Target{};
    const auto whose = named.found() ? named : d_.focus();
    const bool thing =
        has(Class::thing, phrase.noun) && relation && relation.value != "on";  // "a rainbow over"
    if (thing || !whose.found() || !own_pattern(whose, phrase)) return false;
    if (placed) c_.at = place.at;
    return true;
}

/// One thing of a list that is added.
bool Reader::add_one() {
    Phrase phrase;
    Targets made;
    if (!c_.take_phrase(phrase)) return c_.at_end_of_clause() ? fail(reason::Incomplete) : false;
    if (phrase.naming != Naming::Thing) {
        const auto found = d_.resolve(phrase);
        if (!found.found()) return fail(reason::Incomplete);
        return move_target(found);
    }
    if (phrase.noun.empty()) return fail(reason::Incomplete);
    if (c_.is(Class::word_there) && c_.peek(Class::rather_than, 1)) ++c_.at;  // "put a cat there instead of"
    Cursor choice = c_;
    if (choice.take(Class::alternative)) return fail(reason::Ambiguous);
    if (one_more(phrase)) return true;
    const auto focus = d_.focus();
    if (add_paint(phrase)) return true;
    if (add_pattern(phrase)) return true;
    if (add_surroundings(phrase)) return true;
    const auto found = d_.resolve(phrase);
    const bool there = found.found() && found.thing && !phrase.another && phrase.count.empty() &&
                       (phrase.definite || (!is_worn(phrase) && !phrase.indefinite));
    if (there) {
        d_.mention(found);
        if (!move_target(found)) return false;
        return true;
    }
    const bool known = puts_ && (kinds_of(phrase.noun) & (Artifact | Animal | Person | Vehicle | Plant)) != 0;
    if (!found.found() && phrase.definite && !phrase.possessive && (is_worn(phrase) || known) &&
        found.kind == Target::Kind::Missing) {
        missing_ = phrase.noun;  // "place the hat on the grass"
        return fail(reason::NotInScene);
    }
    if (found.found() && !found.thing && phrase.owner) return fail(reason::Ambiguous);  // a part moves alone
    if (found.found() && phrase.definite && !is_part(phrase)) return move_target(found);  // "stack the books"
    if (const auto read = add_in_place(phrase, found)) return *read;
    const std::size_t steps = d_.size();
    if (!place_new(phrase, made)) return false;
    Cursor other = c_;
    Phrase old;
    if (other.take(Class::rather_than) && other.take_phrase(old) && d_.resolve(old).found() &&
        d_.size() == steps + 1) {  // "add wheels instead of legs"
        c_.at = other.at;
        d_.drop_last();
        return become({d_.resolve(old)}, phrase);
    }
    Cursor more = c_;
    more.take_mark(',');
    if (more.take(Class::contrast)) {  // "but not a red one"
        Phrase unwanted;
        if (more.take(Class::negation) && more.take_phrase(unwanted)) c_.at = more.at;
    }
    return true;
}

bool Reader::add_clause() {
    const bool paints = !c_.peek(Class::verb_add);
    const auto& base = c_.word().base;
    puts_ = base == "put" || base == "place" || base == "set" || base == "move";
    if (!c_.take(Class::verb_add) && !c_.take(Class::verb_recolour) && !c_.take(Class::verb_carve) &&
        !c_.take(Class::verb_make) && !c_.take(Class::verb_move))
        return false;
    c_.take(Class::as_well);
    if (c_.done()) return fail(reason::Incomplete);
    Phrase begin;
    Cursor probe = c_;
    if (paints && (!probe.take_phrase(begin) || begin.definite || begin.naming != Naming::Thing ||
                   begin.possessive || !begin.has_determiner()))
        return false;  // "make the hat blue" adds none
    frame_ = Frame::Add;
    Phrase phrase;
    Attribute pattern;
    Cursor dots = c_;  // "put white polka dots on the bear"
    dots.take(Class::article);
    if (dots.take_attribute(pattern, false) && pattern.quality == Quality::Pattern &&
        (dots.take(Class::relation) || dots.take(Class::to)) && dots.take_phrase(phrase) &&
        d_.resolve(phrase).found()) {
        c_.at = dots.at;
        return apply_all({d_.resolve(phrase)}, {pattern});
    }
    const std::size_t first = d_.size();
    do {
        if (!add_one()) return false;
    } while (list_goes_on());
    d_.share_place(first);
    return true;
}

/// The last verb goes on: "paint the bear green, the grass white", "remove the hat and the scarf".
bool Reader::ellipsis() {
    const std::size_t start = c_.at;
    if (starts_verb()) return false;
    Phrase phrase;
    Cursor ahead = c_;
    if (!ahead.take_phrase(phrase)) return false;
    if (const auto receiver = d_.resolve(phrase);
        frame_ == Frame::Give && phrase.definite && receiver.found() && ahead.is(Class::word_a)) {
        c_.at = ahead.at;  // "give the frog a crown and the bear a hat"
        if (has_list(receiver, "with")) return true;
        c_.at = start;
        return false;
    }
    if (frame_ == Frame::Add || frame_ == Frame::Give) {
        if (ahead.peek(Class::copula) || ahead.peek(Class::modal) || ahead.is_mark(":") ||
            phrase.naming != Naming::Thing || phrase.noun.empty() || phrase.none)
            return false;
        if (frame_ == Frame::Add && phrase.definite && d_.resolve(phrase).found()) return false;
        if (ahead.peek(Class::rather_than)) return false;  // "snow instead of grass"
        c_.at = ahead.at;
        if (one_more(phrase)) return true;
        if (frame_ == Frame::Give && d_.last()) {
            const auto bearer = d_.pronoun(Naming::It, true);
            if (bearer.found() && own(bearer, phrase, "with")) return true;
        }
        Targets made;
        if (place_new(phrase, made)) return true;
        c_.at = start;
        return false;
    }
    const auto found = d_.resolve(phrase);
    if (!found.found() || ahead.peek(Class::copula) || ahead.peek(Class::modal) || phrase.indefinite)
        return false;
    c_.at = ahead.at;
    if (frame_ == Frame::Remove) {
        Attribute how;
        if (c_.take_attribute(how, false)) {  // "remove chair, vase blue"
            c_.at = start;
            return false;
        }
        d_.remove(found);
        return true;
    }
    if (c_.is(Class::word_to) || c_.is(Class::word_with) || c_.is(Class::word_by)) ++c_.at;
    if (!c_.at_end_of_clause() && complement({found})) return true;
    c_.at = start;
    return false;
}

bool Reader::give_clause() {
    if (!c_.peek(Class::verb_give)) return false;
    const bool gives = c_.is(Class::word_give) || !c_.peek(Class::verb_make);
    c_.take(Class::verb_give);
    if (!gives) return false;
    if (c_.is(Class::word_to) && starts_object(1)) ++c_.at;  // "give to the bear a crown"
    Targets targets;
    Phrase first;
    Cursor ahead = c_;
    if (!ahead.take_phrase(first, true)) return fail(reason::Incomplete);
    const bool whom = first.possessive && ahead.at_end_of_clause() && c_.peek(Class::pronoun_person);
    if (whom) {  // "give her long hair"
        ahead = c_;
        ahead.take(Class::pronoun_person);
        first = {};
        first.naming = Naming::Person;
    }
    Target receiver = first.naming == Naming::It ? d_.pronoun(Naming::It, true) : d_.resolve(first);
    const bool indirect = !receiver.found() || first.indefinite;
    if (indirect && first.naming == Naming::Thing && ahead.is(Class::word_to)) {  // "give a hat to the bear"
        Phrase second;
        ++ahead.at;
        if (!ahead.take_phrase(second)) return fail(reason::Incomplete);
        receiver = second.naming == Naming::It ? d_.pronoun(Naming::It, true) : expect(second);
        if (!receiver.found()) return false;
        c_.at = ahead.at;
        return own(receiver, first, "with");
    }
    if (!receiver.found()) return expect(first).found();
    c_.at = ahead.at;
    targets.push_back(receiver);
    while (c_.peek(Class::conjunction)) {  // "give the bear and the cat hats"
        Phrase more;
        Cursor list = c_;
        list.take(Class::conjunction);
        if (!list.take_phrase(more, true) || !d_.resolve(more).found()) break;
        c_.at = list.at;
        targets.push_back(d_.resolve(more));
    }
    if (c_.is(Class::word_with) || c_.is(Class::word_a) == false) c_.take(Class::having);
    if (c_.at_end_of_clause()) return fail(reason::Incomplete);
    frame_ = Frame::Give;
    const std::size_t here = c_.at;
    const auto size = d_.size();
    for (const auto& target : targets) {
        c_.at = here;
        if (!has_list(target, "with")) {
            (void)size;
            return false;
        }
        posts(target);
    }
    if (d_.size() == size) d_.mention(receiver);
    return true;
}

bool Reader::dress_clause() {
    if (!c_.take(Class::verb_dress)) return false;
    Targets targets;
    if (!objects(targets)) return false;
    if (c_.is(Class::word_up)) ++c_.at;
    if (c_.is(Class::word_as) || c_.is(Class::word_like)) {
        ++c_.at;
        Phrase role;
        if (!c_.take_phrase(role) || role.noun.empty()) return fail(reason::Incomplete);
        for (const auto& target : targets) d_.step(Operation::Alter, target, role.typed);
        return true;
    }
    if (!c_.is(Class::word_in) && !c_.is(Class::word_with)) return fail(reason::Incomplete);
    ++c_.at;
    Attribute colour;
    Cursor ahead = c_;
    if (ahead.take_attribute(colour, false) && ahead.at_end_of_clause()) {
        if (colour.quality != Quality::Pattern) return false;
        c_.at = ahead.at;  // "dress the bear up in stripes"
        return apply_all(targets, {colour});
    }
    return has_list(targets.front(), "worn by");
}

/// "(cover the bear) in mud", which is a material too.
bool Reader::covers_plainly(const Targets& targets) {
    Cursor plain = c_;
    const bool ground = targets.front().thing && d_.scene().things[*targets.front().thing].is_ground;
    const auto stuff = plain.take(Class::covering);
    if (!stuff || ground || !ends_at(plain) || plain.previous().text != plain.previous().singular)
        return false;
    c_.at = plain.at;
    return apply_all(targets, {{Quality::Material, std::string(stuff.value), std::string(stuff.value), ""}});
}

bool Reader::cover_clause() {
    const bool around = c_.peek(Class::verb_around).length > 0, fills = c_.peek(Class::verb_fill).length > 0;
    const auto wear = c_.peek(Class::verb_wear);
    if (!c_.take(Class::verb_cover) && !c_.take(Class::verb_wear)) return false;
    Targets targets;
    if (!objects(targets)) return fail(reason_.empty() ? reason::Incomplete : reason_), false;
    if (wear && ends_well() && d_.can_wear(targets.front())) {  // "crown the bear"
        Phrase clothes;
        clothes.noun = clothes.typed = wear.value;
        for (const auto& target : targets) d_.add(clothes, "worn by", {target});
        return true;
    }
    if (targets.front().kind == Target::Kind::Made && around)  // "put a crown on it and surround it"
        targets.front() = d_.pronoun(Naming::It, true);
    const auto relation = c_.peek(Class::relation);
    if (!c_.is(Class::word_in) && !c_.is(Class::word_with) && !c_.is(Class::word_by)) return false;
    (void)relation;
    ++c_.at;
    if (!around && !fills && covers_plainly(targets)) return true;
    Cursor ahead = c_;
    std::vector<Attribute> found;
    Attribute next;
    ahead.take(Class::article);
    const bool things =
        ahead.word().text != ahead.word().singular && ahead.noun_length() > 0;  // "with flowers"
    while (!things && !fills && ahead.take_attribute(next, true)) found.push_back(next);
    const auto covering = ahead.peek(Class::covering);
    if (covering && !around && !fills) {
        ahead.at += covering.length;
        c_.at = ahead.at;
        return apply_all(targets,
                         {{Quality::Material, std::string(covering.value), std::string(covering.value), ""}});
    }
    if (!found.empty() && ahead.at_end_of_clause()) {
        c_.at = ahead.at;
        return apply_all(targets, found);
    }
    Phrase phrase;
    if (!c_.take_phrase(phrase) || phrase.noun.empty()) return fail(reason::Incomplete);
    for (const auto& target : targets) {
        if (own_pattern(target, phrase)) continue;
        if (target.thing && d_.scene().things[*target.thing].is_ground && is_ground(phrase) &&
            !has(Class::floating, phrase.typed)) {  // "pave the lawn with cobblestones"
            d_.ground(phrase);
            continue;
        }
        const auto made = d_.add(phrase,
                                 around            ? "around"
                                 : fills           ? "in"
                                 : is_worn(phrase) ? "worn by"
                                                   : "on",
                                 {target});
        d_.mention(made);
        nested(made, target);
    }
    return true;
}

}  // namespace gse::language::plan
