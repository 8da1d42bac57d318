// Descriptions of single steps.
#include "engine/language/plan/step_sentence.h"

#include <algorithm>
#include <array>
#include <cstdlib>

#include "engine/language/plan/words/lexicon.h"
#include "engine/language/vocabulary.h"
#include "engine/language/words.h"

namespace gse::language::plan {
namespace {

constexpr std::array<std::string_view, 14> Comparatives{"darker", "lighter", "brighter", "paler",   "duller",
                                                        "warmer", "cooler",  "more",     "less",    "deeper",
                                                        "vivid",  "softer",  "richer",   "stronger"};
/// Relations that a sentence can name a place by (language::relation_named()).
constexpr std::array<std::string_view, 7> Places{"beside", "left of",     "right of", "behind",
                                                 "above",  "in front of", "under"};

/// Changes of place or size that begin with a verb of their own; the others are told with "make".
constexpr std::array<std::string_view, 7> Movements{"move",   "rotate", "scale", "flip",
                                                    "mirror", "face",   "swap"};

constexpr std::array<std::string_view, 4> Burning{"on fire", "burning", "in flames", "aflame"};

bool is_in(const auto& list, std::string_view word) {
    return std::find(list.begin(), list.end(), word) != list.end();
}

/// True for "wings", not for "bus", "cactus" or "dress".
bool is_plural(const std::string& noun) {
    const auto ends = [&](std::string_view with) { return noun.ends_with(with); };
    return noun.size() > 2 && ends("s") && !ends("ss") && !ends("us") && !ends("is");
}

std::string joined(const std::vector<std::string>& words, const std::string& last) {
    std::string text;
    for (const auto& word : words) text += word + " ";
    return text + last;
}

const SceneThing* thing_named(const SceneWords& scene, const std::string& noun) {
    const auto found = std::find_if(scene.things.begin(), scene.things.end(),
                                    [&](const SceneThing& thing) { return thing.noun == noun; });
    return found == scene.things.end() ? nullptr : &*found;
}

/// " on the grass", unless the ground itself is meant.
std::string standing_on(const SceneWords& scene, const std::string& subject) {
    const auto ground = scene.ground();
    if (!ground || scene.things[*ground].noun == subject) return {};
    return " on the " + scene.things[*ground].noun;
}

/// Makes the description of one step, or says why there is none.
class Describer {
public:
    Describer(const Step& step, const SceneWords& scene, const ModelAbility& model)
        : step_(step), scene_(scene), model_(model) {}

    std::optional<StepSentence> described() {
        switch (step_.operation) {
            case Operation::Recolour:
            case Operation::Material:
            case Operation::Pattern: return look();
            case Operation::Ground: return ground();
            case Operation::Replace: return replacement();
            case Operation::Add: return addition();
            case Operation::Alter: return fire();
            case Operation::Style: return style();
            case Operation::Environment: return environment();
            case Operation::Remove: return removal();
            case Operation::Transform: return transform();
            case Operation::Duplicate: return copies();
            default: return none_for_operation();
        }
    }
    const StepProblem& problem() const { return problem_; }

private:
    std::optional<StepSentence> no(std::string reason, std::string remedy) {
        problem_ = {std::move(reason), std::move(remedy)};
        return std::nullopt;
    }

    std::optional<StepSentence> none_for_operation() {
        constexpr const char* ByModel =
            "a model with an open vocabulary may draw it when it is the only change";
        constexpr const char* OpenModel = "choose a model such as Stable Diffusion or InstructPix2Pix";
        switch (step_.operation) {
            case Operation::Pose: return no("poses and expressions are not drawn from a plan", ByModel);
            case Operation::Alter: return no("this look is no colour, material or pattern", ByModel);
            case Operation::Style:
                return no("styles are drawn by models of an open vocabulary alone", OpenModel);
            case Operation::Environment:
                return no("weather, light and seasons are drawn by models of an open vocabulary alone",
                          OpenModel);
            default: return no("nothing is to be done", "describe the scene after the edit");
        }
    }

    /// The one thing that is meant; null where a search for its noun would find others too.
    const Thing* subject() {
        const auto& subject = step_.subject;
        if (subject.except || subject.is_scene() || subject.links.empty()) {
            no("the whole scene is not changed at once", "name the thing that is to change");
            return nullptr;
        }
        const Thing& thing = subject.links.front();
        if (!thing.attributes.empty() ||
            (!thing.count.empty() && thing.count != "all" && thing.count != "2")) {
            no("the search cannot tell one " + thing.noun + " from the others",
               "label the one that is meant by hand");
            return nullptr;
        }
        return &thing;
    }

