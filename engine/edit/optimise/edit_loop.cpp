// The edit loop.
#include "engine/edit/optimise/edit_loop.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <new>
#include <numeric>

#include "engine/base/check.h"
#include "engine/base/clock.h"
#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/base/memory.h"
#include "engine/base/random.h"
#include "engine/edit/interfaces/stage_timer.h"
#include "engine/edit/masks/dynamic_mask.h"
#include "engine/edit/optimise/convergence.h"
#include "engine/edit/optimise/edit_base.h"
#include "engine/edit/optimise/edit_checks.h"
#include "engine/edit/optimise/edit_strength.h"
#include "engine/edit/optimise/guided_gradient.h"
#include "engine/edit/optimise/preservation_loss.h"
#include "engine/edit/optimise/view_cycle.h"
#include "engine/edit/optimise/working_set.h"
#include "engine/edit/placement/placement_volume.h"
#include "engine/edit/target_views/dataset_update.h"
#include "engine/edit/target_views/shape_round.h"
#include "engine/localize/back_projection.h"
#include "engine/localize/clusters.h"
#include "engine/raster/view_session.h"

namespace gse::edit {
namespace {

constexpr float SeenLabel = 0.5f;            // share of a pixel that the label must cover to be in a mask
constexpr std::array LooksAgain{0.5, 0.75};  // shares of the iterations after which new splats are looked for
constexpr double LeastLeft = 0.15;  // of the new splats; fewer: the model does not see the new thing yet
// Logit of Gaussians that another object replaces: they may come back (METHOD.md, Visual hull).
constexpr double FadedLogit = -6;
// A guidance that is not finite is broken for good, not only now and then, when so many steps in a row were
// left out and all that were are more than this share of the steps.
constexpr std::size_t SkippedInARow = 10;
constexpr double MostSkipped = 0.1;
// Share of the time, at most, where they come by time: those of a large scene are rarer.
constexpr double SnapshotShare = 0.1;
/// While training, colours below black get the full gradient of black (F18 names 0.01): what a large step has
/// driven to black must be able to come back. WorkingSet keeps them from going further.
constexpr float TrainingColourSlope = 1.0f;

/// True when a render of 0-or-1 values shows any row that has a 1.
bool shows_any(const Image& seen) {
    return std::any_of(seen.data.begin(), seen.data.end(), [](float value) { return value > 0; });
}

/// The label without rows that cannot be drawn. Throws Error where nothing is left to edit.
std::vector<std::uint8_t> labelled(const EditBase& base, const EditPlan& plan) {
    GSE_CHECK_EQ(plan.label.size(), base.set.size());
    auto label = base.editable(plan.label);
    if (plan.seeds.size() == 0 &&
        std::none_of(label.begin(), label.end(), [](std::uint8_t bit) { return bit != 0; }))
        throw Error(ErrorCode::InvalidArgument, "nothing is labelled, so there is nothing to edit",
                    "name something the scene shows, or lower label_threshold");
    return label;
}

/// The request with the settings of its loop; `views` may be null.
CheckedRequest for_loop(CheckedRequest request, EditMode mode, const MultiViewEditor* views) {
    static_cast<EditSettings&>(request) = loop_settings(
        request, mode, views != nullptr, views != nullptr && views->supports_appearance_editing());
    return request;
}

}  // namespace

/// Everything one run keeps between iterations.
class Optimiser::Run {
public:
    Run(const GaussianSet& base, const EditPlan& plan, const CheckedRequest& request, const EditTools& tools)
        : base_(base), plan_(plan), label_(labelled(base_, plan)),
          request_(for_loop(request, plan.mode, tools.views)), tools_(tools),
          set_(base_.drawn, label_, plan.seeds, request_, camera_extent(plan.views)),
          preservation_({request.l1, request.ssim, request.preserve}), fit_(FitWeights),
          gradient_of_guidance_(tools.guidance, request_),
          masks_(plan, request_, tools.word, tools.attention, tools.segmenter), cycle_(request.seed),
          rest_(plan.views.size(), request.early_stop_change),
          pictures_(tools.rasterizer.view_session(plan.views.size(), tools.view_bytes)),
          random_(Random::stream(request.seed, 17)) {
        GSE_CHECK_EQ(plan.masks.size(), plan.views.size());
        if (tools.start != nullptr) result_.iterations = tools.start->iteration;
        if (tools.start != nullptr) set_.resume(base_.drawn, *tools.start);
        render_originals();
        settings_.negative_colour_slope = TrainingColourSlope;
        if (tools.views == nullptr) return;
        if (round_plan(request_, plan.mode).anew && tools.attention != nullptr)
            shapes_.emplace(plan_, request_, tools.word, *tools.attention);
        phase_.emplace(plan_, request_, tools_, originals_, masks_, shapes_ ? &*shapes_ : nullptr);
    }

