// Loads, looks, measures.
#include "app/session/state/cost_profile.h"

#include <algorithm>
#include <utility>

#include "engine/base/error.h"
#include "engine/pipeline/models/model_settings.h"
#include "engine/pipeline/models/neural_loader.h"

namespace gse::app {
namespace {

/// Measures the load of a model that was needed for more than the cache holds.
void measure_load(MeasuredRun& run) {
    const auto load = run.model ? load_of(*run.model) : std::nullopt;
    if (!load) return;
    run.loaded = *load;
    run.measured.load = load->seconds;
    if (run.first_load) run.measured.load_mb = load->after_mb - load->before_mb;
}

}  // namespace

std::shared_ptr<MeasuredRun> begin_run(std::shared_ptr<neural::TextToImage> model, bool fits,
                                       const ModelLoad& load, const PlannedMemory& memory,
                                       std::shared_ptr<ArrivingViews> arriving) {
    const auto run = std::make_shared<MeasuredRun>();
    run->first_load = model == nullptr;
    run->memory = memory;
    run->arriving = std::move(arriving);
    if (fits) run->model = std::move(model);
    if (run->model) run->loaded = load;
    return run;
}

void load_model(MeasuredRun& run, const JobParameters& job, const std::shared_ptr<DiskCache>& cache,
                const JobControl& control) {
    control.report("loading the model", 0, 0);
    if (run.model) use_threads(job);
    else run.model = open_recipe_model(job, cache);
    run.segmenters = open_segmenters(job, cache);  // after the model: its failure is not the model's
}

void connect_to_server(MeasuredRun& run, const EditRecipe& recipe, const std::shared_ptr<DiskCache>& cache,
                       const JobControl& control) {
    if (!recipe.server.used()) return;
    control.report(asking_text(recipe.server), 0, 0);
    run.server = open_view_server(recipe.server, cache, control);
    ServerNews news{recipe.server, run.server->agreement(), run.server->facts().model, {}};
    run.server->watch([road = run.road, news](const remote::DrawingNews& drawing) {
        auto one = news;
        one.drawing = drawing;
        road->push(std::move(one));
    });
}

void measure_peak(MeasuredRun& run, const PeakMemory& peak) {
    measure_load(run);
    if (run.loaded.after_mb >= 0) measure_memory(run.measured, run.memory, run.loaded.after_mb, peak.mb());
}

void look(MeasuredRun& run) {
    if (run.arriving)
        run.job->watch_views([views = run.arriving](const auto&... seen) { views->add(seen...); });
    run.job->locate();
    run.job->watch_views({});
    const auto& times = run.job->times();
    if (!run.job->found_by_differences())  // which took the server's time
        measure_search(run.measured, *run.job, times.seconds("locate"));
    const double tuning = times.seconds("dreambooth");
    if (tuning > 0 && times.networks("dreambooth").flop > 0) {
        const double steps = std::max(1, run.job->recipe().dreambooth.steps);
        run.measured.tune_step = tuning / steps;
        run.measured.tune_step_tflop = times.networks("dreambooth").flop * 1e-12 / steps;
    }
    run.attention = splat_attention(*run.job);
}

void take_known_parts(CostProfile& measured, const CostProfile& known) {
    measured.redraw = known.redraw, measured.redraw_view = known.redraw_view,
    measured.redraw_early = known.redraw_early;
    measured.question = known.question, measured.question_tflop = known.question_tflop;
}

void throw_what_ended(const edit::EditResult& result) {
    const char* kept = "; what the edit had reached can be applied";
    if (const auto& shortage = result.shortage)
        throw Error(ErrorCode::Foreign, shortage->message() + kept, shortage->hint());
    if (const auto& failure = result.failure)
        throw Error(failure->code(), failure->message() + kept, failure->hint());
}

}  // namespace gse::app