    /// The one thing that is meant; null where it is a part, too.
    const Thing* whole_subject() {
        const Thing* thing = subject();
        if (thing == nullptr || step_.subject.links.size() == 1) return thing;
        no("a part of a thing only gets another colour, material or pattern",
           "label the part by hand, and name the thing");
        return nullptr;
    }

    std::optional<StepSentence> look() {
        const Thing* thing = subject();
        if (thing == nullptr) return std::nullopt;
        std::string words = step_.operation == Operation::Pattern && !step_.text2.empty()
                                ? step_.text2 + " " + step_.text
                                : step_.text;
        const auto list = words_of(words);
        if (std::any_of(list.begin(), list.end(), [](const auto& word) { return is_in(Comparatives, word); }))
            return no("\"" + words + "\" names no colour of its own",
                      "name the colour, or use Adjust colours (gseditpro adjust)");
        if (contains(list, "and"))
            return no("two colours at once are not drawn", "name one colour, or a pattern");
        words = joined({}, normalised_prompt(words));
        const std::string& noun = thing->noun;
        if (step_.subject.links.size() > 1) return part(words);
        return StepSentence{noun, phrase_of({noun, "", {words}}) + standing_on(scene_, noun), words,
                            EditMode::Modify};
    }

    /// A look of a part of a thing. The part is found by its word, or by the thing's shape.
    std::optional<StepSentence> part(const std::string& look) {
        const std::string& noun = step_.subject.links.front().noun;
        const Thing& whole = step_.subject.links.back();
        if (step_.subject.links.size() > 2 || !whole.attributes.empty() || !whole.count.empty())
            return no("the search cannot tell which " + whole.noun + " has the " + noun + " that is meant",
                      "label the part by hand");
        if (!finds(noun))
            return no("the model has no word for the part \"" + noun + "\" and cannot find it",
                      "label the part by hand, or choose a model of an open vocabulary");
        const Thing changed{noun, "", {look}};
        StepSentence sentence{noun,
                              phrase_of({whole.noun, "", {}}) + " with " +
                                  (is_plural(noun) ? look + " " + noun : phrase_of(changed)) +
                                  standing_on(scene_, whole.noun),
                              look, EditMode::Modify, whole.noun};
        sentence.instruction = "make the " + noun + " of the " + whole.noun + " " + look;
        return sentence;
    }

    /// True for a part that the model has a word for, or that the thing's shape tells.
    bool finds(const std::string& part) const {
        return model_.known.empty() || shape_of_part(part) || vocabulary_contains(model_.known, part);
    }

    /// The scene in words: "a red bear and a blue ball on the grass".
    std::string described_scene() const {
        std::string text;
        const auto ground = scene_.ground();
        for (const auto& thing : scene_.things)
            if (!thing.is_ground && !thing.is_worn)
                text += (text.empty() ? "" : " and ") + phrase_of({thing.noun, "", thing.attributes});
        if (text.empty()) text = "a scene";
        if (ground) text += " on the " + scene_.things[*ground].noun;
        return text;
    }

    std::optional<StepSentence> of_scene(const std::string& joint, const std::string& instruction) {
        StepSentence sentence{"scene", described_scene() + " " + joint + " " + step_.text, step_.text,
                              EditMode::Modify};
        sentence.whole_scene = true;
        sentence.instruction = instruction;
        return sentence;
    }

    std::optional<StepSentence> style() {
        if (!model_.open_vocabulary) return none_for_operation();
        const std::string joint = "in the style of";
        if (step_.subject.is_scene()) return of_scene(joint, "make it look like " + step_.text);
        const Thing* thing = whole_subject();
        if (thing == nullptr) return std::nullopt;
        StepSentence sentence{thing->noun,
                              phrase_of(described_thing(thing->noun)) + " " + joint + " " + step_.text +
                                  standing_on(scene_, thing->noun),
                              step_.text, EditMode::Modify};
        sentence.instruction = "make the " + thing->noun + " look like " + step_.text;
        return sentence;
    }

    /// "at night", "in winter".
    std::optional<StepSentence> environment() {
        if (!model_.open_vocabulary) return none_for_operation();
        const auto words = words_of(step_.text);
        const bool hour = !words.empty() && has(Class::hour, words.back());
        return of_scene(hour ? "at" : "in", "make it " + step_.text);
    }

