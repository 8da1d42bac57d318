// Times that a server took for its pictures, and whether the one that it draws takes much longer.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "engine/base/clock.h"

namespace gse::remote {

/// A picture is slow from this multiple of the usual time on.
inline constexpr double SlowFactor = 3;
/// Least wait that is worth a word, s.
inline constexpr double LeastSlowSeconds = 2;
/// Pictures from which on a usual time is known: the first one may load the model.
inline constexpr std::size_t LeastTimed = 2;

/// Times of one server. Thread of the one who waits.
class PictureTimes {
public:
    using Clock = std::function<double()>;  // s, never back
    explicit PictureTimes(Clock clock = wall_seconds) : clock_(std::move(clock)) {}

    void begin() { begun_ = clock_(); }
    /// The picture came.
    void end() { times_.push_back(clock_() - begun_); }
    /// Median of the earlier pictures, s, where the one that is drawn is slow; none otherwise.
    std::optional<double> usual_of_slow() const;

private:
    Clock clock_;
    std::vector<double> times_;
    double begun_ = 0;
};

}  // namespace gse::remote