    std::optional<ViewTargets> draw_views() {
        GSE_CHECK(phase_);
        guarded([this] {
            prepare();
            ended_ = !phase_->has_views() && !begin_step();
        });
        return ended_ ? std::nullopt : std::optional(phase_->sheet());
    }

    EditResult fit() {
        guarded([this] {
            prepare();
            if (phase_) phase_->show_new_sheet();
            while (!ended_ && result_.iterations < request_.iterations && advance()) {}
        });
        finish();
        apply_strength(base_.set, request_.strength, result_);
        check_result();
        return std::move(result_);
    }

private:
    /// Runs a part of the edit. Where the memory runs out, what was reached is kept and the edit ends; throws
    /// OutOfMemory where nothing was reached.
    template <class Part> void guarded(Part&& part) {
        try {
            part();
        } catch (const std::bad_alloc&) {
            keep_reached(out_of_memory());
        } catch (const OutOfMemory& shortage) { keep_reached(shortage); }
    }

    /// Picks the views that the edit is seen in, once.
    void prepare() {
        if (prepared_) return;
        const auto views = visible_views();
        if (views.empty())
            throw Error(ErrorCode::InvalidArgument, "no labelled splat is visible in any view",
                        "correct the label, or choose views that show it");
        begin_with(views);
        prepared_ = true;
    }

    /// Work before a step: a corrected label, the stop request, redrawn views. Returns false to end the edit.
    bool begin_step() {
        if (begun_) return true;
        if (tools_.new_label) take_label(result_);
        result_.stopped = tools_.job.stop_requested();
        return !result_.stopped && survives([this] { redraw(result_.iterations); });
    }

    /// Tells whether the part went through. An error that ends it is noted, or thrown where nothing was
    /// reached.
    template <class Part> bool survives(Part&& part) {
        try {
            part();
            return true;
        } catch (const Error& error) {
            result_.stopped = error.code() == ErrorCode::Cancelled;
            if (result_.stopped) return false;
            if (result_.history.empty()) throw;
            result_.failure = error;
            return false;
        }
    }

    /// One iteration and what belongs to it; false when it was the last.
    bool advance() {
        EditResult& result = result_;
        const int iteration = result.iterations;
        if (!begin_step() || !iterate(iteration, result)) return false;
        result.iterations = iteration + 1;
        if (prunes_added(iteration)) prune_added(iteration, result);
        const IterationRecord& record = result.history.back();
        result.converged = request_.early_stop && !record.skipped &&
                           rest_.visit(record.view, shown_, masks_.mask(record.view));
        if (tools_.iteration) tools_.iteration(result.history.back());
        if (tools_.snapshot && snapshot_due(iteration)) take_snapshot(iteration);
        tools_.job.report("editing", iteration + 1, request_.iterations);
        if (skipped_in_a_row_ >= SkippedInARow) give_up_on_guidance(result);
        return set_.labelled() > 0 && !result.converged && !result.failure;  // else nothing is left to do
    }

    /// Too many steps were left out: says so, and leaves what was reached before them. Throws when there was
    /// nothing before.
    void give_up_on_guidance(EditResult& result) const {
        const std::size_t steps = result.history.size();
        if (static_cast<double>(result.skipped_steps) <= MostSkipped * static_cast<double>(steps)) return;
        Error failure(
            ErrorCode::Model,
            fmt::format("the guidance was not finite in {} of {} steps, the last {} of them in a row",
                        result.skipped_steps, steps, skipped_in_a_row_),
            "the model's weights are damaged, or it overflows: try another model or a lower guidance scale");
        if (result.skipped_steps == steps) throw failure;
        result.failure = std::move(failure);
    }