    std::optional<StepSentence> ground() {
        if (step_.text2 == "-")
            return no("the scene's ground was not named", "say what the ground is: \"it is about: grass\"");
        const auto thing = scene_.only_thing();
        Thing ground = step_.thing;
        ground.attributes.clear();
        const std::string target = joined(step_.thing.attributes, step_.thing.noun);
        const std::string standing =
            thing ? phrase_of({scene_.things[*thing].noun, "", {}}) + " on the " : "the ";
        return StepSentence{step_.text2, standing + target, target, EditMode::Modify};
    }

    std::optional<StepSentence> replacement() {
        const Thing* thing = whole_subject();
        if (thing == nullptr || several()) return std::nullopt;
        return StepSentence{thing->noun, phrase_of(step_.thing) + standing_on(scene_, thing->noun),
                            step_.thing.noun, EditMode::Replace};
    }

    /// Flames are a thing that models add; any other look is not drawn from a plan.
    std::optional<StepSentence> fire() {
        if (!is_in(Burning, step_.text)) return none_for_operation();
        const Thing* thing = whole_subject();
        if (thing == nullptr) return std::nullopt;
        return StepSentence{
            thing->noun,
            phrase_of(described_thing(thing->noun)) + " in flames" + standing_on(scene_, thing->noun),
            "flames", EditMode::Add};
    }

    /// True, with the reason, where more than one new thing is asked for.
    bool several() {
        if (step_.thing.count.empty()) return false;
        no("several new things at once are not drawn", "add them one after another");
        return true;
    }

    std::optional<StepSentence> addition() {
        if (several()) return std::nullopt;
        if (step_.anchors.size() != 1)
            return no("a place between two things is not found", "name one thing that it stands beside");
        const auto& anchor = step_.anchors.front();
        const auto place = place_at(anchor);
        if (!place) return std::nullopt;
        const auto& [noun, joint, behind] = *place;
        return StepSentence{noun,
                            phrase_of(described_thing(noun)) + " " + joint + " " + phrase_of(step_.thing) +
                                behind + standing_on(scene_, noun),
                            step_.thing.noun, EditMode::Add};
    }

    /// A thing of the scene as it is, in words: "a red bear on the grass". What is worn stands alone ("a blue
    /// hat"), a ground comes with what stands on it.
    std::string description_around(const std::string& noun) const {
        const auto* thing = thing_named(scene_, noun);
        if (thing != nullptr && thing->is_worn) return phrase_of(described_thing(noun));
        if (thing == nullptr || !thing->is_ground)
            return phrase_of(described_thing(noun)) + standing_on(scene_, noun);
        for (const auto& other : scene_.things)
            if (!other.is_worn && !other.is_ground)
                return phrase_of(described_thing(other.noun)) + standing_on(scene_, other.noun);
        return phrase_of(described_thing(noun));
    }

    /// An order about the subject, in an edit that draws nothing. Nothing where the subject is not one thing.
    std::optional<StepSentence> order(EditMode mode, const std::string& verb, const std::string& rest) {
        const Thing* thing = subject();
        if (thing == nullptr) return std::nullopt;
        const auto& links = step_.subject.links;
        const std::string whole = links.size() > 1 ? links.back().noun : std::string();
        if (links.size() > 2 || (!whole.empty() && !finds(thing->noun)))
            return no("the model has no word for the part \"" + thing->noun + "\" and cannot find it",
                      "label the part by hand, or choose a model of an open vocabulary");
        StepSentence sentence{thing->noun,
                              verb + " the " + thing->noun + (whole.empty() ? "" : " of the " + whole) + rest,
                              thing->noun, mode, whole};
        sentence.description = description_around(whole.empty() ? thing->noun : whole);
        return sentence;
    }

    std::optional<StepSentence> removal() { return order(EditMode::Remove, "remove", ""); }

    std::optional<StepSentence> transform() {
        const auto words = words_of(step_.text);
        const bool verb = !words.empty() && is_in(Movements, words.front());
        std::string rest = verb ? step_.text.substr(words.front().size()) : " " + step_.text;
        std::string anchor;
        if (step_.anchors.size() > 1) return no("a place between two things is not found", "name one thing");
        if (!step_.anchors.empty()) {
            const auto& links = step_.anchors.front().links;
            if (links.size() != 1 || step_.anchors.front().except || !links.front().attributes.empty())
                return no("the search cannot tell which thing is meant", "name one thing by its noun");
            anchor = links.front().noun;
            rest += " the " + anchor;
        }
        auto sentence = order(EditMode::Transform, verb ? words.front() : "make", rest);
        if (!sentence) return sentence;
        sentence->change = step_.text;
        sentence->anchor = anchor;
        return sentence;
    }

