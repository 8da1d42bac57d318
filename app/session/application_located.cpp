// What a search found: pictures of the evidence, the label, and thresholds that are moved afterwards.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/session/application.h"
#include "engine/base/error.h"
#include "engine/edit/request/excluded_views.h"
#include "engine/pipeline/session/located_label.h"
#include "engine/scene/label_ops.h"
#include "ui/widgets/controls.h"

namespace gse::app {

void Application::take_located(std::shared_ptr<EditJob> job, std::vector<float> attention) {
    attention_values_ = std::make_shared<const std::vector<float>>(std::move(attention));
    attention_set_ = job->scene().gaussians;
    arriving_->take(model_.attention);  // all of them are in what the job holds
    model_.attention.clear();
    show_located(*job);
}

/// Another threshold over the same views: what was rendered and attended stays as it is on the screen.
void Application::show_located(const EditJob& job) {
    const auto& located = job.located();
    const bool again = model_.attention.size() == located.views.size();
    std::vector<ui::AttentionView> views;
    for (std::size_t v = 0; v < located.views.size(); ++v)
        views.push_back(again ? refreshed(model_.attention[v], located.views[v])
                              : seen_view(job.views()[v], located.views[v]));
    model_.attention = std::move(views);
    model_.attention_word = located.word;
    model_.attention_mode = fmt::format("{}: {}", edit::mode_name(located.mode), located.reason);
    model_.search = {model_.search.number + 1, located.confidence, located.problem,
                     located.message,          located.remedy,     {},
                     located.on_ground};
    if (const auto front = job.front_read())
        model_.search.front = std::fmod(std::round(*front / pipeline::Degree) + 360, 360);
    model_.attention_threshold = job.attention_threshold();
    model_.attention_arriving = false;
    voted_with_ = job.recipe().request;
    ++content_;
}

void Application::label_located(const EditJob& job, const std::string& step, const std::string& merge_key) {
    if (!document_.state().current.shares_all_with(job.scene().gaussians))
        return;  // the scene changed meanwhile
    DocumentState state = with_located_label(document_.state(), job, step.empty());
    const NamedLabel label = state.labels[static_cast<std::size_t>(state.active_label)];
    if (!edit_running()) model_.view.tint_labels = true;  // where it landed is to be seen
    document_.apply(step.empty() ? fmt::format("Locate \"{}\"", label.found_for) : step, std::move(state),
                    merge_key);
    if (merge_key.empty() && !edit_running())
        toast_step(fmt::format("\"{}\": {} splats are labelled.", label.name,
                               ui::count_text(count_labelled(label))));
}

/// Views of a search under way; where it comes to nothing, those of the one before come back.
void Application::show_arriving() {
    if (arriving_->take(model_.attention)) model_.attention_arriving = true;
    if (!model_.attention_arriving || work_.running()) return;
    model_.attention_arriving = false;
    model_.attention.clear();
    if (job_) show_located(*job_);
}

void Application::set_attention_threshold(double value, bool drag_ends) {
    const bool moved = value != model_.request.attention_threshold;
    model_.attention_threshold = value;
    model_.request.attention_threshold = value;
    if (moved)
        wanted_vote_ = Vote{model_.request, fmt::format("Attention threshold {:.3f}", value),
                            fmt::format("attention{}", stroke_)};
    if (drag_ends) ++stroke_;
    vote_if_wanted();
}

void Application::leave_out_view(std::size_t view, bool out) {
    if (view >= model_.attention.size() || model_.attention_arriving) return;
    model_.request.left_out = edit::with_view(model_.request.left_out, view, out);
    auto& shown = model_.attention[view];  // at once; what comes of it follows
    shown.failed = out;
    shown.step = out ? edit::ViewStep::LeftOut : edit::ViewStep::Found;
    wanted_vote_ = Vote{model_.request,
                        fmt::format("{} {}", out ? "Leave out" : "Put back", model_.attention[view].name),
                        {}};
    vote_if_wanted();
}

/// Tells the last search what its views are to vote with now; values that come while it works replace each
/// other.
void Application::vote_if_wanted() {
    if (!wanted_vote_ || work_.running() || pending_) return;  // taken up when the job is done (refresh_jobs)
    const Vote wanted = *std::exchange(wanted_vote_, std::nullopt);
    if (!job_ || !job_set_.shares_all_with(document_.state().current) || same_vote(wanted.with, voted_with_))
        return;
    work_.start({VoteTitle,
                 [job = job_, wanted](const JobControl& control) {
                     job->set_control(control);
                     job->locate_again(wanted.with.attention_threshold, wanted.with.left_out);
                 },
                 [this, job = job_, wanted](const Error* error) {
                     voted_with_ = wanted.with;
                     if (error != nullptr)
                         return error->code() == ErrorCode::Cancelled ? void() : report_error(*error);
                     show_located(*job);
                     if (!job->found())
                         return report_error(
                             Error(ErrorCode::NotFound, job->located().message, job->located().remedy));
                     if (!wanted.step.empty()) label_located(*job, wanted.step, wanted.merge_key);
                 },
                 true});
}

/// Moves through the undo steps; what labels were found with goes with them, into the request and the
/// evidence.
void Application::travel(const std::function<void()>& move) {
    const FoundWith before = found_with(document_.state());
    move();
    const auto [label, with] = found_with(document_.state());
    if (before.with.attention_threshold < 0 || with.attention_threshold < 0 || before.label != label) return;
    if (with.tau != before.with.tau) model_.request.tau = with.tau;
    if (same_vote(with, before.with)) return;
    model_.request.attention_threshold = with.attention_threshold;
    model_.request.left_out = with.left_out;
    if (with.attention_threshold > 0) model_.attention_threshold = with.attention_threshold;
    wanted_vote_ = Vote{with, {}, {}};
    vote_if_wanted();
}

}  // namespace gse::app
