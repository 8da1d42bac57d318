// The last search: its job, and its evidence as the window shows it.
#include "app/session/edit/last_search.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "engine/language/words.h"
#include "engine/pipeline/recipe/recipe.h"
#include "engine/pipeline/run/views.h"

namespace gse::app {

void LastSearch::remember(std::shared_ptr<EditJob> job, const EditRecipe& recipe) {
    job_ = std::move(job);
    splats_ = job_->scene().gaussians;
    const EditRecipe found = job_->recipe().plain();
    words_ = found.request;
    target_read_ = job_->target_read();
    tuning_key_ = pipeline::tuning_key(found);
    tuned_ = job_->tuned();
    EditRecipe searched = recipe;
    searched.request.target = words_.target;
    key_ = valid_search_key(searched);
}

void LastSearch::forget() {
    const auto searches = outcome_.number;
    *this = {};
    outcome_.number = searches;
}

void LastSearch::take_attention(const GaussianSet& splats, std::vector<float> attention) {
    attention_ = std::make_shared<const std::vector<float>>(std::move(attention));
    attention_of_ = splats;
    views_.clear();
}

/// Shows the evidence. Renders and attention stay on the screen when only the threshold changed.
void LastSearch::show_evidence(const EditJob& job) {
    const auto& located = job.located();
    const bool again = views_.size() == located.views.size();
    std::vector<ui::AttentionView> views;
    for (std::size_t v = 0; v < located.views.size(); ++v)
        views.push_back(again ? refreshed(views_[v], located.views[v])
                              : seen_view(job.views()[v], located.views[v]));
    views_ = std::move(views);
    word_ = located.word;
    mode_ = fmt::format("{}: {}{}", edit::mode_name(located.mode), located.reason,
                        job.found_by_differences() ? "; found by what the server changed" : "");
    outcome_ = {outcome_.number + 1, located.confidence, located.problem, located.message, located.remedy, {},
                located.on_ground};
    if (const auto front = job.front_read())
        outcome_.front = std::fmod(std::round(*front / pipeline::Degree) + 360, 360);
    threshold_ = job.attention_threshold();
    arriving_ = false;
    voted_with_ = job.recipe().request;
}

bool LastSearch::take_arriving(ArrivingViews& arriving, bool working) {
    if (arriving.take(views_)) arriving_ = true;
    if (!arriving_ || working) return false;
    arriving_ = false;
    views_.clear();
    if (job_) show_evidence(*job_);
    return job_ != nullptr;
}

std::string LastSearch::read_target(const edit::EditRequest& request) const {
    const bool same =
        target_read_ &&
        language::normalised_prompt(words_.source) == language::normalised_prompt(request.source) &&
        language::normalised_prompt(words_.prompt) == language::normalised_prompt(request.prompt);
    return same ? words_.target : std::string();
}

std::optional<neural::TunedModel> LastSearch::tuning(const EditRecipe& recipe) const {
    const bool same = recipe.use_dreambooth && tuning_key_ == pipeline::tuning_key(recipe);
    return same ? tuned_ : std::nullopt;
}

RowValues LastSearch::attention_of(const GaussianSet& splats) const {
    return attention_ && !undone_ && attention_of_.shares_all_with(splats) ? attention_ : nullptr;
}

void LastSearch::leave_out(std::size_t view, bool out) {
    views_[view].failed = out;
    views_[view].step = out ? edit::ViewStep::LeftOut : edit::ViewStep::Found;
}

void LastSearch::show(ui::SearchPart& model) const {
    model.attention = views();
    model.attention_arriving = arriving_;
    const bool hidden = undone_ && !arriving_;
    model.attention_threshold = hidden ? LastSearch().threshold_ : threshold_;
    model.attention_word = hidden ? std::string() : word_;
    model.attention_mode = hidden ? std::string() : mode_;
    model.search = hidden ? ui::SearchView{} : outcome_;
    model.search.number = outcome_.number;
}

}  // namespace gse::app
