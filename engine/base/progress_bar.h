// A line on stderr that shows stage, share done and time left; plain lines when stderr is no terminal.
#pragma once

#include <chrono>
#include <mutex>
#include <string>
#include <string_view>

namespace gse {

class ProgressBar {
public:
    ProgressBar();
    ~ProgressBar();
    /// Thread-safe; draws at most ten times a second.
    void update(std::string_view stage, int step, int total);

private:
    using Clock = std::chrono::steady_clock;
    void draw(int step, int total, Clock::time_point now);

    std::mutex mutex_;
    bool terminal_;
    std::string stage_;
    Clock::time_point stage_start_{};
    Clock::time_point last_draw_{};
    int first_step_ = 0;
    bool drawn_ = false;
};

}  // namespace gse
