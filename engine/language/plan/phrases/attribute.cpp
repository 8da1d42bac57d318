// Reading descriptions: colours, materials, patterns, sizes, looks and poses.
#include <algorithm>

#include "engine/language/plan/phrases/phrase.h"

namespace gse::language::plan {
namespace {

bool is_colour(std::string_view word) { return has(Class::colour, word); }

std::string text_of(std::span<const Word> words) {
    std::string text;
    for (const auto& word : words) text += (text.empty() ? "" : " ") + word.text;
    return text;
}

/// Change that takes away of a size: "too long" asks for a shorter one.
std::string less_of(const std::string& change) {
    constexpr std::pair<std::string_view, std::string_view> Less[] = {
        {"bigger", "smaller"}, {"smaller", "bigger"},  {"taller", "shorter"},
        {"longer", "shorter"}, {"shorter", "longer"},  {"wider", "narrower"},
        {"narrower", "wider"}, {"thicker", "thinner"}, {"thinner", "thicker"}};
    for (const auto& [more, less] : Less)
        if (more == change) return std::string(less);
    return change;
}

/// "riper", "floppier": no word of the lists, made of an adjective.
bool is_comparative(const std::string& word) {
    if (word.size() < 5 || !word.ends_with("er")) return false;
    const auto stem = word.substr(0, word.size() - 2);
    const auto describes = [](const std::string& text) {
        return (kinds_of(text) & Kind::Adjective) != 0 || has(Class::state, text) || has(Class::pose, text) ||
               has(Class::material_surface, text);
    };
    const bool doubled = stem[stem.size() - 1] == stem[stem.size() - 2];
    const auto vowel = [&](std::size_t back) {
        return std::string_view("aeiouy").find(stem[stem.size() - back]) != std::string_view::npos;
    };
    const bool once = stem.size() == 3 && !vowel(1) && vowel(2) && !vowel(3) && stem[2] != 'w' &&
                      stem[2] != 'x';  // "biger" lacks a letter
    return (describes(stem) && !once) || describes(stem + "e") ||
           (stem.ends_with('i') && describes(stem.substr(0, stem.size() - 1) + "y")) ||
           (doubled && describes(stem.substr(0, stem.size() - 1)));
}

/// Length and name of the colour that the words begin with, shades before it ("dark blue"); 0 for none.
std::size_t colour_length(std::span<const Word> words, std::string& name) {
    std::size_t at = 0;
    while (at < words.size() && has(Class::shade, words[at].text) &&
           match(Class::colour, words.subspan(at)).length < 2)
        ++at;
    const auto found = match(Class::colour, words.subspan(std::min(at, words.size())));
    if (found) {
        const std::size_t length = at + found.length;
        name = text_of(words.first(length));
        const bool colored = length < words.size() && words[length].text == "colored";
        return length + (colored ? 1 : 0);  // "salmon colored"
    }
    if (words.empty()) return 0;
    if (has(Class::colour_noun, words[0].text) && match(Class::pattern_plain, words.subspan(1))) {
        name = *meaning(Class::colour_noun, words[0].text);  // "red and gold striped"
        return 1;
    }
    if (const auto shade =
            match(Class::shade_of, words.subspan(std::min(at, words.size())))) {  // "a deeper shade of red"
        const auto colour = match(Class::colour, words.subspan(at + shade.length));
        if (colour) {
            name = text_of(words.first(at)) + (at > 0 ? " " : "") + std::string(colour.value);
            return at + shade.length + colour.length;
        }
    }
    const auto& word = words[0].text;
    if (has(Class::pattern_plain, word)) return 0;  // "rainbow-colored"
    if (word.ends_with("-colored") && word.size() > 8) {
        name = word;
        return 1;
    }
    // "gold colored"
    const bool named = words.size() > 1 && words[1].text == "colored" && !words[0].mark &&
                       match(Class::pattern_plain, words).length < 2;  // "rainbow colored"
    if (named) {
        const auto metal = meaning(Class::material, word);
        name = metal && is_colour(word) ? word : metal ? std::string(*metal) : word;
        return 2;
    }
    return 0;
}

}  // namespace

void temper(Attribute& attribute) {
    constexpr std::pair<std::string_view, std::string_view> Opposites[] = {
        {"dark", "lighter"},         {"darker", "lighter"},
        {"light", "darker"},         {"lighter", "darker"},
        {"bright", "darker"},        {"brighter", "darker"},
        {"pale", "darker"},          {"paler", "darker"},
        {"vivid", "less saturated"}, {"colorful", "less saturated"},
        {"old", "younger"},          {"young", "older"}};
    if (attribute.quality == Quality::Size) {
        attribute.value = less_of(attribute.value);
        return;
    }
    for (const auto& [much, wanted] : Opposites)
        if (attribute.value == much) {
            attribute.value = wanted;
            return;
        }
    attribute.value = "less " + attribute.value;
    if (attribute.quality != Quality::Colour && attribute.quality != Quality::Shift)
        attribute.quality = Quality::State;
    attribute.typed = attribute.value;
}

bool Cursor::take_colour(Attribute& attribute, bool in_phrase) {
    std::string name;
    std::size_t length = colour_length(rest(), name);
    if (length == 0) return false;
    std::string all = name;
    at += length;
    // "red, yellow and blue"; a comma alone joins only where "and" follows
    while (!done()) {
        std::size_t comma = is_mark(",") ? 1 : 0;
        std::size_t joint = peek(Class::conjunction, comma).length;
        if (is_mark("/")) comma = 1, joint = 0;
        if (comma + joint == 0) break;
        std::size_t begin = comma + joint;
        while (peek(Class::degree, begin) || is(Class::word_half, begin)) ++begin;
        const std::size_t more = colour_length(rest(begin), name);
        if (more == 0) break;
        const std::size_t behind = begin + more;
        // "a red bear and a blue bear" has an article between; "blue and white horse": of one thing
        const bool list_goes_on =
            joint > 0 || is_mark(",/", behind) || peek(Class::conjunction, behind).length > 0;
        if (!list_goes_on && !is_mark("/")) break;
        if (in_phrase && noun_length(behind) == 0 && joint > 0 && !ends_phrase(behind, true) &&
            !peek(Class::pattern_plain, behind))
            break;
        all += " and " + name;
        at += behind;
    }
    attribute = {Quality::Colour, all, all, ""};
    if (const auto pattern = peek(Class::pattern_plain); pattern && peek(Class::pattern)) {
        // "red and white striped": colours of the pattern; "black striped" too
        attribute = {Quality::Pattern, std::string(peek(Class::pattern).value), "", all};
        take(Class::pattern);
        attribute.typed = attribute.value;
    }
    return true;
}

bool Cursor::take_graded(Attribute& attribute) {
    // "more wooden", "less shiny": as without the word
    const bool more = static_cast<bool>(peek(Class::more)), less = static_cast<bool>(peek(Class::less));
    if (!more && !less && !peek(Class::most)) return false;
    const std::size_t start = at;
    if (const auto shift = take(Class::shift)) {
        attribute = {Quality::Shift, std::string(shift.value), text_of(words_.subspan(start, at - start)),
                     ""};
        return true;
    }
    if (const auto size = take(Class::size)) {
        attribute = {Quality::Size, std::string(size.value), text_of(words_.subspan(start, at - start)), ""};
        return true;
    }
    ++at;
    if (take_attribute(attribute, false)) {
        if (less) {
            attribute.value = "less " + attribute.value;
            if (attribute.quality != Quality::Colour && attribute.quality != Quality::Shift)
                attribute.quality = Quality::State;
        }
        if (attribute.quality == Quality::Colour) {  // "less red" of a red bear is no red
            if (more) attribute.value = "more " + attribute.value;
            attribute.typed = attribute.value;
        }
        if (more && attribute.quality == Quality::State) attribute.value = "more " + attribute.value;
        return true;
    }
    if (more && !done() && (kinds_of(word().text) & Kind::Adjective) != 0) {
        attribute = {Quality::State, "more " + word().text, word().text, ""};
        ++at;
        return true;
    }
    at = start;
    return false;
}

/// Adjectives that are in no class: "grumpy", "thatched".
bool Cursor::take_other_attribute(Attribute& attribute, bool in_phrase) {
    for (const auto kind : {Class::courtesy, Class::correction, Class::wearing, Class::holding, Class::having,
                            Class::riding, Class::degree, Class::all})
        if (peek(kind)) return false;
    if (peek(Class::thing_name) || peek(Class::number) || peek(Class::direction) || peek(Class::like) ||
        peek(Class::sequence))
        return false;
    const bool participle = (word().text.ends_with("ed") || word().text.ends_with("ing")) &&
                            word().base != word().text && noun_length() == 0;
    if (participle && in_phrase && noun_length(1) > 0 && !ends_phrase(1, true)) {  // "a thatched roof"
        attribute = {Quality::Other, word().text, word().text, ""};
        ++at;
        return true;
    }
    const auto kinds = kinds_of(word().text);
    const bool only_adjective =
        ((kinds & Kind::Adjective) != 0 && (kinds & (Concrete | Perhaps)) == 0 && noun_length() <= 1) ||
        (kinds == 0 && is_comparative(word().text));
    const bool noun_follows = in_phrase && noun_length(1) > 0 && !ends_phrase(1, true);
    const bool ends = ends_phrase(1, true) && (kinds & Other) == 0;
    if (only_adjective && !peek(Class::colour_word) && !peek(Class::part) && !peek(Class::worn) &&
        (noun_follows || ends) && !is_scene_noun(word().text)) {
        attribute = {Quality::Other, word().text, word().text, ""};
        ++at;
        return true;
    }
    return false;
}

/// "zebra stripes", "spotted", "striped red and white".
bool Cursor::take_pattern(Attribute& attribute, bool in_phrase) {
    if (const auto animal = peek(Class::pattern_animal);
        animal && !is(Class::word_rainbow, 1) &&
        (match(Class::pattern_plain, rest(animal.length)) || word(animal.length).text == "patterned")) {
        at += animal.length;
        if (!take(Class::pattern_plain)) ++at;  // "giraffe-patterned"
        attribute = {Quality::Pattern, std::string(animal.value), std::string(animal.value), ""};
        return true;
    }
    const auto found = take(Class::pattern_plain);
    if (!found) return false;
    const std::string value(meaning(Class::pattern, found.value).value_or(found.value));
    attribute = {Quality::Pattern, value, value, ""};
    if (value == "rainbow") take(Class::pattern_plain);  // "rainbow-striped"
    Attribute colour;
    Cursor behind = *this;
    if (!in_phrase && behind.take_colour(colour, false) && colour.quality == Quality::Colour &&
        (behind.at_end_of_clause() || behind.ends_phrase(0, true))) {
        attribute.colour = colour.value;
        at = behind.at;
    }
    return true;
}

/// "(a) cartoon (bear)", "(an) anime style (bear)".
bool Cursor::take_style(Attribute& attribute) {
    Cursor named = *this;
    const auto style = named.take(Class::style);
    if (!style || peek(Class::compound)) return false;
    named.take(Class::style_word);
    if (!named.is_scene_noun(named.word().singular)) return false;
    at = named.at;
    attribute = {Quality::Style, std::string(style.value), std::string(style.value), ""};
    return true;
}

bool Cursor::take_plain_attribute(Attribute& attribute, bool in_phrase) {
    const std::size_t start = at;
    const auto made = [&](Quality quality, const Match& found, bool as_typed) {
        at += found.length;
        const auto typed = text_of(words_.subspan(start, at - start));
        attribute = {quality, std::string(found.value), as_typed ? typed : std::string(found.value), ""};
        return true;
    };
    if (in_phrase && peek(Class::compound).length > 1) return false;
    if (in_phrase && peek(Class::style).length > 1 && take_style(attribute)) return true;
    if (const auto found = peek(Class::worn_adjective)) return made(Quality::Worn, found, false);
    if (const auto found = peek(Class::unworn_adjective)) return made(Quality::Unworn, found, false);
    if (take_pattern(attribute, in_phrase)) return true;
    if (const auto found = peek(Class::material)) {
        const auto& pattern = word(found.length);  // "golden stripes"
        Attribute striped;
        Cursor behind = *this;
        behind.at += found.length;
        if (pattern.text != pattern.singular && behind.take_pattern(striped, false)) {
            at = behind.at;
            attribute = {Quality::Pattern, striped.value, striped.value, std::string(found.value)};
            return true;
        }
        return made(Quality::Material, found, false);
    }
    if (const auto found = peek(Class::material_surface)) return made(Quality::Surface, found, false);
    if (const auto found = peek(Class::shift);
        found && !(in_phrase && found.length == 1 && !has(Class::shade, word().text)))
        return made(Quality::Shift, found, true);
    if (const auto found = peek(Class::size)) return made(Quality::Size, found, true);
    if (const auto found = peek(Class::state)) return made(Quality::State, found, true);
    if (has(Class::side, word().text) && in_phrase && peek(Class::side).length > 1 && peek(Class::part, 1) &&
        ends_phrase(2, true))  // "its right hand"
        return made(Quality::Side, {1, *meaning(Class::side, word().text)}, false);
    if (const auto found = peek(Class::side);
        found && in_phrase &&
        (peek(Class::part, found.length) || noun_length(found.length) > 0 ||
         is(Class::word_one, found.length)))
        return made(Quality::Side, found, false);
    if (const auto found = peek(Class::pose); found && !peek(Class::fire_words) && !peek(Class::except))
        return made(Quality::Pose, found, true);
    if (in_phrase && is(Class::environment) && peek(Class::environment).length == 1 &&
        (is_scene_noun(word(1).text) || is_scene_noun(word(1).singular)) && ends_phrase(2, true) &&
        !peek(Class::compound))  // "autumn trees"
        return made(Quality::State, peek(Class::environment), true);
    if (in_phrase)
        if (const auto found = peek(Class::pattern_animal);
            found && noun_length(found.length) > 0 && !ends_phrase(found.length, true))
            return made(Quality::Pattern, found, false);
    if (in_phrase && take_style(attribute)) return true;
    if (describes_part(word().text) || word().text.ends_with("-shaped") || word().text.ends_with("-like") ||
        word().text.ends_with("-eyed") || word().text.ends_with("-legged")) {
        attribute = {Quality::Other, word().text, word().text, ""};
        ++at;
        return true;
    }
    return take_other_attribute(attribute, in_phrase);
}

bool Cursor::take_attribute(Attribute& attribute, bool in_phrase) {
    const std::size_t start = at;
    if (done() || word().mark || peek(Class::except).length > 1) return false;
    if (const auto years = peek(Class::number); years && is(Class::word_years, years.length))
        at += years.length + 1;  // "ten years younger"
    const bool too = is(Class::word_too);
    while (const auto degree = peek(Class::degree)) {
        // "light", "little", "pretty" may describe; "too" and "so" may stand alone
        if (peek(Class::size) && !has(Class::shade, word().text) &&
            !has(Class::size, word(degree.length).text) && noun_length(degree.length) > 0 && in_phrase)
            break;
        at += degree.length;
        if (done()) break;
    }
    if (is(Class::word_half) && peek(Class::colour, 1)) ++at;
    if (take_graded(attribute) || take_colour(attribute, in_phrase) ||
        take_plain_attribute(attribute, in_phrase)) {
        if (too) temper(attribute);
        return true;
    }
    at = start;
    return take_plain_attribute(attribute, in_phrase);
}

std::vector<Attribute> Cursor::take_attributes() {
    std::vector<Attribute> attributes;
    Attribute next;
    while (take_attribute(next, false)) {
        attributes.push_back(next);
        Cursor ahead = *this;
        const bool comma = ahead.take_mark(',');
        const bool joint = static_cast<bool>(ahead.take(Class::conjunction));
        if (!comma && !joint) {
            Attribute more;
            Cursor adjacent = *this;
            if (!adjacent.take_attribute(more, false)) break;
            continue;
        }
        Attribute more;
        Cursor probe = ahead;
        const bool order = (kinds_of(ahead.word().text) & Kind::Verb) != 0 && ahead.peek(Class::verb_remove);
        const bool ground = comma && !joint && has(Class::ground, ahead.word().text);  // "blue, snow"
        if (order || ground || !probe.take_attribute(more, false) ||
            (!probe.at_end_of_clause() && probe.noun_length() > 0 && !probe.ends_phrase(0, true)))
            break;
        if (probe.is_mark(":")) break;
        at = ahead.at;
    }
    return attributes;
}

std::string brace_text(const Attribute& attribute) {
    if (attribute.quality == Quality::Pattern && !attribute.colour.empty())
        return attribute.value + " " + attribute.colour;
    return attribute.typed;
}

Thing thing_of(const Phrase& phrase) {
    Thing thing{phrase.noun, phrase.count == "all" ? "some" : phrase.count, {}};
    if (thing.count == "2" && has(Class::pair_noun, phrase.noun)) thing.count.clear();  // "a pair of glasses"
    if (thing.count == "some" && has(Class::pair_noun, phrase.noun) && has(Class::worn, phrase.noun))
        thing.count.clear();  // "some wings"
    if (!thing.count.empty() && phrase.plural && has(Class::pair_noun, phrase.noun) &&
        phrase.noun.find(' ') == std::string::npos)
        thing.noun = word_of(phrase.noun).singular;                    // "some leaves"
    const auto last = phrase.noun.substr(phrase.noun.rfind(' ') + 1);  // "stick arms"
    if (phrase.plural && thing.count.empty() && !has(Class::pair_noun, phrase.noun) &&
        !has(Class::pair_noun, last))
        thing.count = "some";
    for (const auto& attribute : phrase.attributes) {
        if (attribute.quality == Quality::Worn || attribute.quality == Quality::Unworn) continue;
        if (attribute.quality == Quality::Colour && attribute.value.find(" and ") != std::string::npos) {
            std::string rest = attribute.value;
            for (std::size_t cut = rest.find(" and "); cut != std::string::npos; cut = rest.find(" and ")) {
                thing.attributes.push_back(rest.substr(0, cut));
                rest = rest.substr(cut + 5);
            }
            thing.attributes.push_back(rest);
        } else thing.attributes.push_back(brace_text(attribute));
    }
    return thing;
}

}  // namespace gse::language::plan
