// Request of the Prompt panel: its settings, its sentence, and the changes that this asks for.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/edit/request/step_progress.h"

namespace gse::app {

class AskedSentence {
public:
    using Step = language::plan::StepSentence;

    AskedSentence() { request_.prompt.clear(); }

    const edit::EditRequest& request() const { return request_; }
    /// Takes a request. Other words are about the sentence as it is typed again.
    void set(const edit::EditRequest& request);
    /// Settings that no plan depends on.
    edit::EditSettings& settings() { return request_; }
    void forget_target() { request_.target.clear(); }
    /// Takes what applied edits have said: their words are no news any more, and what they `made` is there.
    /// Things that labels are `named` for are there where the sentence needs them.
    void set_said(std::vector<std::string> said, std::vector<std::string> made,
                  std::vector<std::string> named);
    const std::vector<std::string>& said() const { return said_; }
    /// Things of the scene beside the source.
    const std::vector<std::string>& made() const { return there_; }
    /// Tells whether the sentence speaks of such a thing beside its source.
    bool speaks_of(const std::string& thing) const;
    /// Words of the scene as far as nobody has looked at pictures of it.
    language::plan::SceneWords scene() const { return edit::assumed_scene(request_, there_); }
    /// Takes the words that the model finds; none = it takes any. `draws_any`: a server draws, which is told
    /// any word.
    void set_known_words(const std::vector<std::string>& known, bool draws_any);

    /// The request in the words of the step that it is about. Of several, that is the first until one runs.
    edit::EditRequest asked() const;
    /// Makes it about one of the steps, until other words come. Nothing = about the sentence as it is typed.
    void set_step(std::optional<Step> step) { step_ = std::move(step); }
    /// Changes that the sentence asks for, each an edit of its own, among them looks that pictures may show
    /// already. Empty = the sentence runs as it is typed.
    const std::vector<edit::PlannedStep>& steps() const { return steps_; }
    /// True where the steps run in their own words.
    bool follows_plan() const { return follows_plan_; }
    /// Steps that can be done in a scene of these words, but those of `left_out` (in the plan's notation).
    edit::StepProgress steps_in(const language::plan::SceneWords& scene,
                                const std::vector<std::string>& left_out) const;

private:
    void plan();

    edit::EditRequest request_;
    std::vector<std::string> said_, made_, named_;
    std::vector<std::string> there_;  // what was made, and named things that the sentence speaks of
    language::plan::ModelAbility model_;
    std::vector<edit::PlannedStep> steps_;
    bool follows_plan_ = false;
    std::optional<Step> step_;  // that runs, or ran last
};

}  // namespace gse::app
