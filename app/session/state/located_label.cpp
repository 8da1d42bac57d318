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
    const Label decided = edit::decide_label(label.name, set, *label.found, threshold, threads);
    label.weight = std::make_shared<const std::vector<float>>(weights_of(decided, threshold));
    return with_threshold(std::move(label), static_cast<float>(threshold));
}

DocumentState with_located_label(DocumentState state, const EditJob& job, bool fresh) {
    const auto& located = job.located();
    const auto& request = job.recipe().request;
    const bool adds = located.mode == edit::EditMode::Add;
    const Label& source = adds ? located.source_label : located.label;
    const std::size_t rows = state.current.size();
    // Nothing was looked for where the thing is no part of the scene.
    const bool looked = located.found.field.probability.size() == rows;
    std::vector<float> weight =
        looked ? weights_of(source, request.label_threshold) : std::vector<float>(rows, 0.0f);
    const std::string name = adds ? request.source() : located.word;
    auto found = std::find_if(state.labels.begin(), state.labels.end(),
                              [&](const auto& label) { return is_label_of(label, name); });
    if (found == state.labels.end())
        found = state.labels.insert(state.labels.end(), empty_label(name, weight.size()));
    NamedLabel label = empty_label(found->name, weight.size());  // it may have been renamed since
    label.found_for = name;
    label.threshold = static_cast<float>(request.label_threshold);
    label.attention_threshold = request.attention_threshold;
    label.excluded_views = request.excluded_views;
    label.looked_from = job.recipe().job.looked_from;
    label.weight = std::make_shared<const std::vector<float>>(std::move(weight));
    if (looked && located.found.field.views_used > 0)
        label.found = std::make_shared<const FoundField>(located.found);
    const float threshold = found->threshold;
    if (!fresh) label.manual = found->manual;
    *found = !fresh && threshold != label.threshold
                 ? at_threshold(std::move(label), state.current, static_cast<double>(threshold))
                 : with_bits(std::move(label));
    state.active_label = static_cast<int>(found - state.labels.begin());
    return state;
}

}  // namespace gse::app
