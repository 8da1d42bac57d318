// One step of a plan as a description of the scene after it, in words that a text-to-image model is told.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/language/plan/notation/plan.h"
#include "engine/language/plan/words/scene_words.h"
#include "engine/language/sentence.h"

namespace gse::language::plan {

/// A step as an edit: `prompt` describes the scene after it and contains `target`. In modes remove and
/// transform it is an order, and `description` tells the scene as it is.
struct StepSentence {
    std::string source;  // the thing that the edit is about
    std::string prompt;
    std::string target;  // the look, or the noun of the new thing
    EditMode mode = EditMode::Modify;
    std::string part_of = {};      // thing that the source is a part of; empty = a thing of its own
    bool whole_scene = false;      // everything changes its look; nothing is looked for
    std::string description = {};  // of the scene as it is; modes remove and transform
    std::string change = {};       // mode transform: "bigger", "move left 2 m"
    int copies = 1;                // mode transform: how many there are afterwards
    std::string anchor = {};       // mode transform: other thing that the change is relative to
    std::string instruction = {};  // order for models that edit by instructions; empty = from the prompt
};

/// Traits of a model that decide which steps it can do. Without any, only steps that every model can do are
/// described.
struct ModelAbility {
    bool open_vocabulary = false;         // it is told any word: styles, weather
    std::vector<std::string> known = {};  // words that it finds; empty = any, or not known
    bool operator==(const ModelAbility&) const = default;
};

/// Reason why a step cannot be done, and what to do instead; both are parts of a sentence.
struct StepProblem {
    std::string reason;
    std::string remedy;
};

/// The step's description; nothing where none would bring it about with that `model`. Then `problem` says
/// why.
std::optional<StepSentence> sentence_of(const Step& step, const SceneWords& scene,
                                        StepProblem* problem = nullptr, const ModelAbility& model = {});

/// The scene's words once the step is done.
SceneWords after(const Step& step, SceneWords scene);

/// Noun phrase with its article: "a red hat", "an owl", "sunglasses".
std::string phrase_of(const Thing& thing);

/// True for an operation that changes nothing but the look of what is there.
bool changes_look(Operation operation);

}  // namespace gse::language::plan
