// Reading behind a noun: what it wears, holds, is made of, and where it is.
#include <algorithm>

#include "engine/language/plan/grammar/reader.h"

namespace gse::language::plan {
namespace {

std::string leading_word(std::string_view phrase) { return std::string(phrase.substr(0, phrase.find(' '))); }
std::string last_word(std::string_view phrase) {
    const auto blank = phrase.rfind(' ');
    return std::string(blank == std::string_view::npos ? phrase : phrase.substr(blank + 1));
}

/// Tells whether things stand on what has that name: furniture, grounds.
bool carries(const std::string& noun) { return has(Class::furniture, noun) || has(Class::ground, noun); }

/// Relation of a thing that someone has "with" them.
std::string_view having_relation(const Phrase& phrase, bool animate, bool furniture) {
    if (is_worn(phrase)) return "worn by";
    if (has(Class::floating, phrase.noun) || has(Class::floating, phrase.typed))
        return animate && is_held(phrase) ? "held by" : "on";
    if (is_held(phrase) && animate) return "held by";
    if (is_part(phrase)) return animate ? "worn by" : "on";
    return furniture ? "on" : "beside";
}

}  // namespace

/// Tells whether the next of a list stands behind a comma or "and"; steps to it.
bool Reader::list_goes_on() {
    Cursor ahead = c_;
    const bool comma = ahead.take_mark(',');
    const bool joint = ahead.take(Class::conjunction).length > 0 || ahead.take(Class::alternative).length > 0;
    if (!comma && !joint) return false;
    while (ahead.take(Class::having) || ahead.take(Class::wearing) || ahead.take(Class::as_well)) {}
    const std::size_t distance = ahead.at - c_.at;
    if (starts_verb(distance) || ahead.peek(Class::holding) || ahead.peek(Class::riding)) return false;
    Phrase next;
    Cursor probe = ahead;
    if (!probe.take_phrase(next) || next.noun.empty() || next.naming != Naming::Thing) return false;
    if (probe.peek(Class::copula) || probe.is_mark(":") || probe.peek(Class::gone)) return false;
    if (next.definite && !d_.things_named(next).empty()) {
        Attribute attribute;
        if (probe.take_attribute(attribute, false)) return false;  // "..., the grass white"
    }
    const bool ground = is_ground(next) && !next.has_determiner();
    if (comma && !joint && ground) return false;
    if (!d_.things_named(next).empty() && !is_worn(next) && next.indefinite) return false;
    c_.at = ahead.at;
    return true;
}

bool Reader::own_pattern(const Target& subject, const Phrase& phrase) {
    const auto last = last_word(phrase.noun), first = leading_word(phrase.noun);
    std::string colour;
    std::string value;
    for (const auto& attribute : phrase.attributes) {
        if (attribute.quality == Quality::Colour) colour = attribute.value;
        if (attribute.quality == Quality::Pattern)
            value = attribute.value, colour = attribute.colour.empty() ? colour : attribute.colour;
    }
    const bool named = has(Class::pattern_word, last);
    if (named && first != last) value = meaning(Class::pattern, first).value_or(first);
    if (named && value.empty()) {
        for (const auto& attribute : phrase.attributes)
            if (attribute.quality == Quality::Material || attribute.quality == Quality::Surface) {
                d_.apply(subject, attribute);
                return true;
            }
        return false;
    }
    if (!named) {
        const auto plain = meaning(Class::pattern, phrase.typed);
        const auto tail = last_word(phrase.typed);
        const bool is_pattern = has(Class::pattern_plain, tail) && (has(Class::pattern, tail));
        if (!is_pattern) return false;
        if (value.empty())
            value = first != last && has(Class::pattern, first)
                        ? std::string(*meaning(Class::pattern, first))
                        : std::string(plain ? *plain : *meaning(Class::pattern, tail));
    }
    d_.apply(subject, {Quality::Pattern, value, value, colour});
    return true;
}

/// A part that is said to be otherwise: "with a white belly", "with its arms raised", "with closed eyes".
bool Reader::own_part(const Target& subject, const Phrase& phrase) {
    if (phrase.indefinite && c_.peek(Class::relation) && c_.peek(Class::pronoun_it, 1)) return false;
    Phrase owned = phrase;
    owned.possessive = false;
    owned.owner.reset();
    Target part = subject;
    part.thing.reset();
    std::vector<Attribute> attributes;
    Thing link{phrase.typed, "", {}};
    for (const auto& attribute : phrase.attributes) {
        if (attribute.quality == Quality::Side) link.attributes.push_back(attribute.value);
        else attributes.push_back(attribute);
    }
    part.reference.links.insert(part.reference.links.begin(), link);
    part.kind = Target::Kind::There;
    Cursor ahead = c_;
    ahead.take(Class::copula);
    const auto more = ahead.take_attributes();
    const bool ends = ahead.at_end_of_clause() || ahead.ends_phrase(0, true);
    if (!more.empty() && ends) {
        c_.at = ahead.at;
        attributes.insert(attributes.end(), more.begin(), more.end());
    } else if (c_.peek(Class::made_of)) {
        return material_of({part});
    }
    if (attributes.empty() || (is_worn(phrase) && more.empty())) return false;
    for (const auto& attribute : attributes) {
        if (attribute.quality == Quality::Pose)
            d_.step(Operation::Pose, subject, phrase.typed + " " + attribute.value);
        else d_.apply(part, attribute);
    }
    return true;
}

/// Takes what someone has: a pattern, a part, clothes, a thing in the hand, or beside.
bool Reader::own(const Target& subject, const Phrase& phrase, std::string_view relation) {
    if (phrase.none) return lack(subject, phrase);
    if (own_pattern(subject, phrase)) return true;
    if (has(Class::colour_word, last_word(phrase.noun)) || has(Class::colour_word, phrase.noun) ||
        has(Class::look_word, phrase.noun)) {
        if (apply_all({subject}, phrase.attributes)) return true;
        Attribute behind;
        return c_.take_attribute(behind, false) && apply_all({subject}, {behind});
    }
    if (has(Class::pose, phrase.noun)) {
        std::string text;
        for (const auto& attribute : phrase.attributes) text += attribute.typed + " ";
        d_.step(Operation::Pose, subject, text + std::string(*meaning(Class::pose, phrase.noun)));
        return true;
    }
    const auto found = d_.things_named(phrase);
    const bool there = !found.empty() && !phrase.another && phrase.count.empty();
    if (there && !d_.scene().things[found.front()].is_ground) {
        const auto target = d_.target_of_thing(found.front());
        if (target.reference == subject.reference) return false;
        if (relation == "ridden by" && subject.step) d_.set_anchor(subject, "on", target);
        d_.already_so();
        apply_all({target}, phrase.attributes);
        nested(target, subject);
        return true;
    }
    if (is_ground(phrase) && relation == "with" && !is_worn(phrase) && !is_held(phrase) &&
        !has(Class::floating, phrase.noun) && !has(Class::thing, phrase.noun))
        return relate(subject, "on", phrase);
    if (is_part(phrase) && relation != "worn by" && own_part(subject, phrase)) return true;
    if (is_part(phrase) && !is_worn(phrase) && relation == "with" &&
        ((kinds_of(phrase.noun) & Body) != 0 ||
         (has(Class::body_place, phrase.noun) && !phrase.count.empty()))) {
        const std::string count = phrase.another ? "another" : phrase.single ? "1" : phrase.count;
        if (!count.empty()) d_.step(Operation::Alter, subject, count + " " + phrase.typed);
        else d_.already_so();
        return true;
    }
    if (relation == "held by" && is_ground(phrase) && !is_held(phrase)) return false;  // "eating grass"
    const auto how = relation == "with"
                         ? having_relation(phrase, d_.is_animate(subject) || d_.can_wear(subject),
                                           carries(subject.reference.root()))
                         : relation;
    if (how == "worn by" && is_ground(phrase)) return false;
    Cursor instead = c_;
    Phrase old;
    if (instead.take(Class::rather_than) && instead.take_phrase(old)) {  // "a crown instead of a hat"
        c_.at = instead.at;
        const auto before = d_.resolve(old);
        if (before.found() && !(before.reference == subject.reference)) {
            d_.mention(d_.replace(before, phrase));
            return true;
        }
    }
    const auto made = d_.add(phrase, how, {subject});
    d_.mention(made);
    nested(made, subject);
    return true;
}

bool Reader::has_list(const Target& subject, std::string_view relation) {
    Phrase phrase;
    do {
        const std::size_t start = c_.at;
        Cursor lacking = c_;
        lacking.take(Class::article);  // "with a missing arm"
        if (lacking.peek(Class::without) && (lacking.at == c_.at || lacking.peek(Class::gone))) {
            lacking.take(Class::without);
            c_.at = lacking.at;
            return lack_list(subject);
        }
        if (c_.is(Class::word_nothing) && (c_.peek(Class::contrast, 1) || c_.peek(Class::except, 1)))
            c_.at += 2;  // "wearing nothing but a tie"
        if (c_.is(Class::word_nothing)) return false;
        if (!c_.take_phrase(phrase) || phrase.naming != Naming::Thing) {
            // "with blue" and "with stripes" have no noun
            c_.at = start;
            if (relation == "held by") return false;  // "eats honey" is no colour
            const auto attributes = c_.take_attributes();
            if (!apply_all({subject}, attributes)) return false;
            continue;
        }
        if (phrase.noun.empty()) {
            if (!apply_all({subject}, phrase.attributes)) return false;
            continue;
        }
        Cursor choice = c_;
        if (choice.take(Class::alternative)) {
            Phrase other;
            if (choice.take_phrase(other)) {
                d_.refuse(reason::Ambiguous);
                c_.at = choice.at;
                return fail(reason::Ambiguous);
            }
        }
        if (!own(subject, phrase, relation)) return false;
    } while (list_goes_on());
    return true;
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
        d_.remove(target);
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
        if (!c_.take_phrase(phrase)) return false;
        if (!lack(subject, phrase)) return false;

    } while (list_goes_on());
    return true;
}

