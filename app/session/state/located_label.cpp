// Weights of the votes, thresholds and corrections.
#include "app/session/state/located_label.h"

#include <algorithm>

#include "app/session/state/edit_scope.h"
#include "engine/scene/label_ops.h"

namespace gse::app {

DocumentState with_located_label(DocumentState state, const EditJob& job, bool fresh) {
    const auto& located = job.located();
    const auto& request = job.recipe().request;
    const bool adds = located.mode == edit::EditMode::Add;
    const auto& bits = *(adds ? located.source_label : located.label).bits;
    std::vector<float> weight(located.weights.weight);
    weight.resize(state.current.size());  // nothing was looked for where the thing is no part of the scene
    for (std::size_t row = 0; row < bits.size() && row < weight.size();
         ++row)  // what no view told about stays out at any threshold
        if (bits[row] == 0 && weight[row] > request.tau) weight[row] = 0;
    const std::string name = adds ? request.source : located.word;
    auto found = std::find_if(state.labels.begin(), state.labels.end(),
                              [&](const auto& label) { return is_label_of(label, name); });
    if (found == state.labels.end())
        found = state.labels.insert(state.labels.end(), empty_label(name, weight.size()));
    NamedLabel label = empty_label(found->name, weight.size());  // it may have been renamed since
    label.found_for = name;
    label.threshold = static_cast<float>(request.tau);
    label.attention_threshold = request.attention_threshold;
    label.left_out = request.left_out;
    label.looked_from = job.recipe().job.looked_from;
    label.weight = std::make_shared<const std::vector<float>>(std::move(weight));
    if (!fresh) {
        label.manual = found->manual;
        label.threshold = found->threshold;
    }
    *found = with_bits(std::move(label));
    state.active_label = static_cast<int>(found - state.labels.begin());
    return state;
}

}  // namespace gse::app
