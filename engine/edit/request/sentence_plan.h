// Plan of a request's sentence: the operations that it asks for, and which of them an edit can do.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/edit/request/checked_request.h"
#include "engine/language/plan/notation/plan.h"
#include "engine/language/plan/step_sentence.h"
#include "engine/language/plan/words/scene_words.h"

namespace gse::edit {

/// A step of a plan as an edit of its own.
struct PlannedStep {
    language::plan::Step step;
    std::optional<language::plan::StepSentence> words;  // nothing = it cannot be done
    language::plan::StepProblem problem;                // why not
    bool may_be_shown = false;                          // a look that pictures of the scene may show already
};

/// Words of the scene as far as the request tells them. They are the source, and grounds that the sentence
/// takes for known ("on the grass"). Things that applied edits have `made` are there, too.
language::plan::SceneWords assumed_scene(const EditRequest& request,
                                         const std::vector<std::string>& made = {});

/// Words of source and sentence that name or describe something, each once.
std::vector<std::string> words_naming(const EditRequest& request);

/// The scene's words with the request's source first, where none of them names it.
std::string with_source(const std::string& words, const EditRequest& request);

/// The operations that the sentence asks for in a scene of these words.
language::plan::Plan plan_of(const EditRequest& request, const language::plan::SceneWords& scene);

/// The steps but those of `left_out` (in the notation), each described in the scene that the earlier ones
/// leave. Refusals among them are steps that cannot be done, and so is what the `model` cannot do.
std::vector<PlannedStep> planned_steps(const language::plan::Plan& plan, language::plan::SceneWords scene,
                                       const language::plan::ModelAbility& model = {},
                                       const std::vector<std::string>& left_out = {});

/// Knowledge and wishes that changes_of() goes by.
struct ChangesWith {
    std::vector<std::string> said = {};  // words that the scene shows already, from applied edits
    language::plan::ModelAbility model = {};
    std::vector<std::string> left_out = {};  // steps in the notation
};

/// Changes that the request's sentence asks for, each an edit of its own, without those that applied edits
/// have made and those that are left out. Empty for a sentence that is refused, or is told as it is typed.
std::vector<PlannedStep> changes_of(const EditRequest& request, const language::plan::SceneWords& scene,
                                    const ChangesWith& with = {});

/// True for a request whose sentence says everything: source named; target, mode and instruction left open.
bool is_planned(const EditRequest& request);

/// True for a sentence that is told as it is typed, whatever its plan: a description that no plan is made of,
/// or one of what is around the source.
bool is_told_as_typed(const EditRequest& request, const language::plan::Plan& plan);

/// True where the sentence says that another thing wears, holds or has the source, or stands on it. Animals
/// and persons are things of their own.
bool is_borne(const language::Sentence& sentence, const std::string& source);
/// True for a request about a part, or about something borne by another thing.
bool is_about_part(const EditRequest& request);
bool is_about_part(const CheckedRequest& request);

/// True for a sentence in the form of a caption ("a blue bear on the grass"), and no order or telegram.
bool is_caption(const EditRequest& request);

/// True where the typed sentence is read as the step already, by source, kind of change and new words.
bool says_itself(const EditRequest& request, const language::plan::StepSentence& words,
                 const News& news = {});

/// True where the steps run in their own words: several, or one that the typed sentence is no caption of, or
/// does not say itself. One that cannot be done does not run as it is typed either.
bool follows_plan(const EditRequest& request, const std::vector<PlannedStep>& steps, const News& news = {});

/// The request in a step's words.
EditRequest request_of(EditRequest request, const language::plan::StepSentence& words);

/// True where pictures of the scene decide what the sentence asks for. A look stands before the source's name
/// beside another change ("a blue bear wearing a hat"), or a ground is named in passing. `words`: the words
/// of the model that looks at them; it says nothing of a thing that it has no word for.
bool pictures_decide(const EditRequest& request, const std::vector<std::string>& words = {});

/// Reason why the request is no single edit, by its words alone: nothing to change, an operation that no edit
/// does, several changes. Nothing where target, mode or instruction were chosen. Looks before the source's
/// name count as shown where something else is asked for, since pictures tell them (pictures_decide()).
std::optional<Error> single_edit_problem(const EditRequest& request, const News& news);

/// The request in the words of its plan, where that is one step which the typed sentence does not say itself
/// ("give it a hat"). Else as it is.
EditRequest in_plan_words(const EditRequest& request, const News& news);

/// Noun of the sentence that nothing in the scene of these words is called: the first for which the plan, or
/// a step of it, is refused. Empty for other plans, and where target, mode or instruction were chosen.
std::string missing_thing(const EditRequest& request, const language::plan::SceneWords& scene);

/// Sentence for a plan that changes nothing, or refuses. Nothing for another plan.
std::optional<Error> refusal_of(const language::plan::Plan& plan, const std::string& source);

}  // namespace gse::edit
