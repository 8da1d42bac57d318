// Puts guidance, masks and loop together.
#include "engine/pipeline/run/loop.h"
#include "engine/edit/search/make_plan.h"

#include <utility>

#include "engine/base/content_hash.h"
#include "engine/base/log.h"
#include "engine/edit/request/edit_method.h"
#include "engine/language/vocabulary.h"
#include "engine/language/words.h"
#include "engine/pipeline/models/neural_loader.h"
#include "engine/pipeline/models/recipe_model.h"
#include "engine/pipeline/models/segmenters.h"
#include "engine/pipeline/run/rearranged_scene.h"
#include "engine/pipeline/run/view_candidate.h"

namespace gse::pipeline {
namespace {

/// Words that the dynamic mask looks for in the changing pictures: the new object, or the changing one by its
/// new name.
std::string dynamic_word(const Located& located, const language::EditSentence& sentence) {
    const auto& result = located.result;
    const bool keeps_name =
        result.mode == edit::EditMode::Modify && sentence.sentence().contains(result.word);
    return keeps_name ? result.word : new_thing(sentence, result.mode);
}

}  // namespace

neural::SdsParameters with_sentence_before(neural::SdsParameters guidance,
                                           const language::EditSentence& sentence) {
    if (guidance.before_prompt.empty()) guidance.before_prompt = sentence.before();
    return guidance;
}

std::string told_to_editor(const edit::CheckedRequest& request) {
    return language::normalised_prompt(edit::instruction_of(request));
}

edit::CheckedRequest told_to_model(const neural::TextToImage& model, const edit::CheckedRequest& request) {
    const bool unknown =
        !request.part_of().empty() && !language::vocabulary_contains(model.known_words(), request.source());
    return unknown ? request.in_look_of_whole() : request;
}

edit::EditPlan plan_of(RunContext& context, const Located& located, const CheckedRecipe& recipe) {
    const auto* label = located.by_label() ? &located.label : nullptr;
    auto plan = edit::make_plan(question(context, recipe, located.views, label), located.result,
                                context.painter().rasterizer());
    // A thing that is drawn anew needs to know its sides; where none was said, its front is where the views
    // begin.
    plan.azimuths = located.views.azimuths;
    if (plan.mode == edit::EditMode::Replace && plan.view_words.empty()) {
        plan.azimuths = azimuths_around(located.views);
        plan.view_words = words_around(located.views, recipe.request.sided_view_words);
    }
    if (!plan.azimuths.empty()) plan.elevations = elevations_above(located.views);
    return plan;
}

Edited edit_scene(RunContext& context, const Located& located, const edit::EditPlan& plan,
                  const CheckedRecipe& recipe, const EditObserver& observer, const JobControl& control) {
    return edit_scene(context, context.scene().gaussians, located, plan, recipe, observer, control);
}

edit::EditTools tools_of(const SceneEdit& scene_edit, const language::EditSentence& sentence,
                         edit::AttentionSource& attention, edit::Segmenter& segmenter) {
    const auto& [context, scene, located, plan, recipe, observer, control] = scene_edit;
    edit::EditTools tools{context.painter().rasterizer(), nullptr, observer.snapshot, control,
                          observer.iteration};
    tools.snapshot_seconds = observer.snapshot_seconds;
    tools.new_label = observer.new_label;
    tools.start = observer.start ? &*observer.start : nullptr;
    // Attention does not follow an object that the words did not find.
    const bool lost = located.by_label() && located.result.mode == edit::EditMode::Modify;
    tools.attention = lost ? nullptr : &attention;
    tools.segmenter = &segmenter;
    tools.word = dynamic_word(located, sentence);
    return tools;
}

Edited finished(const SceneEdit& scene_edit, const edit::LoopSettings& settings, edit::EditResult result) {
    Edited edited;
    edited.result = std::move(result);
    edited.drawn = drawable(edited.result.set);
    ContentHash hash;
    hash.text(scene_edit.located.key);
    hash.fields(settings);
    hash.fields(scene_edit.recipe.guidance);
    if (const auto* server = scene_edit.context.server()) hash.text(server->key());
    edited.key = hash.key().hex();
    return edited;
}

namespace {

/// Draws the first views by one strategy after the other and fits the scene to those that are chosen.
Edited fit_to_drawn_views(const SceneEdit& scene_edit) {
    const auto ground = plain_ground_under(scene_edit);
    StrategyChooser chooser(draw_strategies(scene_edit, ground));
    for (;;) {
        ViewCandidate candidate(scene_edit, chooser.strategy(), ground,
                                chooser.several() ? &chooser.drawn() : nullptr);
        candidate.draw();
        if (const auto& failure = candidate.failure()) {
            if (!chooser.skips()) throw Error(*failure);
            log::info("the first views are of no use ({}): they are drawn another way", failure->what());
            continue;
        }
        const auto& sheet = candidate.sheet();
        if (!sheet) return candidate.fit();  // it was stopped
        const auto quality = chooser.quality() ? *chooser.quality() : candidate.judge();
        if (!chooser.accepts(quality)) {
            log::info("the first views hardly show \"{}\" (score {:.2f}); they are drawn another way",
                      scene_edit.recipe.request.prompt(),
                      quality.score.value_or(quality.likeness.value_or(0)));
            continue;
        }
        if (quality.warns) log::warning("{}", quality.verdict);
        if (scene_edit.observer.judged) scene_edit.observer.judged(quality, *sheet);
        auto edited = candidate.fit();
        edited.verdict = quality;
        return edited;
    }
}

/// A server draws at its own size, and the scene is fitted at that.
Edited fit_to_views(const SceneEdit& scene_edit) {
    const auto& [context, scene, located, plan, recipe, observer, control] = scene_edit;
    if (context.server() == nullptr) return fit_to_drawn_views(scene_edit);
    const auto larger = plan_at_side(plan, context.server()->side());
    return fit_to_drawn_views({context, scene, located, larger, recipe, observer, control});
}

/// Follows the model's gradient.
Edited follow_gradient(const SceneEdit& scene_edit) {
    const auto& [context, scene, located, plan, recipe, observer, control] = scene_edit;
    const auto& model = context.model();
    const auto request = told_to_model(model, recipe.request);
    const auto prompt = model.kind() == neural::BundleKind::InstructPix2Pix ? told_to_editor(request)
                                                                            : request.sentence().prompt();
    const auto guidance = model.guidance(prompt, with_sentence_before(recipe.guidance, request.sentence()));
    const auto attention = uncached(model).attention(recipe.attention);
    auto tools = tools_of(scene_edit, request.sentence(), *attention, uncached(context.segmenter()));
    tools.guidance = guidance.get();
    return finished(scene_edit, request, edit::run_edit(scene, plan, request, tools));
}

/// Runs an edit as its method asks.
class SceneMethodRun final : public edit::MethodRun {
public:
    explicit SceneMethodRun(const SceneEdit& scene_edit) : scene_edit_(scene_edit) {}
    void fit_redrawn_views(const edit::CheckedRequest& request) override {
        edited_ = run(request, fit_to_views);
    }
    void follow_gradient(const edit::CheckedRequest& request) override {
        edited_ = run(request, pipeline::follow_gradient);
    }
    Edited take() { return std::move(edited_); }

private:
    template <class Lead> Edited run(const edit::CheckedRequest& request, Lead&& lead) const {
        CheckedRecipe recipe = scene_edit_.recipe;
        recipe.request = request;
        return lead({scene_edit_.context, scene_edit_.scene, scene_edit_.located, scene_edit_.plan, recipe,
                     scene_edit_.observer, scene_edit_.control});
    }

    const SceneEdit& scene_edit_;
    Edited edited_;
};

}  // namespace

Edited edit_scene(RunContext& context, const GaussianSet& scene, const Located& located,
                  const edit::EditPlan& plan, const CheckedRecipe& recipe, const EditObserver& observer,
                  const JobControl& control) {
    const auto use_before = network_use();
    const SceneEdit scene_edit{context, scene, located, plan, recipe, observer, control};
    if (!edit::is_drawn(plan.mode)) return rearranged_scene(scene_edit);
    SceneMethodRun run(scene_edit);
    edit::method_of(recipe.request).run(run, recipe.request);
    Edited edited = run.take();
    edited.use = network_use() - use_before;
    return edited;
}

}  // namespace gse::pipeline
