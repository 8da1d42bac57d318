// What a search found: pictures of the evidence, the label, and thresholds that are moved afterwards.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/application.h"
#include "engine/base/error.h"
#include "engine/pipeline/evidence_pictures.h"
#include "engine/scene/label_ops.h"

namespace gse::app {
namespace {

/// What another threshold changes in a view.
ui::AttentionView refreshed_view(ui::AttentionView shown, const edit::ViewEvidence& evidence) {
    shown.mask_picture = masked_picture(evidence.render, evidence.mask);
    shown.points = evidence.points;
    shown.branch = evidence.branch;
    shown.captured = evidence.captured;
    shown.failed = evidence.failed;
    shown.step = evidence.step;
    return shown;
}

ui::AttentionView attention_view(const edit::ViewEvidence& evidence, const View& view) {
    ui::AttentionView shown;
    shown.name = view.name;
    const Image& picture = evidence.drawn.data.empty() ? evidence.render : evidence.drawn;
    shown.drawn = !evidence.drawn.data.empty();
    shown.render = std::make_shared<const Image>(picture);
    shown.map = std::make_shared<const Image>(evidence.map);
    shown.map_coloured = coloured_map(picture, evidence.map);
    shown.camera = view.camera;
    return refreshed_view(std::move(shown), evidence);
}

/// What the active label was found with: attention threshold and share of the votes; negative = not by a search.
struct FoundWith {
    std::string label;
    double attention = -1, share = -1;
};

/// The same with the fewest digits, so that what was 0.4 is 0.4 again.
double plain_number(float value) { return std::stod(fmt::format("{}", value)); }

FoundWith found_with(const DocumentState& state) {
    if (state.active_label < 0 || state.active_label >= static_cast<int>(state.labels.size())) return {};
    const auto& label = state.labels[static_cast<std::size_t>(state.active_label)];
    if (label.attention_threshold < 0) return {};
    return {label.name, label.attention_threshold, plain_number(label.threshold)};
}

}  // namespace

/// The attention itself on the splats: sum(alpha T map) / sum(alpha T) over the views.
std::vector<float> splat_attention(EditJob& job) {
    const auto& set = job.drawn();
    std::vector<double> inside(set.size()), all(set.size());
    for (std::size_t v = 0; v < job.views().size(); ++v)
        job.painter().rasterizer().contributions(set.spans(), job.views()[v].camera, job.plan().settings,
                                                 job.located().views[v].map, inside, all);
    std::vector<float> result(set.size());
    for (std::size_t row = 0; row < result.size(); ++row)
        result[row] = all[row] > 0 ? static_cast<float>(std::clamp(inside[row] / all[row], 0.0, 1.0)) : 0.0f;
    return result;
}

void Application::take_located(std::shared_ptr<EditJob> job, std::vector<float> attention) {
    attention_values_ = std::make_shared<const std::vector<float>>(std::move(attention));
    attention_set_ = job->scene().gaussians;
    model_.attention.clear();
    show_located(*job);
}

/// Another threshold over the same views: what was rendered and attended stays as it is on the screen.
void Application::show_located(const EditJob& job) {
    const auto& located = job.located();
    const bool again = model_.attention.size() == located.views.size();
    std::vector<ui::AttentionView> views;
    for (std::size_t v = 0; v < located.views.size(); ++v)
        views.push_back(again ? refreshed_view(model_.attention[v], located.views[v])
                              : attention_view(located.views[v], job.views()[v]));
    model_.attention = std::move(views);
    model_.attention_word = located.word;
    model_.attention_mode = fmt::format("{}: {}", edit::mode_name(located.mode), located.reason);
    model_.search = {model_.search.number + 1, located.confidence, located.problem, located.message, located.remedy, {}};
    if (const auto front = job.front_read()) model_.search.front = std::fmod(std::round(*front / pipeline::Degree) + 360, 360);
    model_.attention_threshold = job.attention_threshold();
    relabelled_threshold_ = job.recipe().request.attention_threshold;
    ++content_;
}

void Application::label_located(const EditJob& job, const std::string& step, const std::string& merge_key) {
    if (!document_.state().current.shares_all_with(job.scene().gaussians)) return;   // the scene changed meanwhile
    const auto& located = job.located();
    const bool adds = located.mode == edit::EditMode::Add;
    const auto& bits = *(adds ? located.source_label : located.label).bits;
    std::vector<float> weight(located.weights.weight);
    const double tau = job.recipe().request.tau;
    for (std::size_t row = 0; row < weight.size(); ++row)   // what no view told about stays out at any threshold
        if (bits[row] == 0 && weight[row] > tau) weight[row] = 0;
    DocumentState state = document_.state();
    const std::string name = adds ? job.recipe().request.source : located.word;
    auto found = std::find_if(state.labels.begin(), state.labels.end(), [&](const auto& label) { return is_label_of(label, name); });
    if (found == state.labels.end()) found = state.labels.insert(state.labels.end(), empty_label(name, weight.size()));
    NamedLabel label = empty_label(found->name, weight.size());   // it may have been renamed since
    label.found_for = name;
    label.threshold = static_cast<float>(tau);
    label.attention_threshold = job.recipe().request.attention_threshold;
    label.weight = std::make_shared<const std::vector<float>>(std::move(weight));
    if (!step.empty()) {   // the same search: what was corrected by hand, and how sure is sure enough, stay
        label.manual = found->manual;
        label.threshold = found->threshold;
    }
    *found = with_bits(std::move(label));
    state.active_label = static_cast<int>(found - state.labels.begin());
    if (!edit_running()) model_.view.tint_labels = true;   // where it landed is to be seen
    document_.apply(step.empty() ? fmt::format("Locate \"{}\"", name) : step, std::move(state), merge_key);
}

void Application::set_attention_threshold(double value, bool drag_ends) {
    const bool moved = value != model_.request.attention_threshold;
    model_.attention_threshold = value;
    model_.request.attention_threshold = value;
    if (moved) wanted_threshold_ = Threshold{value, fmt::format("attention{}", stroke_)};
    if (drag_ends) ++stroke_;
    relabel_if_wanted();
}

/// Tells the last search the threshold that is wanted now; values that come while it works replace each other.
void Application::relabel_if_wanted() {
    if (!wanted_threshold_ || work_.running() || pending_) return;   // taken up when the job is done (refresh_jobs)
    const Threshold wanted = *std::exchange(wanted_threshold_, std::nullopt);
    if (!job_ || !job_set_.shares_all_with(document_.state().current) || wanted.value == relabelled_threshold_) return;
    work_.start({"New threshold",
                 [job = job_, wanted](const JobControl& control) {
                     job->set_control(control);
                     job->locate_again(wanted.value);
                 },
                 [this, job = job_, wanted](const Error* error) {
                     relabelled_threshold_ = wanted.value;
                     if (error != nullptr) return error->code() == ErrorCode::Cancelled ? void() : report_error(*error);
                     show_located(*job);
                     if (!job->found())
                         return report_error(Error(ErrorCode::NotFound, job->located().message, job->located().remedy));
                     if (wanted.merge_key.empty()) return;
                     label_located(*job, fmt::format("Attention threshold {:.3f}", wanted.value), wanted.merge_key);
                 },
                 true});
}

/// Moves through the undo steps; thresholds that labels were found with go with them, into the request and the evidence.
void Application::travel(const std::function<void()>& move) {
    const FoundWith before = found_with(document_.state());
    move();
    const FoundWith after = found_with(document_.state());
    if (before.attention < 0 || after.attention < 0 || before.label != after.label) return;
    if (after.share != before.share) model_.request.tau = after.share;
    if (after.attention == before.attention) return;
    model_.request.attention_threshold = after.attention;
    if (after.attention > 0) model_.attention_threshold = after.attention;
    wanted_threshold_ = Threshold{after.attention, {}};
    relabel_if_wanted();
}

}  // namespace gse::app
