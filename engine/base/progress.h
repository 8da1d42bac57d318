// Progress reports of long work, and its stop token.
#pragma once

#include <functional>
#include <stop_token>
#include <string_view>

namespace gse {

/// Callback that receives the name of the stage, the step done and the number of steps (0 = unknown).
using ProgressCallback = std::function<void(std::string_view stage, int step, int total)>;

/// Control of a long call: a callback for reports, and a token to check every step. Both may be empty.
struct JobControl {
    ProgressCallback progress;
    std::stop_token stop;

    void report(std::string_view stage, int step, int total) const {
        if (progress) progress(stage, step, total);
    }
    bool stop_requested() const { return stop.stop_requested(); }
};

}  // namespace gse