    std::optional<StepSentence> copies() {
        auto sentence = order(EditMode::Transform, "duplicate", ": " + step_.text + " in all");
        constexpr int Some = 3;
        if (sentence) sentence->copies = step_.text == "some" ? Some : std::atoi(step_.text.c_str());
        return sentence;
    }

    struct Place {
        std::string noun;    // that the new thing belongs to
        std::string joint;   // "wearing"
        std::string behind;  // " beside it"
    };

    std::optional<Place> place_at(const Reference& anchor) {
        const auto failed = [&](std::string reason) -> std::optional<Place> {
            no(std::move(reason), "say which thing it stands beside, or that a thing wears it");
            return std::nullopt;
        };
        if (anchor.is_scene() || anchor.except || anchor.links.empty()) {
            const auto only = scene_.only_thing();
            if (!only) return failed("the sentence does not say where the new thing goes");
            return Place{scene_.things[*only].noun, "with", " beside it"};
        }
        const std::string& noun = anchor.root();
        const auto ground = scene_.ground();
        if (ground && scene_.things[*ground].noun == noun) {
            const auto only = scene_.only_thing();
            if (!only) return failed("a place on the ground alone is not found");
            return Place{scene_.things[*only].noun, "with", " beside it"};
        }
        if (step_.relation == "worn by") return Place{noun, "wearing", ""};
        if (step_.relation == "held by") return Place{noun, "holding", ""};
        if (step_.relation == "on")
            return listed_place(step_.thing.noun) ? Place{noun, "with", ""}
                                                  : Place{noun, "with", " on top of it"};
        if (is_in(Places, step_.relation)) return Place{noun, "with", " " + step_.relation + " it"};
        return failed("a place \"" + step_.relation + "\" a thing is not found");
    }

    /// The thing as the scene shows it, colours included.
    Thing described_thing(const std::string& noun) const {
        const auto* thing = thing_named(scene_, noun);
        return {noun, "", thing != nullptr ? thing->attributes : std::vector<std::string>{}};
    }

    const Step& step_;
    const SceneWords& scene_;
    const ModelAbility& model_;
    StepProblem problem_;
};

}  // namespace

bool changes_look(Operation operation) {
    return operation == Operation::Recolour || operation == Operation::Material ||
           operation == Operation::Pattern;
}

std::string phrase_of(const Thing& thing) {
    const std::string words = joined(thing.attributes, thing.noun);
    if (is_plural(thing.noun) || is_a(thing.noun, WordClass::Ground)) return words;
    return (std::string_view("aeiou").find(words.front()) != std::string_view::npos ? "an " : "a ") + words;
}

std::optional<StepSentence> sentence_of(const Step& step, const SceneWords& scene, StepProblem* problem,
                                        const ModelAbility& model) {
    Describer describer(step, scene, model);
    auto sentence = describer.described();
    if (!sentence && problem != nullptr) *problem = describer.problem();
    return sentence;
}

SceneWords after(const Step& step, SceneWords scene) {
    const std::string noun = step.subject.links.empty() ? "" : step.subject.links.front().noun;
    const auto found = std::find_if(scene.things.begin(), scene.things.end(),
                                    [&](const SceneThing& thing) { return thing.noun == noun; });
    const auto ground = scene.ground();
    if (changes_look(step.operation)) {
        if (found != scene.things.end()) found->attributes = {step.text};
    } else if (step.operation == Operation::Replace) {
        if (found != scene.things.end())
            found->noun = step.thing.noun, found->attributes = step.thing.attributes;
    } else if (step.operation == Operation::Ground) {
        if (ground) scene.things[*ground].noun = step.thing.noun, scene.things[*ground].attributes = {};
    } else if (step.operation == Operation::Remove) {
        if (found == scene.things.end()) return scene;
        const bool wears = !found->is_worn && !found->is_ground;
        auto behind = scene.things.erase(found);
        while (wears && behind != scene.things.end() && behind->is_worn) behind = scene.things.erase(behind);
    } else if (step.operation == Operation::Add) {
        scene.things.push_back({step.thing.noun, step.thing.attributes, false,
                                step.relation == "worn by" || step.relation == "held by"});
    }
    return scene;
}

}  // namespace gse::language::plan
