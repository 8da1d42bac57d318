// The parts of an edit added up.
#include "app/session/state/estimate.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/error.h"
#include "engine/edit/request/decide_mode.h"
#include "engine/edit/request/edit_method.h"
#include "engine/edit/request/unchecked_request.h"
#include "engine/edit/search/place_drawing.h"
#include "engine/edit/target_views/view_round.h"
#include "engine/edit/words/colour_word.h"
#include "engine/language/description.h"
#include "engine/pipeline/run/preview_check.h"

namespace gse::app {
namespace {

constexpr double UsualFollow = 0.6;
constexpr int ProbeSteps = 5;
constexpr double LibrariesMb = 300;  // of torch, until the first load was measured

/// Words that all views are searched for: a new thing, too, unless it is drawn.
double words_of_search(edit::EditMode mode, bool drawn) {
    return mode == edit::EditMode::Add && !drawn ? 2 : 1;
}

/// Work of the model in a whole edit by the job's method.
edit::MethodWork whole_work(const EditJob& job) {
    const auto& request = job.recipe().request;
    return edit::method_of(request).work(request, request.sentence(), job.located().mode, 0,
                                         job.place_cost().views > 0);
}

double tflop_of(const neural::NetworkUse& use) { return use.flop * 1e-12; }

/// Adds up parts; what is needed and was not measured makes the sum unknown.
class Sum {
public:
    void add(double count, double seconds, double tflop = 0) {
        if (count <= 0) return;
        known_seconds_ &= seconds >= 0;
        known_tflop_ &= tflop >= 0;
        cost_.seconds += count * seconds;
        cost_.tflop += count * tflop;
    }
    Cost cost() const { return {known_seconds_ ? cost_.seconds : -1, known_tflop_ ? cost_.tflop : -1}; }

private:
    Cost cost_{0, 0};
    bool known_seconds_ = true, known_tflop_ = true;
};

/// The pictures before the edit; until they were drawn once, from what a pass of the UNet takes.
void add_idea(Sum& sum, const CostProfile& measured) {
    if (measured.idea >= 0) return sum.add(1, measured.idea, measured.idea_tflop);
    const GateParameters gate;
    constexpr double halves = 2;  // with and without the prompt
    const double passes = gate.views * std::round(gate.steps * gate.strength) * halves;
    sum.add(passes, std::max(0.0, measured.pass), measured.pass_tflop);
}

/// Memory of a scene beside its own splats. It holds the working set, two sets put together (the newest
/// snapshot and the one that is looked at), and the snapshots. Labelled rows also have gradients, two
/// moments, anchors, colours at birth and scratch.
double scene_work_mb(const PlannedMemory& memory) {
    constexpr double sets = 1 + 2, labelled_sets = 6;
    return (sets + labelled_sets * memory.labelled_share) * memory.scene + memory.snapshots;
}

/// The pictures that show where something added goes; until they were drawn once, as views of the loop.
void add_place(Sum& sum, const CostProfile& measured, const edit::SearchSettings& search) {
    const double views = search.place_views, steps = views * edit::guided_steps_of_place(search);
    if (measured.place_step >= 0) return sum.add(steps, measured.place_step, measured.place_step_tflop);
    sum.add(views, std::max(0.0, measured.redraw_view), std::max(0.0, measured.redraw_view_tflop));
    sum.add(steps, measured.redraw, measured.redraw_tflop);
}

/// The work of a method. Rounds before the last count as the last one where they were not measured apart.
void add_method(Sum& sum, const CostProfile& measured, const edit::MethodWork& left) {
    sum.add(left.views, std::max(0.0, measured.redraw_view), std::max(0.0, measured.redraw_view_tflop));
    const bool apart = measured.redraw_early >= 0;
    sum.add(left.early_views, std::max(0.0, apart ? measured.redraw_early : measured.redraw_view),
            std::max(0.0, apart ? measured.redraw_early_tflop : measured.redraw_view_tflop));
    sum.add(left.denoising_steps, measured.redraw, measured.redraw_tflop);
    sum.add(left.pulls, measured.guidance, measured.guidance_tflop);
    const double follow = measured.follow >= 0 ? measured.follow : UsualFollow;
    sum.add(follow * left.refreshed_masks + left.searched_views,
            measured.refresh >= 0 ? measured.refresh : measured.question, measured.question_tflop);
}

}  // namespace

Cost estimated_cost(const CostProfile& measured, const edit::EditRequest& asked, const PlannedWork& work) {
    const auto& method = edit::method_of(asked);
    edit::EditSettings settings = asked;
    if (measured.supports_appearance_editing > 0 && method.draws_views())
        settings = edit::restyling(std::move(settings), work.mode);
    auto sentence = edit::unchecked_sentence(asked);
    if (method.draws_views() && work.mode != edit::EditMode::Modify)
        sentence =
            sentence.reworded(language::with_usual_colour(sentence.prompt(), new_thing(sentence, work.mode),
                                                          work.words, work.traits.usual_colours),
                              sentence.target());
    Sum sum;
    sum.add(work.loaded ? 0 : 1, measured.load);
    sum.add(work.tune_steps, measured.tune_step, measured.tune_step_tflop);
    const double rounds = measured.rounds > 0 ? measured.rounds : 1;
    const bool drawn = measured.draws_place > 0 && edit::draws_place(settings, sentence, work.mode);
    const double search = rounds * settings.views * words_of_search(work.mode, drawn);
    sum.add(work.located ? 0 : search, measured.question, measured.question_tflop);
    if (drawn && !work.located) add_place(sum, measured, settings);
    if (work.shows_idea) add_idea(sum, measured);
    const int steps = std::max(0, method.steps(settings, work.mode) - work.first_iteration);
    const double size = static_cast<double>(work.rows) / measured.rows;
    sum.add(size, std::max(0.0, measured.begin));
    add_method(sum, measured, method.work(settings, sentence, work.mode, work.first_iteration, drawn));
    sum.add(steps * size, measured.raster);
    // Before it was seen: every view drawn before and after, which is about a step of the loop.
    sum.add(1,
            measured.finish >= 0 ? measured.finish : settings.views * size * std::max(0.0, measured.raster));
    return sum.cost();
}

std::array<Cost, edit::Qualities.size()> costs_by_quality(const CostProfile& measured,
                                                          edit::EditRequest request,
                                                          const PlannedWork& work) {
    std::array<Cost, edit::Qualities.size()> costs;
    for (std::size_t i = 0; i < costs.size(); ++i) {
        request.quality = edit::Qualities[i];
        costs[i] = estimated_cost(measured, request, work);
    }
    return costs;
}

double estimated_memory_mb(const CostProfile& measured, const PlannedMemory& memory) {
    const double load = measured.load_mb >= 0 ? measured.load_mb : LibrariesMb + memory.weights;
    const double begin = memory.loaded ? memory.before_load : memory.process;
    return std::max(memory.process, begin + load + std::max(0.0, measured.work_mb) + scene_work_mb(memory));
}

void measure_memory(CostProfile& measured, const PlannedMemory& memory, double after_load, double peak) {
    measured.work_mb = std::max(measured.work_mb, std::max(0.0, peak - after_load - scene_work_mb(memory)));
}

void measure_search(CostProfile& measured, const EditJob& job, double seconds) {
    const auto asked = static_cast<double>(job.questions());
    if (asked <= 0) return;
    measured.draws_place = job.supports_scene_conditioning() ? 1 : 0;
    measured.supports_appearance_editing = job.supports_appearance_editing() ? 1 : 0;
    const auto& place = job.place_cost();
    const double words = words_of_search(job.located().mode, place.views > 0);
    auto use = job.times().networks("locate");
    const bool whole = use.cached == 0;
    if (!whole && measured.question >= 0) return;  // less was seen than it would have taken
    if (place.views > 0) {
        const double steps =
            static_cast<double>(place.views) * edit::guided_steps_of_place(job.recipe().request);
        measured.place_step = place.seconds / steps;
        measured.place_step_tflop = tflop_of(place.use) / steps;
        use = use - place.use;
        seconds = std::max(0.0, seconds - place.seconds);
    }
    measured.question = seconds / asked;
    measured.question_tflop = tflop_of(use) / asked;
    measured.rounds = asked / words / job.recipe().request.views;
    if (use.unet == 0 || !whole) return;
    measured.pass = seconds / static_cast<double>(use.unet);
    measured.pass_tflop = tflop_of(use) / static_cast<double>(use.unet);
}

namespace {

double stage_seconds(const edit::EditResult& result, const char* stage) {
    const auto found = result.seconds.find(stage);
    return found == result.seconds.end() ? 0 : found->second;
}

/// Per step, beside the model's part.
double raster_seconds(const edit::EditResult& result) {
    double sum = 0;
    for (const char* stage : {"render", "preserve", "backward", "optimise", "densify", "snapshot"})
        sum += stage_seconds(result, stage);
    return sum;
}

/// A whole run knows the sum of its parts, and keeps the proportion of what is known of them.
void measure_redrawing(CostProfile& measured, const EditJob& job) {
    const auto& result = job.result();
    const double views = static_cast<double>(result.redrawn_views);
    const auto all = whole_work(job);
    if (views <= 0 || all.pictures() <= 0) return;
    const double seconds = stage_seconds(result, "guidance") / views;  // of a picture, over all rounds
    const double steps = all.denoising_steps / all.pictures();
    if (measured.redraw < 0 || measured.redraw_view < 0) {
        measured.redraw = seconds / steps;
        measured.redraw_view = 0;
        measured.redraw_tflop = tflop_of(job.edited().use) / views / steps;
        measured.redraw_view_tflop = 0;
        return;
    }
    const double early = measured.redraw_early >= 0 ? measured.redraw_early : measured.redraw_view;
    const double expected = (all.views * measured.redraw_view + all.early_views * early) / all.pictures() +
                            steps * measured.redraw;
    if (expected <= 0) return;
    for (auto* part : {&measured.redraw, &measured.redraw_view, &measured.redraw_early})
        if (*part > 0) *part *= seconds / expected;
}

void measure_pulling(CostProfile& measured, const EditJob& job, const Edited& edited, int steps) {
    const auto& result = edited.result;
    const auto& request = job.recipe().request;
    measured.guidance = stage_seconds(result, "guidance") / steps;
    const auto refreshed = static_cast<double>(result.masks_refreshed);
    const double searched = whole_work(job).searched_views;
    const double looks = stage_seconds(result, "dynamic_mask") > 0 ? refreshed + searched : 0;
    const double masks = looks * std::max(0.0, measured.question_tflop);
    if (looks <= 0 || measured.question_tflop >= 0)
        measured.guidance_tflop = std::max(0.0, tflop_of(edited.use) - masks) / steps;
    const double could =
        edit::method_of(request)
            .work(request, request.sentence(), job.located().mode, request.iterations - steps, false)
            .refreshed_masks;
    if (refreshed <= 0 || could <= 0 || result.stopped) return;
    measured.follow = refreshed / could;
    measured.refresh = stage_seconds(result, "dynamic_mask") / (refreshed + searched);
}

}  // namespace

void measure_loop(CostProfile& measured, const EditJob& job, int least_steps) {
    const auto& result = job.result();
    const int steps = static_cast<int>(result.history.size());
    if (steps < least_steps || steps == 0) return;
    if (whole_work(job).pictures() > 0) measure_redrawing(measured, job);
    else measure_pulling(measured, job, job.edited(), steps);
    measured.raster = raster_seconds(result) / steps;
    measured.rows = static_cast<double>(std::max<std::size_t>(1, job.scene().gaussians.size()));
}

bool steps_measured(const CostProfile& measured, const EditJob& job) {
    if (whole_work(job).pictures() > 0) return measured.redraw >= 0 && measured.redraw_view >= 0;
    return measured.guidance >= 0;
}

namespace {

/// Guided steps of a first round that has so many.
double guided_steps(const EditJob& job, int view_steps) {
    auto plan = edit::round_plan(job.recipe().request, job.located().mode);
    plan.view_steps = view_steps;
    return plan.guided_steps_of(0);
}

/// Redraws with one step and with three. Tells the time of a step, and that of a view beside its steps, in
/// the last round and in others.
Edited probe_views(CostProfile& measured, EditJob& job) {
    constexpr double pixels_at_once = 8 * 64 * 64;  // as many as the model takes in one piece
    constexpr int more_steps = 3, least_outlines = 3;
    const auto plan = edit::round_plan(job.recipe().request, job.located().mode);
    const double side = job.model().image_size();
    const int views = std::clamp(static_cast<int>(pixels_at_once / (side * side)),
                                 std::min(plan.anew ? least_outlines : 1, plan.views), plan.views);
    const bool early = plan.rounds > 1;
    job.probe({1, views, 1, early});  // the first pass of a model takes longer than the others
    const Edited many = job.probe({1, views, more_steps, early});
    Edited one = job.probe({ProbeSteps, views, 1});
    const Edited first_round = early ? job.probe({1, views, 1, true}) : one;
    const auto redrawn = static_cast<double>(one.result.redrawn_views);
    if (redrawn <= 0 || many.result.redrawn_views != one.result.redrawn_views ||
        first_round.result.redrawn_views != one.result.redrawn_views)
        return one;
    const double first = guided_steps(job, 1), more = guided_steps(job, more_steps) - first;
    const auto seconds_of = [&](const Edited& edited) {
        return stage_seconds(edited.result, "guidance") / redrawn;
    };
    const auto work_of = [&](const Edited& edited) { return tflop_of(edited.use) / redrawn; };
    measured.redraw = std::max(0.0, (seconds_of(many) - seconds_of(first_round)) / more);
    measured.redraw_tflop = std::max(0.0, (work_of(many) - work_of(first_round)) / more);
    measured.redraw_view = std::max(0.0, seconds_of(one) - first * measured.redraw);
    measured.redraw_view_tflop = std::max(0.0, work_of(one) - first * measured.redraw_tflop);
    measured.redraw_early = std::max(0.0, seconds_of(first_round) - first * measured.redraw);
    measured.redraw_early_tflop = std::max(0.0, work_of(first_round) - first * measured.redraw_tflop);
    return one;
}

Edited probe_steps(CostProfile& measured, EditJob& job) {
    job.probe({1});
    Edited edited = job.probe({ProbeSteps});
    measure_pulling(measured, job, edited, static_cast<int>(edited.result.history.size()));
    return edited;
}

}  // namespace

void measure_steps(CostProfile& measured, EditJob& job) {
    try {
        const Edited edited =
            whole_work(job).pictures() > 0 ? probe_views(measured, job) : probe_steps(measured, job);
        const auto& result = edited.result;
        const double raster = raster_seconds(result);
        measured.raster = raster / std::max<std::size_t>(1, result.history.size());
        measured.begin = std::max(0.0, edited.seconds - raster - stage_seconds(result, "guidance"));
        measured.rows = static_cast<double>(std::max<std::size_t>(1, result.base_to_new.size()));
    } catch (const Error& error) {
        if (error.code() == ErrorCode::Cancelled) throw;  // else: the edit itself will say what is wrong
    }
}

}  // namespace gse::app
