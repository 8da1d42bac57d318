// How long an edit will take, from what its parts took on this machine.
#pragma once

#include <cstddef>

#include "engine/base/fields.h"
#include "engine/pipeline/edit_job.h"

namespace gse::pipeline {

/// Seconds that parts of the work took with one model and one size of pictures; negative = not measured yet.
struct Measured {
    double load = -1;        // reading the model
    double question = -1;    // one picture searched for one word
    double rounds = -1;      // how often all views were searched: moving in on what was found means once more
    double idea = -1;        // the pictures before the edit
    double guidance = -1;    // the model's part of a step
    double redraw = -1;      // one denoising step of one redrawn view, with its share of encoding and decoding
    double raster = -1;      // the rest of a step, for `rows` splats
    double rows = 1;
    double refresh = -1;     // one mask that follows the edit
    double follow = -1;      // how many of the masks that could have followed did: a view is only looked at when its turn comes
    double finish = -1;      // checking and packing the result
    double tune_step = -1;   // learning the scene

    template <class Self, class F>
    static void visit_fields(Self& self, F&& f) {
        f("load", self.load, "Reading the model.", Range{-1, 1e6});
        f("question", self.question, "One picture searched for one word.", Range{-1, 1e6});
        f("rounds", self.rounds, "How often all views were searched.", Range{-1, 100});
        f("idea", self.idea, "The pictures before the edit.", Range{-1, 1e6});
        f("guidance", self.guidance, "The model's part of a step.", Range{-1, 1e6});
        f("redraw", self.redraw, "One denoising step of one redrawn view.", Range{-1, 1e6});
        f("raster", self.raster, "The rest of a step.", Range{-1, 1e6});
        f("rows", self.rows, "Splats of the scene that was measured.", Range{1, 1e12});
        f("refresh", self.refresh, "One mask that follows the edit.", Range{-1, 1e6});
        f("follow", self.follow, "Share of the masks that could have followed and did.", Range{-1, 10});
        f("finish", self.finish, "Checking and packing the result.", Range{-1, 1e6});
        f("tune_step", self.tune_step, "One step of learning the scene.", Range{-1, 1e6});
    }
};

/// What decides about an edit's time besides its request.
struct PlannedWork {
    bool loaded = false;           // the model is in memory
    bool located = false;          // the search is done
    edit::EditMode mode = edit::EditMode::Modify;
    bool shows_idea = true;
    int tune_steps = 0;
    std::size_t rows = 1;
    int first_iteration = 0;
};

/// Seconds until the result is there; negative = a part that is needed has not been measured.
double estimated_seconds(const Measured& measured, const edit::EditRequest& request, const PlannedWork& work);

/// What a finished search tells; `seconds` of the whole search.
void measure_search(Measured& measured, const EditJob& job, double seconds);
/// What a run of the loop tells; nothing when it was shorter than that.
void measure_loop(Measured& measured, const EditJob& job, int least_steps);
/// Whether the steps of the job's loop were measured, by the method it is led by.
bool steps_measured(const Measured& measured, const EditJob& job);
/// Runs a few steps of the loop for their time, the result is dropped; nothing where the loop cannot run.
void measure_steps(Measured& measured, EditJob& job);

}  // namespace gse::pipeline
