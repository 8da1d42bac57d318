// A run beside a window: the model it works with, what it found, and what it took, for the next estimate.
#pragma once

#include <memory>
#include <vector>

#include "app/engine_names.h"
#include "app/session/state/arriving_views.h"
#include "app/session/state/estimate.h"
#include "app/session/state/server_news.h"
#include "engine/base/process_memory.h"
#include "engine/pipeline/run/edit_job.h"

namespace gse::app {

/// Results of a run for the thread that began it.
struct MeasuredRun {
    std::shared_ptr<EditJob> job;
    std::shared_ptr<neural::TextToImage> model;
    std::vector<float> attention;  // per splat, see splat_attention()
    CostProfile measured;
    ModelLoad loaded;
    bool first_load = false;  // in this process: the libraries come with it
    PlannedMemory memory;
    neural::NetworkUse use;
    Segmenters segmenters;
    std::shared_ptr<ViewServer> server;       // that draws the views; null = the model does
    std::shared_ptr<ArrivingViews> arriving;  // is told of the views while they are looked from
    std::shared_ptr<ServerRoad> road;         // is told of what the server draws
};

/// `model`: the one in memory, if any; `fits`: it is the one that is wanted.
std::shared_ptr<MeasuredRun> begin_run(std::shared_ptr<neural::TextToImage> model, bool fits,
                                       const ModelLoad& load, const PlannedMemory& memory,
                                       std::shared_ptr<ArrivingViews> arriving);

/// Model and segmenters of the recipe, where they are not in memory.
void load_model(MeasuredRun& run, const JobParameters& job, const std::shared_ptr<DiskCache>& cache,
                const JobControl& control);

/// Connects to the image server that the recipe names and asks what it is. Throws Error.
void connect_to_server(MeasuredRun& run, const EditRecipe& recipe, const std::shared_ptr<DiskCache>& cache,
                       const JobControl& control);

/// Locates, and measures what that took.
void look(MeasuredRun& run);

/// The most memory that the job has taken beside model and scene.
void measure_peak(MeasuredRun& run, const PeakMemory& peak);

/// Parts of what a run can only tell the sum of.
void take_known_parts(CostProfile& measured, const CostProfile& known);

/// Throws the Error that ended an edit before its last step, if something went wrong.
void throw_what_ended(const edit::EditResult& result);

}  // namespace gse::app
