// Deltas for the stack, and labels that follow.
#include "engine/scene/stack_edits.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "engine/base/check.h"
#include "engine/scene/label_ops.h"

namespace gse {

EditNode removal_of(const DocumentState& state, std::span<const std::uint8_t> rows, std::uint64_t id) {
    GaussianData none;
    none.sh_degree = state.current.sh_degree();
    return exchange_of(state, rows, std::move(none), id);
}

EditNode exchange_of(const DocumentState& state, std::span<const std::uint8_t> rows, GaussianData added,
                     std::uint64_t id) {
    GSE_CHECK_EQ(rows.size(), state.current.size());
    GSE_CHECK_EQ(added.sh_degree, state.current.sh_degree());
    SceneDelta delta;
    for (std::size_t row = 0; row < rows.size(); ++row)
        if (rows[row] != 0) delta.removed.push_back((*state.row_ids)[row]);
    std::sort(delta.removed.begin(), delta.removed.end());
    delta.changed_rows.sh_degree = state.current.sh_degree();
    for (std::size_t row = 0; row < added.size(); ++row) delta.added.push_back(id << EditIdShift | row);
    delta.added_rows = std::move(added);
    EditNode node;
    node.id = id;
    node.name = fmt::format("Delete {} splats", delta.removed.size());
    node.delta = std::make_shared<const SceneDelta>(std::move(delta));
    return node;
}

DocumentState with_adjustment(const DocumentState& before, std::span<const std::uint8_t> rows,
                              const ColourAdjustment& adjustment, std::uint64_t id) {
    GSE_CHECK_EQ(rows.size(), before.current.size());
    const GaussianSet some = before.current.filtered(rows);  // of a large scene little is adjusted
    const GaussianSet after = adjusted(some, std::vector<std::uint8_t>(some.size(), 1), adjustment);
    if (adjustment == ColourAdjustment{}) return before;
    std::vector<RowId> ids;
    for (std::size_t row = 0; row < rows.size(); ++row)
        if (rows[row] != 0) ids.push_back((*before.row_ids)[row]);
    std::vector<std::int64_t> all(some.size());
    std::iota(all.begin(), all.end(), std::int64_t{0});
    EditNode node;
    node.id = id;
    node.name = fmt::format("Colours: {}", adjustment_text(adjustment));
    node.delta = std::make_shared<const SceneDelta>(make_delta(some, ids, after, all, id));
    auto stack = before.stack;
    stack.push_back(std::move(node));
    return with_stack(before, std::move(stack));
}

DocumentState with_edit(const DocumentState& before, EditNode node, const std::string& target, bool beside,
                        std::span<const std::uint8_t> apart) {
    const std::uint64_t id = node.id;
    auto stack = before.stack;
    stack.push_back(std::move(node));
    DocumentState state = with_stack(before, std::move(stack));
    std::vector<std::uint8_t> added(state.current.size(), 0);
    for (std::size_t row = 0; row < added.size(); ++row) {
        const RowId identity = (*state.row_ids)[row], index = identity - (id << EditIdShift);
        const bool fills = index < apart.size() && apart[index] != 0;
        added[row] = identity >> EditIdShift == id && !fills ? 1 : 0;
    }
    if (std::find(added.begin(), added.end(), std::uint8_t{1}) == added.end()) return state;
    if (beside || state.active_label < 0) {
        state.labels.push_back(empty_label(free_label_name(state.labels, target), added.size()));
        state.active_label = static_cast<int>(state.labels.size()) - 1;
    }
    auto& label = state.labels[static_cast<std::size_t>(state.active_label)];
    label = with_added(std::move(label), added);
    return state;
}

std::optional<std::size_t> EditVariations::applied(const std::vector<EditNode>& stack) const {
    for (const auto& node : stack)
        for (std::size_t index = 0; index < nodes.size(); ++index)
            if (node.id == edit && node.delta == nodes[index].delta) return index;
    return std::nullopt;
}

namespace {

std::vector<RowId> sorted_union(const std::vector<RowId>& a, const std::vector<RowId>& b) {
    std::vector<RowId> all = a;
    all.insert(all.end(), b.begin(), b.end());
    std::sort(all.begin(), all.end());
    return all;
}

bool share_any(const std::vector<RowId>& a, const std::vector<RowId>& b) {
    for (std::size_t i = 0, j = 0; i < a.size() && j < b.size(); a[i] < b[j] ? ++i : ++j)
        if (a[i] == b[j]) return true;
    return false;
}

}  // namespace

std::vector<std::string> edits_built_on(const std::vector<EditNode>& stack, std::uint64_t id) {
    std::vector<std::string> names;
    std::vector<RowId> made;
    for (const auto& node : stack) {
        if (!node.delta) continue;
        if (node.id == id) made = sorted_union(node.delta->changed, node.delta->added);
        else if (node.enabled && share_any(made, sorted_union(node.delta->changed, node.delta->removed)))
            names.push_back(node.name);
    }
    return names;
}

}  // namespace gse
