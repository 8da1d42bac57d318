// Places: where a thing is, seen from another, and what is around all of them.
#include <algorithm>

#include "engine/language/plan/grammar/reader.h"

namespace gse::language::plan {
namespace {

constexpr std::pair<std::string_view, std::string_view> Inverses[] = {
    {"on", "under"},           {"under", "above"},      {"above", "under"},
    {"left of", "right of"},   {"right of", "left of"}, {"behind", "in front of"},
    {"in front of", "behind"}, {"in", "around"},        {"around", "in"}};

std::string_view inverse(std::string_view relation) {
    for (const auto& [one, other] : Inverses)
        if (one == relation) return other;
    return relation;
}

}  // namespace

/// "in blue", "in stripes".
bool Reader::in_colour(const Target& subject) {
    {
        Cursor colour = c_;
        colour.take(Class::article);
        const auto attributes = colour.take_attributes();
        const bool ends = colour.at_end_of_clause() ||
                          (colour.ends_phrase(0, true) && colour.noun_length() == 0) ||
                          colour.peek(Class::colour_word);
        const bool colours = !attributes.empty() &&
                             std::all_of(attributes.begin(), attributes.end(), [](const Attribute& each) {
                                 return each.quality == Quality::Colour || each.quality == Quality::Pattern ||
                                        each.quality == Quality::Shift || each.quality == Quality::Material;
                             });
        if (colours && ends && subject.found() &&
            !(attributes.size() == 1 && attributes[0].quality == Quality::Material &&
              has(Class::ground, attributes[0].value))) {
            c_.at = colour.at;
            c_.take(Class::colour_word);
            return apply_all({subject}, attributes);
        }
    }
    return false;
}

/// "a forest", with `before` said of it, where the scene shows none.
bool Reader::in_place(const Cursor& ahead, const std::string& before) {
    const auto place = ahead.peek(Class::place);
    Phrase named;
    named.noun = named.typed = std::string(place.value);
    if (place && d_.things_named(named).empty()) {
        Cursor behind = ahead;
        behind.at += place.length;
        if (behind.at_end_of_clause() || behind.ends_phrase(0, true)) {
            c_.at = behind.at;
            d_.environment(before + std::string(place.value));
            return true;
        }
    }
    return false;
}

/// Surroundings: "at night", "in a forest", "in the style of", "in blue".
bool Reader::surroundings(const Target& subject, std::string_view relation) {
    Cursor ahead = c_;
    const bool inside = relation == "in" || relation == "under" || relation == "beside" || relation == "on";
    if (!inside) return false;
    Cursor style = ahead;
    style.take(Class::definite);
    style.take(Class::article);
    if (style.take(Class::style_word) && style.take(Class::of)) {
        const auto whole = described_ && subject.found() && described_->reference == subject.reference &&
                                   frame_ == Frame::Describe && !described_definite_
                               ? d_.scene_target()
                               : subject;
        c_.at = style.at;
        if (style_text({whole})) return true;
        Phrase model;
        if (!c_.take_phrase(model)) return false;
        d_.style(whole, model.typed);
        return true;
    }
    if (relation == "in" && style_text({frame_ == Frame::Describe ? d_.scene_target() : subject}))
        return true;
    ahead.take(Class::article);
    ahead.take(Class::definite);
    Attribute adjective;
    Cursor described = ahead;
    std::string text;
    if (!ahead.peek(Class::environment) && described.take_attribute(adjective, true)) {
        if (described.peek(Class::environment) || described.peek(Class::place)) {
            text = adjective.typed + " ";
            ahead.at = described.at;
        }
    }
    const auto weather = ahead.peek(Class::environment);
    if (weather && relation != "on") {
        Cursor behind = ahead;
        behind.at += weather.length;
        if (behind.at_end_of_clause() || behind.ends_phrase(0, true) || behind.peek(Class::time_word) ||
            behind.noun_length() == 0) {
            text += weather.value;
            behind.take(Class::time_word);
            c_.at = behind.at;
            d_.environment(text);
            return true;
        }
    }
    if (relation != "under" && in_place(ahead, text)) return true;
    return relation == "in" && in_colour(subject);
}

/// "between the house and the tree".
bool Reader::between(const Target& subject, const Phrase& phrase) {
    Phrase second;
    Cursor ahead = c_;
    ahead.take(Class::conjunction);
    if (ahead.take_phrase(second)) {
        c_.at = ahead.at;
        const auto one = d_.resolve(phrase), two = d_.resolve(second);
        if (subject.step && one.found() && two.found()) {
            d_.set_anchors(subject, "between", {one, two});
            return true;
        }
        if (!one.found() && !two.found() && subject.kind == Target::Kind::There) {
            d_.add(phrase, "left of", {subject});
            d_.add(second, "right of", {subject});
            return true;
        }
        for (const auto& each : {phrase, second})  // "the camera" is no thing of the scene, and none to add
            if (each.definite && !d_.resolve(each).found()) return expect(each).found();
        if (subject.kind == Target::Kind::There) {
            for (const auto& each : {phrase, second})
                if (!d_.resolve(each).found()) d_.add(each, "beside", {subject});
            return true;
        }
    }
    return false;
}

bool Reader::related(const Target& subject) {
    const std::size_t start = c_.at;
    if (const auto weather = c_.peek(Class::environment); weather && !c_.peek(Class::relation)) {
        c_.at += weather.length;
        d_.environment(std::string(weather.value));
        return true;
    }
    const auto relation = c_.take(Class::relation);
    if (surroundings(subject, relation.value)) return true;
    Phrase phrase;
    Attribute ignored;
    if (!c_.take_phrase(phrase)) {
        c_.at = start;
        return false;
    }
    if (relation.value == "in" && phrase.indefinite && is_worn(phrase) && d_.can_wear(subject))
        return own(subject, phrase, "worn by");  // "in a hood"
    if (relation.value == "between" && c_.peek(Class::conjunction)) {
        if (between(subject, phrase)) return true;
    }
    if (!relate(subject, relation.value, phrase)) {
        c_.at = start;
        return false;
    }
    // "on the grass and the sand", "next to a tree and a house"
    while (true) {
        Cursor ahead = c_;
        Phrase next;
        if (relation.value == "on" || relation.value == "in" || !ahead.take(Class::conjunction) ||
            starts_verb(ahead.at - c_.at) || !ahead.take_phrase(next) || next.noun.empty() ||
            !next.indefinite)
            break;
        if (ahead.peek(Class::relation) || ahead.peek(Class::copula)) break;
        c_.at = ahead.at;
        if (!relate(subject, relation.value, next)) break;
    }
    return true;
}

/// The other thing is there: the subject is beside it, or goes there.
bool Reader::relate_there(const Target& subject, std::string_view relation, const Phrase& phrase,
                          const Target& found) {
    const bool of_focus = subject.step && !phrase.possessive && d_.focus().found();
    Target bearer = of_focus ? d_.focus() : subject;  // "flags on the towers"
    if (on_bearer(phrase, bearer) && subject.step) {
        d_.set_anchor(subject, relation, bearer);
        return true;
    }
    if (subject.step && subject.kind == Target::Kind::Made) {
        const bool worn =
            relation == "on" && has(Class::worn, subject.reference.root()) && d_.can_wear(found);
        d_.set_anchor(subject, worn ? std::string_view("worn by") : relation, found);
        apply_all({found}, found.thing ? phrase.attributes : std::vector<Attribute>{});
        return true;
    }
    if (subject.reference == found.reference) return true;
    const bool surface = !d_.is_animate(found) || (found.thing && d_.scene().things[*found.thing].is_ground);
    const bool backdrop = relation == "in front of" && has(Class::backdrop, found.reference.root());
    const bool side = !backdrop && relation != "in" && relation != "beside" && relation != "under" &&
                      (relation != "on" || !surface);
    if (found.thing && !phrase.attributes.empty()) apply_all({found}, phrase.attributes);
    if (side && subject.thing && !phrase.owner) d_.move(subject, "move " + std::string(relation), found);
    else d_.already_so();
    return true;
}

/// Subject and another thing, new or there: where the one is, seen from the other.
bool Reader::relate(const Target& subject, std::string_view relation, const Phrase& phrase) {
    if (phrase.naming == Naming::Something) return false;
    const bool place_of_thing = (relation == "on" || relation == "in" || relation == "under") &&
                                is_ground(phrase) && !is_worn(phrase);
    const auto found = d_.resolve(phrase);
    const bool there = found.found();
    if (place_of_thing && !(there && !phrase.another)) {
        if (subject.is_scene()) return false;
        d_.ground(phrase);
        return true;
    }
    if (place_of_thing && there && found.thing && d_.scene().things[*found.thing].is_ground) {
        d_.already_so();
        const bool named = phrase.noun == d_.scene().things[*found.thing].noun;
        if (!named && has(Class::ground, phrase.noun) &&
            !are_synonyms(d_.scene().things[*found.thing].noun, phrase.noun))
            d_.ground(phrase);
        else apply_all({found}, phrase.attributes);
        return true;
    }
    if (there) { return relate_there(subject, relation, phrase, found); }
    if (found.kind == Target::Kind::Ambiguous) return fail(reason::Ambiguous);
    if (phrase.noun.empty() || phrase.naming != Naming::Thing) return false;
    if (phrase.owner || (phrase.possessive && is_part(phrase))) return false;
    if (is_worn(phrase) && relation == "in" && !has(Class::container, phrase.noun))
        return own(subject, phrase, "worn by");
    if (!is_thing(phrase)) return false;
    auto how = inverse(relation);
    if (relation == "between") how = "beside";
    if (relation == "in" && !has(Class::container, phrase.noun) &&
        (kinds_of(phrase.noun) & (Artifact | Object)) == 0) {
        if ((kinds_of(phrase.noun) & (Plant | Animal | Person)) == 0) {
            d_.environment(phrase.typed);
            return true;
        }
    }
    const auto made = d_.add(phrase, how, {subject});
    d_.mention(made);
    nested(made, subject);
    return true;
}

}  // namespace gse::language::plan