    /// The memory ran out: what the loop alone needs goes, so that what was reached can be put together.
    void keep_reached(const OutOfMemory& shortage) {
        if (result_.iterations == 0) throw shortage;
        ended_ = true;
        result_.shortage = shortage;
        originals_ = {};
        for (Image* image : {&shown_, &gradient_, &label_seen_}) *image = {};
    }

    /// Frees memory that only the steps need, so that the result has room.
    void end_steps() {
        work_ = pictures_->work();
        pictures_->forget();
        output_ = {};
        gradients_ = {};
        set_.end_steps();
    }

    bool snapshot_due(int iteration) const {
        if (tools_.snapshot_seconds > 0)
            return wall_seconds() - last_snapshot_ >=
                   std::max(tools_.snapshot_seconds, snapshot_cost_ * (1 / SnapshotShare - 1));
        return (iteration + 1) % request_.snapshot_every == 0;
    }

    void take_snapshot(int iteration) {
        const StageTimer timer(seconds_.snapshot);
        const double begin = wall_seconds();
        EditSnapshot snapshot = set_.snapshot(base_.set, iteration + 1);
        if (phase_) snapshot.round = phase_->state();
        tools_.snapshot(std::move(snapshot));
        last_snapshot_ = wall_seconds();
        snapshot_cost_ = last_snapshot_ - begin;
    }

    void render_originals() {
        const StageTimer timer(seconds_.originals);
        settings_ = plan_.settings;
        for (const auto& view : plan_.views) {
            tools_.rasterizer.forward(base_.drawn.spans(), view.camera, settings_, output_);
            originals_.push_back(output_.colour);
        }
    }

    /// Views in which at least one labelled row is drawn. The others cannot change anything.
    std::vector<std::size_t> visible_views() const {
        const auto values = label_values();
        std::vector<std::size_t> views;
        Image seen;
        for (std::size_t v = 0; v < plan_.views.size(); ++v) {
            tools_.rasterizer.forward_values(spans(set_.rows()), plan_.views[v].camera, settings_, values,
                                             seen);
            if (shows_any(seen)) views.push_back(v);
        }
        return views;
    }

    /// The views the edit is seen in: all are drawn, or those that are redrawn.
    void begin_with(const std::vector<std::size_t>& visible) {
        if (phase_) phase_->choose(visible);
        draw_only(phase_ ? phase_->fitted() : visible);
    }

    /// The views that were fitted to and the round before the views of an iteration were redrawn, and what
    /// the model told of them.
    struct Redrawn {
        std::vector<std::size_t> fitted_before;
        int round_before;
        std::map<std::string, double> scalars;
    };

    /// Has views redrawn where a round begins.
    void redraw(int iteration) {
        if (!phase_) return;
        Redrawn redrawn{phase_->fitted(), phase_->round(), {}};
        if (phase_->begins(iteration))
            redrawn.scalars = phase_->redraw(iteration, spans(set_.rows()), set_.unlabelled(), settings_);
        begun_ = std::move(redrawn);
    }

    /// Does what the artist says of redrawn views; a new shape grows anew from each round: what was fitted to
    /// pictures that contradict each other is of their mixed colours.
    void begin_round(IterationRecord& record) {
        const Redrawn redrawn = std::move(*begun_);
        record.guidance = redrawn.scalars;
        phase_->show_new_sheet();
        phase_->take_orders();
        if (phase_->fitted() != redrawn.fitted_before) draw_only(phase_->fitted());
        if (!shapes_ || phase_->round() == redrawn.round_before) return;
        const auto seeds =
            shapes_->seeds(phase_->found(), bounds_of(plan_.room, plan_.seeds), set_.rows().sh_degree);
        if (seeds.size() > 0) return set_.plant(seeds, phase_->hole_fill(set_.rows().sh_degree), FadedLogit);
        const std::string nothing = "the redrawn views agree on no shape of \"" + tools_.word + "\"";
        if (phase_->round() > 0)
            return log::warning("{} any more; the last round's is fitted further", nothing);
        if (plan_.seeds.size() == 0)
            throw Error(ErrorCode::Model, nothing, "try another seed, or more views (shape_views)");
        log::warning("{}; it grows from the place that was found for it", nothing);
    }

