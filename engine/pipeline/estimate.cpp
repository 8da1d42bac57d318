// The parts of an edit added up.
#include "engine/pipeline/estimate.h"

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"

namespace gse::pipeline {
namespace {

constexpr double LookAgainRounds = 2;             // over all views, when something is added
constexpr double UsualFollow = 0.6;
constexpr int ProbeSteps = 5;

double words_of_search(edit::EditMode mode) { return mode == edit::EditMode::Add ? 2 : 1; }

/// Masks that could follow the edit while the loop runs.
double refreshes(const edit::EditRequest& request, int first_iteration) {
    if (!request.dynamic_mask || request.iterations <= 0) return 0;
    const double span = std::max(0.0, 1 - request.dynamic_from) * request.iterations;
    const double visits = std::min(span, static_cast<double>(request.iterations - first_iteration));
    const double every = std::max(1.0, request.dynamic_every * request.iterations);
    return std::min(visits, request.views * std::ceil(span / every));
}

/// Pictures searched to see where something added is.
double looks_again(const edit::EditRequest& request, edit::EditMode mode) {
    return mode == edit::EditMode::Add && request.look_again ? LookAgainRounds * request.views : 0;
}

/// Denoising steps of single views in the first `steps` of the loop.
double redrawn_steps(const edit::EditRequest& request, edit::EditMode mode, int steps) {
    return static_cast<double>(request.edited_views) * edit::round_plan(request, mode).view_steps_within(steps);
}

bool led_by_views(const EditJob& job) { return edit::edits_by_views(job.recipe().request, job.located().mode); }

}  // namespace

double estimated_seconds(const Measured& measured, const edit::EditRequest& request, const PlannedWork& work) {
    double seconds = 0;
    bool known = true;
    const auto add = [&](double count, double each) {
        if (count <= 0) return;
        known &= each >= 0;
        seconds += count * each;
    };
    add(work.loaded ? 0 : 1, measured.load);
    add(work.tune_steps, measured.tune_step);
    const double rounds = measured.rounds > 0 ? measured.rounds : 1;
    const double search = rounds * request.views * words_of_search(work.mode);
    add(work.located ? 0 : search, measured.question);
    add(work.shows_idea ? 1 : 0, measured.idea >= 0 ? measured.idea : 0);
    const bool by_views = edit::edits_by_views(request, work.mode);
    const int steps = std::max(0, edit::loop_steps(request, work.mode) - work.first_iteration);
    if (by_views) add(redrawn_steps(request, work.mode, steps), measured.redraw);
    else add(steps, measured.guidance);
    add(steps * static_cast<double>(work.rows) / measured.rows, measured.raster);
    const double follow = measured.follow >= 0 ? measured.follow : UsualFollow;
    add(by_views ? 0 : follow * refreshes(request, work.first_iteration) + looks_again(request, work.mode),
        measured.refresh >= 0 ? measured.refresh : measured.question);
    add(1, measured.finish >= 0 ? measured.finish : 0);
    return known ? seconds : -1;
}

void measure_search(Measured& measured, const EditJob& job, double seconds) {
    const auto asked = static_cast<double>(job.questions());
    if (asked <= 0) return;
    const double words = words_of_search(job.located().mode);
    measured.question = seconds / asked;
    measured.rounds = asked / words / job.recipe().request.views;
}

void measure_loop(Measured& measured, const EditJob& job, int least_steps) {
    const auto& result = job.result();
    const int steps = static_cast<int>(result.history.size());
    if (steps < least_steps || steps == 0) return;
    const auto seconds = [&](const char* stage) {
        const auto found = result.seconds.find(stage);
        return found == result.seconds.end() ? 0 : found->second;
    };
    const auto& request = job.recipe().request;
    const bool by_views = led_by_views(job);
    if (by_views) measured.redraw = seconds("guidance") / redrawn_steps(request, job.located().mode, steps);
    else measured.guidance = seconds("guidance") / steps;
    measured.raster = (seconds("render") + seconds("preserve") + seconds("backward") + seconds("optimise") +
                       seconds("densify") + seconds("snapshot")) / steps;
    measured.rows = static_cast<double>(std::max<std::size_t>(1, job.scene().gaussians.size()));
    if (by_views) return;
    const double could = refreshes(request, request.iterations - steps);
    if (result.masks_refreshed == 0 || could <= 0 || result.stopped) return;
    const auto refreshed = static_cast<double>(result.masks_refreshed);
    measured.follow = refreshed / could;
    measured.refresh = seconds("dynamic_mask") / (refreshed + looks_again(request, job.located().mode));
}

bool steps_measured(const Measured& measured, const EditJob& job) {
    return (led_by_views(job) ? measured.redraw : measured.guidance) >= 0;
}

void measure_steps(Measured& measured, EditJob& job) {
    try {
        job.probe(1);   // the first step of a model takes longer than the others
        job.probe(ProbeSteps);
        measure_loop(measured, job, ProbeSteps);
    } catch (const Error& error) {
        if (error.code() == ErrorCode::Cancelled) throw;   // else: the edit itself will say what is wrong
    }
}

}  // namespace gse::pipeline
