// Fields of searches, thresholds and corrections.
#include "app/session/state/located_label.h"

#include <algorithm>

#include "app/session/state/edit_scope.h"
#include "engine/edit/search/decide_label.h"
#include "engine/scene/label_ops.h"

namespace gse::app {
namespace {

/// Weights of a decided label that compare with the threshold as its bits do: no view told about the rest.
std::vector<float> weights_of(const Label& label, double threshold) {
    std::vector<float> weight = *label.weight;
    for (std::size_t row = 0; row < weight.size(); ++row)
        if ((*label.bits)[row] == 0 && weight[row] > threshold) weight[row] = 0;
    return weight;
}

}  // namespace

NamedLabel at_threshold(NamedLabel label, const GaussianSet& set, double threshold, ThreadPool* threads) {
    if (label.found == nullptr || label.found->field.probability.size() != set.size())
        return with_threshold(std::move(label), static_cast<float>(threshold));
    const Label decided = edit::decide_label(label.name, set, *label.found, threshold, threads).label;
    label.weight = std::make_shared<const std::vector<float>>(weights_of(decided, threshold));
    return with_threshold(std::move(label), static_cast<float>(threshold));
}

namespace {

/// Label of a job's search, with weights but no bits yet.
NamedLabel searched_label(const EditJob& job) {
    const auto& located = job.located();
    const auto& request = job.recipe().request;
    const bool adds = located.mode == edit::EditMode::Add;
    const Label& source = adds ? located.source_label : located.label;
    const std::size_t rows = job.scene().gaussians.size();
    // Nothing was looked for where the thing is no part of the scene.
    const bool looked = located.found.field.probability.size() == rows;
    NamedLabel label = empty_label(adds ? request.source() : located.word, rows);
    label.found_for = label.name;
    label.threshold = static_cast<float>(request.label_threshold);
    label.attention_threshold = request.attention_threshold;
    label.excluded_views = request.excluded_views;
    label.looked_from = job.recipe().job.looked_from;
    label.weight = std::make_shared<const std::vector<float>>(
        looked ? weights_of(source, request.label_threshold) : std::vector<float>(rows, 0.0f));
    if (looked && located.found.field.views_used > 0)
        label.found = std::make_shared<const FoundField>(located.found);
    return label;
}

/// Place of the label that was found for the same word; a new one at the end where there is none.
NamedLabel& label_for(DocumentState& state, const NamedLabel& label) {
    auto place = std::find_if(state.labels.begin(), state.labels.end(),
                              [&](const auto& other) { return is_label_of(other, label.found_for); });
    if (place == state.labels.end())
        place = state.labels.insert(state.labels.end(), empty_label(label.found_for, label.weight->size()));
    state.active_label = static_cast<int>(place - state.labels.begin());
    return *place;
}

}  // namespace

NamedLabel located_label(const EditJob& job) {
    const auto& located = job.located();
    NamedLabel label = with_bits(searched_label(job));
    if (count_labelled(label) > 0) return label;
    const bool adds = located.mode == edit::EditMode::Add;
    return combine(std::move(label), *(adds ? located.source_label : located.label).bits,
                   LabelOperation::Add);
}

DocumentState with_found_label(DocumentState state, NamedLabel label) {
    NamedLabel& place = label_for(state, label);
    label.name = place.name;  // it may have been renamed since
    place = std::move(label);
    return state;
}

DocumentState with_located_label(DocumentState state, const EditJob& job, bool fresh) {
    NamedLabel label = searched_label(job);
    NamedLabel& place = label_for(state, label);
    label.name = place.name;
    const float threshold = place.threshold;
    if (!fresh) label.manual = place.manual;
    place = !fresh && threshold != label.threshold
                ? at_threshold(std::move(label), state.current, static_cast<double>(threshold))
                : with_bits(std::move(label));
    return state;
}

}  // namespace gse::app
