// A short list with a place in it.
#include "app/session/state/waiting_results.h"

#include <algorithm>
#include <utility>

namespace gse::app {
namespace {

std::size_t bytes_of(const PendingResult& result) {
    const auto& set = result.set;
    return (set.position().size() + set.log_scale().size() + set.rotation().size() +
            set.opacity_logit().size() + set.sh().size()) *
           sizeof(float);
}

}  // namespace

std::uint64_t WaitingResults::next_seed() const {
    std::uint64_t next = 0;
    for (const auto& result : results_) next = std::max(next, result.seed + 1);
    return next;
}

void WaitingResults::add(PendingResult result) {
    results_.push_back(std::move(result));
    std::size_t bytes = 0, kept = 0;
    for (auto newest = results_.rbegin(); newest != results_.rend(); ++newest) {
        bytes += bytes_of(*newest);
        if (kept > 0 && (kept == Most || bytes > MostBytes)) break;
        ++kept;
    }
    results_.erase(results_.begin(), results_.end() - static_cast<std::ptrdiff_t>(kept));
    shown_ = results_.size() - 1;
}

void WaitingResults::show(std::size_t index) {
    if (index < results_.size()) shown_ = index;
}

void WaitingResults::set_aside() {
    back_ = shown_.value_or(0);
    shown_.reset();
}

void WaitingResults::come_back() {
    if (!shown_ && !results_.empty()) shown_ = back_;
}

void WaitingResults::reset(std::optional<PendingResult> result) {
    results_.clear();
    shown_.reset();
    back_ = 0;
    if (result) add(std::move(*result));
}

}  // namespace gse::app
