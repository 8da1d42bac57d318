// Times the pictures of a turn with a renderer that is warm.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "engine/base/clock.h"

namespace gse::bench {

/// Timer of turns, one per renderer. The first picture of every view grows buffers and touches memory for the
/// first time. A whole turn is therefore drawn before anything is timed, else the first setting would look
/// dearer than the others. Before the turns of other settings one picture is enough.
class TurnTimer {
public:
    /// Wall milliseconds of draw(0) to draw(views - 1), ascending.
    template <class Draw> std::vector<double> time(std::size_t views, const Draw& draw) {
        for (std::size_t view = warm_ ? views - 1 : 0; view < views; ++view) draw(view);
        warm_ = true;
        std::vector<double> times;
        for (std::size_t view = 0; view < views; ++view) {
            const double start = wall_seconds();
            draw(view);
            times.push_back(1e3 * (wall_seconds() - start));
        }
        std::sort(times.begin(), times.end());
        return times;
    }

private:
    bool warm_ = false;
};

}  // namespace gse::bench
