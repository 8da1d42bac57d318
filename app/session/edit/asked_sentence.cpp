// Request of the Prompt panel: its settings, its sentence, and the changes that this asks for.
#include "app/session/edit/asked_sentence.h"

#include <algorithm>
#include <utility>

#include "engine/language/words.h"

namespace gse::app {

void AskedSentence::set(const edit::EditRequest& request) {
    const bool told_else = request.source != request_.source || request.prompt != request_.prompt;
    if (told_else || request.target != request_.target || request.mode != request_.mode) step_.reset();
    request_ = request;
    if (told_else) request_.excluded_views.clear();  // they were views of another search
    // A word that was clicked in another sentence is no target of this one.
    auto& target = request_.target;
    if (!target.empty() && !language::has_phrase(request.prompt, target)) target.clear();
    plan();
}

void AskedSentence::set_said(std::vector<std::string> said) {
    if (said == said_) return;
    said_ = std::move(said);
    plan();
}

edit::EditRequest AskedSentence::asked() const {
    if (step_) return edit::request_of(request_, *step_);
    const auto first = std::find_if(steps_.begin(), steps_.end(),
                                    [](const auto& planned) { return planned.words.has_value(); });
    return several() && first != steps_.end() ? edit::request_of(request_, *first->words) : request_;
}

std::vector<AskedSentence::Step> AskedSentence::steps_in(const language::plan::SceneWords& scene,
                                                         const std::vector<std::string>& left_out) const {
    std::vector<Step> steps;
    for (const auto& planned : edit::changes_of(request_, scene, {said_, {}}, left_out))
        if (planned.words) steps.push_back(*planned.words);
    return steps;
}

void AskedSentence::plan() {
    steps_ = edit::changes_of(request_, edit::assumed_scene(request_), {said_, {}});
}

}  // namespace gse::app
