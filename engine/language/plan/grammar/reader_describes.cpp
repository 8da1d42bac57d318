// Descriptions of the scene after the edit: "a blue bear wearing a hat", "blue", "on snow".
#include <algorithm>

#include "engine/language/plan/grammar/reader.h"
#include "engine/language/plan/words/sentence_words.h"

namespace gse::language::plan {
namespace {

constexpr std::size_t LongestPlain = 14;  // words; in longer sentences "my sister" is who tells

bool is_one_slip(const std::string& noun, const std::string& other) {
    const std::vector<std::string> needed{other};
    const auto near = slips_of(noun, needed, 100);
    const auto blank = other.rfind(' ');  // "bear" of a teddy bear
    return std::find(near.begin(), near.end(), other) != near.end() ||
           (blank != std::string::npos && is_one_slip(noun, other.substr(blank + 1)));
}

}  // namespace

/// Tells whether the thing that the sentence is about is named from that word on.
bool Reader::mentions_focus(std::size_t from) const {
    const auto focus = d_.focus();
    Cursor here = c_;
    bool instead = false;
    for (here.at = from; !here.done(); ++here.at) {
        instead = here.peek(Class::rather_than).length > 0;
        if (instead) return false;
        Phrase word;
        word.noun = here.word().singular;
        word.typed = here.word().text;
        for (const auto index : d_.things_named(word))
            if (focus.thing ? index == *focus.thing : !d_.scene().things[index].is_ground) return true;
        if (here.peek(Class::pronoun_person)) return true;
        if (const auto relation = here.peek(Class::relation);
            relation && here.peek(Class::possessive, relation.length))
            return true;
    }
    return false;
}

/// "green eyes", "a chimney on the house".
bool Reader::describe_part(const Phrase& phrase, const Target& found) {
    std::vector<Attribute> attributes;
    for (const auto& attribute : phrase.attributes)
        if (attribute.quality != Quality::Side) attributes.push_back(attribute);
    Cursor colour = c_;  // "paw pads in pink"
    const bool coloured = colour.take(Class::relation).value == "in" && !colour.take_attributes().empty() &&
                          colour.at_end_of_clause();
    const bool placed =
        (phrase.plural && !phrase.has_determiner() && c_.peek(Class::relation) && !coloured) ||
        c_.is(Class::word_for);  // "wings for the bear"
    if (attributes.empty() && (phrase.indefinite || placed) && !phrase.owner)
        return describe_new(phrase);  // "a chimney on the house", "leaves on the pavement"
    const bool own_worn = is_worn(phrase) && !phrase.owner &&
                          ((kinds_of(phrase.noun) & Body) == 0 ||
                           (attributes.empty() && !phrase.definite && c_.at_end_of_clause()));  // "beard"
    if (own_worn) {
        d_.add(phrase, "worn by", {d_.focus()});
        return describe_more();
    }
    if (!apply_all({found}, attributes) && !complement({found})) return fail(reason::Incomplete);
    Cursor whose = c_;  // "blue ears for the bear"
    Phrase owner;
    const bool of_whom = whose.is(Class::word_for) || whose.is(Class::word_on) || whose.is(Class::word_of);
    if (of_whom && ++whose.at && whose.take_phrase(owner) && d_.resolve(owner).found() &&
        d_.resolve(owner).reference.root() == found.reference.root())
        c_.at = whose.at;
    return describe_more();
}

/// "carpet instead of the floor", "an armchair instead": of what is there by another name.
std::optional<bool> Reader::describe_other_kind(const Phrase& phrase, const Target& found) {
    Cursor in_place = c_;
    Phrase old;
    if (found.thing && !phrase.definite && in_place.take(Class::rather_than) && in_place.take_phrase(old) &&
        d_.resolve(old).reference == found.reference) {
        c_.at = in_place.at;  // "carpet instead of the floor"
        frame_ = Frame::Replace;
        return become({found}, phrase);
    }
    if (found.thing && phrase.indefinite && c_.peek(Class::instead)) {  // "an armchair instead"
        c_.take(Class::instead);
        return c_.at_end_of_clause() && become({found}, phrase);
    }
    return std::nullopt;
}

/// "the red one", "a darker red": a description without a noun.
bool Reader::describe_nameless(const Phrase& phrase) {
    const auto last = phrase.attributes.empty() ? Quality::Other : phrase.attributes.back().quality;
    if (phrase.indefinite && !phrase.definite && phrase.attributes.size() > 1 &&
        (last == Quality::State || last == Quality::Other) && !described_)
        return fail(reason::NotASentence);  // "a blue bare": what is blue is not said
    const bool bare = phrase.indefinite && !phrase.definite && !described_ && last == Quality::State &&
                      (c_.peek(Class::wearing) || c_.peek(Class::holding) || c_.peek(Class::having));
    if (bare) return fail(reason::NotASentence);  // "a bare wearing a hat"
    auto target = phrase.definite ? d_.resolve(phrase) : d_.focus();
    Cursor whose = c_;
    Phrase bearer;
    if ((c_.is(Class::word_for) || c_.is(Class::word_on)) && ++whose.at && whose.take_phrase(bearer) &&
        bearer.definite && whose.at_end_of_clause() && d_.resolve(bearer).thing) {
        target = d_.resolve(bearer);  // "a deeper red for the bear"
        c_.at = whose.at;
    }
    if (!target.found()) return fail(reason::Ambiguous);
    return apply_all({target}, phrase.attributes);
}

/// "bear hat red", "golden bear grass": what stands behind it without a joint.
void Reader::describe_telegraphic(const Target& found) {
    Cursor worn = c_;
    Phrase clothes;
    if (worn.take_phrase(clothes) && is_worn(clothes) && !clothes.has_determiner() && d_.can_wear(found) &&
        clothes.naming == Naming::Thing && (worn.peek(Class::colour) || worn.at_end_of_clause())) {
        c_.at = worn.at;
        nested(d_.add(clothes, "worn by", {found}), found);
    }
    Cursor none = c_;
    Phrase lacking;
    if (none.take_phrase(lacking) && lacking.none && !lacking.noun.empty()) {  // "bear no hat"
        c_.at = none.at;
        if (!lack(found, lacking)) c_.at = none.at;
    }
    Cursor last = c_;
    Phrase ground;
    if (last.take_phrase(ground) && last.at_end_of_clause() && is_ground(ground) &&
        !ground.has_determiner() && d_.resolve(ground).found() && ground.attributes.empty())
        c_.at = last.at;
}

/// "a polar bear" of a bear: another thing, or the bear in a style or a pose.
bool Reader::describe_kin(const Phrase& phrase, const Target& kin, std::size_t thing) {
    const auto first = phrase.noun.substr(0, phrase.noun.find(' '));
    const bool compound = has(Class::compound, phrase.noun);
    if (first.ends_with("ing") && word_of(first).base != first && !compound) {
        described_ = kin;  // "a hugging bear"
        d_.step(Operation::Pose, kin, first);
        posts(kin);
        return describe_more();
    }
    const bool species =
        (kinds_of(first) & (Concrete | Perhaps | Other | Adjective)) != 0 || kinds_of(first) == 0;
    if (!species && !compound) return fail(reason::NotASentence);  // "a read bear"
    if (describe_in_style(phrase, thing)) return describe_more();
    const auto made = d_.replace(kin, phrase);
    described_ = made;
    posts(made);
    return describe_more();
}

/// The first thing of a description: it is there, or stands in the place of what is.
bool Reader::describe(const Phrase& phrase) {
    frame_ = Frame::Describe;
    const auto focus = d_.focus();
    if (phrase.noun.empty()) return describe_nameless(phrase);
    if (phrase.none) return lack(focus, phrase);
    if (one_more(phrase)) return describe_more();
    const auto named = d_.things_named(phrase);
    if (phrase.single && phrase.attributes.empty() && named.size() > 1 && c_.at_end_of_clause()) {
        auto others = d_.resolve(phrase);  // "just one chair" of two
        if (!others.found()) return fail(reason::Ambiguous);
        others.reference.links.front().count = std::to_string(named.size() - 1);
        d_.remove(others);
        return true;
    }
    const bool exact = std::any_of(named.begin(), named.end(),
                                   [&](std::size_t i) { return d_.scene().things[i].noun == phrase.noun; });
    if (const auto kin = d_.kin_of(phrase);
        kin && !phrase.owner && (named.empty() || (phrase.indefinite && !exact)))
        return describe_kin(phrase, d_.target_of_thing(*kin), *kin);
    if (describe_likeness(phrase)) return describe_more();
    const auto found = d_.resolve(phrase);
    if (found.kind == Target::Kind::Ambiguous) return fail(reason::Ambiguous);
    if (!exact)
        if (const auto read = describe_other_kind(phrase, found)) return *read;
    if (!found.found()) return describe_new(phrase);
    if (!phrase.definite && !described_ && beside_its_like(phrase, found)) return true;
    if (describe_empty(phrase, found)) return true;
    if (std::count_if(phrase.attributes.begin(), phrase.attributes.end(),
                      [](const Attribute& each) { return each.quality == Quality::Colour; }) > 1)
        return fail(reason::Contradiction);
    if (found.kind == Target::Kind::There && found.reference.links.size() > 1 &&
        !found.thing) {  // "green eyes"
        return describe_part(phrase, found);
    }
    if (!described_) described_definite_ = phrase.definite;
    described_ = described_ ? described_ : std::optional(found);
    if (phrase.count.empty() || phrase.count == "all" || found.reference.links[0].count == "all" ||
        found.kind == Target::Kind::Made) {
        if (found.kind == Target::Kind::There) d_.already_so();
        apply_all({found}, phrase.attributes);
    } else {
        apply_all({found}, phrase.attributes);
        d_.duplicate(found, phrase.count);
    }
    d_.mention(found);
    posts(found);
    describe_telegraphic(found);
    return describe_more();
}

/// A new thing, and the thing of the scene behind it: "a cat near a bear", "a tree and a bear".
bool Reader::describe_beside(const Phrase& phrase) {
    const auto focus = d_.focus();
    const auto made =
        d_.add(phrase, is_worn(phrase) ? "worn by" : "beside", focus.found() ? Targets{focus} : Targets{});
    if (!focus.found()) d_.set_anchor(made, "in", d_.scene_target());
    d_.mention(made);
    nested(made, focus);
    // "for the bear"
    posts(made);
    if (is_worn(phrase)) described_ = focus;
    while (c_.take(Class::conjunction)) {
        Phrase other;
        if (!c_.take_phrase(other)) return false;
        const auto found = d_.resolve(other);
        if (found.found()) {
            d_.set_anchor(made, "beside", found);
            apply_all({found}, other.attributes);
            described_ = found;
            posts(found);
        } else {
            if (other.definite && !other.owner) return expect(other).found();
            const bool worn = is_worn(other) && d_.can_wear(focus);
            const auto more =
                d_.add(other, worn ? "worn by" : "beside", focus.found() ? Targets{focus} : Targets{});
            nested(more, focus);
            posts(more);
        }
    }
    return true;
}

/// "a cat instead of the bear".
std::optional<bool> Reader::describe_instead(const Phrase& phrase) {
    Cursor ahead = c_;
    if (!ahead.take(Class::rather_than) && !ahead.take(Class::than)) ++ahead.at;  // "prefer ... over"
    Phrase old;
    if (ahead.take_phrase(old)) {
        const auto target = d_.resolve(old);
        if (!target.found()) return expect(old).found();
        c_.at = ahead.at;
        const auto made = d_.replace(target, phrase);
        described_ = made;
        posts(made);
        return describe_more();
    }
    return std::nullopt;
}

/// Tells whether the phrase is placed at another thing of the scene, and is of another kind than what the
/// sentence is about: it does not stand in its place.
bool Reader::stands_by_other(const Phrase& phrase) const {
    const auto focus = d_.focus();
    Cursor ahead = c_;
    Phrase place;
    while (!ahead.peek(Class::relation) && (ahead.take(Class::emerging) || ahead.take(Class::pose))) {}
    const auto relation = ahead.take(Class::relation);
    if (!focus.thing || !relation || !ahead.take_phrase(place) || !place.definite) return false;
    const auto found = d_.resolve(place);
    if (!found.thing && found.reference.links.size() > 1)  // "a monkey on a branch of the tree"
        return found.reference.root() != focus.reference.root();
    if (!found.thing || found.thing == focus.thing || d_.scene().things[*found.thing].is_ground) return false;
    if (relation.value == "above") return true;  // "a dragon above the castle"
    const auto lives = [](const std::string& noun) {
        return has(Class::animal, noun) || (kinds_of(noun) & (Animal | Person)) != 0;
    };
    const bool backdrop = has(Class::place, found.reference.root()) && relation.value == "in front of";
    if (backdrop && lives(phrase.noun) && lives(focus.reference.root()))
        return false;  // "a dragon in front of"
    return (kinds_of(phrase.noun) & kinds_of(d_.scene().things[*focus.thing].noun) & Concrete) == 0;
}

/// "a striped pattern on the bear".
bool Reader::describe_pattern(const Phrase& phrase) {
    const auto focus = d_.focus();
    const auto where_to = c_.peek(Class::relation);
    const bool thing =
        has(Class::thing, phrase.noun) && where_to && where_to.value != "on";  // "a rainbow over"
    if (thing || !focus.found() || !own_pattern(focus, phrase)) return false;
    Cursor place = c_;
    Phrase where;
    if ((place.take(Class::relation) || place.take(Class::to)) && place.take_phrase(where) &&
        d_.resolve(where).reference == focus.reference)
        c_.at = place.at;
    return true;
}

/// "pink frosting on top": of the thing that the sentence is about; nothing for other phrases.
std::optional<bool> Reader::describe_on_top(const Phrase& phrase) {
    const auto focus = d_.focus();
    Cursor place = c_;
    const auto relation = place.take(Class::relation);
    if (!relation || !focus.found() || described_) return std::nullopt;
    Phrase backdrop;
    const bool behind = relation.value == "in" && place.take_phrase(backdrop) &&
                        has(Class::backdrop, backdrop.noun) && d_.things_named(backdrop).empty();
    if (!place.at_end_of_clause() || (relation.value == "in" && !behind)) return std::nullopt;
    c_.at = place.at;
    d_.mention(d_.add(phrase,
                      behind            ? std::string_view("behind")
                      : is_worn(phrase) ? std::string_view("worn by")
                                        : relation.value,
                      {focus}));
    return true;
}

/// "pink frosting": on the thing that the sentence is about, never in its place.
bool Reader::describe_clinging(const Phrase& phrase) {
    const auto focus = d_.focus();
    const bool clings = has(Class::floating, phrase.noun) && (kinds_of(phrase.noun) & (Animal | Plant)) == 0;
    if (!clings || !focus.found()) return false;
    const auto made = d_.add(phrase, "on", {focus});
    d_.mention(made);
    nested(made, focus);
    posts(made);
    return true;
}

/// Tells whether the noun is a slip of the pen for what is there, or a part of it: "a blue beer", "piano
/// lid".
bool Reader::is_slip_of_focus(const Phrase& phrase) const {
    const auto focus = d_.focus();
    const bool of_focus = focus.found() && phrase.noun.starts_with(focus.reference.root() + " ");
    if (of_focus && !phrase.has_determiner() && !has(Class::compound, phrase.noun) && !is_worn(phrase))
        return true;
    // "a blue beer": food is no likely slip of a pen, but of the bear's name
    const bool being = (kinds_of(phrase.noun) & (Animal | Person | Artifact | Vehicle)) != 0;
    const bool lives = (kinds_of(phrase.noun) & (Animal | Person)) != 0 || has(Class::person, phrase.noun) ||
                       has(Class::animal, phrase.noun) || has(Class::thing, phrase.noun);
    const bool acts = c_.peek(Class::wearing) || c_.peek(Class::holding);  // "a bar wearing a scarf"
    return focus.found() && (!being || (acts && !lives)) && is_one_slip(phrase.noun, focus.reference.root());
}

/// "snow on the ground", "a tutu for the bear", "a lion out of the bear", "a moose where the bear is";
/// nothing for other phrases.
std::optional<bool> Reader::describe_elsewhere(const Phrase& phrase) {
    if (lies_on_ground(phrase)) return true;
    if (Cursor whom = c_; !described_ && whom.is(Class::word_for)) {
        Phrase bearer;  // "a pink tutu for the bear"
        ++whom.at;
        const auto receiver = whom.take_phrase(bearer) ? d_.resolve(bearer) : Target{};
        if (receiver.found() && (whom.at_end_of_clause() || whom.peek(Class::courtesy))) {
            c_.at = whom.at;
            return own(receiver, phrase, "with");
        }
    }
    if (c_.is(Class::word_there) && c_.peek(Class::instead, 1)) ++c_.at;
    if (Cursor from = c_; from.take(Class::made_of).length > 1) {
        Phrase old;  // "make a lion out of the bear"
        const auto target = from.take_phrase(old) && old.definite ? d_.resolve(old) : Target{};
        if (target.thing && from.at_end_of_clause()) {
            c_.at = from.at;
            return become({target}, phrase);
        }
    }
    Target place;
    if (!described_ && stands_where(place)) return become({place}, phrase);
    if (!described_ && in_place_of(place)) return become({place}, phrase);
    return std::nullopt;
}

/// Further things stand beside the first, or are worn by it.
bool Reader::describe_further(const Phrase& phrase, const Target& bearer) {
    if (!bearer.found()) return fail(reason::Ambiguous);
    const auto how =
        is_worn(phrase) && d_.can_wear(bearer) ? std::string_view("worn by") : std::string_view("beside");
    const auto made = d_.add(phrase, how, {bearer});
    d_.mention(made);
    nested(made, bearer);
    posts(made);
    return describe_more();
}

/// A thing that the scene does not show.
bool Reader::describe_new(const Phrase& phrase) {
    const auto focus = d_.focus();
    if (!described_ && d_.source_missing()) {
        missing_ = d_.source_word();
        return fail(reason::NotInScene);
    }
    if (describe_pattern(phrase)) return true;
    const bool tells =
        word_count_ > LongestPlain && phrase.possessive && (kinds_of(phrase.noun) & Person) != 0;
    if (tells || !is_thing(phrase)) return fail(reason::NotASentence);
    if (const auto read = describe_one_of(phrase)) return *read;
    if (const auto read = describe_elsewhere(phrase)) return *read;
    if (is_ground(phrase) && !phrase.has_determiner() && !c_.peek(Class::rather_than))
        c_.take(Class::as_well);  // "snow everywhere"
    const bool bare = c_.at_end_of_clause();
    if (const auto placed = describe_on_top(phrase)) return *placed;
    if (const auto read = describe_place(phrase, bare)) return *read;
    const bool wears = is_worn(phrase) || (is_held(phrase) && described_);
    const auto bearer = described_ && described_->found() ? *described_ : focus;
    if (described_) return describe_further(phrase, bearer);
    const bool over = prefers_ && (c_.is(Class::word_to) || c_.word().text == "over");
    if (c_.peek(Class::rather_than) || (c_.peek(Class::than) && requested_) || over) {
        if (const auto read = describe_instead(phrase)) return *read;
    }
    const bool later = mentions_focus(c_.at);
    if (!later && stands_by_other(phrase)) {  // "graffiti on the wall" of a bicycle before a wall
        Targets made;
        return place_new(phrase, made) && describe_more();
    }
    if (later || (wears && focus.found() && d_.can_wear(focus) && is_worn(phrase)))
        return describe_beside(phrase);
    if (is_slip_of_focus(phrase)) return fail(reason::NotASentence);
    if (describe_clinging(phrase)) return describe_more();
    const bool many = phrase.count == "some" || (phrase.plural && phrase.count.empty());
    if (many && !has(Class::pair_noun, phrase.noun)) {  // "lots of flowers in the grass"
        const auto made = d_.add(phrase, "in", {d_.scene_target()});
        d_.mention(made);
        posts(made);
        return describe_more();
    }
    if (focus.found()) {
        const auto made = d_.replace(focus, phrase);
        described_ = made;
        d_.mention(made);
        posts(made);
        if (c_.take(Class::rather_than)) {
            Phrase old;
            if (!c_.take_phrase(old)) return false;
        }
        return describe_more();
    }
    const auto made = d_.add(phrase, "in", {d_.scene_target()});
    d_.mention(made);
    posts(made);
    return describe_more();
}

/// "on grass instead of snow": says what is not there.
bool Reader::skip_instead() {
    Cursor ahead = c_;
    ahead.take(Class::rather_than);
    Phrase old;
    Cursor probe = ahead;
    Attribute attribute;
    if (probe.take_phrase(old) && (!old.noun.empty() || old.definite)) {
        c_.at = probe.at;
        return true;
    }
    if (ahead.take_attribute(attribute, false)) {
        c_.at = ahead.at;
        return true;
    }
    return false;
}

/// Things that a description names behind its first thing: "and a cat", ", snow", "on the grass".
bool Reader::describe_more() {
    while (true) {
        Cursor ahead = c_;
        const std::size_t start = c_.at;
        if (c_.peek(Class::rather_than) && described_) {
            if (skip_instead()) continue;
        }
        const bool comma = ahead.take_mark(',');
        const bool joint = ahead.take(Class::conjunction).length > 0;
        if (!joint || comma) return true;
        const std::size_t distance = ahead.at - c_.at;
        if (starts_verb(distance) && !(ahead.peek(Class::article) || ahead.peek(Class::number))) return true;
        Phrase phrase;
        if (!ahead.take_phrase(phrase) || phrase.naming != Naming::Thing) return true;
        if (phrase.noun.empty()) {  // "a red bear and a blue one"
            if (!phrase.indefinite || phrase.attributes.empty() || !described_ || !described_->thing)
                return true;
            phrase.noun = phrase.typed = d_.scene().things[*described_->thing].noun;
        }
        if (ahead.peek(Class::copula) || ahead.peek(Class::modal) || ahead.is_mark(":") ||
            ahead.peek(Class::gone))
            return true;
        Attribute behind;
        Cursor adjective = ahead;
        if (adjective.take_attribute(behind, false) && adjective.at_end_of_clause() &&
            d_.resolve(phrase).found())
            return true;
        c_.at = ahead.at;
        const auto found = d_.resolve(phrase);
        if (described_ && described_->thing && phrase.indefinite && !phrase.attributes.empty()) {
            if (describe_other(phrase)) continue;
        }
        const bool same =
            found.found() && described_ && found.reference == described_->reference && phrase.indefinite;
        if (same && !phrase.attributes.empty()) {  // "a red bear and a blue bear"
            Phrase second = phrase;
            second.another = true;
            const auto made = d_.add(second, "beside", {found});
            posts(made);
            continue;
        }
        if (!describe(phrase)) {
            c_.at = start;
            return false;
        }
        return true;
    }
}

/// "(a blue bear,) snow": the ground, where other steps stand before.
bool Reader::bare_ground() {
    Cursor ground = c_;
    if (d_.size() == 0 || !ground.take(Class::ground) || !ground.at_end_of_clause()) return false;
    Phrase bare;
    bare.noun = bare.typed = c_.text_to(ground.at);
    c_.at = ground.at;
    d_.ground(bare);
    return true;
}

/// "blue on the bear", "a deeper red for the bear".
bool Reader::attributes_for() {
    Cursor ahead = c_;
    ahead.take(Class::article);
    const auto qualities = ahead.take_attributes();
    if (qualities.empty() || (!ahead.is(Class::word_for) && !ahead.is(Class::word_on))) return false;
    ++ahead.at;
    Phrase bearer;
    if (!ahead.take_phrase(bearer) || !bearer.definite || !ahead.at_end_of_clause()) return false;
    const auto found = d_.resolve(bearer);
    if (!found.thing || d_.scene().things[*found.thing].is_ground) return false;
    c_.at = ahead.at;
    return apply_all({found}, qualities);
}

/// "blue", "bigger", "on snow", "wearing a hat": of the thing that the sentence is about.
bool Reader::attribute_clause() {
    const std::size_t start = c_.at;
    const bool made = (frame_ == Frame::Replace || frame_ == Frame::Add) && d_.last() && d_.last()->step;
    const auto target = made ? *d_.last() : described_ && described_->found() ? *described_ : d_.focus();
    Attribute attribute;
    Cursor ahead = c_;
    const auto degree = ahead.peek(Class::degree).length;  // "a little bit bluer"
    const bool article = degree < 2 && ahead.take(Class::article).length > 0;
    const bool attributes = ahead.take_attribute(attribute, false);
    const bool acts = ahead.peek(Class::wearing) || ahead.peek(Class::holding) || ahead.peek(Class::having);
    if (article && acts && attribute.quality == Quality::State)
        return fail(reason::NotASentence);  // "a bare wearing a hat"
    const bool begins = c_.peek(Class::relation) || c_.peek(Class::wearing) || c_.peek(Class::holding) ||
                        c_.peek(Class::having) || c_.peek(Class::made_of) ||
                        c_.peek(Class::inverse_relation) || c_.peek(Class::riding) || c_.peek(Class::like) ||
                        c_.peek(Class::without) || c_.peek(Class::times) || c_.peek(Class::pose) ||
                        c_.peek(Class::fire_words);
    if (!attributes && !begins) return false;
    if (!made && bare_ground()) return true;
    if (c_.peek(Class::colour) && swaps_colours()) return true;  // "red to blue"
    if (const auto contrast = c_.take(Class::contrast_change)) {
        d_.step(Operation::Recolour, d_.scene_target(), std::string(contrast.value));
        return true;
    }
    if (attributes_for()) return true;
    ahead = c_;
    ahead.take(Class::article);
    ahead.take_attributes();
    if (!target.found()) {
        if (target.kind == Target::Kind::Missing) missing_ = target.word;
        return fail(target.kind == Target::Kind::Missing ? reason::NotInScene : reason::Ambiguous);
    }
    const bool ends = ahead.done() || ahead.peek(Class::rather_than);
    if (attributes && attribute.quality == Quality::Other && ends && !described_)
        return fail(reason::NotASentence);
    Cursor place = c_;  // "add a cat, sitting to the right of the bear"
    if (made && place.take(Class::where_pose) && place.peek(Class::relation) && post(target)) {
        posts(target);
        return true;
    }
    c_.at = start;
    if (attributes && complement({target})) {
        frame_ = Frame::Make;
        return true;
    }
    c_.at = start;
    Cursor role = c_;  // "as a panda"
    Phrase model;
    if (role.is(Class::word_as) && ++role.at && role.take_phrase(model) && model.indefinite &&
        role.at_end_of_clause()) {
        c_.at = role.at;
        return become({target}, model);
    }
    if (post(target)) {
        posts(target);
        return true;
    }
    c_.at = start;
    return false;
}

}  // namespace gse::language::plan
