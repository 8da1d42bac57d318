// Redrawn views on their way between the edit's thread and the window, and what the artist says about them.
#include <fmt/format.h>

#include <algorithm>

#include "app/session/application.h"

namespace gse::app {
namespace {

ui::TargetRound shown_round(const EditJob& job, const edit::ViewTargets& sheet) {
    ui::TargetRound round{sheet.round, sheet.rounds, {}, sheet.sentence, sheet.warnings};
    for (const auto& target : sheet.views) {
        const View& view = job.views()[target.view];
        round.targets.push_back({target.view,
                                 view.name.empty() ? fmt::format("view {}", target.view) : view.name,
                                 target.before, target.after, view.camera, target.attempt, target.dropped});
    }
    return round;
}

}  // namespace

void watch_targets(const EditJob& job, LiveEdit& live, EditObserver& observer) {
    observer.targets = [&job, &live](const edit::ViewTargets& sheet) {
        ui::TargetRound round = shown_round(job, sheet);
        const std::lock_guard lock(live.mutex);
        const bool known = !live.targets.empty() && live.targets.back().round == round.round;
        if (known) live.targets.back() = std::move(round);
        else live.targets.push_back(std::move(round));
        if (!known) live.waits = live.reviews;
        ++live.version;
    };
    observer.judged = [&live](const EditQuality& verdict, const edit::ViewTargets& sheet) {
        ui::GateView view;
        for (std::size_t i = 0; i < sheet.views.size(); i += std::max<std::size_t>(1, sheet.views.size() / 4))
            if (view.pictures.size() < 4) view.pictures.push_back(sheet.views[i].after);
        view.verdict = verdict.verdict;
        view.warns = verdict.warns;
        const std::lock_guard lock(live.mutex);
        live.gate = std::move(view);
        ++live.version;
    };
    observer.target_orders = [&job, &live] {
        std::unique_lock lock(live.mutex);
        if (live.waits && live.orders.empty()) {
            lock.unlock();
            job.control().report("waiting for your look at the redrawn views", 0, 0);
            lock.lock();
            live.spoken.wait(lock, job.control().stop,
                             [&live] { return !live.waits || !live.orders.empty(); });
        }
        return std::exchange(live.orders, {});
    };
}

/// With the lock of the running edit held.
void Application::refresh_targets() {
    model_.target_rounds = live_->targets;
    model_.targets_wait = live_->waits;
    if (model_.target_rounds.empty()) return;
    for (const auto& order : live_->orders)
        for (auto& target : model_.target_rounds.back().targets) target.ordered |= target.view == order.view;
}

void Application::order_target(const edit::TargetOrder& order) {
    if (!edit_running()) return toast("The edit is over: branch from a snapshot to go on with other views.");
    const std::lock_guard lock(live_->mutex);
    if (live_->targets.empty() || live_->targets.back().round != order.round) return;
    live_->orders.push_back(order);
    live_->spoken.notify_all();
    ++live_->version;
}

void Application::fit_to_targets() {
    const std::lock_guard lock(live_->mutex);
    live_->waits = false;
    live_->spoken.notify_all();
    ++live_->version;
}

}  // namespace gse::app