/// Steps over how a new thing is: "(wings) like an eagle".
bool Reader::skip_likeness() {
    Cursor like = c_;
    Phrase model;
    if (c_.is(Class::word_as) || !like.take(Class::like) || !like.take_phrase(model) || model.noun.empty() ||
        !like.at_end_of_clause())
        return false;
    c_.at = like.at;
    return true;
}

/// Place of a new thing on or beside who has it: "on its head", "next to him", "made of gold", "that is red".
void Reader::nested(const Target& made, const Target& bearer) {
    while (true) {
        const std::size_t start = c_.at;
        Cursor ahead = c_;
        while (ahead.take(Class::emerging)) {}
        if (const auto relation = ahead.take(Class::relation)) {
            Phrase place;
            Cursor at_place = ahead;
            if (!ahead.take_phrase(place)) {
                if (relation.value == "on" && ahead.at_end_of_clause()) {
                    c_.at = ahead.at;
                    continue;
                }
                if (made.step && ahead.at_end_of_clause() && relation.value != "in") {
                    d_.set_anchor(made, relation.value, bearer);
                    c_.at = ahead.at;
                    continue;
                }
                return;
            }
            Target whose = bearer;
            if (on_bearer(place, whose)) {
                c_.at = ahead.at;
                const bool worn = has(Class::worn, made.reference.root()) || made.thing;
                if (made.step && !worn) d_.set_anchor(made, relation.value, whose);
                continue;
            }
            if (place.naming == Naming::It || place.naming == Naming::Person) {
                c_.at = ahead.at;
                if (made.step) d_.set_anchor(made, relation.value, bearer);
                continue;
            }
            const auto found = d_.resolve(place);
            const bool bears = found.found() && found.reference == bearer.reference;
            if (bears) {
                c_.at = ahead.at;
                if (made.step) d_.set_anchor(made, relation.value, bearer);
                continue;
            }
            c_.at = start;
            (void)at_place;
            return;
        }
        if (c_.peek(Class::made_of) && made.step && material_of({made})) continue;
        if (made.step && skip_likeness()) continue;
        if (c_.peek(Class::relative) && relative(made)) continue;
        Attribute behind;
        if (made.step && ahead.at == c_.at && ahead.take_attribute(behind, false) &&
            (ahead.at_end_of_clause() || ahead.ends_phrase(0, true)) && behind.quality != Quality::Pose) {
            c_.at = ahead.at;
            d_.apply(made, behind);
            continue;
        }
        return;
    }
}

