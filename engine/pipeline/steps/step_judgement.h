// Judgement of an edit that has run: does what changed agree with its sentence, and did nothing else change.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "engine/edit/request/request.h"
#include "engine/pipeline/run/edit_job.h"

namespace gse::pipeline {

/// Measurements of an edit, pooled over views of it. Shares lie in [0,1]. The thing is what the label marks;
/// in add mode, what is new.
struct StepFigures {
    edit::EditMode mode = edit::EditMode::Modify;
    std::string thing;               // what changes, or what the new thing belongs to
    std::string news;                // what comes: a look, or a new thing
    std::optional<double> pictures;  // score of the redrawn views; none = nobody can tell
    std::optional<double> scene;     // score of renders of the result; none = nobody can tell
    std::optional<double> likeness;  // of what is drawn to a known thing, see EditQuality::likeness
    std::optional<double> look;      // EditQuality::look, in place of the scores
    double changed = 0;              // pixels of the thing that changed clearly
    double spilled = 0;              // pixels outside the masks that changed clearly
    double old_left = 0;             // replace: pixels of the old thing that mainly show splats of it
    double new_shown = 0;            // replace: pixels of the new thing, as a share of those of the old one
    double gone = 0;                 // remove: splats of the scene, without those that came
    double seen = 0;                 // add: views that show the new thing
    bool beside = false;             // add: the sentence puts it to a side of the thing
    double on_thing = 0;             // add: pixels of the new thing that showed the thing before
    std::size_t added = 0;           // new splats
    std::size_t changed_rows = 0;    // splats outside the label that changed
};

/// Verdict on an edit.
struct StepJudgement {
    StepFigures figures;
    std::string reason;  // one sentence on what failed; empty = nothing did
    std::string remedy;  // what to try
    bool passed() const { return reason.empty(); }
};

/// Measures a job whose run() has ended, with the job's own painter: not beside another call of the job. No
/// network is asked but the image-text encoder.
StepFigures measure_step(EditJob& job);

/// Verdict that follows from figures alone. The first thing that failed is the reason.
StepJudgement judge_step(StepFigures figures);

/// Verdict on a job whose run() has ended.
StepJudgement judge_step(EditJob& job);

/// JSON {"passed", "reason", "remedy", figures}; reason and remedy only where it failed.
nlohmann::ordered_json judgement_to_json(const StepJudgement& judgement);

}  // namespace gse::pipeline
