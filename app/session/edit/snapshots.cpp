// States of a running or finished edit that can be looked at, taken as the result, and gone on from.
#include "app/session/edit/snapshots.h"

#include <algorithm>
#include <utility>

#include "engine/scene/row_values.h"

namespace gse::app {

const edit::EditSnapshot* Snapshots::shown() const {
    return shown_ >= 0 && shown_ < static_cast<int>(list_.size()) ? &list_[static_cast<std::size_t>(shown_)]
                                                                  : nullptr;
}

const edit::EditSnapshot* Snapshots::at_or_before(int iteration) const {
    const auto after = std::find_if(list_.begin(), list_.end(),
                                    [&](const auto& snapshot) { return snapshot.iteration > iteration; });
    return after == list_.begin() ? nullptr : &*std::prev(after);
}

GaussianSet Snapshots::set_of(const edit::EditSnapshot& snapshot) {
    if (newest_set_.of == snapshot.rows) return newest_set_.set;
    if (looked_at_.of != snapshot.rows) looked_at_ = {snapshot.rows, snapshot.materialise()};
    return looked_at_.set;
}

void Snapshots::begin(const GaussianSet& base, std::vector<std::int64_t> rows) {
    base_ = base;
    rows_ = std::move(rows);
    shown_ = -1;
}

std::vector<std::int64_t> Snapshots::rows_of(const edit::EditSnapshot& snapshot) const {
    auto rows = snapshot.base_to_new();
    return rows_.empty() ? rows : chained(rows_, rows);
}

void Snapshots::add(edit::EditSnapshot snapshot, GaussianSet set) {
    const auto* looked_at = shown();
    const int iteration = looked_at != nullptr ? looked_at->iteration : -1;
    newest_set_ = {snapshot.rows, std::move(set)};
    list_.push_back(std::move(snapshot));
    edit::thin_out(list_, Most, MostBytes);
    if (iteration < 0) return;
    const auto at = std::find_if(list_.begin(), list_.end(),
                                 [&](const auto& state) { return state.iteration >= iteration; });
    look_at(static_cast<int>(at - list_.begin()), false);
}

void Snapshots::look_at(int index, bool result) {
    const int last = static_cast<int>(list_.size()) - (result ? 0 : 1);
    shown_ = index >= last || index < 0 ? -1 : index;
}

void Snapshots::drop_after(int iteration) {
    std::erase_if(list_, [&](const auto& snapshot) { return snapshot.iteration > iteration; });
}

void Snapshots::forget() {
    list_.clear();
    newest_set_ = looked_at_ = {};
}

void Snapshots::show(ui::EditPart& model) const {
    model.snapshots.clear();
    for (const auto& snapshot : list_) model.snapshots.push_back({snapshot.iteration, snapshot.size()});
    model.shown_snapshot = shown_;
}

}  // namespace gse::app
