// Puts guidance, masks and loop together.
#include "engine/pipeline/run/loop.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "engine/base/content_hash.h"
#include "engine/base/log.h"
#include "engine/edit/placement/head.h"
#include "engine/edit/request/colour_word.h"
#include "engine/edit/request/instruction.h"
#include "engine/edit/request/vocabulary.h"
#include "engine/edit/target_views/strategies/colour_remap.h"
#include "engine/edit/target_views/strategies/default_ground_colour.h"
#include "engine/edit/target_views/strategies/studio_background.h"
#include "engine/pipeline/models/neural_loader.h"
#include "engine/pipeline/models/recipe_model.h"
#include "engine/pipeline/models/segmenters.h"

namespace gse::pipeline {
namespace {

/// What the dynamic mask looks for in the changing pictures: the new thing, or the thing that changes by its
/// new name.
std::string dynamic_word(const Located& located, const edit::EditRequest& request) {
    const auto& result = located.result;
    const bool keeps_name =
        result.mode == edit::EditMode::Modify && edit::has_word(request.prompt, result.word);
    return keeps_name ? result.word : new_thing(request, result.mode);
}

/// A sheet takes the place of the one of its round.
void keep(std::vector<edit::ViewTargets>& rounds, const edit::ViewTargets& sheet) {
    const auto found = std::find_if(rounds.begin(), rounds.end(),
                                    [&](const auto& round) { return round.round == sheet.round; });
    if (found == rounds.end()) rounds.push_back(sheet);
    else *found = sheet;
}

/// One way to have the views drawn.
struct Way {
    bool restyle = false;       // SdsParameters::restyle
    bool plain_ground = false;  // the model is not shown the scene
    bool usual_look = false;    // it is not asked at all
};

/// A network that is shown the scene draws well where that looks as in the pictures it was trained on, and
/// may do nearly the opposite where it does not: a photographed wooden statue became blue for "a golden
/// statue" (score -0.12), and for "a red cat" a green bush (-0.18). As if they stood alone on a plain ground
/// it drew them golden (0.38) and as a cat with a face (0.29). Of 72 supports_appearance_editing of the suite
/// (seeds 1 to 4) none scored below 0.30. So where the first views hardly show what was asked, the next way
/// is tried, and the best of all is used. What stands in nothing is drawn so at first: a man cut out of his
/// surroundings became a green bear with a face (0.45; without it a dark lump, 0.26), and a golden figure
/// (0.51; 0.30, no figure), and the wings that he got were wings (0.51; 0.05). A ground cannot be shown
/// without the scene: it gets the colour that such a ground has. (A dark scan's became blue for "on the
/// snow", 0.01, and red for "on the sand", 0.11; drawn by the model itself it was purple in half the views;
/// in its colour 0.09 and 0.43.)
std::vector<Way> ways_to_draw(const neural::TextToImage& model, edit::EditMode mode, const EditRecipe& recipe,
                              const std::optional<edit::GroundUnder>& ground) {
    const auto& guidance = recipe.guidance;
    std::vector<Way> ways{{guidance.restyle, false}};
    if (!edit::edits_by_views(recipe.request)) return ways;
    const bool supports_appearance_editing =
        mode == edit::EditMode::Modify && guidance.restyle && model.supports_appearance_editing();
    const bool draws_anew =
        model.supports_scene_conditioning() &&
        (mode == edit::EditMode::Replace || (mode == edit::EditMode::Add && ground && ground->in_nothing));
    if (ground && (supports_appearance_editing || draws_anew))
        ways.insert(ground->in_nothing ? ways.begin() : ways.end(), {guidance.restyle, true});
    if (draws_anew && ground && ground->in_nothing) ways.resize(1);
    if (!supports_appearance_editing) return ways;
    if (edit::usual_look(recipe.request, mode)) ways.push_back({guidance.restyle, false, true});
    else ways.push_back({false, false});  // the model itself
    return ways;
}

/// A plain ground under what changes, or under what something is added to; none where it stands on nothing,
/// or is not asked for.
std::optional<edit::GroundUnder> ground_under(RunContext& workplace, const GaussianSet& scene,
                                              const Located& located, const edit::EditPlan& plan,
                                              const EditRecipe& recipe) {
    if (!recipe.guidance.plain_ground || !edit::edits_by_views(recipe.request)) return std::nullopt;
    if (edit::replaces_accessory(recipe.request, plan.mode)) {
        const auto below = workplace.ground(recipe.request.prompt, located.views.views);
        return below ? std::optional<edit::GroundUnder>({*below, true}) : std::nullopt;
    }
    const bool adds = plan.mode == edit::EditMode::Add;
    if (adds && recipe.request.source == recipe.request.target) return std::nullopt;  // to all of the scene
    const auto& bits = adds ? *located.result.source_label.bits : plan.label;
    return edit::ground_under(recipe.request.prompt, scene, bits, located.views.orbit.up, located.views.front,
                              workplace.painter().rasterizer());
}

edit::BeforePlain shown_before(const edit::EditPlan& plan, const EditRecipe& recipe) {
    return plan.mode == edit::EditMode::Add || edit::replaces_accessory(recipe.request, plan.mode)
               ? edit::BeforePlain::Scene
               : edit::BeforePlain::Nothing;
}

/// What a way has drawn.
struct Answer {
    edit::EditViewsRequest input;
    std::size_t views = 0;
    edit::EditedViews targets;
    bool answers(const edit::EditViewsRequest& asked, std::size_t count) const {
        return views == count && input.round == asked.round && input.seed == asked.seed &&
               input.strength == asked.strength && input.sentence == asked.sentence;
    }
};

/// Keeps what a way draws before anything is fitted: where it is the best after all, the same is not drawn
/// again.
class Kept final : public edit::MultiViewEditor {
public:
    Kept(edit::MultiViewEditor& guidance, std::vector<Answer>& answers)
        : guidance_(guidance), answers_(answers) {}
    edit::EditedViews edit(const std::vector<edit::EditView>& views, const edit::EditViewsRequest& input,
                           const JobControl& job) override {
        for (const auto& answer : answers_)
            if (answer.answers(input, views.size())) return answer.targets;
        auto targets = guidance_.edit(views, input, job);
        if (input.round == 0) answers_.push_back({input, views.size(), targets});
        return targets;
    }
    bool supports_appearance_editing() const override { return guidance_.supports_appearance_editing(); }

private:
    edit::MultiViewEditor& guidance_;
    std::vector<Answer>& answers_;
};

/// The ways in turn, and then the best of them.
class Attempts {
public:
    explicit Attempts(std::vector<Way> ways) : ways_(std::move(ways)), answers_(ways_.size()) {}
    const Way& way() const { return ways_[at_]; }
    std::vector<Answer>& answers() { return answers_[at_]; }
    bool several() const { return ways_.size() > 1; }
    /// Whether these pictures are not to be used, or not yet.
    bool goes_on(const EditQuality& verdict) {
        if (!verdict.score && verdict.likeness) {  // it finds lumps, but says little of which way is the
                                                   // better one: the last is used
            decided_ |= !verdict.is_poor() || at_ + 1 == ways_.size();
            if (decided_) return false;
            best_score_ = *verdict.likeness, best_ = at_++;  // should the next one draw nothing at all
            return true;
        }
        const auto score = verdict.score;
        if (ways_.size() == 1 || !score || (!verdict.is_poor() && *score >= best_score_)) decided_ = true;
        if (decided_) return false;
        if (*score > best_score_) best_score_ = *score, best_ = at_;
        if (at_ + 1 < ways_.size()) {
            ++at_;
            return true;
        }
        const auto last = at_;
        decide();
        return at_ != last;
    }
    /// The model could not draw them at all; false where no way is left.
    bool fails() {
        if (decided_) return false;
        if (at_ + 1 < ways_.size()) {
            ++at_;
            return true;
        }
        if (best_score_ < LeastCosine) return false;
        decide();
        return true;
    }

private:
    static constexpr double LeastCosine = -1;
    void decide() {
        decided_ = true;
        at_ = best_;
    }

