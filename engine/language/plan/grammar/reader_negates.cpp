// Negation: "no hat", "without a hat", "not red but green", "I do not want".
#include <algorithm>

#include "engine/language/plan/grammar/reader.h"

namespace gse::language::plan {

/// "no hat on the bear", "not a bear but a lion".
bool Reader::no_thing_clause() {
    Cursor ahead = c_;
    Phrase phrase;
    if (!ahead.take_phrase(phrase) || !phrase.none) return false;
    if (phrase.noun.empty()) {  // "a silver crown, not a golden one"
        if (phrase.attributes.empty() || !ahead.at_end_of_clause()) return false;
        if (d_.size() == 0)  // "no green, make it purple"
            for (const auto& attribute : phrase.attributes) d_.deny(d_.focus(), attribute);
        c_.at = ahead.at;
        return true;
    }
    c_.at = ahead.at;
    phrase.none = false;
    if (c_.peek(Class::relation)) {  // "no hat on the bear"
        Cursor place = c_;
        place.take(Class::relation);
        Phrase where;
        if (place.take_phrase(where)) c_.at = place.at;
        else c_.take(Class::relation);
    } else if (Cursor whom = c_; whom.is(Class::word_for)) {  // "no hat for the bear"
        Phrase bearer;
        ++whom.at;
        if (whom.take_phrase(bearer) && d_.resolve(bearer).found()) c_.at = whom.at;
    }
    Phrase other;
    Cursor but = c_;
    but.take_mark(',');
    if ((but.take(Class::contrast) || but.take(Class::only)) && but.take_phrase(other) && other.indefinite &&
        other.naming == Naming::Thing && d_.resolve(phrase).found()) {
        c_.at = but.at;  // "not a bear but a lion"
        return become({d_.resolve(phrase)}, other);
    }
    if (const auto found = d_.resolve(phrase); d_.last_is(found) && found.kind == Target::Kind::Made) {
        remove_all({found});  // "add a hat. no, no hat"
        return true;
    }
    if (const auto found = d_.resolve(phrase); found.found() && d_.replaces(found)) return true;
    if (!lack(d_.focus(), phrase)) return false;
    return !c_.peek(Class::none) || c_.done() || no_thing_clause();
}

/// "not on grass but on sand": the second says where.
bool Reader::not_there_clause() {
    Cursor ahead = c_;
    Phrase place;
    if (!ahead.take(Class::negation) || !ahead.take(Class::relation) || !ahead.take_phrase(place))
        return false;
    ahead.take_mark(',');
    if (!ahead.take(Class::contrast) || !ahead.peek(Class::relation)) return false;
    c_.at = ahead.at;
    return clause();
}

/// "nobody wears a hat".
bool Reader::nobody_clause(Cursor ahead) {
    if (!ahead.take(Class::nobody)) return false;
    if (!ahead.take(Class::wearing) && !ahead.take(Class::holding) && !ahead.take(Class::having))
        return false;
    c_.at = ahead.at;
    return lack_list(d_.focus());
}

/// "do not touch the bear": nothing is asked.
bool Reader::do_not_clause(Cursor ahead) {
    if (starts_verb(ahead.at - c_.at) || ahead.is(Class::word_use) || ahead.word().text == "touch" ||
        ahead.word().text == "forget") {
        if (ahead.word().text == "forget") {
            c_.at = ahead.at + 1;
            c_.take(Class::to);
            return clause();
        }
        while (!ahead.at_end_of_clause() && !ahead.peek(Class::contrast)) ++ahead.at;
        c_.at = ahead.at;
        d_.nothing_asked();
        return true;
    }
    return false;
}

/// Tells whether an order on what is unwanted follows: "I do not like the hat, make it yellow".
bool Reader::is_only_mentioned(const Target& unwanted) const {
    Cursor order = c_;
    if (!unwanted.found() || !order.is_mark(".,;!")) return false;
    ++order.at;
    while (order.take(Class::courtesy) || order.take(Class::request) || order.take(Class::contrast)) {}
    return starts_verb(order.at - c_.at) && !order.peek(Class::verb_remove) &&
           order.peek(Class::pronoun_it, 1);
}

/// "I do not want to see a bear there", "I do not like red".
bool Reader::unwanted_clause(Cursor ahead) {
    Phrase phrase;
    Attribute colour;
    Cursor plain = ahead;
    if (plain.take_attribute(colour, false) && plain.at_end_of_clause() && !plain.done()) {
        c_.at = plain.at;  // "I do not like red, make it blue"
        d_.deny(d_.focus(), colour);
        return true;
    }
    if (!ahead.take_phrase(phrase) || phrase.naming != Naming::Thing) return false;
    if (d_.things_named(phrase).empty() && (phrase.definite || !is_thing(phrase))) return false;
    if (Cursor wanted = ahead; phrase.indefinite && !phrase.attributes.empty() && wanted.take_mark(',') &&
                               d_.resolve(phrase).thing && wanted.peek(Class::request)) {
        c_.at = ahead.at;  // "I do not want a red bear, I want a golden one"
        for (const auto& each : phrase.attributes) d_.deny(d_.resolve(phrase), each);
        return true;
    }
    c_.at = ahead.at;
    while (c_.take(Class::as_well) || c_.is(Class::word_there)) {
        if (c_.is(Class::word_there)) ++c_.at;
    }
    const auto unwanted = d_.resolve(phrase);
    if (unwanted.found()) d_.mention(unwanted);
    Cursor there = c_;
    Phrase where;
    if (there.take(Class::relation) && there.take_phrase(where) && there.at_end_of_clause() &&
        d_.resolve(where).found())
        c_.at = there.at;  // "I do not want that hat on the bear"
    if (Cursor worn = c_; unwanted.found() && worn.is(Class::word_to) &&
                          (worn.peek(Class::wearing, 1) || worn.peek(Class::having, 1))) {
        c_.at += 2;  // "I do not want the bear to wear a hat"
        return lack_list(unwanted);
    }
    if (is_only_mentioned(unwanted)) {
        d_.nothing_asked();
        return true;
    }
    return c_.at_end_of_clause() && lack(d_.focus(), phrase);
}

/// "neither a bear nor a cat", "neither the car nor the house should change".
bool Reader::neither_clause() {
    Cursor ahead = c_;
    ++ahead.at;
    Phrase phrase;
    Cursor said = ahead;  // "neither the car nor the house should change"
    while (said.take_phrase(phrase) && said.is(Class::word_nor)) ++said.at;
    if (said.take(Class::modal)) {
        said.take(Class::copula);
        if (!said.take(Class::verb_become) && !said.take(Class::verb_turn)) return false;
        c_.at = said.at;
        d_.nothing_asked();
        return true;
    }
    Attribute attribute;
    Cursor denied = ahead;
    if (denied.take_attribute(attribute, false) && (denied.done() || denied.is(Class::word_nor)))
        return fail(reason::Incomplete);  // "neither red nor blue"
    c_.at = ahead.at;
    do {
        if (!c_.take_phrase(phrase) || !lack(d_.focus(), phrase)) return false;
    } while (c_.is(Class::word_nor) && ++c_.at);
    return true;
}

/// "no hat", "neither a bear nor a cat", "without a hat", "not red but green".
bool Reader::negative_clause() {
    Cursor ahead = c_;
    if (ahead.take(Class::do_not)) {  // "do not touch the bear": nothing is asked
        return do_not_clause(ahead);
    }
    if (ahead.take(Class::unwanted)) return unwanted_clause(ahead);
    if (c_.peek(Class::without)) {
        c_.take(Class::without);
        return lack_list(d_.last() ? *d_.last() : d_.focus());
    }
    if (Cursor none = ahead;
        none.take(Class::nobody) &&
        (none.take(Class::wearing) || none.take(Class::holding) || none.take(Class::having))) {
        c_.at = none.at;  // "nobody wears a hat"
        return lack_list(d_.focus());
    }
    if (ahead.is(Class::word_neither)) return neither_clause();
    if (Cursor colour = ahead; d_.size() == 0 && colour.take(Class::none)) {
        Attribute denied;  // "no green"
        if (colour.take_attribute(denied, false) && denied.quality == Quality::Colour &&
            (colour.at_end_of_clause() || colour.peek(Class::courtesy)) && d_.focus().found()) {
            c_.at = colour.at;
            d_.deny(d_.focus(), denied);
            return true;
        }
    }
    if (Cursor weather = ahead;
        weather.take(Class::none) && weather.take(Class::environment) && weather.at_end_of_clause()) {
        c_.at = weather.at;  // "no rain": the scene shows none
        d_.already_so();
        return true;
    }
    if (ahead.peek(Class::none) && (!ahead.peek(Class::correction) || d_.size() == 0))
        return no_thing_clause();
    if (not_there_clause()) return true;
    if (ahead.peek(Class::negation)) {
        const std::size_t start = c_.at;
        Cursor behind = ahead;
        behind.take(Class::negation);
        Phrase other;
        Attribute attribute;
        Cursor probe = behind;
        if (!probe.take_attribute(attribute, false) && behind.take_phrase(other) &&
            other.naming == Naming::Thing &&
            (behind.at_end_of_clause() || (other.definite && behind.peek(Class::contrast))) &&
            (d_.size() > 0 || !behind.done())) {
            c_.at = behind.at;  // "not the hat, the bear should be yellow"
            leave_as_it_is(other);
            return true;
        }
        const auto focus = d_.last() ? *d_.last() : d_.focus();
        if (!focus.found()) return fail(reason::Ambiguous);
        if (denied({focus})) return true;
        if (!reason_.empty()) return false;
        c_.at = start;
    }
    return false;
}

/// "(should) not be here", "not be red but blue".
bool Reader::should_not(const Targets& subjects) {
    if (c_.peek(Class::copula)) c_.take(Class::copula);
    if (c_.word().text.ends_with("ed") && (c_.peek(Class::verb_turn) || c_.peek(Class::verb_recolour) ||
                                           c_.peek(Class::verb_remove) || c_.peek(Class::verb_move))) {
        ++c_.at;  // "must not be changed"
        d_.nothing_asked();
        return true;
    }
    if (const auto present = c_.peek(Class::present)) {  // "should not be here"
        c_.at += present.length;
        for (const auto& subject : subjects) d_.remove(subject);
        return true;
    }
    if (c_.take(Class::having) || c_.take(Class::wearing) || c_.take(Class::holding))
        return lack_list(subjects.front());
    const bool so = c_.word().text == "so" || c_.word().text == "that" || c_.is(Class::word_too);
    if (c_.word().text == "that") ++c_.at;
    auto attributes = c_.take_attributes();
    Phrase same;
    if (Cursor but = c_; attributes.empty() && but.take_phrase(same) && d_.resolve(same).found()) {
        but.take_mark(',');
        if (!but.take(Class::contrast)) return false;
        c_.at = but.at;  // "should not be a bear but a wolf"
        return complement(subjects);
    }
    if (attributes.empty()) return false;
    if (so && c_.at_end_of_clause()) {  // "should not be so big"
        for (auto& each : attributes) temper(each);
        return apply_all(subjects, attributes);
    }
    for (const auto& subject : subjects)
        for (const auto& attribute : attributes) d_.deny(subject, attribute);
    Cursor but = c_;
    but.take_mark(',');
    if (but.take(Class::contrast)) {
        c_.at = but.at;
        return complement(subjects);
    }
    if (c_.done()) return fail(reason::Incomplete);
    return c_.at_end_of_clause();  // "should not be red, make it gray"
}

bool Reader::lack(const Target& subject, const Phrase& phrase) {
    Phrase what = phrase;
    what.none = false;
    Cursor on = c_;  // "with no hat on"
    if (on.take(Class::relation) && on.at_end_of_clause()) c_.at = on.at;
    if (what.naming != Naming::Thing || what.noun.empty()) return false;
    if (const auto found = d_.things_named(what); !found.empty()) {
        const auto target = d_.resolve(what);
        if (!target.found()) return fail(reason::Ambiguous);
        if (d_.replaces(target)) return true;  // "a panda, not a bear"
        d_.remove(target);
        return true;
    }
    Phrase made = what;
    made.definite = true;
    if (const auto found = d_.resolve(made); found.kind == Target::Kind::Made && !d_.replaces(found)) {
        d_.contradict();  // "wearing a hat and no hat"
        return true;
    }
    if (is_part(what) && !is_worn(what)) {
        what.owner.reset();
        Target part = subject;
        part.thing.reset();
        part.reference.links.insert(part.reference.links.begin(), Thing{what.typed, "", {}});
        d_.remove(part);
        return true;
    }
    if ((kinds_of(what.noun) & Body) != 0 && is_part(what)) {
        Target part = subject;
        part.thing.reset();
        part.reference.links.insert(part.reference.links.begin(), Thing{what.typed, "", {}});
        d_.remove(part);
        return true;
    }
    d_.already_so();
    return true;
}

/// "(with) neither hat nor scarf".
bool Reader::lack_both(const Target& subject) {
    do {
        Phrase phrase;
        ++c_.at;
        if (!c_.take_phrase(phrase) || !lack(subject, phrase)) return false;
    } while (c_.is(Class::word_nor));
    return true;
}

bool Reader::lack_list(const Target& subject) {
    Phrase phrase;
    do {
        Cursor doing = c_;
        if (doing.word().text.ends_with("ing") && doing.peek(Class::verb_keep).length == 0 &&
            doing.noun_length() == 0) {
            // "without touching the hat"
            ++doing.at;
            if (!doing.take_phrase(phrase)) return false;
            c_.at = doing.at;
            d_.nothing_asked();
            continue;
        }
        if (doing.word().text == "touching" || doing.word().text == "changing" ||
            doing.word().text == "altering") {
            ++doing.at;
            if (!doing.take_phrase(phrase)) return false;
            c_.at = doing.at;
            d_.nothing_asked();
            continue;
        }
        if (c_.take(Class::something)) {  // "not wearing anything"
            undress();
            Cursor place = c_;
            Phrase where;
            if (place.take(Class::relation) && place.take_phrase(where) && is_part(where)) c_.at = place.at;
            continue;
        }
        if (!c_.take_phrase(phrase) || !lack(subject, phrase)) return false;

    } while (list_goes_on());
    return true;
}

/// "not red but blue": the first says nothing of what is to be.
bool Reader::denied(const Targets& targets) {
    Cursor ahead = c_;
    if (!ahead.take(Class::negation)) return false;
    ahead.take(Class::article);
    std::vector<Attribute> attributes;
    Attribute one;
    while (ahead.take_attribute(one, false)) {
        attributes.push_back(one);
        if (!ahead.take(Class::alternative)) break;
    }
    if (Phrase same; attributes.empty() && ahead.take_phrase(same) && !targets.empty() &&
                     d_.resolve(same).reference == targets.front().reference) {
        ahead.take_mark(',');
        if (!ahead.take(Class::contrast)) return false;
        c_.at = ahead.at;  // "is not a bear but a dog"
        return complement(targets);
    }
    if (attributes.empty()) return false;
    while (ahead.take(Class::as_well)) {}
    c_.at = ahead.at;
    for (const auto& target : targets)
        for (const auto& attribute : attributes) d_.deny(target, attribute);
    c_.take_mark(',');
    if (c_.take(Class::contrast) || c_.take(Class::rather_than)) return complement(targets);
    Cursor more = c_;
    if ((more.take(Class::pronoun_it) || more.take(Class::pronoun_person)) && more.take(Class::copula))
        c_.at = more.at;  // "it is not blue, it is yellow"
    else more = c_;
    Attribute attribute;
    if (more.take_attribute(attribute, false)) return complement(targets);
    const bool so = std::any_of(targets.begin(), targets.end(), [&](const Target& target) {
        return std::any_of(attributes.begin(), attributes.end(),
                           [&](const Attribute& each) { return d_.is_so(target, each); });
    });
    if (!so) d_.already_so();  // "the bear is not blue", and it is red
    return d_.size() > 0 || !so || fail(reason::Incomplete);
}

}  // namespace gse::language::plan
