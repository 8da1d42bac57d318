// Estimates of an edit, from the costs of its parts on this machine.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "app/engine_names.h"
#include "engine/base/fields.h"
#include "engine/pipeline/run/edit_job.h"

namespace gse::app {

/// Costs of parts of the work with one model and one size of pictures; negative = not measured yet. Seconds,
/// and 10^12 operations of the networks if the name says so.
struct CostProfile {
    double load = -1, load_mb = -1;
    double work_mb = -1;
    double question = -1, question_tflop = -1;
    double rounds = -1;
    double pass = -1, pass_tflop = -1;
    double draws_place = -1;
    double supports_appearance_editing = -1;
    double place_step = -1, place_step_tflop = -1;
    double idea = -1, idea_tflop = -1;
    double begin = -1;
    double guidance = -1, guidance_tflop = -1;
    double redraw = -1, redraw_tflop = -1;
    double redraw_view = -1, redraw_view_tflop = -1;
    double redraw_early = -1, redraw_early_tflop = -1;
    double raster = -1;
    double rows = 1;
    double refresh = -1;
    double follow = -1;
    double finish = -1;
    double tune_step = -1, tune_step_tflop = -1;

    template <class Self, class F> static void visit_fields(Self& self, F&& f) {
        constexpr Range any{-1, 1e9};
        f("load", self.load, "Reading the model.", any);
        f("load_mb", self.load_mb, "Memory that the loaded model takes.", any);
        f("work_mb", self.work_mb, "Memory that a search or an edit takes beside the model and the scene.",
          any);
        f("question", self.question, "One picture searched for one word.", any);
        f("question_tflop", self.question_tflop, "Operations of one picture searched for one word, 10^12.",
          any);
        f("rounds", self.rounds,
          "How often all views were searched: moving in on what was found means once more.", any);
        f("pass", self.pass, "One pass of the UNet over one picture, in a search.", any);
        f("pass_tflop", self.pass_tflop, "Operations of one pass of the UNet in a search, 10^12.", any);
        f("draws_place", self.draws_place,
          "1 where the model draws what is added to see where it goes, 0 where it does not.", any);
        f("restyles", self.supports_appearance_editing,
          "1 where the model gives things another look by a network that is shown them, 0 where it does not.",
          any);
        f("place_step", self.place_step,
          "One guided denoising step of a view drawn for the place of an addition, with its share of "
          "encoding "
          "and decoding.",
          any);
        f("place_step_tflop", self.place_step_tflop,
          "Operations of one denoising step of a view drawn for the place, 10^12.", any);
        f("idea", self.idea, "The pictures before the edit.", any);
        f("idea_tflop", self.idea_tflop, "Operations of the pictures before the edit, 10^12.", any);
        f("begin", self.begin, "Work of the loop before its first step.", any);
        f("guidance", self.guidance, "The model's part of a step.", any);
        f("guidance_tflop", self.guidance_tflop, "Operations of the model's part of a step, 10^12.", any);
        f("redraw", self.redraw, "One guided denoising step of one redrawn view.", any);
        f("redraw_tflop", self.redraw_tflop, "Operations of one denoising step of a redrawn view, 10^12.",
          any);
        f("redraw_view", self.redraw_view, "One redrawn view beside its steps: encoding and decoding.", any);
        f("redraw_view_tflop", self.redraw_view_tflop,
          "Operations of one redrawn view beside its steps, 10^12.", any);
        f("redraw_early", self.redraw_early,
          "One redrawn view in a round that is not the last: a tiny autoencoder does for it.", any);
        f("redraw_early_tflop", self.redraw_early_tflop,
          "Operations of one redrawn view in an early round, 10^12.", any);
        f("raster", self.raster, "The rest of a step.", any);
        f("rows", self.rows, "Splats of the scene that was measured.", Range{1, 1e12});
        f("refresh", self.refresh, "One mask that follows the edit.", any);
        f("follow", self.follow,
          "Share of the masks that could have followed and did: a view is only looked at when its turn "
          "comes.",
          any);
        f("finish", self.finish, "Checking and packing the result.", any);
        f("tune_step", self.tune_step, "One step of learning the scene.", any);
        f("tune_step_tflop", self.tune_step_tflop,
          "Operations of one step of learning, 10^12, without gradients.", any);
    }
};

/// Facts that decide an edit's cost, besides its request.
struct PlannedWork {
    bool loaded = false;   // the model is in memory
    bool located = false;  // the search is done
    edit::EditMode mode = edit::EditMode::Modify;
    std::vector<std::string> words = {};  // that the model draws; a thing that comes has its usual colour
                                          // where they name it. Empty: any word
    edit::ModelTraits traits = {};
    bool shows_idea = true;
    int tune_steps = 0;
    std::size_t rows = 1;
    int first_iteration = 0;
};

/// An edit and the facts that decide its cost.
struct PlannedEdit {
    edit::EditRequest request;
    PlannedWork work = {};
    bool made = true;  // false: it cannot be done, and costs nothing
};

/// Part of edits that an image server does.
struct ServerCost {
    int pictures = 0;     // that it draws, further attempts apart; 0 = none
    double seconds = -1;  // that they take; negative = it has not drawn any yet
};

/// Until the result is there; negative = a part that is needed has not been measured.
struct Cost {
    double seconds = -1;
    double tflop = -1;  // of the networks' forward passes
};
Cost estimated_cost(const CostProfile& measured, const edit::EditRequest& request, const PlannedWork& work);

/// Estimates for every quality, in the order of edit::Qualities.
std::array<Cost, edit::Qualities.size()> costs_by_quality(const CostProfile& measured,
                                                          edit::EditRequest request, const PlannedWork& work);

/// Facts that decide an edit's memory, in MB.
struct PlannedMemory {
    double process = 0;         // of this process now
    bool loaded = false;        // with the model in it,
    double before_load = 0;     // and as it was before that
    double weights = 0;         // of the model's files: says what loading takes until it was measured
    double scene = 0;           // of the splats
    double labelled_share = 0;  // of them
    double snapshots = 0;       // those that are kept, at most
};
/// The most that the process will hold.
double estimated_memory_mb(const CostProfile& measured, const PlannedMemory& memory);
/// Measures memory by a job with such a peak. `after_load` is of the process before it began, with the model
/// in it.
void measure_memory(CostProfile& measured, const PlannedMemory& memory, double after_load, double peak);

/// Measures costs by a finished search. `seconds` is the time of the whole search.
void measure_search(CostProfile& measured, const EditJob& job, double seconds);
/// Measures costs by a run of the loop; nothing when it was too short. If views led it, `measured` may hold
/// known costs of its parts.
void measure_loop(CostProfile& measured, const EditJob& job, int least_steps);
/// Tells whether the steps of the job's loop were measured, by the method it is led by.
bool steps_measured(const CostProfile& measured, const EditJob& job);
/// Runs a few steps of the loop, or redraws a few views, for their time; the result is dropped. Nothing where
/// the loop cannot run.
void measure_steps(CostProfile& measured, EditJob& job);

}  // namespace gse::app
