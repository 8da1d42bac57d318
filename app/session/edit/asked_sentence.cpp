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

void AskedSentence::set_said(std::vector<std::string> said, std::vector<std::string> made,
                             std::vector<std::string> named) {
    if (said == said_ && made == made_ && named == named_) return;
    said_ = std::move(said);
    made_ = std::move(made);
    named_ = std::move(named);
    plan();
}

void AskedSentence::set_known_words(const std::vector<std::string>& known, bool draws_any) {
    const bool open = draws_any || known.empty();
    if (known == model_.known && open == model_.open_vocabulary) return;
    model_ = {open, known};
    plan();
}

edit::EditRequest AskedSentence::asked() const {
    if (step_) return edit::request_of(request_, *step_);
    const auto first = std::find_if(steps_.begin(), steps_.end(),
                                    [](const auto& planned) { return planned.words.has_value(); });
    return follows_plan_ && first != steps_.end() ? edit::request_of(request_, *first->words) : request_;
}

edit::StepProgress AskedSentence::steps_in(const language::plan::SceneWords& scene,
                                           const std::vector<std::string>& left_out) const {
    auto steps = edit::changes_of(request_, scene, {said_, model_, left_out});
    std::erase_if(steps, [](const auto& planned) { return !planned.words; });
    return {std::move(steps), scene, model_};
}

bool AskedSentence::speaks_of(const std::string& thing) const {
    if (thing.empty() || thing == language::normalised_prompt(request_.source)) return false;
    return language::contains(there_, thing) || edit::missing_thing(request_, scene()) == thing;
}

void AskedSentence::plan() {
    there_ = made_;
    for (std::size_t tries = 0; tries < named_.size(); ++tries) {
        const auto missing = edit::missing_thing(request_, scene());
        if (missing.empty() || !language::contains(named_, missing)) break;
        there_.push_back(missing);
    }
    steps_ = edit::changes_of(request_, scene(), {said_, model_, {}});
    follows_plan_ = edit::follows_plan(request_, steps_, {said_, {}});
}

}  // namespace gse::app
