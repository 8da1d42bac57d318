// Other results of applied edits, to be exchanged for what was applied.
#include "app/session/state/variations.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "engine/scene/label_ops.h"

namespace gse::app {
namespace {

EditNode as_node(const PendingResult& result, const DocumentState& before, std::uint64_t id) {
    EditNode node = node_of(result);
    node.id = id;
    node.delta = std::make_shared<const SceneDelta>(
        make_delta(result.before, *before.row_ids, result.set, *result.base_to_new, id));
    return node;
}

std::size_t kept_bytes(const EditVariations& variations) {
    std::size_t bytes = 0;
    for (const auto& node : variations.nodes) bytes += node.delta->byte_size();
    return bytes;
}

/// Byte per row: 1 for those that the edit added.
std::vector<std::uint8_t> rows_of(const DocumentState& state, std::uint64_t edit) {
    std::vector<std::uint8_t> rows(state.row_ids->size());
    std::transform(state.row_ids->begin(), state.row_ids->end(), rows.begin(),
                   [&](RowId id) { return static_cast<std::uint8_t>(id >> EditIdShift == edit ? 1 : 0); });
    return rows;
}

bool holds_any(const NamedLabel& label, const std::vector<std::uint8_t>& rows) {
    if (!label.bits || label.bits->size() != rows.size()) return false;
    for (std::size_t row = 0; row < rows.size(); ++row)
        if (rows[row] != 0 && (*label.bits)[row] != 0) return true;
    return false;
}

}  // namespace

void KeptVariations::keep(const WaitingResults& results, const EditNode& node, const DocumentState& before) {
    if (results.all().size() < 2 || !results.shown()) return;
    EditVariations variations;
    variations.edit = node.id;
    for (std::size_t index = 0; index < results.all().size(); ++index) {
        const auto& result = results.all()[index];
        if (!result.before.shares_all_with(before.current)) continue;  // of another state of the scene
        variations.nodes.push_back(index == *results.shown() ? node : as_node(result, before, node.id));
        variations.seeds.push_back(result.seed);
    }
    if (variations.nodes.size() < 2) return;
    all_.push_back(std::move(variations));
    std::size_t bytes = 0;
    for (auto newest = all_.rbegin(); newest != all_.rend(); ++newest) {
        bytes += kept_bytes(*newest);
        if (bytes <= MostBytes) continue;
        all_.erase(all_.begin(), newest.base());
        return;
    }
}

const EditVariations* KeptVariations::of(std::uint64_t edit) const {
    const auto found = std::find_if(
        all_.begin(), all_.end(), [&](const EditVariations& variations) { return variations.edit == edit; });
    return found == all_.end() ? nullptr : &*found;
}

std::vector<EditVariations> KeptVariations::stored(const std::vector<EditNode>& stack) const {
    std::vector<EditVariations> some;
    std::size_t bytes = 0;
    for (auto newest = all_.rbegin(); newest != all_.rend(); ++newest) {
        if (!newest->applied(stack)) continue;
        bytes += kept_bytes(*newest);
        if (bytes > MostStored) break;
        some.push_back(*newest);
    }
    std::reverse(some.begin(), some.end());
    return some;
}

DocumentState with_variation(const DocumentState& state, const EditNode& variation) {
    auto stack = state.stack;
    const auto found = std::find_if(stack.begin(), stack.end(),
                                    [&](const EditNode& node) { return node.id == variation.id; });
    if (found == stack.end()) return state;
    const auto old = std::exchange(*found, variation);
    found->enabled = old.enabled;
    found->strength = old.strength;
    const auto added_before = rows_of(state, variation.id);
    std::vector<bool> holds;
    for (const auto& label : state.labels) holds.push_back(holds_any(label, added_before));
    DocumentState next = with_stack(state, std::move(stack));
    const auto added = rows_of(next, variation.id);
    for (std::size_t index = 0; index < holds.size(); ++index)
        if (holds[index]) next.labels[index] = with_added(std::move(next.labels[index]), added);
    return next;
}

}  // namespace gse::app