/// Tells whether the phrase is a place on the bearer ("its head", "the bear's neck"); then `bearer` is the
/// part.
bool Reader::on_bearer(const Phrase& phrase, Target& bearer) const {
    if (!has(Class::body_place, phrase.noun) && !has(Class::body_place, phrase.typed) && !is_part(phrase))
        return false;
    if (!phrase.possessive && !phrase.owner && !phrase.definite) return false;
    if (!d_.things_named(phrase).empty()) return false;
    if (phrase.owner) {
        const auto owner = d_.resolve(*phrase.owner);
        if (!owner.found()) return false;
        bearer = owner;
    }
    bearer.thing.reset();
    bearer.kind = Target::Kind::There;
    bearer.reference.links.insert(bearer.reference.links.begin(), Thing{phrase.typed, "", {}});
    return true;
}

/// "that is blue", "which wears a hat", "who has no hat".
bool Reader::relative(const Target& subject) {
    Cursor ahead = c_;
    if (!ahead.take(Class::relative)) return false;
    const std::size_t start = c_.at;
    c_.at = ahead.at;
    if (c_.peek(Class::pronoun_it) || c_.peek(Class::narrative)) {
        c_.at = start;
        return false;
    }
    c_.take(Class::modal);
    if (predicate({subject})) return true;
    c_.at = start;
    return false;
}

