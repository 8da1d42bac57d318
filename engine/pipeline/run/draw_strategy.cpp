// Which strategies suit an edit, and in which order.
#include "engine/pipeline/run/draw_strategy.h"

#include <algorithm>
#include <utility>

#include "engine/edit/placement/head.h"
#include "engine/edit/target_views/strategies/default_ground_colour.h"

namespace gse::pipeline {
namespace {

using Ground = DrawStrategy::Ground;

constexpr double LeastCosine = -1;

}  // namespace

const char* DrawStrategy::name() const {
    switch (ground) {
        case Ground::Plain: return "plain ground";
        case Ground::DefaultColour: return "default ground colour";
        case Ground::Scene: break;
    }
    return "scene";
}

std::optional<edit::GroundUnder> plain_ground_under(const SceneEdit& scene_edit) {
    const auto& [context, scene, located, plan, recipe, observer, control] = scene_edit;
    if (context.server() != nullptr) return std::nullopt;  // such models know any ground
    if (!recipe.guidance.plain_ground || recipe.request.whole_scene()) return std::nullopt;
    const auto& request = recipe.request;
    if (edit::replaces_accessory(request.sentence(), plan.mode)) {
        context.look_for_ground(located.views.views);
        const auto below = context.ground(request.prompt());
        return below ? std::optional<edit::GroundUnder>({*below, true}) : std::nullopt;
    }
    const bool adds = plan.mode == edit::EditMode::Add;
    if (adds && request.source() == request.target()) return std::nullopt;  // to all of the scene
    const auto& bits = adds ? *located.result.source_label.bits : plan.label;
    return edit::ground_under(request.prompt(), scene, bits, located.views.orbit.up, located.views.front,
                              context.painter().rasterizer(), context.traits());
}

/// Order of ways to draw. A network that is shown the scene draws well if the scene looks like its training
/// pictures, and may do nearly the opposite otherwise. An object that stands in nothing is drawn on a plain
/// ground at first. A ground cannot be shown without the scene: its default colour comes last.
std::vector<DrawStrategy> draw_strategies(const SceneEdit& scene_edit,
                                          const std::optional<edit::GroundUnder>& ground) {
    if (scene_edit.context.server() != nullptr) return {{false, Ground::Scene}};
    const auto& model = scene_edit.context.model();
    const auto& recipe = scene_edit.recipe;
    const auto mode = scene_edit.plan.mode;
    const bool restyle = recipe.guidance.restyle;
    const bool in_nothing = ground && ground->in_nothing;
    const bool keeps_shapes =
        mode == edit::EditMode::Modify && restyle && model.supports_appearance_editing();
    const bool draws_anew = model.supports_scene_conditioning() &&
                            (mode == edit::EditMode::Replace || (mode == edit::EditMode::Add && in_nothing));
    std::vector<DrawStrategy> strategies{{restyle, Ground::Scene}};
    if (ground && (keeps_shapes || draws_anew))
        strategies.insert(in_nothing ? strategies.begin() : strategies.end(), {restyle, Ground::Plain});
    if (draws_anew && in_nothing) strategies.resize(1);
    if (!keeps_shapes) return strategies;
    if (edit::default_ground_colour(recipe.request.sentence(), mode, scene_edit.context.traits()))
        strategies.push_back({restyle, Ground::DefaultColour});
    else strategies.push_back({false, Ground::Scene});  // the model itself
    return strategies;
}

edit::EditedViews CachedViews::edit(const std::vector<edit::EditView>& views,
                                    const edit::EditViewsRequest& request, const JobControl& job) {
    const auto answers = [&](const CachedPictures& drawn) {
        return drawn.views == views.size() && drawn.request.round == request.round &&
               drawn.request.seed == request.seed && drawn.request.strength == request.strength &&
               drawn.request.sentence == request.sentence;
    };
    if (const auto found = std::find_if(drawn_.begin(), drawn_.end(), answers); found != drawn_.end())
        return found->pictures;
    auto pictures = editor_.edit(views, request, job);
    if (request.round == 0) drawn_.push_back({request, views.size(), pictures});
    return pictures;
}

StrategyChooser::StrategyChooser(std::vector<DrawStrategy> strategies) : best_score_(2 * LeastCosine) {
    for (const auto& strategy : strategies) tried_.push_back({strategy});
}

bool StrategyChooser::accept() {
    decided_ = true;
    return true;
}

void StrategyChooser::go_back() {
    decided_ = true;
    at_ = best_;
}

bool StrategyChooser::accepts(const EditQuality& quality) {
    tried_[at_].quality = quality;
    if (decided_) return true;
    if (!quality.score && quality.likeness) {
        // A likeness tells lumps from things, but hardly which strategy is better: the last one is used.
        if (!quality.is_poor() || is_last()) return accept();
        best_score_ = *quality.likeness, best_ = at_++;  // should the next one draw nothing at all
        return false;
    }
    if (!several() || !quality.score || (!quality.is_poor() && *quality.score >= best_score_))
        return accept();
    if (*quality.score > best_score_) best_score_ = *quality.score, best_ = at_;
    if (!is_last()) {
        ++at_;
        return false;
    }
    const auto last = at_;
    go_back();
    return at_ == last;
}

bool StrategyChooser::skips() {
    if (decided_) return false;
    if (!is_last()) {
        ++at_;
        return true;
    }
    if (best_score_ < LeastCosine) return false;
    go_back();
    return true;
}

}  // namespace gse::pipeline
