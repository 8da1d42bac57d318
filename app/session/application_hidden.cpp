// Hiding and isolating labels: what is seen and picked; the document never changes.
#include <algorithm>
#include <numeric>

#include "app/cli/engine_names.h"
#include "app/session/application.h"

namespace gse::app {

/// [set] 1 for what is hidden of a set that is on the screen or compared with. Rows that a running edit added
/// are seen.
std::vector<std::uint8_t> Application::hidden_rows(const GaussianSet& set) const {
    const auto& state = document_.state();
    if (model_.compared_revision != 0 && set.shares_all_with(compared_.set))
        return hidden_.rows(*compared_.ids);
    if (set.shares_all_with(state.base) && !set.shares_all_with(state.current)) {
        std::vector<RowId> ids(set.size());
        std::iota(ids.begin(), ids.end(), RowId{0});
        return hidden_.rows(ids);
    }
    const auto rows = hidden_.rows(*state.row_ids);
    std::vector<float> visible(rows.size());
    std::transform(rows.begin(), rows.end(), visible.begin(),
                   [](auto hidden) { return hidden != 0 ? 0.0f : 1.0f; });
    const auto shown = on_screen(std::make_shared<const std::vector<float>>(std::move(visible)), set);
    std::vector<std::uint8_t> hidden(set.size(), 0);
    for (std::size_t row = 0; shown && row < hidden.size(); ++row) hidden[row] = (*shown)[row] == 0 ? 1 : 0;
    return hidden;
}

/// The set as it is seen; the same arrays as long as nothing changes, so that nothing is uploaded anew.
GaussianSet Application::seen(const GaussianSet& set) {
    if (hidden_.empty()) return set;
    constexpr std::size_t sides = 2;  // of a comparison
    const auto known = std::find_if(seen_.begin(), seen_.end(),
                                    [&](const auto& one) { return one.of.shares_all_with(set); });
    if (known != seen_.end()) return known->set;
    if (seen_.size() >= sides) seen_.pop_front();
    seen_.push_back({set, with_hidden(set, hidden_rows(set))});
    return seen_.back().set;
}

/// What an export writes of a set: all of it unless the artist said otherwise.
GaussianSet Application::exported(const GaussianSet& set) const {
    if (!model_.exports.visible_only || hidden_.empty()) return set;
    return without_hidden(set, hidden_rows(set));
}

bool Application::something_to_export() {
    if (!require_scene()) return false;
    if (!model_.exports.visible_only || model_.hidden < document_.state().current.size()) return true;
    toast("Every splat is hidden: show some of them (Shift + H), or export what is hidden too.", true);
    return false;
}

/// After another choice, and after rows have come or gone.
void Application::hidden_changed() {
    seen_.clear();
    if (picking_) picking_->forget_rows();  // what is hidden is not picked
    ++content_;
    const auto rows = hidden_.rows(*document_.state().row_ids);
    model_.hidden = static_cast<std::size_t>(std::count(rows.begin(), rows.end(), std::uint8_t{1}));
    if (hidden_.empty()) model_.exports.visible_only = false;  // a choice for what is hidden now
}

void Application::hide_label() {
    const NamedLabel* label = active_label();
    if (label == nullptr || model_.labelled == 0) return;
    hidden_.hide(*document_.state().row_ids, *label->bits);
    hidden_changed();
}

void Application::isolate_label() {
    const NamedLabel* label = active_label();
    if (label == nullptr || model_.labelled == 0) return;
    hidden_.isolate(*document_.state().row_ids, *label->bits);
    hidden_changed();
}

void Application::show_hidden() {
    hidden_.show_all();
    if (!document_.empty()) hidden_changed();
}

}  // namespace gse::app