    /// From here on only these views are drawn, and have to come to rest.
    void draw_only(const std::vector<std::size_t>& views) {
        rest_ = ConvergenceDetector(plan_.views.size(), request_.early_stop_change);
        for (std::size_t v = 0; v < plan_.views.size(); ++v)
            if (std::find(views.begin(), views.end(), v) == views.end()) rest_.ignore(v);
        cycle_.begin(views);
    }

    std::vector<float> label_values() const {
        std::vector<float> values(set_.rows().size(), 0.0f);
        std::fill(values.begin() + static_cast<std::ptrdiff_t>(set_.first_row()), values.end(), 1.0f);
        return values;
    }

    /// One step, left out when the guidance is not finite; false when the guidance was stopped, with
    /// everything as before.
    bool iterate(int iteration, EditResult& result) {
        IterationRecord record;
        record.iteration = iteration;
        const bool begins = !phase_ || survives([&] { begin_round(record); });
        begun_.reset();
        if (!begins) return false;
        const std::size_t view = record.view = cycle_.next();
        {
            const StageTimer timer(seconds_.render);
            render(view);
        }
        show(shown_);
        if (masks_.due(view, iteration)) refresh_mask(view, iteration);
        {
            const StageTimer timer(seconds_.preserve);
            gradient_.resize(output_.colour.width, output_.colour.height, 3);
            std::fill(gradient_.data.begin(), gradient_.data.end(), 0.0f);
            if (phase_)  // redrawn inside the mask, the original outside: one loss for both
                record.preservation = fit_.add_gradient(output_.colour, phase_->target(view), no_mask(),
                                                        gradient_, phase_->trust(view));
            else
                record.preservation = preservation_.add_gradient(output_.colour, originals_[view],
                                                                 masks_.mask(view), gradient_);
            record.preservation_norm = norm(gradient_);
        }
        if (!phase_ && !follow_guidance(iteration, view, record)) return false;
        skipped_in_a_row_ = record.skipped ? skipped_in_a_row_ + 1 : 0;
        if (record.skipped) ++result.skipped_steps;
        else record.anchor = step(iteration);
        densify(iteration, result);
        result.history.push_back(std::move(record));
        return true;
    }

    /// The view as it is now, into output_; backward() of the session may follow.
    void render(std::size_t view) {
        pictures_->forward(view, spans(set_.rows()), set_.first_row(), plan_.views[view].camera, settings_,
                           output_);
    }

    const Mask& no_mask() {
        if (no_mask_.data.size() != output_.colour.pixel_count())
            no_mask_ = Mask(output_.colour.width, output_.colour.height);
        return no_mask_;
    }

    /// From the gradient on the picture to new rows; returns the anchors' loss.
    double step(int iteration) {
        {
            const StageTimer timer(seconds_.backward);
            pictures_->backward(gradient_, {}, gradients_);
        }
        const StageTimer timer(seconds_.optimise);
        set_.collect(gradients_);
        return set_.step(gradients_, iteration, request_);
    }

    /// Takes over a corrected label: its rows, masks from where it is seen in the base, and the views that
    /// see it. A label with which nothing would be left to edit is not taken.
    void take_label(EditResult& result) {
        auto label = tools_.new_label();
        if (!label || label->size() != label_.size()) return;
        *label = base_.editable(*label);
        if (*label == label_) return;
        std::vector<Mask> masks;
        const auto seen_in = views_of_base(*label, masks);
        if (seen_in.empty() && plan_.seeds.size() == 0)
            return log::warning("the corrected label is seen in no view of the edit and was not taken over");
        label_ = std::move(*label);
        set_.relabel(base_.drawn, label_, request_);
        pictures_->forget();
        for (std::size_t v = 0; v < masks.size(); ++v) masks_.set_static(v, std::move(masks[v]));
        ++result.label_changes;
        if (phase_) return phase_->take_masks();
        const auto now = visible_views();
        if (!now.empty() || !seen_in.empty()) draw_only(now.empty() ? seen_in : now);
    }

