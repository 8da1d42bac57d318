// The editors of a strategy, one upon the other.
#include "engine/pipeline/run/view_candidate.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "engine/base/log.h"
#include "engine/edit/placement/head.h"
#include "engine/edit/target_views/strategies/default_ground_colour.h"
#include "engine/edit/target_views/strategies/look_correction.h"
#include "engine/edit/target_views/strategies/whole_thing.h"
#include "engine/edit/words/colour_word.h"
#include "engine/language/description.h"
#include "engine/language/vocabulary.h"
#include "engine/language/words.h"
#include "engine/pipeline/models/recipe_model.h"
#include "engine/pipeline/models/segmenters.h"
#include "engine/pipeline/run/search.h"

namespace gse::pipeline {
namespace {

/// A sheet takes the place of the one of its round.
void keep(std::vector<edit::ViewTargets>& rounds, const edit::ViewTargets& sheet) {
    const auto found = std::find_if(rounds.begin(), rounds.end(),
                                    [&](const auto& round) { return round.round == sheet.round; });
    if (found == rounds.end()) rounds.push_back(sheet);
    else *found = sheet;
}

edit::BeforePlain shown_before(const edit::EditPlan& plan, const CheckedRecipe& recipe) {
    return plan.mode == edit::EditMode::Add || edit::replaces_accessory(recipe.request.sentence(), plan.mode)
               ? edit::BeforePlain::Scene
               : edit::BeforePlain::Nothing;
}

/// Judges remapped views in the colour that the model was told, which its encoder knows. There is nothing to
/// say of a thing that only gets another colour.
EditQuality judge_undyed(const neural::TextToImage& model, const edit::CheckedRequest& request,
                         edit::EditMode mode, const edit::ColourRemap& remap, const edit::DyedViews* views) {
    if (mode == edit::EditMode::Modify || views == nullptr) return {};
    std::vector<PicturePair> pictures;
    for (const auto& view : views->drawn()) pictures.emplace_back(&view.original, &view.undyed);
    const auto told = request.sentence().reworded(edit::told_with(remap, request.prompt()),
                                                  edit::told_with(remap, request.target()));
    return judge(model, told, told.prompt(), pictures);
}

/// Share of the way to a ground's colour from which on pictures show that ground, by judgement.
constexpr double InItsColour = 0.6;

/// Judges by the encoder; a ground that it has no word for, by the colour that such a ground has.
EditQuality judge_drawn(const neural::TextToImage& model, const language::EditSentence& sentence,
                        edit::EditMode mode, const edit::ViewTargets& round,
                        const edit::ModelTraits& traits) {
    auto verdict = judge_targets(model, sentence, round);
    const auto look = edit::default_ground_colour(sentence, mode, traits);
    if (!look) return verdict;
    const double gone = edit::gone_towards(*look, round);
    if (!verdict.score) verdict.likeness = gone;
    if (verdict.warns && gone >= InItsColour) {
        verdict.warns = false;
        verdict.verdict = fmt::format(
            "The pictures show the colour of {}, which the model's encoder hardly sees (score {:.2f}).",
            sentence.target(), *verdict.score);
    }
    return verdict;
}

/// Judges by the look itself, where the encoder does not know such scenes.
EditQuality judge_look(const std::string& word, double share) {
    EditQuality verdict;
    verdict.look = share;
    verdict.warns = share < LeastLook;
    verdict.verdict = fmt::format(
        "{:.0f} % of the redrawn thing looks {}. The model's encoder does not know "
        "such scenes and is not asked.",
        100 * share, word);
    return verdict;
}

/// Gives what comes in a thing's place or is added its usual colour where the sentence tells none.
edit::CheckedRequest in_usual_colour(const neural::TextToImage& model, edit::CheckedRequest request,
                                     edit::EditMode mode, const edit::ModelTraits& traits) {
    if (mode == edit::EditMode::Modify) return request;
    const auto known = model.known_words();
    const auto &thing = new_thing(request.sentence(), mode), &told = request.sentence().prompt();
    const auto usual = language::with_usual_colour(
        told, thing,
        language::promptable_vocabulary(known, edit::with_dyes(model.generated_vocabulary(), known)),
        traits.usual_colours);
    if (usual == told) return request;
    log::info("the sentence names no colour for \"{}\": it is drawn as \"{}\"", thing, usual);
    return request.reworded(usual, request.target());
}

}  // namespace

GaussianSet PatternLayer::over(const GaussianSet& set, std::vector<std::uint8_t> rows,
                               const std::vector<std::uint8_t>& hole_fill) const {
    for (std::size_t row = 0; row < rows.size(); ++row) rows[row] &= hole_fill[row] == 0 ? 1 : 0;
    return edit::dye_rows(remap, {edit::standing_alone(set, rows, up, front), up, front}, rows, set, seed);
}

edit::SnapshotCallback PatternLayer::over(edit::SnapshotCallback snapshots) const {
    if (!snapshots) return snapshots;
    const auto finish = [layer = *this](const edit::EditSnapshot& snapshot, const GaussianSet& set) {
        return layer.over(set, snapshot.label(), snapshot.hole_fill());
    };
    return [finish, next = std::move(snapshots)](edit::EditSnapshot snapshot) {
        snapshot.finish = finish;
        next(std::move(snapshot));
    };
}

ViewCandidate::ViewCandidate(const SceneEdit& scene_edit, const DrawStrategy& strategy,
                             const std::optional<edit::GroundUnder>& ground,
                             std::vector<CachedPictures>* drawn)
    : scene_edit_(scene_edit), request_(scene_edit.recipe.request) {
    const auto& [context, scene, located, plan, recipe, observer, control] = scene_edit;
    const auto& model = context.model();
    const auto* server = context.server();  // it is told any word
    if (server == nullptr) request_ = told_to_model(model, request_);
    if (server == nullptr && model.kind() != neural::BundleKind::InstructPix2Pix) {
        request_ = in_usual_colour(model, std::move(request_), plan.mode, context.traits());
        remap_ =
            edit::dye_of(request_.sentence(), plan.mode,
                         language::promptable_vocabulary(model.known_words(), model.generated_vocabulary()));
    }
    if (remap_ && remap_->pattern)
        pattern_ = PatternLayer{*remap_, located.views.orbit.up, located.views.front, request_.seed};
    settings_ = with_sentence_before(recipe.guidance, request_.sentence());
    settings_.restyle = strategy.restyle;
    add_editors(strategy, ground, drawn);
    attention_ = uncached(model).attention(recipe.attention);  // every render is another question
    auto tools = tools_of(scene_edit, request_.sentence(), *attention_, context.segmenter());
    if (pattern_) tools.snapshot = pattern_->over(tools.snapshot);
    tools.views = editors_.back().get();
    if (server == nullptr) tools.known = model.known_words();
    tools.redraw_key = model.name() + tuning_key(recipe.plain()) + fields_to_json(settings_).dump() +
                       strategy.name() + (remap_ ? language::joined(remap_->words) : "") +
                       (server != nullptr ? server->key() : "");
    tools.targets = [this](const edit::ViewTargets& sheet) { show(sheet); };
    tools.target_orders = observer.target_orders;
    optimiser_ = std::make_unique<edit::Optimiser>(scene, plan, request_, tools);
}

template <class Editor, class... Parts> Editor& ViewCandidate::add(Parts&&... parts) {
    auto editor = std::make_unique<Editor>(std::forward<Parts>(parts)...);
    auto& added = *editor;
    editors_.push_back(std::move(editor));
    return added;
}

void ViewCandidate::add_editors(const DrawStrategy& strategy, const std::optional<edit::GroundUnder>& ground,
                                std::vector<CachedPictures>* drawn) {
    const auto& recipe = scene_edit_.recipe;
    const auto& plan = scene_edit_.plan;
    const auto& model = scene_edit_.context.model();
    if (auto* server = scene_edit_.context.server()) {
        editors_.push_back(server->editor(request_, plan.mode, recipe.guidance.negative_prompt));
        if (drawn != nullptr) add<CachedViews>(*editors_.back(), *drawn);
        return;
    }
    if (strategy.ground == DrawStrategy::Ground::DefaultColour) {
        add<edit::DefaultGroundColour>(
            *edit::default_ground_colour(recipe.request.sentence(), plan.mode, scene_edit_.context.traits()));
    } else {
        const bool instructed = model.kind() == neural::BundleKind::InstructPix2Pix;
        const auto prompt = instructed ? told_to_editor(request_) : request_.sentence().prompt();
        editors_.push_back(model.views(remap_ ? edit::told_with(*remap_, prompt) : prompt, settings_));
        if (remap_) remapped_ = &add<edit::DyedViews>(*editors_.back(), *remap_);
    }
    const auto& located = scene_edit_.located;
    if (!located.within.empty() && request_.part_of().empty())  // the model is told the thing itself
        add<edit::WholeThing>(*editors_.back(), scene_edit_.context.painter().rasterizer(),
                              scene_edit_.context.drawn(), located.within, plan.settings);
    if (strategy.ground == DrawStrategy::Ground::Plain && ground)
        add<edit::OnPlainGround>(*editors_.back(), ground->plain, shown_before(plan, recipe));
    if (const auto look = look_asked(); look && strategy.ground != DrawStrategy::Ground::DefaultColour)
        corrected_ = &add<edit::LookCorrection>(*editors_.back(), *look);
    if (drawn != nullptr) add<CachedViews>(*editors_.back(), *drawn);
}

std::optional<edit::Look> ViewCandidate::look_asked() const {
    const auto& [context, scene, located, plan, recipe, observer, control] = scene_edit_;
    const auto look =
        plan.mode == edit::EditMode::Modify && !remap_ ? edit::look_named(request_.target()) : std::nullopt;
    // On things like those that it learned from the model knows better.
    return look && !edit::encoder_knows(finding_of(context, located), context.recognition()) ? look
                                                                                             : std::nullopt;
}

void ViewCandidate::draw() {
    try {
        sheet_ = optimiser_->draw_views();
    } catch (const Error& error) {
        if (error.code() != ErrorCode::Model) throw;
        failure_ = error;
    }
}

EditQuality ViewCandidate::judge() const {
    const auto& model = scene_edit_.context.model();
    const auto mode = scene_edit_.plan.mode;
    if (corrected_ != nullptr && corrected_->share())
        return judge_look(request_.target(), *corrected_->share());
    return remap_ ? judge_undyed(model, request_, mode, *remap_, remapped_)
                  : judge_drawn(model, request_.sentence(), mode, *sheet_, scene_edit_.context.traits());
}

void ViewCandidate::show(const edit::ViewTargets& sheet) {
    keep(sheets_, sheet);
    if (scene_edit_.observer.targets) scene_edit_.observer.targets(sheet);
}

Edited ViewCandidate::fit() {
    auto result = optimiser_->fit();
    if (pattern_) result.set = pattern_->over(result.set, result.label, result.hole_fill);
    auto edited = finished(scene_edit_, request_, std::move(result));
    edited.targets = std::move(sheets_);
    return edited;
}

}  // namespace gse::pipeline
