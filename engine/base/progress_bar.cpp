// Draws the progress line.
#include "engine/base/progress_bar.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace gse {
namespace {

std::string duration_text(double seconds) {
    const auto whole = static_cast<long>(seconds + 0.5);
    if (whole >= 3600) return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
    return fmt::format("{}:{:02}", whole / 60, whole % 60);
}

}  // namespace

ProgressBar::ProgressBar() : terminal_(isatty(STDERR_FILENO) == 1) {}

ProgressBar::~ProgressBar() {
    if (terminal_ && drawn_) std::fputc('\n', stderr);
}

void ProgressBar::update(std::string_view stage, int step, int total) {
    const std::lock_guard lock(mutex_);
    const auto now = Clock::now();
    const bool fresh = stage != stage_;
    if (fresh) {
        if (terminal_ && drawn_) std::fputc('\n', stderr);
        stage_ = stage;
        stage_start_ = now;
        first_step_ = step;
    }
    // A log file gets a line per stage and every ten seconds, a terminal a live bar.
    const auto interval = terminal_ ? std::chrono::milliseconds(100) : std::chrono::milliseconds(10000);
    if (!fresh && step < total && now - last_draw_ < interval) return;
    last_draw_ = now;
    drawn_ = true;
    draw(step, total, now);
}

void ProgressBar::draw(int step, int total, Clock::time_point now) {
    std::string line = stage_;
    if (total > 0) {
        const double share = std::clamp(static_cast<double>(step) / total, 0.0, 1.0);
        constexpr int width = 30;
        const int full = static_cast<int>(share * width);
        line =
            fmt::format("{:<22} [{}{}] {:3.0f} %", stage_, std::string(static_cast<std::size_t>(full), '#'),
                        std::string(static_cast<std::size_t>(width - full), '.'), share * 100);
        const double elapsed = std::chrono::duration<double>(now - stage_start_).count();
        const int done = step - first_step_;
        if (done > 0 && step < total) line += ", " + duration_text(elapsed / done * (total - step)) + " left";
    }
    // Not fmt::print: it throws when stderr takes no more, and a progress line must not end the work.
    std::fputs((terminal_ ? "\r\x1b[K" + line : line + "\n").c_str(), stderr);
    std::fflush(stderr);
}

}  // namespace gse
