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
std::string_view having_relation(const Phrase& phrase, bool animate, bool furniture, bool holds) {
    if (is_worn(phrase)) return "worn by";
    if (has(Class::floating, phrase.noun) || has(Class::floating, phrase.typed))
        return animate && is_held(phrase) ? "held by" : "on";
    if (is_held(phrase) && animate) return "held by";
    if (is_part(phrase)) return animate ? "worn by" : "on";
    return holds && (kinds_of(phrase.noun) & (Plant | Food)) != 0 ? "in" : furniture ? "on" : "beside";
}

}  // namespace

/// Tells whether the next of a list stands behind a comma or "and"; steps to it.
bool Reader::list_goes_on() {
    Cursor ahead = c_;
    const bool comma = ahead.take_mark(',');
    const bool joint = ahead.take(Class::conjunction).length > 0 || ahead.take(Class::alternative).length > 0;
    if (!comma && !joint) return false;
    while (ahead.take(Class::having) || ahead.take(Class::as_well)) {}
    if (ahead.peek(Class::wearing)) return false;
    const std::size_t distance = ahead.at - c_.at;
    if (comma && ahead.peek(Class::noise)) return false;
    const bool clothes = ahead.peek(Class::worn) && !starts_object(distance + 1);  // "a suit and tie"
    if ((starts_verb(distance) && !clothes) || ahead.peek(Class::holding) || ahead.peek(Class::riding))
        return false;
    if (ahead.peek(Class::sequence) && !ahead.peek(Class::another)) return false;  // "and finally remove"
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
        if (attribute.quality == Quality::Colour || attribute.quality == Quality::Material)
            colour = attribute.value;  // "golden stripes"
        if (attribute.quality == Quality::Pattern)
            value = attribute.value, colour = attribute.colour.empty() ? colour : attribute.colour;
    }
    const bool named = has(Class::pattern_word, last);
    if (Cursor of = c_; named && value.empty() && of.take(Class::of)) {  // "a pattern of hearts"
        if (const auto motif = of.take(Class::pattern)) {
            c_.at = of.at;
            value = motif.value;
        }
    }
    if (named && first != last && has(Class::material, first) && !has(Class::pattern, first)) {
        const auto stuff = *meaning(Class::material, first);  // "a wood grain"
        d_.apply(subject, {Quality::Material, std::string(stuff), std::string(stuff), ""});
        return true;
    }
    if (named && first != last) value = meaning(Class::pattern, first).value_or(first);
    const bool motif = last == "pattern" || last == "print" || last == "motif";
    for (const auto& attribute : phrase.attributes)  // "a diamond pattern"
        if (motif && value.empty() && attribute.quality == Quality::Material &&
            has(Class::pattern, attribute.value))
            value = *meaning(Class::pattern, attribute.value), colour.clear();
    if (named && value.empty()) {
        for (const auto& attribute : phrase.attributes)
            if (attribute.quality == Quality::Material || attribute.quality == Quality::Surface ||
                (attribute.quality == Quality::Colour && !motif)) {
                d_.apply(subject, attribute);
                value = attribute.value;
            }
        return !value.empty();
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
    const bool stands = c_.peek(Class::where_pose) && ahead.peek(Class::relation);  // "a mane sitting on"
    if (!more.empty() && ends && !stands) {
        c_.at = ahead.at;
        attributes.insert(attributes.end(), more.begin(), more.end());
    } else if (c_.peek(Class::made_of) && !is_worn(phrase)) {
        return material_of({part});
    }
    if (attributes.empty() || (is_worn(phrase) && more.empty())) return false;
    for (const auto& attribute : attributes) {
        const bool out = attribute.typed == "out";  // "with its tongue out"
        if (attribute.quality == Quality::Pose || out)
            d_.step(Operation::Pose, subject, phrase.typed + " " + attribute.value);
        else d_.apply(part, attribute);
    }
    return true;
}

