// Results that wait to be applied, one of which is.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "app/session/state/pending_result.h"

namespace gse::app {

/// Outcomes of edits of one scene with different seeds or settings. One of them is shown and is the operand
/// of commands, until all are set aside for another edit.
class WaitingResults {
public:
    /// Most splats in all kept results together. The oldest are dropped beyond it.
    static constexpr std::size_t MostBytes = std::size_t{2} << 30;
    static constexpr std::size_t Most = 8;

    bool has_value() const { return shown_.has_value(); }
    explicit operator bool() const { return has_value(); }
    PendingResult& operator*() { return results_[*shown_]; }
    const PendingResult& operator*() const { return results_[*shown_]; }
    PendingResult* operator->() { return &**this; }
    const PendingResult* operator->() const { return &**this; }

    const std::vector<PendingResult>& all() const { return results_; }
    std::optional<std::size_t> shown() const { return shown_; }
    /// Tells whether the one that is shown is what the last edit came to.
    bool shows_last() const { return shown_ && *shown_ + 1 == results_.size(); }
    /// The one that is shown, or will be once the edit that it was set aside for has come to nothing; null
    /// without any.
    const PendingResult* kept() const {
        return results_.empty() ? nullptr : &results_[shown_.value_or(back_)];
    }
    /// No result has it.
    std::uint64_t next_seed() const;

    /// Behind the others; it is shown.
    void add(PendingResult result);
    /// An index that is none changes nothing.
    void show(std::size_t index);
    void set_aside();
    /// The result that was shown before it was set aside, if nothing is shown.
    void come_back();
    /// None is left, or this one alone.
    void reset(std::optional<PendingResult> result = std::nullopt);

private:
    std::vector<PendingResult> results_;
    std::optional<std::size_t> shown_;
    std::size_t back_ = 0;
};

}  // namespace gse::app