void Reader::posts(const Target& subject) {
    while (!c_.done()) {
        const std::size_t start = c_.at;
        if (c_.is_mark(",")) ++c_.at;
        while (c_.take(Class::conjunction) || (c_.at > start && c_.take(Class::contrast))) {}
        if (c_.at > start && c_.peek(Class::none)) {  // "but no scarf"
            Phrase lacking;
            Cursor ahead = c_;
            if (ahead.take_phrase(lacking) && lacking.none) {
                c_.at = ahead.at;
                if (lack(subject, lacking)) continue;
            }
        }
        if (c_.at > start && c_.peek(Class::into)) {
            c_.at = start;
            return;
        }
        if (c_.at > start) {
            const bool begins = c_.peek(Class::having) || c_.peek(Class::wearing) ||
                                c_.peek(Class::holding) || c_.peek(Class::riding) ||
                                c_.peek(Class::without) || c_.peek(Class::made_of) ||
                                c_.peek(Class::relation) || c_.peek(Class::inverse_relation) ||
                                c_.peek(Class::emerging) || c_.peek(Class::relative) || c_.peek(Class::pose);
            const bool imperative = starts_verb() && !c_.word().text.ends_with("ing");
            if (!begins || imperative) {
                c_.at = start;
                return;
            }
        }
        if (post(subject)) continue;
        c_.at = start;
        return;
    }
}

/// "surrounded by penguins", "covered with moss".
bool Reader::inversely_related(const Target& subject) {
    if (c_.peek(Class::inverse_relation)) {
        const auto relation = c_.take(Class::inverse_relation).value;
        Phrase phrase;
        if (!c_.take_phrase(phrase)) return false;
        if (relation == "on" && subject.thing && (is_ground(phrase) || has(Class::covering, phrase.noun))) {
            if (const auto covering = meaning(Class::covering, phrase.typed))
                return apply_all({subject},
                                 {{Quality::Material, std::string(*covering), std::string(*covering), ""}});
        }
        d_.add(phrase, relation, {subject});
        return true;
    }
    return false;
}

/// "while snow is falling".
bool Reader::weather_clause() {
    Cursor weather = c_;
    weather.take(Class::subordinate);
    const auto found = weather.peek(Class::environment);
    if (found && (weather.at += found.length, weather.at_end_of_clause())) {
        c_.at = weather.at;
        d_.environment(std::string(found.value));
        return true;
    }
    return false;
}

bool Reader::post(const Target& subject) {
    const std::size_t start = c_.at;
    if (c_.peek(Class::rather_than)) return false;
    if (c_.peek(Class::subordinate)) {  // "while snow is falling"
        if (weather_clause()) return true;
    }
    c_.take(Class::degree);
    c_.take(Class::as_well);
    const auto back = [&] {
        c_.at = start;
        return false;
    };
    if (const auto fire = c_.peek(Class::fire_words); fire && !subject.is_scene()) {
        c_.at += fire.length;
        Phrase flames;
        flames.noun = flames.typed = std::string(fire.value);
        d_.add(flames, "on", {subject});
        return true;
    }
    if (c_.take(Class::without)) return lack_list(subject) || back();
    if (c_.peek(Class::inverse_relation)) return inversely_related(subject) || back();
    if (c_.peek(Class::made_of) || c_.peek(Class::of)) return material_of({subject}) || back();
    if (c_.take(Class::dressed_as)) {
        Phrase role;
        if (!c_.take_phrase(role) || role.noun.empty()) return back();
        d_.step(Operation::Alter, subject, role.typed);
        return true;
    }
    if (c_.take(Class::wearing)) return has_list(subject, "worn by") || back();
    if (const auto holding = c_.peek(Class::holding); holding && !c_.is(Class::word_like)) {
        c_.at += holding.length;
        if (has_list(subject, "held by")) return true;
        return back();
    }
    if (c_.take(Class::riding)) return has_list(subject, "ridden by") || back();
    if (c_.peek(Class::having) && !c_.peek(Class::conjunction)) {
        c_.take(Class::having);
        return has_list(subject, "with") || back();
    }
    if (c_.peek(Class::relative)) return relative(subject) || back();
    if (const auto where = c_.peek(Class::emerging);
        where && (c_.peek(Class::relation, where.length) || c_.peek(Class::direction, where.length)))
        c_.at += where.length;
    if (const auto where = c_.peek(Class::where_pose)) {
        Cursor place = c_;
        place.at += where.length;
        while (place.take(Class::as_well) || place.take(Class::degree)) {}
        if (place.peek(Class::relation)) c_.at = place.at;
    }
    if (c_.peek(Class::relation) || c_.peek(Class::environment)) return related(subject) || back();
    if (const auto like = c_.peek(Class::like)) {
        if (alike({subject})) return true;
        (void)like;
        return back();
    }
    if (c_.peek(Class::pose) || c_.peek(Class::verb_pose)) return pose_text({subject}) || back();
    return back();
}

}  // namespace gse::language::plan