/// A thing that the scene shows already: how it is, or another of its kind.
bool Reader::own_there(const Target& subject, const Phrase& phrase, std::string_view relation,
                       const Target& there) {
    const bool itself = there.reference == subject.reference;
    if (itself && phrase.indefinite && relation != "with" && phrase.noun != subject.reference.root()) {
        nested(d_.add(phrase, relation, {subject}), subject);  // "a bear hugging a teddy bear"
        return true;
    }
    if (itself) return false;
    if (relation == "ridden by" && subject.thing && there.thing) {  // "the frog should ride the bear"
        d_.move(subject, "move on", there);
        return true;
    }
    if (relation == "ridden by" && subject.step) d_.set_anchor(subject, "on", there);
    d_.already_so();
    apply_all({there}, phrase.attributes);
    nested(there, subject);
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
        return own_there(subject, phrase, relation, d_.target_of_thing(found.front()));
    }
    if (is_ground(phrase) && relation == "with" && !is_worn(phrase) && !is_held(phrase) &&
        !has(Class::floating, phrase.noun) && !has(Class::thing, phrase.noun))
        return relate(subject, "on", phrase);
    const bool of_things = d_.can_wear(subject) && has(Class::part_made, word_of(phrase.noun).singular) &&
                           phrase.indefinite;  // "a golden key around its neck"
    if (is_part(phrase) && !of_things && relation != "worn by" && own_part(subject, phrase)) return true;
    if (is_part(phrase) && !is_worn(phrase) && relation == "with" && d_.can_wear(subject) &&
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
                                           carries(subject.reference.root()),
                                           has(Class::container, subject.reference.root()))
                         : relation;
    if (how == "worn by" && is_ground(phrase)) return false;
    const auto head = kinds_of(last_word(phrase.noun));
    if (how == "beside" && !is_thing(phrase) && (head & Perhaps) == 0) return false;  // "with a difference"
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
    if (phrase.possessive && is_part(phrase) && !is_worn(phrase)) return false;  // "its paw on a ball"
    const auto made = d_.add(phrase, how, {subject});
    d_.mention(made);
    nested(made, subject);
    return true;
}

/// "with blue" and "with stripes" have no noun; "with lavender" is no colour.
bool Reader::has_quality(const Target& subject, std::string_view relation) {
    if (relation == "held by") return false;  // "eats honey" is no colour
    const auto& plant = c_.word();
    const bool several = plant.text != plant.singular && has(Class::material, plant.text) &&
                         c_.peek(Class::relation, 1) && c_.peek(Class::pronoun_it, 2);
    if (several) {  // "with diamonds on it"
        Phrase many;
        many.noun = plant.singular;
        many.typed = plant.text;
        many.plural = true;
        ++c_.at;
        const auto made = d_.add(many, "on", {subject});
        nested(made, subject);
        return true;
    }
    const bool grows = relation == "with" && (kinds_of(plant.text) & (Plant | Food)) != 0;
    if (!grows || c_.noun_length() != 1 || !has(Class::colour, plant.text))
        return apply_all({subject}, c_.take_attributes());
    Phrase herb;
    herb.noun = herb.typed = plant.text;
    ++c_.at;
    return own(subject, herb, relation);
}

/// "with a huge smile", "with a blue (one)".
bool Reader::has_looks(const Target& subject, const std::vector<Attribute>& attributes) {
    if (attributes.size() < 2 || attributes.back().quality != Quality::Pose)
        return apply_all({subject}, attributes);
    std::string text;
    for (const auto& each : attributes) text += (text.empty() ? "" : " ") + each.typed;
    d_.step(Operation::Pose, subject, text);
    return true;
}

/// Removes all that is worn.
void Reader::undress() {
    const auto& things = d_.scene().things;
    d_.already_so();
    for (std::size_t i = 0; i < things.size(); ++i)
        if (things[i].is_worn) d_.remove(d_.target_of_thing(i));
}

