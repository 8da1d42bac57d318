// State of a background job, for whoever shows it.
#pragma once

#include <string>

namespace gse {

struct JobStatus {
    bool running = false, paused = false, can_pause = false;
    std::string title;        // "Edit: a red bear", "Turntable turn.mp4"
    std::string stage;        // "render", "attention", ...
    std::string outcome;      // empty while it runs; then "done", "stopped", "failed"
    std::string error;        // one sentence, with what to do; empty = none
    int step = 0, total = 0;  // of the stage; total 0 = unknown
    double seconds = 0;       // without pauses
    double eta_seconds = -1;  // of the stage; negative = unknown
};

}  // namespace gse
