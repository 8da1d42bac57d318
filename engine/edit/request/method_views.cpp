// The method "views": the model redraws some views, and the rows are fitted to them.
#include <fmt/format.h>

#include <algorithm>

#include "engine/edit/request/edit_method.h"
#include "engine/edit/words/colour_word.h"
#include "engine/language/description.h"

namespace gse::edit {
namespace {

/// Tells whether one view is drawn before all others, for the colour of a new thing that the sentence leaves
/// open.
bool draws_key_view(const RoundPlan& plan, const language::EditSentence& sentence, EditMode mode,
                    bool drawn) {
    if (drawn || !plan.anew) return false;
    const auto& thing = new_thing(sentence, mode);
    return !thing.empty() && !language::is_described(sentence.prompt(), thing);
}

class RedrawnViews final : public EditMethod {
public:
    const char* name() const override { return "views"; }
    const char* description() const override { return "redraws some views, the scene is fitted to them"; }
    const char* leader() const override { return "redrawn views"; }
    const char* process() const override { return "views are redrawn and fitted to"; }
    unsigned uses() const override { return RedrawnViewField; }
    bool draws_views() const override { return true; }

    int drawn_steps(const LoopSettings& settings, EditMode mode) const override {
        const auto plan = round_plan(settings, mode);
        return plan.rounds * plan.fit_steps;
    }
    void set_steps(LoopSettings& settings, EditMode mode, int steps) const override {
        const auto plan = round_plan(settings, mode);
        (plan.anew ? settings.shape_fit_steps : settings.fit_steps) =
            std::max(1, (steps + plan.rounds - 1) / plan.rounds);
    }
    std::string steps_help(const LoopSettings& settings, EditMode mode) const override {
        const auto plan = round_plan(settings, mode);
        return fmt::format(
            "Steps of fitting to the redrawn views: {} round{} of {}. Rounds and views are under \"All "
            "settings\".",
            plan.rounds, plan.rounds == 1 ? "" : "s", plan.fit_steps);
    }

    /// A round that was begun is not begun again.
    MethodWork drawn_work(const EditSettings& settings, const language::EditSentence& sentence, EditMode mode,
                          int first_iteration, bool drawn) const override {
        const auto plan = round_plan(settings, mode);
        MethodWork left;
        const auto draw = [&](int round, double views) {
            (round + 1 < plan.rounds ? left.early_views : left.views) += views;
            left.denoising_steps += views * plan.guided_steps_of(round);
        };
        if (first_iteration == 0 && draws_key_view(plan, sentence, mode, drawn)) draw(0, 1);
        for (int round = (first_iteration + plan.fit_steps - 1) / plan.fit_steps; round < plan.rounds;
             ++round)
            draw(round, plan.views);
        return left;
    }
    void run(MethodRun& run, const CheckedRequest& request) const override { run.fit_redrawn_views(request); }
};

}  // namespace

const EditMethod& redrawn_views_method() {
    static const RedrawnViews method;
    return method;
}

}  // namespace gse::edit
