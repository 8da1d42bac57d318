// Orders that take away, and those that keep.
#include <algorithm>

#include "engine/language/plan/grammar/reader.h"

namespace gse::language::plan {
namespace {

/// Steps over "stays as it is".
bool stays(Cursor& here) {
    const bool said = here.is(Class::word_stays) || here.is(Class::word_stay) ||
                      here.is(Class::word_remains) || here.is(Class::word_remain) ||
                      here.is(Class::word_unchanged) || here.is(Class::word_untouched);
    if (!said) return false;
    while (!here.at_end_of_clause() && !here.peek(Class::contrast) && !here.peek(Class::conjunction))
        ++here.at;
    return true;
}

}  // namespace

/// "off the bear", "out of here", "from the table"; a part is of what is named there.
void Reader::skip_from(Targets& targets) {
    Cursor with = c_;  // "the vase with the flower"
    Phrase along;
    if (with.take(Class::having) && with.take_phrase(along) && along.definite && d_.resolve(along).thing &&
        with.at_end_of_clause()) {
        c_.at = with.at;
        targets.push_back(d_.resolve(along));
    }
    while (c_.take(Class::gone) || c_.is(Class::word_off) || c_.is(Class::word_out) ||
           c_.is(Class::word_down) || c_.is(Class::word_away)) {
        if (c_.is(Class::word_off) || c_.is(Class::word_out) || c_.is(Class::word_down) ||
            c_.is(Class::word_away))
            ++c_.at;
    }
    Cursor off = c_;
    Phrase bearer;
    if (c_.at > 0 && off.take_phrase(bearer) && d_.resolve(bearer).found() &&
        (bearer.naming == Naming::Thing || bearer.naming == Naming::Person))
        c_.at = off.at;
    if (c_.take(Class::from) || c_.is(Class::word_of) || c_.peek(Class::relation)) {
        if (c_.is(Class::word_of)) ++c_.at;
        if (c_.peek(Class::relation)) c_.take(Class::relation);
        Phrase whole;
        Cursor place = c_;
        if (place.take_phrase(whole)) {
            c_.at = place.at;
            if (targets.size() == 1 && targets[0].reference.links.size() > 1 && !targets[0].thing &&
                whole.naming == Naming::Thing && !is_part(whole)) {
                const auto owner = d_.resolve(whole);
                if (owner.found() && !owner.is_scene())
                    targets[0].reference.links.back() = owner.reference.links.back();
            }
        } else if (c_.is(Class::word_here) || c_.is(Class::word_there)) ++c_.at;
    }
}

/// "take it off" of who wears one thing: that thing.
void Reader::take_worn(Targets& targets) const {
    Targets worn;
    for (std::size_t i = 0; i < d_.scene().things.size(); ++i)
        if (d_.scene().things[i].is_worn) worn.push_back(d_.target_of_thing(i));
    if (worn.size() == 1) targets = worn;
}

/// Tells whether a particle behind the object makes a removal of "take" and "get".
bool Reader::takes_away(const Cursor& particle, bool direct, bool gets) const {
    const bool away = particle.is(Class::word_off) || particle.is(Class::word_away) ||
                      particle.is(Class::word_out) || particle.peek(Class::from) ||
                      particle.peek(Class::gone) || particle.is(Class::word_down);
    return away || (direct && !gets);
}

/// "everything on the table": what stands there in the place of the scene; false where nothing does.
bool Reader::take_things_there(Targets& targets) {
    Cursor ahead = c_;
    Phrase place;
    if (!ahead.take(Class::from) && !ahead.take(Class::relation)) return true;
    if (!ahead.take_phrase(place) || place.naming != Naming::Thing) return true;
    const auto found = d_.resolve(place);
    if (!found.thing || d_.scene().things[*found.thing].is_ground) return true;
    Targets worn;  // "everything off the bear"
    for (std::size_t i = 0; d_.can_wear(found) && i < d_.scene().things.size(); ++i)
        if (d_.scene().things[i].is_worn) worn.push_back(d_.target_of_thing(i));
    const auto on = worn.empty() ? things_on(found) : worn;
    if (on.empty()) return fail(reason::Ambiguous);
    c_.at = ahead.at;
    targets = on;
    return true;
}

/// "pull the hat off".
bool Reader::pull_off() {
    Cursor pulled = c_;
    Phrase what;
    const bool tossed = pulled.take(Class::verb_toss).length > 0;  // "throw the hat away"
    if (!tossed && !pulled.take(Class::verb_off)) return false;
    if (!pulled.take_phrase(what)) return false;
    const bool away = tossed && (pulled.is(Class::word_away) || pulled.is(Class::word_out));
    if (!away && !pulled.is(Class::word_off) && (tossed || !pulled.is(Class::word_from))) return false;
    const auto found = expect(what);
    if (!found.found()) return false;
    c_.at = pulled.at;
    Targets off{found};
    skip_from(off);
    remove_all(off);
    return true;
}

bool Reader::remove_clause() {
    const bool takes = c_.is(Class::word_take) || c_.is(Class::word_get) || c_.is(Class::word_cut) ||
                       c_.is(Class::word_put) || c_.is(Class::word_throw) || c_.is(Class::word_wipe) ||
                       c_.is(Class::word_chop) || c_.is(Class::word_clear) || c_.is(Class::word_make);
    if (c_.peek(Class::verb_empty) || c_.peek(Class::verb_relieve)) {
        const std::size_t start = c_.at;
        if (instruct_less_clause()) return true;
        c_.at = start;
        if (!reason_.empty()) return false;
    }
    Cursor verb = c_;
    const auto direct = verb.peek(Class::verb_remove);
    const bool moves = verb.peek(Class::verb_move).length > 0;
    const bool gets = c_.peek(Class::verb_make) && c_.is(Class::word_get);
    if (!direct && pull_off()) return true;
    if (!direct && !gets && !c_.is(Class::word_take)) return false;
    const bool takes_off = takes && c_.is(Class::word_off, 1);
    c_.at += direct ? direct.length : 1;
    if (c_.done()) return fail(reason::Incomplete);
    Targets targets;
    std::vector<Phrase> phrases;
    Phrase first;
    Cursor ahead = c_;
    if (!ahead.take_phrase(first) && !c_.peek(Class::what_stands) && !c_.is(Class::word_what)) return false;
    const auto alone = direct.length < 2 && (gets || takes);
    if (alone) {  // needs a particle: "take the hat off", "get the bear out of here"
        if (!takes_away(ahead, direct.length > 0, gets)) return false;
    }
    if (first.naming == Naming::Thing && !first.noun.empty() && first.indefinite && first.count.empty() &&
        d_.things_named(first).empty() && !is_part(first)) {
        missing_ = first.noun;
        return fail(reason::NotInScene);
    }
    if (!objects(targets, &phrases)) return false;
    const auto& part = targets.front().reference.links.front().noun;
    if (targets.front().reference.links.size() > 1 && has(Class::facial_hair, part)) {
        missing_ = part;  // of a bear that wears none
        return fail(reason::NotInScene);
    }
    if (const auto place = c_.peek(Class::relation).value; moves && (place == "behind" || place == "under"))
        return false;  // "hide the man behind the bus"
    if (first.naming == Naming::It && d_.is_animate(targets[0]) &&
        (c_.is(Class::word_off) || takes_off)) {  // "take it off"
        take_worn(targets);
    }
    if (targets.size() == 1 && targets[0].is_scene() && !take_things_there(targets)) return false;
    if (targets.size() == 1 && targets[0].is_scene() &&
        (c_.peek(Class::contrast) || c_.is(Class::word_except)))
        return false;
    if (first.excepted.size() > 1)
        std::erase_if(targets, [&](const Target& each) {
            return each.thing && d_.scene().things[*each.thing].is_ground;
        });
    skip_from(targets);
    frame_ = Frame::Remove;
    remove_all(targets);
    return true;
}

/// Removes the targets; one that the last step made is not made.
void Reader::remove_all(const Targets& targets) {
    for (const auto& target : targets) {
        const bool just_made =
            target.kind == Target::Kind::Made && target.step && *target.step + 1 == d_.size();
        if (!just_made) {
            d_.remove(target);
            continue;
        }
        d_.drop_last();
        d_.nothing_asked();
    }
}

/// Things that stand on or in the target: neither ground, worn nor furniture.
Reader::Targets Reader::things_on(const Target& target) const {
    Targets on;
    if (!target.thing) return on;
    const auto& things = d_.scene().things;
    const auto& noun = things[*target.thing].noun;
    const bool container =
        has(Class::container, noun) || (has(Class::held, noun) && !has(Class::furniture_flat, noun));
    for (std::size_t i = 0; i < things.size(); ++i) {
        const bool stays = things[i].is_ground || things[i].is_worn || has(Class::furniture, things[i].noun);
        if (i != *target.thing && !stays && (!container || i > *target.thing))
            on.push_back(d_.target_of_thing(i));
    }
    return on;
}

/// "the thing on the table": names what stands there.
void Reader::narrow(Phrase& phrase) {
    Cursor ahead = c_;
    Phrase place;
    if (!has(Class::thing_name, phrase.noun) || !phrase.definite || d_.focus().found()) return;
    if (!ahead.take(Class::relation) || !ahead.take_phrase(place)) return;
    const auto on = things_on(d_.resolve(place));
    if (on.size() != 1 || !on.front().thing) return;
    phrase.noun = phrase.typed = d_.scene().things[*on.front().thing].noun;
    c_.at = ahead.at;
}

/// "empty the vase", "clear the table", "strip the bear of its hat", "rid the bear of its hat".
bool Reader::instruct_less_clause() {
    Cursor verb = c_;
    if (!verb.take(Class::verb_empty) && !verb.take(Class::verb_relieve)) return false;
    Phrase whole;
    if (!verb.take_phrase(whole)) return false;
    if (whole.owner && whole.owner->possessive && !is_part(whole)) {  // "strip the bear of its hat"
        const auto worn = d_.resolve(*whole.owner);
        if (!worn.found()) return expect(*whole.owner).found();
        c_.at = verb.at;
        d_.remove(worn);
        return true;
    }
    const auto target = d_.resolve(whole);
    if (!target.found()) return false;
    if (verb.take(Class::of)) {
        c_.at = verb.at;
        return lack_list(target);
    }
    if (!target.thing || !verb.at_end_of_clause() || d_.scene().things[*target.thing].is_worn) return false;
    const auto on = things_on(target);
    if (on.empty()) return fail(reason::Ambiguous);
    c_.at = verb.at;
    for (const auto& each : on) d_.remove(each);
    return true;
}

/// "shave him", "shave off his beard", "undress the man".
bool Reader::shave_clause() {
    const bool shave = c_.peek(Class::verb_shave).length > 0,
               undress = c_.peek(Class::verb_undress).length > 0;
    if (!shave && !undress) return false;
    c_.at += std::max(c_.peek(Class::verb_shave).length, c_.peek(Class::verb_undress).length);
    Phrase phrase;
    if (!c_.take_phrase(phrase)) return false;
    const auto target = d_.resolve(phrase);
    if (!target.found()) return expect(phrase).found();
    c_.take(Class::gone);
    bool removed = false;
    if (target.thing && !d_.scene().things[*target.thing].is_worn)
        for (std::size_t i = 0; i < d_.scene().things.size(); ++i) {
            const auto& noun = d_.scene().things[i].noun;
            const bool hair =
                are_synonyms("mustache", noun) || noun == "beard" || noun == "hair" || noun == "goatee";
            if (d_.scene().things[i].is_worn && hair == shave) {
                d_.remove(d_.target_of_thing(i));
                removed = true;
            }
        }
    else {
        d_.remove(target);
        removed = true;
    }
    if (!removed) d_.step(Operation::Alter, target, shave ? "shaved" : "naked");
    return true;
}

/// Nothing is asked of it. A part of what just changed is another matter: no step leaves it out.
void Reader::leave_as_it_is(const Phrase& phrase) {
    if (d_.changes_whole() && is_part(phrase) && d_.things_named(phrase).empty())
        d_.refuse(reason::NotASentence);
    else d_.nothing_asked();
}

/// Removes what "everything but" leaves out.
bool Reader::remove_excepted(const Phrase& phrase) {
    for (const auto& each : phrase.excepted) {
        const auto gone = expect(each);
        if (!gone.found()) return false;
        d_.remove(gone);
    }
    return true;
}

/// "leave the bear green": nothing to do where it is so.
bool Reader::keep_coloured(const Phrase& phrase, Cursor behind) {
    Attribute attribute;
    if (!behind.take_attribute(attribute, false) || !behind.at_end_of_clause()) return false;
    const auto found = d_.resolve(phrase);
    const bool stuff = attribute.quality == Quality::Colour || attribute.quality == Quality::Material;
    if (!found.found() || !stuff) return false;
    const auto steps = d_.size();
    d_.apply(found, attribute);
    if (d_.size() < steps) d_.contradict();  // "paint it blue but leave it red"
    c_.at = behind.at;
    return true;
}

/// "keep the hat", "leave the grass as it is", "everything stays": nothing is asked of them.
bool Reader::keep_clause() {
    Cursor ahead = c_;
    if (ahead.take(Class::nobody) && ahead.at_end_of_clause()) {
        c_.at = ahead.at;
        d_.nothing_asked();
        return true;
    }
    ahead = c_;
    if (ahead.take(Class::verb_keep)) {
        Phrase phrase;
        Cursor object = ahead;
        if (ahead.peek(Class::only)) return false;
        if (!object.take_phrase(phrase)) {
            if (!ahead.at_end_of_clause()) return false;
            c_.at = ahead.at;
            d_.nothing_asked();
            return true;
        }
        const Phrase kept = phrase;
        if (c_.is(Class::word_leave) && object.is(Class::word_out)) return false;  // "leave the hat out"
        if (!kept.excepted.empty() && object.at_end_of_clause() && !c_.peek(Class::do_not)) {
            c_.at = object.at;
            return remove_excepted(kept);  // "keep everything but the hat"
        }
        while (true) {
            Cursor more = object;
            more.take_mark(',');
            more.take(Class::conjunction);
            if (more.at == object.at || more.peek(Class::only) || starts_verb(more.at - c_.at) ||
                !more.take_phrase(phrase))
                break;  // "do not move the ship, just paint it"
            object.at = more.at;
        }
        if (c_.is(Class::word_leave) && c_.is(Class::word_out, 1)) return false;  // a removal
        if (keep_coloured(phrase, object)) return true;
        while (!object.at_end_of_clause() && !object.peek(Class::contrast) &&
               !object.peek(Class::conjunction))
            ++object.at;
        c_.at = object.at;
        leave_as_it_is(kept);
        return true;
    }
    return likes_clause();
}

/// "I like the hat, but make it yellow", "everything except the hat stays".
bool Reader::likes_clause() {
    Phrase subject;
    Cursor ahead = c_;
    if (ahead.take(Class::liked) && ahead.take_phrase(subject) && d_.resolve(subject).found() &&
        ahead.peek(Class::contrast)) {  // "I like the hat, but make it yellow"
        d_.mention(d_.resolve(subject));
        d_.nothing_asked();
        c_.at = ahead.at;
        return true;
    }
    ahead = c_;
    if (ahead.take_phrase(subject)) {
        ahead.take(Class::modal);
        if (stays(ahead)) {
            c_.at = ahead.at;
            d_.nothing_asked();
            return remove_excepted(subject);  // "everything except the hat stays"
        }
    }
    return false;
}

/// "set the bear on fire".
bool Reader::fire_clause() {
    Cursor ahead = c_;
    if (!ahead.take(Class::fire_verb)) return false;
    Phrase phrase;
    if (!ahead.take_phrase(phrase)) return false;
    const auto fire = ahead.peek(Class::fire_words);
    if (!fire) return false;
    const auto target = expect(phrase);
    if (!target.found()) return false;
    c_.at = ahead.at + fire.length;
    Phrase flames;
    flames.noun = flames.typed = std::string(fire.value);
    d_.add(flames, "on", {target});
    return true;
}

/// "an empty lawn", "an empty table": what stands there goes.
bool Reader::describe_empty(const Phrase& phrase, const Target& found) {
    if (phrase.attributes.empty() || !has(Class::empty, phrase.attributes.front().typed)) return false;
    const bool on_ground = found.thing && d_.scene().things[*found.thing].is_ground;
    if (on_ground && d_.focus().found()) {
        d_.remove(d_.focus());
        return true;
    }
    const auto on = things_on(found);
    const auto& noun = found.reference.root();
    if (on.empty() && found.thing && (has(Class::container, noun) || has(Class::furniture, noun))) {
        d_.already_so();  // "an empty vase" of one that is
        described_ = found;
        posts(found);
        return describe_more();
    }
    if (on.empty() || !c_.at_end_of_clause()) return false;
    remove_all(on);
    return true;
}

/// "the car that is blue": what tells which of several.
void Reader::tell_apart(Phrase& phrase) {
    Cursor told = c_;
    if (!phrase.definite || d_.things_named(phrase).size() < 2 || !told.take(Class::relative) ||
        !told.take(Class::copula))
        return;
    const auto how = told.take_attributes();
    if (how.empty() || !(ends_at(told) || told.peek(Class::conjunction))) return;
    phrase.attributes.insert(phrase.attributes.end(), how.begin(), how.end());
    c_.at = told.at;
}

/// "(make the lawn) empty": what stands there goes.
bool Reader::empties(const Targets& targets) {
    Cursor empty = c_;
    if (targets.size() != 1 || !targets.front().thing || !empty.take(Class::empty) || !ends_at(empty))
        return false;
    const auto on = d_.scene().things[*targets.front().thing].is_ground && d_.focus().found()
                        ? Targets{d_.focus()}
                        : things_on(targets.front());
    if (on.empty()) return false;
    c_.at = empty.at;
    remove_all(on);
    return true;
}

/// "what the bear is wearing", "what it has on its head"; none where no such words stand.
Reader::Targets Reader::what_is_worn() {
    Cursor ahead = c_;
    Phrase who, place;
    Targets worn;
    if (!ahead.is(Class::word_what)) return worn;
    ++ahead.at;
    if (!ahead.take_phrase(who) || !d_.resolve(who).found()) return worn;
    ahead.take(Class::copula);
    if (ahead.take(Class::having)) {
        if (!ahead.is(Class::word_on)) return worn;
        ++ahead.at;
        if (Cursor part = ahead; part.take_phrase(place) && is_part(place)) ahead.at = part.at;
    } else if (!ahead.take(Class::wearing)) return worn;
    for (std::size_t i = 0; i < d_.scene().things.size(); ++i)
        if (d_.scene().things[i].is_worn) worn.push_back(d_.target_of_thing(i));
    if (!worn.empty()) c_.at = ahead.at;
    return worn;
}

}  // namespace gse::language::plan
