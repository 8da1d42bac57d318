// States of a running or finished edit: looked at, taken as the result, gone on from.
#include <fmt/format.h>

#include <algorithm>

#include "app/session/application.h"

namespace gse::app {

void Application::list_snapshots() {
    model_.snapshots.clear();
    for (const auto& snapshot : snapshots_) model_.snapshots.push_back({snapshot.iteration, snapshot.size()});
}

void Application::forget_snapshots() {
    snapshots_.clear();
    newest_set_ = looked_at_ = {};
}

/// The edited set; those of the newest snapshot and of the one that was asked for last are at hand.
GaussianSet Application::snapshot_set(const edit::EditSnapshot& snapshot) {
    if (newest_set_.of == snapshot.rows) return newest_set_.set;
    if (looked_at_.of != snapshot.rows) looked_at_ = {snapshot.rows, snapshot.materialise()};
    return looked_at_.set;
}

/// New states came and old ones were thinned out; the one that is looked at stays, or the next later one.
void Application::take_snapshots(const std::deque<edit::EditSnapshot>& snapshots) {
    const int shown =
        model_.shown_snapshot >= 0 && model_.shown_snapshot < static_cast<int>(snapshots_.size())
            ? snapshots_[static_cast<std::size_t>(model_.shown_snapshot)].iteration
            : -1;
    snapshots_ = snapshots;
    list_snapshots();
    ++content_;
    if (shown < 0) return;
    const auto at = std::find_if(snapshots_.begin(), snapshots_.end(),
                                 [&](const auto& snapshot) { return snapshot.iteration >= shown; });
    show_snapshot(static_cast<int>(at - snapshots_.begin()));
}

void Application::show_snapshot(int index) {
    const int last =
        static_cast<int>(snapshots_.size()) - (pending_ ? 0 : 1);  // behind all of them there is the result
    model_.shown_snapshot = index >= last || index < 0 ? -1 : index;
    ++content_;
}

/// The snapshot of that iteration, else the last before it; null (and said) where it cannot be used.
const edit::EditSnapshot* Application::usable_snapshot(int iteration) {
    const auto after = std::find_if(snapshots_.begin(), snapshots_.end(),
                                    [&](const auto& snapshot) { return snapshot.iteration > iteration; });
    if (after == snapshots_.begin()) return nullptr;
    if (document_.empty() || !snapshot_base_.shares_all_with(document_.state().current)) {
        toast("The scene was changed since; the snapshots do not fit it any more.");
        return nullptr;
    }
    return &*std::prev(after);
}

void Application::take_snapshot(int iteration) {
    const edit::EditSnapshot* snapshot =
        pending_.shows_last() && !work_.running() ? usable_snapshot(iteration) : nullptr;
    if (snapshot == nullptr)
        return pending_ && !pending_.shows_last()
                   ? toast("Those states are of the last result: show that one first.")
                   : void();
    pending_->set = snapshot_set(*snapshot);
    pending_->base_to_new = std::make_shared<const std::vector<std::int64_t>>(snapshot->base_to_new());
    pending_->name = fmt::format("{} (iteration {})", model_.request.prompt, snapshot->iteration);
    model_.shown_snapshot = -1;
    ++content_;
    toast(fmt::format("The state of iteration {} is the result now. Apply keeps it.", snapshot->iteration));
}

void Application::branch_from_snapshot(int iteration) {
    if (work_.running() && !edit_running()) return toast("An edit can go on when the job is done.");
    const edit::EditSnapshot* snapshot = usable_snapshot(iteration);
    if (snapshot == nullptr) return;
    if (const int steps = edit::planned_steps(current_recipe().request); steps <= snapshot->iteration)
        return toast(fmt::format("The edit has {} iterations: set more than {} to go on from there.", steps,
                                 snapshot->iteration));
    branch_ = *snapshot;
    if (work_.running()) work_.cancel();  // it ends after its step, and then the branch begins
    else go_on_from_branch();
}

void Application::go_on_from_branch() {
    const edit::EditSnapshot start = *std::exchange(branch_, std::nullopt);
    pending_.reset();
    ++content_;
    std::erase_if(snapshots_, [&](const auto& snapshot) { return snapshot.iteration > start.iteration; });
    std::erase_if(model_.losses, [&](const auto& point) { return point.iteration >= start.iteration; });
    start_edit(start);
}

}  // namespace gse::app