    /// Views in which the rows of a label are seen in the base, and where; per view.
    std::vector<std::size_t> views_of_base(const std::vector<std::uint8_t>& label, std::vector<Mask>& masks) {
        const std::vector<float> values(label.begin(), label.end());
        std::vector<std::size_t> views;
        for (std::size_t v = 0; v < plan_.views.size(); ++v) {
            const Camera& camera = plan_.views[v].camera;
            tools_.rasterizer.forward_values(base_.drawn.spans(), camera, settings_, values, label_seen_);
            if (shows_any(label_seen_)) views.push_back(v);
            Mask mask = localize::threshold_map(label_seen_, SeenLabel);
            if (plan_.seeds.size() > 0 ||
                plan_.mode == EditMode::Replace)  // what is new needs its room as before
                for (std::size_t i = 0; i < mask.data.size(); ++i) mask.data[i] |= plan_.masks[v].data[i];
            else mask = localize::dilate(mask, mask_growth(request_, plan_.mode, mask));
            masks.push_back(std::move(mask));
        }
        return views;
    }

    bool prunes_added(int iteration) const {
        if (!request_.prune_added || plan_.seeds.size() == 0 || !masks_.can_look()) return false;
        return std::any_of(LooksAgain.begin(), LooksAgain.end(), [&](double share) {
            return iteration + 1 == static_cast<int>(share * request_.iterations);
        });
    }

    /// Drops new splats outside of where the new thing is seen by now: the place was found before there was
    /// anything to see.
    void prune_added(int iteration, EditResult& result) {
        const StageTimer timer(seconds_.dynamic_mask);
        std::vector<localize::MaskedView> votes;
        Image shown;  // shown_ stays what the step has seen
        for (std::size_t v = 0; v < plan_.views.size(); ++v) {
            const Camera& camera = plan_.views[v].camera;
            render(v);
            show(shown);
            const Mask found = masks_.found_in(shown, v, iteration);
            Image share(camera.width, camera.height, 1);
            std::copy(found.data.begin(), found.data.end(), share.data.begin());
            votes.push_back({camera, std::move(share), found.count() == 0});
        }
        const auto failed =
            std::count_if(votes.begin(), votes.end(), [](const auto& vote) { return vote.failed; });
        if (2 * static_cast<std::size_t>(failed) > votes.size()) return;  // the model does not see it yet
        const auto seen = localize::back_project(spans(set_.rows()), votes, settings_, tools_.rasterizer);
        result.pruned +=
            set_.keep_added(seen.probability, seen.coverage, request_.prune_added_threshold, LeastLeft);
    }

    /// Last render as networks expect pictures: in [0,1].
    void show(Image& shown) const {
        shown.resize(output_.colour.width, output_.colour.height, 3);
        for (std::size_t i = 0; i < shown.data.size(); ++i)
            shown.data[i] = std::clamp(output_.colour.data[i], 0.0f, 1.0f);
    }

    void refresh_mask(std::size_t view, int iteration) {
        const StageTimer timer(seconds_.dynamic_mask);
        tools_.rasterizer.forward_values(spans(set_.rows()), plan_.views[view].camera, settings_,
                                         label_values(), label_seen_);
        masks_.refresh(view, iteration, shown_, label_seen_);
        render(view);  // for backward()
    }

    /// Adds the guidance's gradient; false when the guidance was stopped.
    bool follow_guidance(int iteration, std::size_t view, IterationRecord& record) {
        const StageTimer timer(seconds_.guidance);
        const GuidanceInput input{
            shown_,
            plan_.views[view],
            view,
            plan_.view_words.empty() ? std::string() : plan_.view_words[view],
            iteration,
            request_.iterations,
            Random::stream(request_.seed, 1000 + static_cast<std::uint64_t>(iteration)).next(),
            &originals_[view]};
        try {
            record.skipped =
                !gradient_of_guidance_.add(input, output_.colour, masks_.mask(view), gradient_, record);
        } catch (const Error& error) {
            if (error.code() != ErrorCode::Cancelled) throw;
            result_.stopped = true;
            return false;
        }
        return true;
    }

    void densify(int iteration, EditResult& result) {
        const int step = iteration + 1;
        if (request_.densify_every == 0 || step % request_.densify_every != 0 || step < request_.densify_from)
            return;
        const StageTimer timer(seconds_.densify);
        const bool may_grow = step <= request_.densify_until * request_.iterations;
        const auto count = set_.densify(request_, random_, may_grow);
        result.cloned += count.cloned;
        result.split += count.split;
        result.pruned += count.pruned;
    }

