// Which thing of the scene, or of an earlier step, a phrase means.
#include <algorithm>

#include "engine/language/plan/grammar/draft.h"

namespace gse::language::plan {
namespace {

std::string head_of(std::string_view noun) {
    const auto of = noun.find(" of ");
    const auto phrase = of == std::string_view::npos ? noun : noun.substr(0, of);
    const auto blank = phrase.rfind(' ');
    return std::string(blank == std::string_view::npos ? phrase : phrase.substr(blank + 1));
}

bool is_kind(std::string_view noun, std::uint32_t kinds) { return (kinds_of(head_of(noun)) & kinds) != 0; }

bool is_being(std::string_view noun) {
    const auto head = head_of(noun);
    return is_kind(noun, Animal | Person) || has(Class::animal, head) || has(Class::person, head) ||
           has(Class::animal, noun) || has(Class::person, noun) || has(Class::masculine, head) ||
           has(Class::feminine, head);
}

/// Tells whether the words name the thing: its noun, its last word, a synonym, a kind that it is of.
bool names(const SceneThing& thing, const Phrase& phrase) {
    const auto& noun = phrase.noun;
    if (noun == thing.noun || noun == head_of(thing.noun) || phrase.typed == thing.noun) return true;
    if (are_synonyms(thing.noun, noun) || are_synonyms(head_of(thing.noun), noun)) return true;
    const bool closed = noun.size() > 3 && thing.noun.size() > noun.size() && thing.noun.ends_with(noun);
    if (closed && !phrase.indefinite && !phrase.another && phrase.count.empty() && !thing.is_ground)
        return true;  // "coat" of a raincoat
    if (thing.is_ground) return has(Class::ground_name, noun);
    if (thing.is_worn) return has(Class::clothes_name, noun) && !phrase.plural;
    const bool being = is_being(thing.noun);
    if (has(Class::animal_name, noun))
        return being && (is_kind(thing.noun, Animal) || has(Class::animal, thing.noun) ||
                         has(Class::animal, head_of(thing.noun)));
    if (has(Class::person_name, noun)) return is_kind(thing.noun, Person) || has(Class::person, thing.noun);
    if (has(Class::vehicle_name, noun)) return is_kind(thing.noun, Vehicle) && noun == "vehicle";
    if (has(Class::plant_name, noun)) return is_kind(thing.noun, Plant);
    if (has(Class::furniture_name, noun)) return has(Class::furniture, thing.noun);
    return false;
}

bool told_of(const SceneThing& thing, const Attribute& attribute) {
    return std::any_of(thing.attributes.begin(), thing.attributes.end(), [&](const std::string& word) {
        return word == attribute.value || word == attribute.typed ||
               meaning(Class::material, word).value_or(word) == attribute.value;
    });
}

bool tells_apart(const Attribute& attribute) {
    return attribute.quality == Quality::Colour || attribute.quality == Quality::Material ||
           attribute.quality == Quality::Surface;
}

}  // namespace

bool is_part(const Phrase& phrase) {
    const auto head = head_of(phrase.noun);
    if (has(Class::compound, phrase.noun) && !has(Class::part, phrase.noun)) return false;  // "a lily pad"
    return has(Class::part, phrase.noun) || has(Class::part, head) ||
           has(Class::part, word_of(head).singular);
}
bool is_worn(const Phrase& phrase) {
    return has(Class::worn, phrase.noun) || has(Class::worn, phrase.typed) ||
           has(Class::worn, head_of(phrase.noun)) || is_kind(phrase.noun, Worn);
}
bool is_held(const Phrase& phrase) {
    return has(Class::held, phrase.noun) || has(Class::held, head_of(phrase.noun));
}
bool is_thing(const Phrase& phrase) {
    const auto head = head_of(phrase.noun);
    const auto single = word_of(head).singular;
    for (const auto kind : {Class::compound, Class::worn, Class::held, Class::ground, Class::place,
                            Class::thing, Class::person, Class::animal, Class::container, Class::ridden,
                            Class::floating, Class::pair_noun, Class::part, Class::environment})
        if (has(kind, phrase.noun) || has(kind, head) || has(kind, single)) return true;
    return (kinds_of(head) & Concrete) != 0 || (kinds_of(single) & Concrete) != 0;
}
bool is_ground(const Phrase& phrase) {
    return has(Class::ground, phrase.noun) || has(Class::ground, phrase.typed);
}

Draft::Draft(const SceneWords& scene, std::string_view source) : scene_(&scene) {
    const auto words = scene_words(source).things;
    if (words.empty()) {
        focus_ = scene.only_thing();
        return;
    }
    Phrase phrase;
    phrase.noun = words.front().noun;
    phrase.typed = phrase.noun;
    source_word_ = phrase.noun;
    std::vector<std::size_t> found = things_named(phrase);
    std::erase_if(found, [&](std::size_t index) {
        const auto& told = scene.things[index].attributes;
        return std::any_of(words.front().attributes.begin(), words.front().attributes.end(),
                           [&](const std::string& word) {
                               return std::find(told.begin(), told.end(), word) == told.end() &&
                                      scene.things[index].noun != word + " " + phrase.noun;
                           });
    });
    if (found.size() == 1) focus_ = found.front();
    else if (found.empty()) source_missing_ = true;
}

Target Draft::target_of_thing(std::size_t index) const {
    const auto& thing = scene_->things[index];
    Thing link{thing.noun, "", {}};
    const auto same = std::count_if(scene_->things.begin(), scene_->things.end(),
                                    [&](const SceneThing& other) { return other.noun == thing.noun; });
    if (same > 1) {
        for (const auto& word : thing.attributes) {
            const auto with =
                std::count_if(scene_->things.begin(), scene_->things.end(), [&](const SceneThing& other) {
                    return other.noun == thing.noun &&
                           std::find(other.attributes.begin(), other.attributes.end(), word) !=
                               other.attributes.end();
                });
            if (with == 1 && link.attributes.empty()) link.attributes.push_back(word);
        }
        if (link.attributes.empty()) link.count = "1";
    }
    return {Target::Kind::There, {{link}, false}, index, std::nullopt, ""};
}

Target Draft::focus() const {
    if (focus_) return target_of_thing(*focus_);
    if (source_missing_) return {Target::Kind::Missing, {}, std::nullopt, std::nullopt, source_word_};
    return {Target::Kind::Ambiguous, {}, std::nullopt, std::nullopt, ""};
}

std::vector<std::size_t> Draft::things_named(const Phrase& phrase) const {
    std::vector<std::size_t> exact, near;
    for (std::size_t i = 0; i < scene_->things.size(); ++i) {
        const auto& noun = scene_->things[i].noun;
        if (noun == phrase.noun || noun == phrase.typed) exact.push_back(i);
        else if (names(scene_->things[i], phrase)) near.push_back(i);
    }
    return exact.empty() ? near : exact;
}

std::optional<std::size_t> Draft::kin_of(const Phrase& phrase) const {
    const auto head = head_of(phrase.noun);
    if (head == phrase.noun) return std::nullopt;
    for (std::size_t i = 0; i < scene_->things.size(); ++i)
        if (!scene_->things[i].is_ground &&
            (scene_->things[i].noun == head || head_of(scene_->things[i].noun) == head))
            return i;
    return std::nullopt;
}

bool Draft::is_animate(const Target& target) const {
    return target.found() && target.reference.links.size() == 1 && is_being(target.reference.root());
}

bool Draft::can_wear(const Target& target) const {
    return target.found() && is_being(target.reference.root());
}

/// Tells whether what lives has such a part: no wall, no wheels.
bool Draft::may_have(const Target& owner, const Phrase& phrase) const {
    const auto& root = owner.reference.root();
    const bool lives = is_kind(root, Animal | Person) || has(Class::animal, root) || has(Class::person, root);
    const auto head = word_of(head_of(phrase.noun)).singular;
    Phrase whole;  // "the cage door"
    whole.noun = whole.typed = phrase.noun.substr(0, std::min(phrase.noun.rfind(' '), phrase.noun.size()));
    if (whole.noun.size() < phrase.noun.size() && things_named(whole).size() == 1) return true;
    if (is_being(root) && has(Class::worn, head) && has(Class::part_made, head)) return false;  // a crown
    return !lives || is_kind(root, Plant) ||
           !(has(Class::part_made, head) || has(Class::part_made, phrase.noun));
}

Target Draft::part_target(const Target& owner, const Phrase& phrase) const {
    if (const auto blank = phrase.noun.rfind(' '); blank != std::string::npos) {  // "the cage door"
        Phrase whole, last = phrase;
        whole.noun = whole.typed = phrase.noun.substr(0, blank);
        last.noun = phrase.noun.substr(blank + 1);
        last.typed = phrase.typed.substr(phrase.typed.rfind(' ') + 1);
        const auto named = things_named(whole);
        if (named.size() == 1) return part_target(target_of_thing(named.front()), last);
    }
    Target part = owner;
    part.thing.reset();
    Thing link{phrase.typed.empty() ? phrase.noun : phrase.typed, "", {}};
    for (const auto& attribute : phrase.attributes)
        if (attribute.quality == Quality::Side) link.attributes.push_back(attribute.value);
    part.reference.links.insert(part.reference.links.begin(), link);
    return part;
}

bool Draft::is_plural(const Target& target) const {
    const auto& link = target.reference.links.front();
    return !link.count.empty() || has(Class::pair_noun, link.noun) ||
           (target.step && !steps_[*target.step].thing.count.empty());
}

Target Draft::pronoun(Naming naming, bool bearer) const {
    const Target ambiguous{Target::Kind::Ambiguous, {}, std::nullopt, std::nullopt, ""};
    if (naming == Naming::Person) {
        if (last_ && is_animate(*last_)) return *last_;
        if (focus_ && is_animate(focus())) return focus();
        std::optional<std::size_t> being;
        for (std::size_t i = 0; i < scene_->things.size(); ++i)
            if (is_being(scene_->things[i].noun) && !scene_->things[i].is_worn) {
                if (being) return ambiguous;
                being = i;
            }
        return being ? target_of_thing(*being) : focus();
    }
    if (naming == Naming::It && last_ && last_->found()) {
        if (bearer && last_->kind == Target::Kind::There &&
            last_->reference.links.size() > 1) {  // the whole of a part
            for (std::size_t i = 0; i < scene_->things.size(); ++i)
                if (scene_->things[i].noun == last_->reference.root()) return target_of_thing(i);
        }
        if (!bearer || last_->kind == Target::Kind::There || is_animate(*last_)) return *last_;
        const auto& step = steps_[*last_->step];
        if (step.anchors.size() == 1 && !step.anchors.front().is_scene()) {
            Target anchor{Target::Kind::There, step.anchors.front(), std::nullopt, std::nullopt, ""};
            for (std::size_t i = 0; i < scene_->things.size(); ++i)
                if (step.anchors.front() == target_of_thing(i).reference) anchor.thing = i;
            return anchor;
        }
        return *last_;
    }
    if (naming == Naming::They) return last_ && last_->found() && is_plural(*last_) ? *last_ : ambiguous;
    return focus();
}

std::optional<Target> Draft::made_named(const Phrase& phrase) const {
    for (std::size_t i = steps_.size(); i-- > 0;) {
        const auto& step = steps_[i];
        const bool makes = step.operation == Operation::Add || step.operation == Operation::Replace;
        if (makes && (step.thing.noun == phrase.noun || head_of(step.thing.noun) == phrase.noun))
            return Target{Target::Kind::Made, {{{step.thing.noun, "", {}}}, false}, std::nullopt, i, ""};
    }
    return std::nullopt;
}

Target Draft::of_several(const Phrase& phrase, const std::vector<std::size_t>& found) const {
    std::vector<std::size_t> left = found;
    std::string side;
    bool told = false;
    for (const auto& attribute : phrase.attributes) {
        if (attribute.quality == Quality::Side) side = attribute.value;
        if (!tells_apart(attribute)) continue;
        told = true;
        std::erase_if(left, [&](std::size_t index) { return !told_of(scene_->things[index], attribute); });
    }
    std::string called;
    for (const auto& attribute : phrase.attributes) called += attribute.typed + " ";
    called += phrase.noun;
    while (called.ends_with(' ')) called.pop_back();
    const Target missing{Target::Kind::Missing, {}, std::nullopt, std::nullopt, called};
    if (told && left.empty()) return missing;
    if (left.size() == 1) return target_of_thing(left.front());
    const auto& noun = scene_->things[left.front()].noun;
    const bool alike = std::all_of(left.begin(), left.end(),
                                   [&](std::size_t index) { return scene_->things[index].noun == noun; });
    if (!side.empty() && alike)
        return {Target::Kind::There, {{{noun, "", {side}}}, false}, std::nullopt, std::nullopt, ""};
    const bool part_of = phrase.some_of && phrase.count != "all";
    const bool of_all = (phrase.count == "all" || phrase.plural) && !part_of;
    if ((of_all || phrase.count == std::to_string(left.size())) && alike)
        return {Target::Kind::There, {{{noun, "all", {}}}, false}, std::nullopt, std::nullopt, ""};
    if (focus_ && std::find(left.begin(), left.end(), *focus_) != left.end()) return target_of_thing(*focus_);
    const bool fewer = phrase.some_of && !phrase.count.empty() && phrase.count != "all";
    if (fewer && alike && std::size_t(std::atoi(phrase.count.c_str())) < left.size())
        return {Target::Kind::There, {{{noun, phrase.count, {}}}, false}, std::nullopt, std::nullopt, ""};
    if (phrase.single && alike)
        return {Target::Kind::There, {{{noun, "1", {}}}, false}, std::nullopt, std::nullopt, ""};
    return {Target::Kind::Ambiguous, {}, std::nullopt, std::nullopt, ""};
}

/// "the other one", "the second bear"; nothing where no such word stands.
std::optional<Target> Draft::ordinal(const Phrase& phrase) const {
    const auto side =
        std::find_if(phrase.attributes.begin(), phrase.attributes.end(), [](const Attribute& each) {
            return each.quality == Quality::Side && has(Class::ordinal, each.value);
        });
    if (phrase.another && phrase.definite && things_named(phrase).size() == 1)
        return Target{Target::Kind::Missing, {}, std::nullopt, std::nullopt, "second " + phrase.noun};
    if (side != phrase.attributes.end() && !phrase.owner && !is_part(phrase)) {  // "the other one"
        std::vector<std::size_t> others;
        const auto first = focus_ ? focus_ : last_ ? last_->thing : std::nullopt;
        for (std::size_t i = 0; i < scene_->things.size(); ++i)
            if (!scene_->things[i].is_ground && !scene_->things[i].is_worn && first != i) others.push_back(i);
        if (side->value == "other" && first && others.size() == 1 &&
            (phrase.noun.empty() || names(scene_->things[others.front()], phrase)))
            return target_of_thing(others.front());
        if (things_named(phrase).size() == 1)
            return Target{
                Target::Kind::Missing, {}, std::nullopt, std::nullopt, side->value + " " + phrase.noun};
    }
    return std::nullopt;
}

/// "the bear's hat", "the roof of the house".
Target Draft::owned(const Phrase& phrase) const {
    const Target missing{Target::Kind::Missing, {}, std::nullopt, std::nullopt, phrase.noun};
    const auto owner = resolve(*phrase.owner);
    if (const auto found = things_named(phrase);
        !found.empty() && !(is_part(phrase) && scene_->things[found.front()].is_ground))
        return target_of_thing(found.front());
    if (owner.found() && !may_have(owner, phrase))
        return {Target::Kind::Missing, {}, std::nullopt, std::nullopt, phrase.typed};
    if (!owner.found() || (!is_part(phrase) && !is_worn(phrase))) return owner.found() ? missing : owner;
    return is_worn(phrase) && !is_part(phrase) && !(kinds_of(phrase.noun) & Body)
               ? missing
               : part_target(owner, phrase);
}

/// "the blue thing": the only one that is so.
std::optional<Target> Draft::told_thing(const Phrase& phrase) const {
    if (!has(Class::thing_name, phrase.noun) || !phrase.definite || phrase.attributes.empty())
        return std::nullopt;
    std::vector<std::size_t> told;
    for (std::size_t i = 0; i < scene_->things.size(); ++i)
        if (!scene_->things[i].is_ground && told_of(scene_->things[i], phrase.attributes.front()))
            told.push_back(i);
    return told.size() == 1 ? std::optional(target_of_thing(told.front())) : std::nullopt;
}

Target Draft::resolve(const Phrase& phrase) const {
    const Target missing{Target::Kind::Missing, {}, std::nullopt, std::nullopt, phrase.noun};
    switch (phrase.naming) {
        case Naming::Thing: break;
        case Naming::Everything:
            if (phrase.excepted.size() > 1)
                return {Target::Kind::Ambiguous, {}, std::nullopt, std::nullopt, ""};
            if (!phrase.excepted.empty()) {
                auto target = resolve(phrase.excepted.front());
                target.reference.except = true;
                target.thing.reset();
                return target;
            }
            return scene_target();
        case Naming::EverythingElse: {
            auto target = last_ && last_->kind == Target::Kind::There ? *last_ : focus();
            target.reference.except = true;
            target.thing.reset();
            return target;
        }
        case Naming::Something: return missing;
        default: return pronoun(phrase.naming);
    }
    if (const auto other = ordinal(phrase)) return *other;
    if (phrase.noun.empty()) {  // "the red one"
        std::vector<std::size_t> all;
        for (std::size_t i = 0; i < scene_->things.size(); ++i)
            if (!scene_->things[i].is_ground) all.push_back(i);
        return all.empty() || phrase.attributes.empty() ? missing : of_several(phrase, all);
    }
    if (phrase.owner) return owned(phrase);
    const auto found = things_named(phrase);
    if (const auto made = made_named(phrase); made && (found.empty() || phrase.definite)) return *made;
    if (found.size() == 1) {
        const auto target = target_of_thing(found.front());
        const bool several =
            !target.reference.links[0].attributes.empty() || !target.reference.links[0].count.empty();
        if (!several) return target;
        return of_several(phrase, found);
    }
    if (found.size() > 1) return of_several(phrase, found);
    if (const auto told = told_thing(phrase)) return *told;
    if (has(Class::thing_name, phrase.noun) && phrase.definite)  // "every item on the desk" is not one thing
        return phrase.count == "all" ? pronoun(Naming::They) : focus();
    const bool new_thing = phrase.indefinite && !phrase.possessive && has(Class::thing, phrase.noun) &&
                           (kinds_of(phrase.noun) & Body) == 0;
    const bool clothes = is_worn(phrase) && !phrase.definite && !phrase.possessive && !phrase.plural &&
                         (kinds_of(phrase.noun) & Body) == 0 && phrase.attributes.empty() && focus_ &&
                         can_wear(focus());
    if (is_part(phrase) && !new_thing && !clothes) {  // "on a pedestal", "a crown"
        const bool of_last =
            last_ && last_->kind == Target::Kind::There && !last_->thing && phrase.definite &&
            last_->reference.links.size() > 1;  // "paint the table legs red and the top white"
        Target owner = phrase.possessive || of_last ? pronoun(Naming::It, true) : focus();
        if (!owner.found() && !scene_->things.empty() && owner.kind == Target::Kind::Ambiguous)
            owner = target_of_thing(0);
        if (owner.found() && may_have(owner, phrase)) return part_target(owner, phrase);
    }
    return missing;
}

std::vector<Target> Draft::resolve_all(const Phrase& phrase) const { return {resolve(phrase)}; }

}  // namespace gse::language::plan
