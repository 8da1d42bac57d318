// Orders that change, replace, give and take away.
#include <algorithm>

#include "engine/language/plan/grammar/reader.h"

namespace gse::language::plan {
namespace {

constexpr Class Verbs[] = {
    Class::verb_recolour, Class::verb_shift,   Class::verb_make,      Class::verb_turn,
    Class::verb_replace,  Class::verb_swap,    Class::verb_add,       Class::verb_give,
    Class::verb_dress,    Class::verb_cover,   Class::verb_remove,    Class::verb_relieve,
    Class::verb_shave,    Class::verb_undress, Class::verb_empty,     Class::verb_move,
    Class::verb_size,     Class::verb_scale,   Class::verb_double,    Class::verb_rotate,
    Class::verb_flip,     Class::verb_face,    Class::verb_duplicate, Class::verb_style,
    Class::verb_material, Class::verb_carve,   Class::verb_pattern,   Class::verb_alter,
    Class::verb_pose,     Class::verb_raise,   Class::verb_keep,      Class::fire_verb,
    Class::verb_wear,     Class::verb_off};

}  // namespace

/// Tells whether an object of a verb may begin there.
bool Reader::starts_object(std::size_t ahead) const {
    Cursor here = c_;
    here.at += ahead;
    if (here.done()) return false;
    for (const auto kind : {Class::article, Class::definite, Class::possessive, Class::another, Class::all,
                            Class::some, Class::number, Class::pronoun_it, Class::pronoun_person,
                            Class::pronoun_all, Class::everything, Class::everything_else, Class::none})
        if (here.peek(kind)) return true;
    if (here.word().text.find_first_not_of("0123456789") == std::string::npos) return true;
    return here.is_scene_noun(here.word().singular);
}

/// Tells whether an order begins there: a verb, and no noun or description of the same spelling.
bool Reader::starts_verb(std::size_t ahead) const {
    Cursor here = c_;
    here.at += ahead;
    if (here.done() || here.word().mark || here.peek(Class::compound).length > 1) return false;
    std::size_t length = 0;
    for (const auto kind : Verbs) length = std::max(length, here.peek(kind).length);
    if (length == 0) return false;
    const auto& word = here.word();
    const bool form = word.text == word.base || word.text.ends_with("ing") || has(Class::verb_add, word.text);
    if (!form) return false;
    Cursor next = here;  // "dirty truck" describes
    ++next.at;
    const bool bare =
        length == 1 && next.is_scene_noun(next.word().singular) &&
        (here.peek(Class::material_surface) || here.peek(Class::state) || here.peek(Class::material));
    if (bare) return false;
    if (starts_object(ahead + length)) return true;
    if (length > 1) return true;
    const auto kinds = kinds_of(word.text);
    const bool noun = (kinds & (Concrete | Perhaps)) != 0 || here.is_scene_noun(word.singular);
    Attribute attribute;
    Cursor description = here;
    if (description.take_attribute(attribute, false) && !here.peek(Class::verb_pose)) return false;
    if (word.text.ends_with("ing") &&
        (here.peek(Class::pose) || here.peek(Class::holding) || here.peek(Class::wearing)))
        return false;
    return !noun || here.peek(Class::verb_make) || here.peek(Class::verb_turn) ||
           here.peek(Class::verb_remove) || here.peek(Class::verb_add) || here.peek(Class::verb_recolour) ||
           here.peek(Class::verb_swap);
}

Target Reader::expect(const Phrase& phrase) {
    const auto found = d_.resolve(phrase);
    if (found.found()) return found;
    if (found.kind == Target::Kind::Ambiguous) fail(reason::Ambiguous);
    else {
        missing_ = found.word.empty() ? phrase.noun : found.word;
        fail(missing_.empty() ? reason::Ambiguous : reason::NotInScene);
    }
    return found;
}

/// Tells whether the phrase calls the thing of the scene by a colour that it does not have.
bool Reader::contradicts_colour(const Phrase& phrase, const Target& found) const {
    if (!found.thing || !phrase.definite || d_.size() > 0) return false;
    const auto& told = d_.scene().things[*found.thing].attributes;
    const bool coloured = std::any_of(told.begin(), told.end(),
                                      [](const std::string& word) { return has(Class::colour, word); });
    return coloured &&
           std::any_of(phrase.attributes.begin(), phrase.attributes.end(), [&](const Attribute& each) {
               return each.quality == Quality::Colour &&
                      std::find(told.begin(), told.end(), each.value) == told.end();
           });
}

/// "everything but the house and the grass": each other thing; what is worn goes with who wears it.
bool Reader::all_but(const std::vector<Phrase>& excepted, Targets& targets) {
    Targets kept;
    for (const auto& each : excepted) {
        kept.push_back(expect(each));
        if (!kept.back().found()) return false;
    }
    const auto& things = d_.scene().things;
    for (std::size_t i = 0; i < things.size(); ++i) {
        const auto target = d_.target_of_thing(i);
        const bool stays =
            things[i].is_worn || std::any_of(kept.begin(), kept.end(), [&](const Target& each) {
                return each.reference == target.reference;
            });
        if (!stays) targets.push_back(target);
    }
    for (std::size_t i = 0; i < things.size() && targets.empty(); ++i) {  // nothing but clothes is left
        const auto target = d_.target_of_thing(i);
        const bool stays = std::any_of(
            kept.begin(), kept.end(), [&](const Target& each) { return each.reference == target.reference; });
        if (things[i].is_worn && !stays) targets.push_back(target);
    }
    return !targets.empty() || fail(reason::Incomplete);
}

/// "both of them": the two things that stand on the ground; none where there are more.
Reader::Targets Reader::both() const {
    Targets all;
    const auto& things = d_.scene().things;
    for (std::size_t i = 0; i < things.size(); ++i)
        if (!things[i].is_ground && !things[i].is_worn) all.push_back(d_.target_of_thing(i));
    return all.size() == 2 ? all : Targets{};
}

/// "both animals", "the furniture": each thing of the scene that is one; none where the word names a thing.
Reader::Targets Reader::collective(const Phrase& phrase) const {
    Targets all;
    const bool kind = has(Class::animal_name, phrase.noun) || has(Class::furniture_name, phrase.noun) ||
                      has(Class::person_name, phrase.noun) || has(Class::vehicle_name, phrase.noun) ||
                      has(Class::plant_name, phrase.noun) || has(Class::clothes_name, phrase.noun);
    const bool several = phrase.plural || phrase.count == "all" || phrase.noun == "furniture";
    if (!kind || !several || phrase.owner || phrase.naming != Naming::Thing) return all;
    const auto found = d_.things_named(phrase);
    bool differ = false;
    for (const auto index : found)
        differ = differ || d_.scene().things[index].noun != d_.scene().things[found.front()].noun;
    if (differ)
        for (const auto index : found) all.push_back(d_.target_of_thing(index));
    return all;
}

/// "what stands on the table", "both of them"; nothing where the object has a noun.
std::optional<bool> Reader::untold_object(Targets& targets, Phrase& phrase) {
    if (Cursor of = c_; of.take(Class::definite) && of.take(Class::colour) && of.take(Class::of)) {
        Phrase whole;  // "the red of the bear"
        const auto found = of.take_phrase(whole) ? d_.resolve(whole) : Target{};
        if (found.found()) {
            c_.at = of.at;
            targets.push_back(found);
            return true;
        }
    }
    if (const auto worn = what_is_worn(); !worn.empty()) {
        targets.insert(targets.end(), worn.begin(), worn.end());
        return true;
    }
    Cursor whatever = c_;
    Phrase carrier;
    if (whatever.take(Class::what_stands) && whatever.take(Class::relation) &&
        whatever.take_phrase(carrier)) {
        const auto on = things_on(d_.resolve(carrier));
        if (on.size() != 1) return fail(reason::Ambiguous);
        c_.at = whatever.at;
        targets.push_back(on.front());
        return true;
    }
    Cursor two = c_;
    const bool alone = two.take(Class::word_both) && (two.done() || two.noun_length() == 0) &&
                       !two.peek(Class::definite) && !two.peek(Class::of);
    const auto all = alone ? both() : Targets{};
    if (all.empty()) return std::nullopt;
    c_.at = two.at;
    phrase = {};
    phrase.naming = Naming::They;
    targets.insert(targets.end(), all.begin(), all.end());
    return true;
}

bool Reader::object(Targets& targets, Phrase& phrase, bool split) {
    if (const auto read = untold_object(targets, phrase)) return *read;
    if (!c_.take_phrase(phrase, split)) return false;
    narrow(phrase);
    tell_apart(phrase);
    if (phrase.excepted.size() > 1) return all_but(phrase.excepted, targets);
    if (phrase.owner && has(Class::colour_word, phrase.noun))
        phrase = Phrase(*phrase.owner);  // "the colors of the bear"
    if (Cursor about = c_; phrase.naming == Naming::Everything && about.is(Class::word_about)) {
        Phrase whole;  // "everything about the bear"
        ++about.at;
        if (about.take_phrase(whole) && d_.resolve(whole).found()) {
            c_.at = about.at;
            phrase = whole;
        }
    }
    if (const auto several = collective(phrase); !several.empty()) {
        targets.insert(targets.end(), several.begin(), several.end());
        return true;
    }
    Target found;
    if (phrase.naming == Naming::It) found = d_.pronoun(Naming::It);
    else found = d_.resolve(phrase);
    if (!found.found()) {
        expect(phrase);
        return false;
    }
    if (contradicts_colour(phrase, found)) {  // "the blue bear", which is red
        missing_ = phrase.attributes.front().typed + " " + phrase.noun;
        return fail(reason::NotInScene);
    }
    if (found.is_scene()) {  // "make everything blue except the grass"
        Cursor except = c_;
        while (!except.at_end_of_clause() && !except.peek(Class::except)) ++except.at;
        Phrase kept;
        if (except.take(Class::except) && except.take_phrase(kept) && d_.resolve(kept).found()) {
            found = d_.resolve(kept);
            found.reference.except = true;
            found.thing.reset();
        }
    }
    Cursor further = c_;  // "the wall behind him yellow"
    Phrase near;
    Attribute colour;
    if (phrase.definite && further.take(Class::relation) && further.take_phrase(near) &&
        d_.resolve(near).found()) {
        Cursor after = further;
        if (after.take_attribute(colour, false)) c_.at = further.at;
    }
    // "the thing on the grass", "the vase on the table": tells which
    Cursor ahead = c_;
    Phrase place;
    if (phrase.naming == Naming::Thing && ahead.take(Class::relation) && ahead.take_phrase(place) &&
        (has(Class::thing_name, phrase.noun) || phrase.noun.empty()) && d_.resolve(place).found())
        c_.at = ahead.at;
    targets.push_back(found);
    return true;
}

bool Reader::objects(Targets& targets, std::vector<Phrase>* phrases, bool split) {
    while (true) {
        Phrase phrase;
        if (!object(targets, phrase, split)) return false;
        if (phrases != nullptr) phrases->push_back(phrase);
        Cursor ahead = c_;
        const bool comma = ahead.take_mark(',');
        const bool joint = ahead.take(Class::conjunction).length > 0;
        if (!comma && !joint) break;
        if (starts_verb(ahead.at - c_.at)) break;
        Phrase next;
        Cursor probe = ahead;
        if (!probe.take_phrase(next) || next.naming != Naming::Thing || next.noun.empty() ||
            !d_.resolve(next).found())
            break;
        Attribute how;  // "remove the chair, the vase is blue"
        const bool told = probe.peek(Class::copula) || probe.peek(Class::modal) || probe.is_mark(":") ||
                          (probe.take_attribute(how, false) && probe.at_end_of_clause());
        if (told && !joint) break;
        c_.at = ahead.at;
    }
    d_.mention(targets.back());
    return true;
}

bool Reader::verb_clause() {
    if (!try_verbs()) return false;
    return true;
}

bool Reader::try_verbs() {
    using Try = bool (Reader::*)();
    constexpr Try Tries[] = {
        &Reader::fire_clause,      &Reader::shave_clause,   &Reader::rotate_clause, &Reader::face_clause,
        &Reader::swap_clause,      &Reader::replace_clause, &Reader::remove_clause, &Reader::give_clause,
        &Reader::dress_clause,     &Reader::cover_clause,   &Reader::move_clause,   &Reader::size_clause,
        &Reader::duplicate_clause, &Reader::paint_clause,   &Reader::turn_clause,   &Reader::make_clause,
        &Reader::shift_clause,     &Reader::pose_clause,    &Reader::add_clause};
    const std::size_t start = c_.at;
    const auto draft = d_;
    std::string_view reason;
    std::string missing;
    for (const auto each : Tries) {
        reason_ = {};
        missing_.clear();
        if ((this->*each)() && ends_well()) return true;
        c_.at = start;
        d_ = draft;
        if (reason.empty() && !reason_.empty()) {
            reason = reason_;
            missing = missing_;
        }
    }
    reason_ = reason;
    missing_ = missing;
    return false;
}

/// "(make it) three chairs" of two.
bool Reader::makes_several(Cursor counted) {
    Phrase several;
    if (!counted.take_phrase(several) || several.count.empty() || d_.things_named(several).size() < 2)
        return false;
    c_.at = counted.at;
    return one_more(several);
}

/// "make it look like a comic", "turn it into a painting": a style is of the whole scene.
bool Reader::looks_as_a_whole() {
    const std::size_t start = c_.at;
    if (d_.size() > 0 || !c_.take(Class::pronoun_it)) return false;
    const bool looks = c_.take(Class::look_word).length > 0;
    while (c_.take(Class::like) || c_.take(Class::into)) {}
    if (style_text({d_.scene_target()}) && ends_well()) return true;
    Attribute state;  // "make it look abandoned", where several things are
    const bool told = looks && d_.focus().kind == Target::Kind::Ambiguous &&
                      c_.take_attribute(state, false) &&
                      (state.quality == Quality::State || state.quality == Quality::Other) && ends_well();
    if (told) d_.style(d_.scene_target(), state.typed);
    else c_.at = start;
    return told;
}

bool Reader::make_clause() {
    if (!c_.take(Class::verb_make)) return false;
    if (looks_as_a_whole()) return true;
    Targets targets;
    const std::size_t start = c_.at;
    std::vector<Phrase> phrases;
    // "make a bear with a hat": as a description
    Phrase first;
    Cursor ahead = c_;
    if (ahead.take_phrase(first) && first.indefinite && first.naming == Naming::Thing &&
        !d_.resolve(first).found())
        return noun_clause();
    if (ahead.at == c_.at && !c_.peek(Class::what_stands)) {
        if (c_.done()) return fail(reason::Incomplete);
        return attribute_clause();
    }
    if (first.naming == Naming::It && makes_several(ahead)) return true;
    if (first.naming == Naming::Something) return false;
    const bool grows = first.naming == Naming::Thing && !first.noun.empty() && !first.definite &&
                       !first.possessive && ahead.peek(Class::emerging) && is_thing(first);
    if (grows && !d_.resolve(first).found()) {  // "let ivy grow on the bear"
        Targets made;
        c_.at = ahead.at;
        return place_new(first, made);
    }
    if (!first.attributes.empty() && first.noun.empty() && first.indefinite) return attribute_clause();
    const bool around = has(Class::time_word, first.noun) || has(Class::backdrop, first.noun);
    if (around && d_.things_named(first).empty()) {  // "make the light warmer"
        c_.at = ahead.at;
        const auto how = c_.take_attributes();
        for (const auto& each : how) d_.environment(each.typed + " " + first.noun);
        return !how.empty();
    }
    if (!objects(targets, &phrases)) return false;
    const bool poses = c_.peek(Class::verb_pose) || c_.peek(Class::pose);
    if (first.naming == Naming::It && poses && targets.front().kind == Target::Kind::Made &&
        !d_.is_animate(targets.front()))
        targets.front() = d_.pronoun(Naming::It, true);  // "give it wings and let it fly"
    frame_ = Frame::Make;
    c_.take(Class::instead);
    if (c_.at_end_of_clause()) {
        std::vector<Attribute> told;
        for (const auto& attribute : phrases.front().attributes)
            if (attribute.quality != Quality::Side) told.push_back(attribute);
        if (first.indefinite || (!told.empty() && !first.definite)) return noun_clause();
        if (phrases.size() == 1 && !told.empty() && phrases.front().possessive)
            return apply_all(targets, told);
        return fail(reason::Incomplete);
    }
    if (first.indefinite && first.naming == Naming::Thing) {
        c_.at = start;
        return noun_clause();
    }
    return complement(targets);
}

bool Reader::paint_clause() {
    const bool carve = c_.peek(Class::verb_carve).length > 0;
    if (!c_.take(Class::verb_recolour) && !c_.take(Class::verb_carve)) return false;
    Targets targets;
    Phrase first;
    Cursor ahead = c_;
    if (c_.done()) return fail(reason::Incomplete);
    if (ahead.take_phrase(first) &&
        (first.indefinite || (!first.count.empty() && !first.definite) || first.another) &&
        first.naming == Naming::Thing && !first.noun.empty() && !d_.resolve(first).found())
        return false;  // a new thing
    if (ahead.at == c_.at && !c_.peek(Class::what_stands)) return attribute_clause();
    if (!objects(targets)) return false;
    frame_ = Frame::Paint;
    if (c_.at_end_of_clause()) return fail(reason::Incomplete);
    if (carve && c_.peek(Class::from)) return material_of(targets);  // "carve it from ice"
    Cursor how = c_;
    if (how.is(Class::word_in) || how.is(Class::word_with) || how.is(Class::word_to)) {
        ++how.at;
        if (Cursor at = c_; how.peek(Class::definite) && (c_.at = how.at, compared(targets))) return true;
        else c_.at = at.at;  // "in the color of the hat"
        how.take(Class::article);
        if (how.peek(Class::definite) && how.peek(Class::colour_word, 1)) how.at += 2;  // "in the color blue"
        const auto attributes = how.take_attributes();
        if (!attributes.empty() && (how.at_end_of_clause() || how.peek(Class::colour_word) ||
                                    how.peek(Class::conjunction) || how.ends_phrase(0, true))) {
            c_.at = how.at;
            c_.take(Class::colour_word);
            return apply_all(targets, attributes);
        }
    }
    Cursor gold = c_;
    Attribute metal;
    if (!carve && gold.take_attribute(metal, false) && metal.quality == Quality::Material) {
        c_.at = gold.at;
        const std::size_t steps = d_.size();
        for (const auto& target : targets)
            if (target.kind == Target::Kind::Made) d_.apply(target, metal);
            else d_.step(Operation::Recolour, target, metal.value);
        skip_rest(steps);
        return true;
    }
    return complement(targets);
}

/// "(change) the background to a city": of the scene; nothing where the scene shows such a thing.
std::optional<bool> Reader::changes_backdrop() {
    Cursor whole = c_;
    Phrase backdrop, place;
    if (!whole.take_phrase(backdrop) || !has(Class::backdrop, backdrop.noun) ||
        !d_.things_named(backdrop).empty())
        return std::nullopt;
    c_.at = whole.at;
    while (c_.take(Class::to) || c_.take(Class::into) || c_.take(Class::copula)) {}
    if (c_.is(Class::word_with) || c_.is(Class::word_by) || c_.is(Class::word_for)) ++c_.at;
    if (c_.take_phrase(place) && !place.noun.empty()) {
        d_.environment(place.typed + " " + backdrop.noun);
        return true;
    }
    const auto attributes = c_.take_attributes();
    for (const auto& attribute : attributes) d_.environment(attribute.typed + " " + backdrop.noun);
    return !attributes.empty();
}

bool Reader::turn_clause() {
    const bool colour_first = c_.peek(Class::verb_turn).length > 0;
    if (!colour_first || !c_.take(Class::verb_turn)) return false;
    if (c_.done()) return fail(reason::Incomplete);
    if (swaps_colours() || looks_as_a_whole()) return true;
    Targets targets;
    // "change the color of the bear to blue", "change bear color green"
    Cursor ahead = c_;
    ahead.take(Class::definite);
    Phrase colour;
    Cursor whole = c_;
    if (whole.take_phrase(colour) &&
        (has(Class::colour_word, colour.noun) || has(Class::quality, colour.noun)) &&
        (colour.owner || colour.possessive)) {
        const auto target = colour.owner ? expect(*colour.owner) : d_.pronoun(Naming::It);
        if (!target.found()) return false;
        c_.at = whole.at;
        d_.mention(target);
        Cursor from = c_;  // "the pillow's color from green to orange"
        Attribute old;
        if (from.take(Class::from) && from.take_attribute(old, false) && from.peek(Class::to))
            c_.at = from.at;
        while (c_.take(Class::to) || c_.take(Class::into) || c_.take(Class::from)) {}
        if (c_.at_end_of_clause()) return fail(reason::Incomplete);
        return complement({target});
    }
    std::vector<Phrase> phrases;
    if (const auto read = changes_backdrop()) return *read;
    if (!objects(targets, &phrases)) return false;
    frame_ = Frame::Turn;
    c_.take(Class::colour_word);
    Cursor from = c_;
    if (from.take(Class::from)) {  // "from red to blue"
        Attribute old;
        Phrase old_thing;
        if (from.take_attribute(old, false) || from.take_phrase(old_thing)) c_.at = from.at;
    }
    if (c_.at_end_of_clause()) return fail(reason::Incomplete);
    if ((c_.is(Class::word_to) || c_.is(Class::word_with) || c_.is(Class::word_for) ||
         c_.is(Class::word_in) || c_.is(Class::word_by)))
        ++c_.at;
    return complement(targets);
}

/// "use a cat instead of the bear", "substitute a cat for the bear"; nothing where it is said otherwise.
std::optional<bool> Reader::use_clause(bool substitute) {
    Phrase first;
    Cursor ahead = c_;
    if (ahead.take_phrase(first) &&
        (ahead.take(Class::rather_than) || (substitute && ahead.is(Class::word_for) && ++ahead.at))) {
        Phrase old;
        if (!ahead.take_phrase(old)) return fail(reason::Incomplete);
        const auto target = expect(old);
        if (!target.found()) return false;
        c_.at = ahead.at;
        return become({target}, first);
    }
    if (!substitute && first.indefinite && !first.noun.empty() && d_.focus().found() &&
        !d_.resolve(first).found() && (ahead.at_end_of_clause() || ahead.peek(Class::instead))) {
        ahead.take(Class::instead);  // "use a giraffe"
        c_.at = ahead.at;
        return become({d_.focus()}, first);
    }
    return std::nullopt;
}

/// Steps over "with", "for", "in for" between what goes and what comes.
bool Reader::takes_exchange() {
    if ((c_.is(Class::word_in) || c_.is(Class::word_out)) &&
        (c_.is(Class::word_for, 1) || c_.is(Class::word_with, 1)))
        ++c_.at;  // "trade the bear in for a cat"
    const bool joint = c_.is(Class::word_with) || c_.is(Class::word_by) || c_.is(Class::word_for) ||
                       c_.is(Class::word_to) || c_.is(Class::word_against);
    if (joint) ++c_.at;
    return joint || c_.take(Class::into);
}

bool Reader::replace_clause() {
    if (c_.peek(Class::verb_swap) && c_.peek(Class::verb_replace).length == 0) return false;
    const bool use = c_.is(Class::word_use), substitute = c_.is(Class::word_substitute);
    if (!c_.take(Class::verb_replace)) return false;
    if (c_.done()) return fail(reason::Incomplete);
    Phrase first;
    if (Cursor colour = c_; use) {  // "use blue"
        const auto how = colour.take_attributes();
        if (!how.empty() && how.front().quality == Quality::Colour && colour.at_end_of_clause() &&
            d_.focus().found()) {
            c_.at = colour.at;
            return apply_all({d_.focus()}, how);
        }
    }
    if (use || substitute) {  // "use a cat instead of the bear", "substitute a cat for the bear"
        if (use && attributes_for()) return true;  // "use a lighter shade of red for the bear"
        if (const auto read = use_clause(substitute)) return *read;
        if (use) return false;
    }
    if (swaps_colours()) return true;
    if (const auto read = changes_backdrop()) return *read;
    Targets targets;
    Cursor whole = c_;
    Phrase owned;
    const bool of_colour =
        whole.take_phrase(owned) && has(Class::colour_word, owned.noun) && d_.things_named(owned).empty();
    if (of_colour && !owned.owner && d_.focus().found()) {  // "the color"
        c_.at = whole.at;
        targets.push_back(d_.focus());
    } else if (c_.is(Class::word_with) && d_.focus().found()) {  // "replace with a horse"
        targets.push_back(d_.focus());
    } else if (!objects(targets)) return false;
    frame_ = Frame::Replace;
    if (!takes_exchange()) return fail(reason::Incomplete);
    if (c_.at_end_of_clause()) return fail(reason::Incomplete);
    Cursor paint = c_;  // "replace its color with blue"
    if (const auto how = paint.take_attributes(); of_colour && !how.empty() && paint.at_end_of_clause()) {
        c_.at = paint.at;
        return apply_all(targets, how);
    }
    if (c_.peek(Class::nobody)) {
        ++c_.at;
        for (const auto& target : targets) d_.remove(target);
        return true;
    }
    Phrase phrase;
    if (!c_.take_phrase(phrase) || phrase.naming != Naming::Thing) return false;
    const auto other = d_.resolve(phrase);
    if (targets.size() == 1 && other.thing && phrase.definite && !(other.reference == targets[0].reference)) {
        d_.move(targets[0], "swap with", other);
        return true;
    }
    if (targets.size() > 1) return become_each(targets, phrase);
    if (!become(targets, phrase)) return false;
    if (targets.front().thing) add_beside();
    return true;
}

}  // namespace gse::language::plan
