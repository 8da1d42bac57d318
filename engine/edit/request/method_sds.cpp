// The method "sds": score distillation, a gradient of the model at every step.
#include <algorithm>
#include <cmath>

#include "engine/edit/request/edit_method.h"

namespace gse::edit {
namespace {

constexpr double SearchesOfAdded = 2;  // over all views, when something is added

/// Masks that could follow the edit while the loop runs.
double refreshed_masks(const EditSettings& settings, int first_iteration) {
    if (!settings.dynamic_mask || settings.iterations <= 0) return 0;
    const double span = std::max(0.0, 1 - settings.dynamic_from) * settings.iterations;
    const double visits = std::min(span, static_cast<double>(settings.iterations - first_iteration));
    const double every = std::max(1.0, settings.dynamic_every * settings.iterations);
    return std::min(visits, settings.views * std::ceil(span / every));
}

class ScoreDistillation final : public EditMethod {
public:
    const char* name() const override { return "sds"; }
    const char* description() const override { return "pulls at every step, the paper's way"; }
    const char* leader() const override { return "the model's pull (method sds)"; }
    const char* process() const override { return "the model pulls at every step"; }
    unsigned uses() const override { return GradientField; }
    bool draws_views() const override { return false; }

    int drawn_steps(const LoopSettings& settings, EditMode) const override { return settings.iterations; }
    void set_steps(LoopSettings& settings, EditMode, int steps) const override {
        settings.iterations = std::max(1, steps);
    }
    std::string steps_help(const LoopSettings&, EditMode) const override {
        return "Optimisation steps. More = closer to the sentence, and longer.";
    }

    MethodWork drawn_work(const EditSettings& settings, const language::EditSentence&, EditMode mode,
                          int first_iteration, bool) const override {
        MethodWork left;
        left.pulls = std::max(0, settings.iterations - first_iteration);
        left.refreshed_masks = refreshed_masks(settings, first_iteration);
        if (mode == EditMode::Add && settings.prune_added)
            left.searched_views = SearchesOfAdded * settings.views;
        return left;
    }
    void run(MethodRun& run, const CheckedRequest& request) const override { run.follow_gradient(request); }
};

}  // namespace

const EditMethod& score_distillation_method() {
    static const ScoreDistillation method;
    return method;
}

}  // namespace gse::edit