bool Reader::has_list(const Target& subject, std::string_view relation) {
    Phrase phrase;
    std::size_t behind = 0;        // position behind the thing before
    std::vector<Attribute> looks;  // of the part before
    if (c_.is(Class::word_neither)) return lack_both(subject);
    do {
        const std::size_t start = c_.at;
        if (c_.peek(Class::definite) && compared({subject})) continue;  // "the color of honey"
        if (Cursor look = c_; look.take(Class::article) && look.take(Class::style) &&
                              look.take(Class::style_word)) {  // "a vintage look"
            const auto subjects = Targets{subject};
            if (style_text(subjects)) continue;
        }
        Cursor lacking = c_;
        lacking.take(Class::article);  // "with a missing arm"
        if (lacking.peek(Class::without) && (lacking.at == c_.at || lacking.peek(Class::gone))) {
            lacking.take(Class::without);
            c_.at = lacking.at;
            return lack_list(subject);
        }
        if (c_.is(Class::word_nothing) && (c_.peek(Class::contrast, 1) || c_.peek(Class::except, 1)))
            c_.at += 2;                                             // "wearing nothing but a tie"
        if (c_.is(Class::word_nothing) && relation == "worn by") {  // "wears nothing"
            ++c_.at;
            undress();
            return true;
        }
        if (c_.is(Class::word_nothing)) return false;
        if (!c_.take_phrase(phrase) || phrase.naming != Naming::Thing) {
            c_.at = start;
            if (!has_quality(subject, relation)) return false;
            continue;
        }
        if (phrase.noun.empty()) {
            if (!has_looks(subject, phrase.attributes)) return false;
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
        const bool bare = is_part(phrase) && !phrase.has_determiner() && phrase.attributes.empty();
        if (bare && behind > 0) phrase.attributes = looks;  // "purple hands and feet"
        looks = is_part(phrase) ? phrase.attributes : std::vector<Attribute>{};
        if (relation == "worn by" && behind > 0 && !is_worn(phrase) &&
            (kinds_of(phrase.noun) & (Animal | Person)) != 0) {
            c_.at = behind;  // "wearing a hat and a scarf, and a cat"
            return true;
        }
        if (!own(subject, phrase, relation)) return false;
        behind = c_.at;
    } while (list_goes_on());
    return true;
}

/// "(a hat) on its head", "next to him"; false where another place stands there, nothing where none does.
std::optional<bool> Reader::nested_place(const Target& made, const Target& bearer, Cursor ahead) {
    Phrase place;
    const auto relation = ahead.take(Class::relation);
    if (!relation) return std::nullopt;
    if (!ahead.take_phrase(place)) {
        if (!ahead.at_end_of_clause()) return false;
        const bool put_on = relation.value == "on" && relation.length == 1;  // "with no hat on"
        if (!put_on && (!made.step || relation.value == "in")) return false;
        if (!put_on) d_.set_anchor(made, relation.value, bearer);
        c_.at = ahead.at;
        return true;
    }
    Target whose = bearer;
    if (on_bearer(place, whose)) {
        c_.at = ahead.at;
        const bool worn = has(Class::worn, made.reference.root()) || made.thing;
        const bool held = relation.value == "in" && has(Class::hand, word_of(place.typed).singular);
        if (made.step && held) d_.set_anchor(made, "held by", bearer);
        else if (made.step && !worn) d_.set_anchor(made, relation.value, whose);
        return true;
    }
    const auto found = d_.resolve(place);
    const bool bears = found.found() && found.reference == bearer.reference;
    if (!bears && place.naming != Naming::It && place.naming != Naming::Person) return false;
    c_.at = ahead.at;
    if (made.step) d_.set_anchor(made, relation.value, bearer);
    return true;
}

/// Place of a new thing on or beside who has it: "on its head", "next to him", "made of gold", "that is red".
void Reader::nested(const Target& made, const Target& bearer) {
    while (true) {
        const std::size_t start = c_.at;
        Cursor ahead = c_;
        Target owner;
        if (const auto side = made.step ? take_side(owner) : std::string_view(); !side.empty()) {
            d_.set_anchor(made, side, owner);
            continue;
        }
        if (made.step && ahead.peek(Class::copula) && ahead.peek(Class::emerging, 1)) ++ahead.at;
        while (ahead.take(Class::emerging)) {}
        if (const auto read = nested_place(made, bearer, ahead)) {
            if (*read) continue;
            c_.at = start;
            return;
        }
        if (const auto side = c_.peek(Class::direction);
            made.step && bearer.found() && !c_.peek(Class::of, side.length) &&
            ((side.length == 3 && (side.value == "left" || side.value == "right")) ||
             (side.length == 3 && c_.is(Class::possessive, 1)))) {
            c_.at += side.length;  // "to its left", "to the right"
            d_.set_anchor(made, side.value == "left" ? "left of" : "right of", bearer);
            continue;
        }
        if (made.step && c_.is(Class::word_to) && takes_use(made, bearer)) continue;
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

/// "on fire", "in flames".
bool Reader::burns(const Target& subject) {
    const auto fire = c_.peek(Class::fire_words);
    if (!fire || subject.is_scene()) return false;
    c_.at += fire.length;
    Phrase flames;
    flames.noun = flames.typed = std::string(fire.value);
    d_.add(flames, "on", {subject});
    return true;
}

/// Steps over "standing" and "lying" before a place.
void Reader::skip_where_pose() {
    if (const auto where = c_.peek(Class::emerging);
        where && c_.peek(Class::relation).length <= where.length &&
        (c_.peek(Class::relation, where.length) || c_.peek(Class::direction, where.length)))
        c_.at += where.length;
    Cursor place = c_;
    if (c_.peek(Class::relation).length > 1) return;  // "leaning on"
    if (!place.take(Class::where_pose)) return;
    while (place.take(Class::as_well) || place.take(Class::degree)) {}
    if (place.peek(Class::relation)) c_.at = place.at;
}

/// "holding a flower", "playing on the grass".
bool Reader::holds(const Target& subject) {
    const auto verb = c_.word().text;
    c_.take(Class::holding);
    if (!c_.peek(Class::relation) && !c_.at_end_of_clause()) return has_list(subject, "held by");
    const bool doing = verb.ends_with("ing");
    if (doing && subject.kind == Target::Kind::There) d_.step(Operation::Pose, subject, verb);
    return doing;
}

bool Reader::post(const Target& subject) {
    const std::size_t start = c_.at;
    const bool lacks = c_.peek(Class::negation) && (c_.peek(Class::wearing, 1) ||
                                                    c_.peek(Class::holding, 1) || c_.peek(Class::having, 1));
    if (c_.peek(Class::rather_than) && !lacks) return false;
    if (c_.peek(Class::subordinate)) {  // "while snow is falling"
        if (weather_clause()) return true;
    }
    c_.take(Class::degree);
    if (c_.peek(Class::as_well).length >= c_.peek(Class::relation).length) c_.take(Class::as_well);
    const auto back = [&] {
        c_.at = start;
        return false;
    };
    if (burns(subject) || looks_somewhere({subject}) || stands_on_part(subject)) return true;
    if (c_.peek(Class::size) && compared({subject})) return true;  // "a bear bigger than a house"
    if (c_.is(Class::word_as) && (compared({subject}) || as_much_as({subject}))) return true;
    if (lacks) {  // "not wearing a hat"
        c_.at += 2;
        return lack_list(subject) || back();
    }
    if (c_.peek(Class::verb_recolour) && c_.word().text.ends_with("ed") && !c_.at_end_of_clause() &&
        complement_once({subject}))
        return true;                                               // "a vase painted blue"
    if (c_.peek(Class::times) && measure({subject})) return true;  // "a bear twice as tall"
    if (c_.take(Class::word_whose)) {                              // "whose eyes are blue"
        Phrase part;
        return (c_.take_phrase(part) && is_part(part) && own_part(subject, part)) || back();
    }
    if (c_.take(Class::without)) return lack_list(subject) || back();
    if (c_.peek(Class::inverse_relation)) return inversely_related(subject) || back();
    const bool of_other = c_.peek(Class::of) && c_.peek(Class::made_of).length < 2 && c_.is_thing_before() &&
                          c_.previous().singular != last_word(subject.reference.root());
    if (of_other) return back();  // "in a field of flowers"
    if (c_.peek(Class::made_of) || c_.peek(Class::of)) return material_of({subject}) || back();
    if (c_.take(Class::dressed_as)) {
        Phrase role;
        if (!c_.take_phrase(role) || role.noun.empty()) return back();
        d_.step(Operation::Alter, subject, role.typed);
        return true;
    }
    if (const auto pose = doing(); !pose.empty()) {  // "scratching its back"
        d_.step(Operation::Pose, subject, pose);
        return true;
    }
    if (c_.take(Class::wearing)) return has_list(subject, "worn by") || back();
    const bool holds_more = c_.peek(Class::holding).length >= c_.peek(Class::relation).length;
    if (c_.peek(Class::holding) && holds_more && !c_.is(Class::word_like)) return holds(subject) || back();
    if (c_.take(Class::riding)) return has_list(subject, "ridden by") || back();
    if (c_.peek(Class::having) && !c_.peek(Class::conjunction)) {
        c_.take(Class::having);
        return has_list(subject, "with") || back();
    }
    if (c_.peek(Class::relative)) return relative(subject) || back();
    skip_where_pose();
    if (c_.peek(Class::relation) || c_.peek(Class::environment)) return related(subject) || back();
    if (c_.peek(Class::like)) return alike({subject}) || back();
    if (c_.peek(Class::pose) || c_.peek(Class::verb_pose)) return pose_text({subject}) || back();
    return back();
}

}  // namespace gse::language::plan
