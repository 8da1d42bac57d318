// Signs that a plan misses what its sentence says: steps of nothing, descriptions that no step has.
#include "engine/language/plan/grammar/audit.h"

#include <algorithm>
#include <array>
#include <set>
#include <string>

namespace gse::language::plan {
namespace {

using Words = std::span<const Word>;
using Texts = std::set<std::string, std::less<>>;

constexpr std::size_t LongestAudited = 18;  // words; longer sentences tell more than they ask for

/// Descriptions that some step has to say.
constexpr std::array Descriptions = {Class::colour,        Class::material, Class::material_surface,
                                     Class::pattern_plain, Class::size,     Class::state,
                                     Class::pose};
/// Words beside which a description may be said of what is not to be.
constexpr std::array Excuses = {
    Class::negation,  Class::none,       Class::without,      Class::rather_than, Class::except,
    Class::like,      Class::correction, Class::alternative,  Class::from,        Class::do_not,
    Class::unwanted,  Class::than,       Class::word_neither, Class::instead,     Class::negative_prompt,
    Class::verb_keep, Class::nobody};

template <std::size_t N> bool is_any(Words words, const std::array<Class, N>& kinds) {
    return std::any_of(kinds.begin(), kinds.end(), [&](Class kind) { return match(kind, words).length > 0; });
}

void add_words(Texts& texts, std::string_view phrase) {
    std::string word;
    for (const char letter : std::string(phrase) + " ") {
        if (std::isalnum(static_cast<unsigned char>(letter)) != 0) word += letter;
        else if (!word.empty()) {
            texts.insert(word_of(word).singular);
            texts.insert(std::move(word));
            word.clear();
        }
    }
}

bool is_empty(const Reference& reference) {
    return std::any_of(reference.links.begin(), reference.links.end(),
                       [](const Thing& link) { return link.noun.empty(); }) ||
           reference.links.empty();
}

bool has_empty_anchor(const Step& step) {
    return std::any_of(step.anchors.begin(), step.anchors.end(), is_empty);
}

/// Words of the grammar that hold a description or a noun: "overgrown with", "on fire", "in the dark".
constexpr std::array Fixed = {Class::inverse_relation,
                              Class::fire_words,
                              Class::relation,
                              Class::compound,
                              Class::courtesy,
                              Class::request,
                              Class::caption,
                              Class::as_well,
                              Class::emerging,
                              Class::direction,
                              Class::environment,
                              Class::viewer,
                              Class::turning,
                              Class::flipping,
                              Class::sequence,
                              Class::pose,
                              Class::there_is,
                              Class::times,
                              Class::everything,
                              Class::pronoun_it,
                              Class::colour_word,
                              Class::furniture_name,
                              Class::thing_name,
                              Class::animal_name,
                              Class::person_name,
                              Class::clothes_name,
                              Class::ground_name,
                              Class::vehicle_name,
                              Class::plant_name,
                              Class::noise,
                              Class::gone,
                              Class::degree,
                              Class::empty,
                              Class::unworn_adjective,
                              Class::shade_of};

template <std::size_t N> std::size_t longest(Words words, const std::array<Class, N>& kinds) {
    std::size_t length = 0;
    for (const auto kind : kinds) length = std::max(length, match(kind, words).length);
    return length;
}

/// Tells whether a step or the scene says what the words begin with.
bool is_said(Words words, const Texts& said) {
    Texts parts;
    add_words(parts, words[0].text);  // "t-shirt"
    const bool all =
        std::all_of(parts.begin(), parts.end(), [&](const std::string& part) { return said.contains(part); });
    if (match(Class::size, words).length > 0 && said.contains("transform")) return true;  // "20 % smaller"
    if (said.contains(words[0].singular) || (all && !parts.empty())) return true;
    for (const auto kind : {Class::colour, Class::material, Class::material_surface, Class::pattern_plain,
                            Class::covering, Class::size, Class::state, Class::pose})
        if (const auto found = match(kind, words)) {
            Texts meant;
            add_words(meant, found.value);
            if (const auto pattern = meaning(Class::pattern, found.value)) add_words(meant, *pattern);
            for (const auto& each : meant)
                if (said.contains(each)) return true;
        }
    return false;
}

bool is_verb(const Word& word) {
    constexpr std::array Verbs = {
        Class::verb_recolour, Class::verb_make,      Class::verb_turn,     Class::verb_replace,
        Class::verb_add,      Class::verb_give,      Class::verb_dress,    Class::verb_cover,
        Class::verb_remove,   Class::verb_relieve,   Class::verb_shave,    Class::verb_move,
        Class::verb_lift,     Class::verb_size,      Class::verb_rotate,   Class::verb_flip,
        Class::verb_face,     Class::verb_duplicate, Class::verb_material, Class::verb_carve,
        Class::verb_pattern,  Class::verb_alter,     Class::verb_pose,     Class::verb_raise};
    const std::array base{word};
    return is_any(Words(base), Verbs);
}

/// Tells whether the word names a thing of some kind, a part or clothes, whatever else it may be.
bool may_name(const Word& word) {
    constexpr std::uint32_t Things = Animal | Person | Plant | Food | Vehicle | Kind::Worn | Artifact | Body;
    return (kinds_of(word.singular) & Things) != 0 || has(Class::worn, word.singular) ||
           has(Class::thing, word.singular);
}

bool is_noun(const Word& word) {
    if (is_verb(word) || has(Class::body_place, word.singular)) return false;
    constexpr std::uint32_t Things = Animal | Person | Plant | Food | Vehicle | Kind::Worn | Artifact;
    return ((kinds_of(word.singular) & Things) != 0 &&
            (kinds_of(word.text) & (Kind::Verb | Adjective | Body)) == 0) ||
           has(Class::worn, word.text);
}

bool names_any(const SceneWords& scene, const Word& word) {
    return std::any_of(scene.things.begin(), scene.things.end(), [&](const SceneThing& thing) {
        const auto head = thing.noun.substr(thing.noun.rfind(' ') + 1);
        return are_synonyms(thing.noun, word.singular) || are_synonyms(head, word.singular) ||
               head.ends_with(word.singular);
    });
}

/// Tells whether the step asks for what nobody asks: a thing beside the whole scene, a nose for a bear.
bool is_odd(const Step& step, const SceneWords& scene) {
    if (has(Class::nobody, step.thing.noun) || has(Class::something, step.thing.noun)) return true;
    if (step.operation == Operation::Replace)
        return step.subject.links.size() == 1 && (kinds_of(word_of(step.thing.noun).singular) & Body) != 0 &&
               !has(Class::worn, step.thing.noun);
    if (step.operation == Operation::Alter) {
        const bool lives = (kinds_of(step.subject.root()) & (Animal | Person)) != 0;
        return has(Class::praise, step.text) || (lives && has(Class::environment, step.text));
    }
    if (step.operation != Operation::Add) return has_empty_anchor(step);
    if (has_empty_anchor(step)) return true;
    const auto& anchor = step.anchors.front();
    if (anchor.is_scene()) return step.relation != "in";
    const bool there = std::any_of(scene.things.begin(), scene.things.end(),
                                   [&](const SceneThing& thing) { return thing.noun == step.thing.noun; });
    const bool inside = step.relation == "in" || step.relation == "on" || step.relation.ends_with(" by");
    if (anchor.links.size() == 1 && anchor.root() == step.thing.noun && (!there || inside))
        return true;  // a hat beside itself
    const auto head = step.thing.noun.substr(step.thing.noun.rfind(' ') + 1);
    const auto kinds = kinds_of(head);
    if (step.relation == "held by")
        return (kinds_of(step.thing.noun) & Body) != 0 || has(Class::body_place, step.thing.noun);
    return step.relation == "worn by" && !has(Class::worn, head) && (kinds & Kind::Worn) == 0 &&
           (kinds & (Vehicle | Food | Person)) != 0;
}

/// Tells whether a word names something that neither a step nor the scene has.
bool names_other(Words words, const SceneWords& scene, const Texts& said) {
    return std::any_of(words.begin(), words.end(), [&](const Word& word) {
        const bool grammatical = is_grammatical(word.text) && !has(Class::worn, word.text);
        return may_name(word) && !grammatical && !said.contains(word.singular) && !names_any(scene, word);
    });
}

/// Tells whether a description or a noun is in no step.
bool leaves_unsaid(Words words, const SceneWords& scene, const Texts& said) {
    for (std::size_t at = 0; at < words.size();) {
        const auto here = words.subspan(at);
        if (here[0].text == "my" || here[0].text == "our") {  // who wants it
            at += 2;
            continue;
        }
        if (const auto compound = match(Class::compound, here); compound.length > 1) {
            Texts meant;
            add_words(meant, compound.value);
            if (std::none_of(meant.begin(), meant.end(),
                             [&](const auto& each) { return said.contains(each); }))
                return true;
            at += compound.length;
            continue;
        }
        if (const auto fixed = longest(here, Fixed); fixed > 0) {
            at += fixed;
            continue;
        }
        const auto animal = match(Class::pattern_animal, here).length;
        const auto pattern = here[0].text == "rainbow" ? 1 : animal;  // "rainbow-striped"
        if (pattern > 0 && is_said(here, said)) {                     // "zebra stripes"
            at += pattern + match(Class::pattern_plain, words.subspan(at + pattern)).length;
            continue;
        }
        const bool matters = is_any(here, Descriptions) || (is_noun(here[0]) && !names_any(scene, here[0]));
        if (matters && !is_said(here, said)) return true;
        at += std::max<std::size_t>(1, longest(here, Descriptions));
    }
    return false;
}

}  // namespace

std::string_view doubt(Words words, const SceneWords& scene, const Plan& plan) {
    const auto& first = plan.steps.front();
    if (plan.steps.back().operation == Operation::Refuse) return {};
    const bool tells = words.size() > LongestAudited;  // a story tells how things look
    for (const auto& step : plan.steps)
        if (is_odd(step, scene) || (tells && step.operation == Operation::Alter)) return reason::NotASentence;
    if (tells) return {};
    for (std::size_t at = 0; at < words.size(); ++at)
        if (is_any(words.subspan(at), Excuses) || words[at].text == "again" || words[at].text == "then")
            return {};
    Texts said;
    add_words(said, to_string(plan));
    for (const auto& thing : scene.things) {
        add_words(said, thing.noun);
        for (const auto& attribute : thing.attributes) add_words(said, attribute);
    }
    const bool so = first.operation == Operation::None && first.text == reason::AlreadySo;
    if ((so && names_other(words, scene, said)) || leaves_unsaid(words, scene, said))
        return reason::NotASentence;
    return {};
}

}  // namespace gse::language::plan