    std::vector<Way> ways_;
    std::vector<std::vector<Answer>> answers_;  // of each way
    std::size_t at_ = 0, best_ = 0;
    double best_score_ = 2 * LeastCosine;  // of the ways that were tried
    bool decided_ = false;
};

/// Of what was dyed, in the colour that the model was told, which its encoder knows. Of a thing that only
/// gets another colour there is nothing to say.
EditQuality judge_undyed(const neural::TextToImage& model, const edit::EditRequest& request,
                         edit::EditMode mode, const edit::ColourRemap& dye, const edit::DyedViews& views) {
    if (mode == edit::EditMode::Modify) return {};
    std::vector<PicturePair> pictures;
    for (const auto& view : views.drawn()) pictures.emplace_back(&view.original, &view.undyed);
    auto told = request;
    for (auto* words : {&told.prompt, &told.target}) *words = edit::told_with(dye, *words);
    return judge(model, told, edit::as_told(told.prompt), pictures);
}

/// Of the way to the colour of a ground: that much is no picture of something else. By judgement; drawn for a
/// dark scan it was -0.73 to -0.05.
constexpr double InItsColour = 0.6;

/// By the encoder; of a ground that it has no word for, by the colour that such a ground has.
EditQuality judge_drawn(const neural::TextToImage& model, const edit::EditRequest& request,
                        edit::EditMode mode, const edit::ViewTargets& round) {
    auto verdict = judge_targets(model, request, edit::as_told(request.prompt), round);
    const auto look = edit::usual_look(request, mode);
    if (!look) return verdict;
    const double gone = edit::gone_towards(*look, round);
    if (!verdict.score) verdict.likeness = gone;
    if (verdict.warns && gone >= InItsColour) {
        verdict.warns = false;
        verdict.verdict = fmt::format(
            "The pictures show the colour of {}, which the model's encoder hardly sees (score {:.2f}).",
            request.target, *verdict.score);
    }
    return verdict;
}

/// What comes in a thing's place or is added, in its usual colour where the sentence tells none: before a
/// dark nothing most of the wings that the first view showed was black, and all views drew black ones.
edit::EditRequest in_usual_colour(const neural::TextToImage& model, edit::EditRequest request,
                                  edit::EditMode mode) {
    if (mode == edit::EditMode::Modify) return request;
    const auto known = model.known_words();
    const auto thing = new_thing(request, mode), told = edit::as_told(request.prompt);
    const auto usual = edit::with_usual_colour(
        told, thing, edit::promptable_vocabulary(known, edit::with_dyes(model.drawn_words(), known)));
    if (usual == told) return request;
    log::info("the sentence names no colour for \"{}\": it is drawn as \"{}\"", thing, usual);
    request.prompt = usual;
    return request;
}

/// Lays a dye's pattern over what is labelled, but for the ground that an old thing hid.
struct PatternLayer {
    edit::ColourRemap dye;
    Vec3 up, front;
    std::uint64_t seed;

