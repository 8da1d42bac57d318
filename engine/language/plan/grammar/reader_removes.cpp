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
    while (c_.take(Class::gone) || c_.is(Class::word_off) || c_.is(Class::word_out) ||
           c_.is(Class::word_down) || c_.is(Class::word_away)) {
        if (c_.is(Class::word_off) || c_.is(Class::word_out) || c_.is(Class::word_down) ||
            c_.is(Class::word_away))
            ++c_.at;
    }
    Cursor off = c_;
    Phrase bearer;
    if (c_.at > 0 && off.take_phrase(bearer) && bearer.naming == Naming::Thing && d_.resolve(bearer).found())
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
    if (!direct && !gets && !c_.is(Class::word_take)) return false;
    const bool takes_off = takes && c_.is(Class::word_off, 1);
    c_.at += direct ? direct.length : 1;
    if (c_.done()) return fail(reason::Incomplete);
    Targets targets;
    std::vector<Phrase> phrases;
    Phrase first;
    Cursor ahead = c_;
    if (!ahead.take_phrase(first)) return false;
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
    if (const auto place = c_.peek(Class::relation).value; moves && (place == "behind" || place == "under"))
        return false;  // "hide the man behind the bus"
    if (first.naming == Naming::It && d_.is_animate(targets[0]) &&
        (c_.is(Class::word_off) || takes_off)) {  // "take it off"
        take_worn(targets);
    }
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
    const bool container = has(Class::container, noun) || has(Class::held, noun);
    for (std::size_t i = 0; i < things.size(); ++i) {
        const bool stays = things[i].is_ground || things[i].is_worn || has(Class::furniture, things[i].noun);
        if (i != *target.thing && !stays && (!container || i > *target.thing))
            on.push_back(d_.target_of_thing(i));
    }
    return on;
}

/// "empty the vase", "clear the table", "strip the bear of its hat", "rid the bear of its hat".
bool Reader::instruct_less_clause() {
    Cursor verb = c_;
    if (!verb.take(Class::verb_empty) && !verb.take(Class::verb_relieve)) return false;
    Phrase whole;
    if (!verb.take_phrase(whole)) return false;
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
        if (!object.take_phrase(phrase)) {
            if (!ahead.at_end_of_clause()) return false;
            c_.at = ahead.at;
            d_.nothing_asked();
            return true;
        }
        const Phrase kept = phrase;
        while (true) {
            Cursor more = object;
            more.take_mark(',');
            more.take(Class::conjunction);
            if (more.at == object.at || more.peek(Class::only) || starts_verb(more.at - c_.at) ||
                !more.take_phrase(phrase))
                break;  // "do not move the ship, just paint it"
            object.at = more.at;
        }
        // "leave the bear green": nothing to do either way; "leave out the hat" is a removal
        if (c_.is(Class::word_leave) && c_.is(Class::word_out, 1)) return false;
        Attribute attribute;
        Cursor how = object;
        if (how.take_attribute(attribute, false) && how.at_end_of_clause() && !how.is(Class::word_as)) {
            const auto found = d_.resolve(phrase);
            if (found.found() &&
                (attribute.quality == Quality::Colour || attribute.quality == Quality::Material)) {
                d_.apply(found, attribute);
                c_.at = how.at;
                return true;
            }
        }
        while (!object.at_end_of_clause() && !object.peek(Class::contrast) &&
               !object.peek(Class::conjunction))
            ++object.at;
        c_.at = object.at;
        leave_as_it_is(kept);
        return true;
    }
    Phrase subject;
    ahead = c_;
    if (ahead.take_phrase(subject)) {
        ahead.take(Class::modal);
        if (stays(ahead)) {
            c_.at = ahead.at;
            d_.nothing_asked();
            return true;
        }
    }
    return false;
}

}  // namespace gse::language::plan