    void finish() {
        EditResult& result = result_;
        end_steps();
        const EditSnapshot reached = set_.snapshot(base_.set, result.iterations);
        result.set = reached.materialise();
        result.base_to_new = reached.base_to_new();
        result.label = reached.label();
        result.generation = reached.generation();
        result.hole_fill = reached.hole_fill();
        result.skipped_rows = set_.skipped_rows();
        result.guidance_scale = gradient_of_guidance_.scale();
        if (phase_) {
            result.redrawn_views = phase_->redrawn();
            if (!result.shortage && !result.stopped)
                result.kept_chroma = phase_->check_colour(result.set.spans(), settings_);
            seconds_.guidance = phase_->seconds();
        }
        result.seconds = {
            {"originals", seconds_.originals},       {"render", seconds_.render},
            {"preserve", seconds_.preserve},         {"guidance", seconds_.guidance},
            {"backward", seconds_.backward},         {"optimise", seconds_.optimise},
            {"densify", seconds_.densify},           {"snapshot", seconds_.snapshot},
            {"dynamic_mask", seconds_.dynamic_mask},
        };
        result.masks_refreshed = masks_.refreshed();
        result.continued_pictures = work_.continued;
    }

    /// Counts what must not be, and what cannot be drawn.
    void check_result() {
        result_.changed_outside_label = count_changed_outside(base_.set, label_, result_);
        GSE_CHECK_EQ(result_.changed_outside_label, std::size_t{0});
        result_.nonfinite = count_nonfinite(result_);
        const auto unusable = [](const std::vector<std::uint8_t>& usable) {
            return static_cast<std::size_t>(std::count(usable.begin(), usable.end(), std::uint8_t{0}));
        };
        result_.unusable_before = unusable(base_.usable);
        result_.unusable = unusable(usable_rows(result_.set));
        if (result_.skipped_steps > 0)
            log::warning("{} guidance steps were not finite and left out", result_.skipped_steps);
    }

    struct StageSeconds {
        double originals = 0, render = 0, preserve = 0, guidance = 0, backward = 0, optimise = 0, densify = 0,
               snapshot = 0, dynamic_mask = 0;
    };

    const EditBase base_;
    const EditPlan& plan_;
    std::vector<std::uint8_t> label_;  // what may change now
    const CheckedRequest request_;
    const EditTools tools_;
    WorkingSet set_;
    PreservationLoss preservation_, fit_;  // of steps by a gradient, and of those to redrawn views
    GuidedGradient gradient_of_guidance_;
    DynamicMasks masks_;
    std::optional<ShapeFinder> shapes_;  // of view guidance that draws a thing anew
    Mask no_mask_;
    ViewCycle cycle_;
    ConvergenceDetector rest_;
    std::unique_ptr<raster::ViewSession> pictures_;
    Random random_;
    raster::Settings settings_;
    raster::ForwardOutput output_;
    raster::Gradients gradients_;
    std::vector<Image> originals_;
    std::optional<DatasetUpdate> phase_;  // of view guidance
    Image gradient_;
    Image shown_, label_seen_;
    std::size_t skipped_in_a_row_ = 0;
    StageSeconds seconds_;
    raster::ViewSessionWork work_;
    double last_snapshot_ = wall_seconds(), snapshot_cost_ = 0;
    EditResult result_;
    std::optional<Redrawn> begun_;  // views of the next iteration, which were redrawn already
    bool prepared_ = false, ended_ = false;
};

double camera_extent(const std::vector<View>& views) {
    if (views.empty()) return 1;
    Vec3 mean;
    for (const auto& view : views) mean = mean + view.camera.centre() / static_cast<double>(views.size());
    double largest = 0;
    for (const auto& view : views) largest = std::max(largest, length(view.camera.centre() - mean));
    return largest > 0 ? 1.1 * largest : 1;
}

Optimiser::Optimiser(const GaussianSet& base, const EditPlan& plan, const CheckedRequest& request,
                     const EditTools& tools)
    : run_(std::make_unique<Run>(base, plan, request, tools)) {}

Optimiser::~Optimiser() = default;

std::optional<ViewTargets> Optimiser::draw_views() { return run_->draw_views(); }

EditResult Optimiser::fit() { return run_->fit(); }

EditResult run_edit(const GaussianSet& base, const EditPlan& plan, const CheckedRequest& request,
                    const EditTools& tools) {
    return Optimiser(base, plan, request, tools).fit();
}

}  // namespace gse::edit