    GaussianSet over(const GaussianSet& set, std::vector<std::uint8_t> rows,
                     const std::vector<std::uint8_t>& hidden) const {
        for (std::size_t row = 0; row < rows.size(); ++row) rows[row] &= hidden[row] == 0 ? 1 : 0;
        return edit::dye_rows(dye, {edit::standing_alone(set, rows, up, front), up, front}, rows, set, seed);
    }
    /// Hands on states of the edit which show it.
    edit::SnapshotCallback over(edit::SnapshotCallback snapshots) const {
        if (!snapshots) return snapshots;
        const auto finish = [layer = *this](const edit::EditSnapshot& snapshot, const GaussianSet& set) {
            return layer.over(set, snapshot.label(), snapshot.hidden());
        };
        return [finish, next = std::move(snapshots)](edit::EditSnapshot snapshot) {
            snapshot.finish = finish;
            next(std::move(snapshot));
        };
    }
};

/// Ends an attempt before anything was fitted.
struct AnotherWay {};

}  // namespace

neural::SdsParameters with_sentence_before(neural::SdsParameters guidance, const edit::EditRequest& request) {
    if (guidance.before_prompt.empty()) guidance.before_prompt = edit::sentence_before(request);
    return guidance;
}

std::string new_thing(const edit::EditRequest& request, edit::EditMode mode) {
    const auto thing = mode == edit::EditMode::Replace ? edit::thing_in_place(request) : std::string();
    return thing.empty() ? request.target : thing;
}

std::string told_to_editor(const edit::EditRequest& request) {
    return edit::as_told(edit::instruction_of(request));
}

edit::EditPlan plan_of(RunContext& workplace, const Located& located, const EditRecipe& recipe) {
    const auto* label = located.by_label() ? &located.label : nullptr;
    auto plan = edit::make_plan(question(workplace, recipe, located.views, label), located.result,
                                workplace.painter().rasterizer());
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

Edited edit_scene(RunContext& workplace, const Located& located, const edit::EditPlan& plan,
                  const EditRecipe& recipe, const EditObserver& observer, const JobControl& control) {
    return edit_scene(workplace, workplace.scene().gaussians, located, plan, recipe, observer, control);
}

namespace {

Edited run_attempt(RunContext& workplace, const GaussianSet& scene, const Located& located,
                   const edit::EditPlan& plan, const EditRecipe& recipe,
                   const std::optional<edit::GroundUnder>& ground, Attempts& attempts,
                   const EditObserver& observer, const JobControl& control) {
    const Way way = attempts.way();
    const auto& model = workplace.model();
    const bool editor = model.kind() == neural::BundleKind::InstructPix2Pix;
    const bool by_views = edit::edits_by_views(recipe.request);
    const auto request =
        by_views && !editor ? in_usual_colour(model, recipe.request, plan.mode) : recipe.request;
    const auto dye = by_views && !editor
                         ? edit::dye_of(request, plan.mode,
                                        edit::promptable_vocabulary(model.known_words(), model.drawn_words()))
                         : std::nullopt;
    const auto prompt = editor ? told_to_editor(request) : edit::as_told(request.prompt);
    auto settings = with_sentence_before(recipe.guidance, request);
    settings.restyle = way.restyle;
    const auto guidance = by_views ? nullptr : model.guidance(prompt, settings);
    const auto drawn =
        by_views ? model.views(dye ? edit::told_with(*dye, prompt) : prompt, settings) : nullptr;
    std::optional<edit::DyedViews> dyed;
    if (dye) dyed.emplace(*drawn, *dye);
    std::optional<edit::DefaultGroundColour> look;
    if (way.usual_look) look.emplace(*edit::usual_look(recipe.request, plan.mode));
    edit::MultiViewEditor* const views = look   ? &*look
                                         : dyed ? static_cast<edit::MultiViewEditor*>(&*dyed)
                                                : drawn.get();
    std::optional<PatternLayer> pattern;
    if (dye && dye->pattern)
        pattern = PatternLayer{*dye, located.views.orbit.up, located.views.front, request.seed};
    edit::EditTools tools{workplace.painter().rasterizer(), guidance.get(),
                          pattern ? pattern->over(observer.snapshot) : observer.snapshot, control,
                          observer.iteration};
    tools.snapshot_seconds = observer.snapshot_seconds;
    tools.new_label = observer.new_label;
    tools.start = observer.start ? &*observer.start : nullptr;
    const auto attention = uncached(model).attention(recipe.attention);  // every render is another question
    // What the words did not find, their attention does not follow either.
    const bool lost = located.by_label() && located.result.mode == edit::EditMode::Modify;
    tools.attention = lost ? nullptr : attention.get();
    tools.segmenter = by_views ? &workplace.segmenter() : &uncached(workplace.segmenter());
    tools.word = dynamic_word(located, request);
    std::optional<edit::OnPlainGround> on_ground;
    if (way.plain_ground && ground && views)
        on_ground.emplace(*views, ground->plain, shown_before(plan, recipe));
    tools.views = on_ground ? &*on_ground : views;
    std::optional<Kept> kept;
    if (attempts.several() && views) tools.views = &kept.emplace(*tools.views, attempts.answers());
    tools.known = model.known_words();
    tools.redraw_key = model.name() + tuning_key(recipe) + fields_to_json(settings).dump() +
                       (on_ground ? "plain ground"
                        : look    ? "usual look"
                                  : "") +
                       (dye ? edit::joined(dye->words) : "");
    Edited edited;
    tools.targets = [&](const edit::ViewTargets& sheet) {
        if (!edited.verdict) {
            const auto verdict = dyed ? judge_undyed(model, request, plan.mode, *dye, *dyed)
                                      : judge_drawn(model, request, plan.mode, sheet);
            if (attempts.goes_on(verdict)) {
                log::info("the first views hardly show \"{}\" (score {:.2f}); they are drawn another way",
                          request.prompt, verdict.score.value_or(verdict.likeness.value_or(0)));
                throw AnotherWay{};
            }
            if (verdict.warns) log::warning("{}", verdict.verdict);
            edited.verdict = verdict;
            if (observer.judged) observer.judged(*edited.verdict, sheet);
        }
        keep(edited.targets, sheet);
        if (observer.targets) observer.targets(sheet);
    };
    tools.target_orders = observer.target_orders;
    edited.result = edit::run_edit(scene, plan, request, tools);
    if (pattern)
        edited.result.set = pattern->over(edited.result.set, edited.result.label, edited.result.hidden);
    edited.drawn = drawable(edited.result.set);
    ContentHash hash;
    hash.text(located.key);
    hash.fields(static_cast<const edit::LoopSettings&>(request));
    hash.fields(recipe.guidance);
    edited.key = hash.key().hex();
    return edited;
}

}  // namespace

Edited edit_scene(RunContext& workplace, const GaussianSet& scene, const Located& located,
                  const edit::EditPlan& plan, const EditRecipe& recipe, const EditObserver& observer,
                  const JobControl& control) {
    const auto use_before = network_use();
    const auto ground = ground_under(workplace, scene, located, plan, recipe);
    auto ways = ways_to_draw(workplace.model(), plan.mode, recipe, ground);
    Attempts attempts(std::move(ways));
    for (;;) {
        try {
            auto edited =
                run_attempt(workplace, scene, located, plan, recipe, ground, attempts, observer, control);
            edited.use = network_use() - use_before;
            return edited;
        } catch (const AnotherWay&) {  // the next one is set
        } catch (const Error& error) {
            if (error.code() != ErrorCode::Model || !attempts.fails()) throw;
            log::info("the first views are of no use ({}): they are drawn another way", error.what());
        }
    }
}

}  // namespace gse::pipeline
