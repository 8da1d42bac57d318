// Lists of rows that go, stay and come, put together as the result of an edit.
#include "engine/pipeline/run/rearranged_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/check.h"
#include "engine/base/clock.h"
#include "engine/base/content_hash.h"
#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/edit/placement/rearrangement.h"
#include "engine/heal/carried_shade.h"
#include "engine/heal/heal.h"
#include "engine/language/grammar.h"
#include "engine/localize/clusters.h"
#include "engine/pipeline/scene/label_names.h"
#include "engine/pipeline/scene/placed_shadow.h"
#include "engine/scene/delta.h"
#include "engine/scene/transform/joined_sets.h"
#include "engine/scene/transform/transformed.h"

namespace gse::pipeline {
namespace {

using Bits = std::vector<std::uint8_t>;

constexpr float TouchedShare = 0.02f;  // of a pixel that changed rows make up: less is not seen

/// Rows of a result in the making: those that go, those that come.
struct RowChange {
    Bits gone;                             // [N]
    GaussianSet changed;                   // [N] the scene, with rows that moved
    Bits moved;                            // [N] rows of the thing that stay its rows
    GaussianData healing;                  // rows that fill a hole
    std::vector<GaussianSet> copies = {};  // of the thing
};

/// Puts the rows together: those that stay in their order, then copies, then healing.
edit::EditResult result_of(const RowChange& change) {
    const std::size_t rows = change.gone.size();
    Bits keep(rows);
    edit::EditResult result;
    result.base_to_new.assign(rows, -1);
    std::int64_t next = 0;
    for (std::size_t row = 0; row < rows; ++row) {
        keep[row] = change.gone[row] == 0 ? 1 : 0;
        if (keep[row] == 0) continue;
        result.base_to_new[row] = next++;
        result.label.push_back(change.moved[row]);
    }
    std::vector<GaussianSet> parts{change.changed.filtered(keep)};
    parts.insert(parts.end(), change.copies.begin(), change.copies.end());
    parts.emplace_back(change.healing);
    result.set = joined(parts);
    if (result.set.empty())
        throw Error(ErrorCode::InvalidArgument, "nothing of the scene would be left",
                    "label less of it, or keep it");
    result.generation.assign(result.label.size(), 0);
    result.label.resize(result.set.size(), 1);
    result.generation.resize(result.set.size(), 1);
    result.hole_fill.assign(result.set.size(), 0);
    std::fill(result.hole_fill.end() - static_cast<std::ptrdiff_t>(change.healing.size()),
              result.hole_fill.end(), std::uint8_t{1});
    result.iterations = 1;
    return result;
}

std::size_t count_unusable(const GaussianSet& set) {
    const auto usable = usable_rows(set);
    return static_cast<std::size_t>(std::count(usable.begin(), usable.end(), std::uint8_t{0}));
}

/// Rows that stay and are not the thing's, and differ from the scene in any bit.
std::size_t changed_elsewhere(const GaussianSet& before, const RowChange& change) {
    const auto old = before.spans(), now = change.changed.spans();
    std::size_t count = 0;
    for (std::size_t row = 0; row < before.size(); ++row)
        if (change.gone[row] == 0 && change.moved[row] == 0 && !same_row(old, row, now, row)) ++count;
    return count;
}

/// Pixels of each view in which rows that went, moved or came are seen, grown as masks are.
std::vector<Mask> touched_masks(const SceneEdit& edit, const RowChange& change,
                                const edit::EditResult& result) {
    auto& rasterizer = edit.context.painter().rasterizer();
    const auto& plan = edit.plan;
    std::vector<float> before(change.gone.begin(), change.gone.end());
    for (std::size_t row = 0; row < before.size(); ++row)
        if (change.moved[row] != 0) before[row] = 1;
    const std::vector<float> after(result.label.begin(), result.label.end());
    std::vector<Mask> masks;
    Image seen;
    for (std::size_t v = 0; v < plan.views.size(); ++v) {
        const auto& camera = plan.views[v].camera;
        Mask mask(camera.width, camera.height);
        const auto mark = [&](const GaussianSet& set, const std::vector<float>& values) {
            rasterizer.forward_values(set.spans(), camera, plan.settings, values, seen);
            for (std::size_t p = 0; p < mask.data.size(); ++p)
                if (seen.data[p] > TouchedShare) mask.data[p] = 1;
        };
        mark(edit.scene, before);
        mark(result.set, after);
        mask = localize::dilate(mask, edit::mask_growth(edit.recipe.request, plan.mode, mask));
        for (std::size_t p = 0; p < mask.data.size(); ++p) mask.data[p] |= plan.masks[v].data[p];
        masks.push_back(std::move(mask));
    }
    return masks;
}

/// Rows that go with the thing, and rows that fill its hole. `lit`: its shadow goes, too.
heal::Healed healed(const SceneEdit& edit, const Bits& thing, bool lit = true) {
    heal::HealSettings settings;
    settings.seed = edit.recipe.request.seed;
    settings.shadow = lit;
    edit.control.report("healing the hole", 0, 0);
    return heal::remove_and_heal({edit.scene, thing, edit.located.views.orbit.up, edit.control}, settings);
}

/// A ground that goes leaves nothing around it to go on.
bool heals(const SceneEdit& edit) {
    return edit.recipe.request.heal && !language::names_ground(edit.recipe.request.source());
}

void tell(const heal::Healed& healed) {
    if (healed.carried > 0) log::info("{} splats that only the thing held go with it", healed.carried);
    if (!healed.open.empty()) log::warning("{}", healed.open);
}

GaussianData no_rows(const SceneEdit& edit) {
    GaussianData none;
    none.sh_degree = edit.scene.sh_degree();
    return none;
}

RowChange removal(const SceneEdit& edit) {
    const std::size_t rows = edit.scene.size();
    RowChange change{edit.plan.label, edit.scene, Bits(rows, 0), no_rows(edit)};
    if (!heals(edit)) return change;
    auto healing = healed(edit, edit.plan.label);
    tell(healing);
    change.gone = std::move(healing.removed);
    change.healing = std::move(healing.added);
    return change;
}

/// Rows of the other thing of the words, looked for.
Bits found_anchor(const SceneEdit& edit) {
    CheckedRecipe recipe = edit.recipe;
    recipe.request = edit.recipe.request.search_for_anchor();
    Views views = edit.located.views;
    if (views.automatic) views = choose_views(edit.context.scene(), recipe, {});
    const Located found = locate(edit.context, recipe, views, {}, edit.control);
    edit::require_found(found.result);
    return *found.result.label.bits;
}

/// Rows of the other thing of the words; empty where there is none. Throws Error (NotFound) where no view
/// shows it.
Bits anchor_rows(const SceneEdit& edit) {
    const auto& anchor = edit.recipe.request.anchor();
    if (anchor.empty()) return {};
    const Label* named = label_for(edit.context.scene().labels, anchor, edit.context.model().known_words());
    Bits rows = named != nullptr ? *named->bits : found_anchor(edit);
    for (std::size_t row = 0; row < rows.size(); ++row)
        if (edit.plan.label[row] != 0) rows[row] = 0;
    return rows;
}

/// Rows of the thing with those that only it holds. A part of a thing moves alone.
Bits moving_rows(const SceneEdit& edit) {
    if (!edit.recipe.request.part_of().empty()) return edit.plan.label;
    return heal::with_held_parts({edit.scene, edit.plan.label, edit.located.views.orbit.up, edit.control});
}

/// Puts darker copies of rows in the place of those that come to lie in the shadow of the thing.
void take_shadow_along(const SceneEdit& edit, const heal::Shadow& shadow, const std::vector<Affine>& places,
                       RowChange& change) {
    const auto on_healing = light_in_shadows(GaussianSet(change.healing), shadow, places),
               on_scene = light_in_shadows(edit.scene, shadow, places);
    GaussianData healing;
    healing.sh_degree = edit.scene.sh_degree();
    const GaussianSet filled(std::move(change.healing));
    for (std::size_t row = 0; row < filled.size(); ++row)
        heal::append_lit(filled, row, on_healing[row], healing);
    for (std::size_t row = 0; row < on_scene.size(); ++row) {
        if (change.gone[row] != 0 || change.moved[row] != 0 || on_scene[row] == Vec3(1)) continue;
        change.gone[row] = 1;
        heal::append_lit(edit.scene, row, on_scene[row], healing);
    }
    change.healing = std::move(healing);
}

/// Rows of the scene under maps of the thing, its anchor and its copies.
RowChange transformation(const SceneEdit& edit) {
    const Bits label = moving_rows(edit);
    const Vec3 up = edit.located.views.orbit.up, front = edit.located.views.front;
    const auto anchor = anchor_rows(edit);
    Bits known = label;
    for (std::size_t row = 0; row < anchor.size(); ++row) known[row] |= anchor[row];
    const auto thing = edit::thing_frame(edit.scene, label, up, front);
    const auto other = anchor.empty() ? edit::ThingFrame{} : edit::thing_frame(edit.scene, anchor, up, front);
    const auto places =
        edit::rearrangement(edit.recipe.request, thing, anchor.empty() ? nullptr : &other,
                            edit::other_points(edit.scene, anchor.empty() ? label : known, thing.frame));
    RowChange change{Bits(label.size(), 0), edit.scene, label, no_rows(edit)};
    std::vector<Affine> shadows;
    for (const auto& place : places.copies)
        shadows.push_back(map_of_shadow(edit.scene, label, up, thing.standing.foot, place));
    heal::Shadow shadow;
    if (heals(edit) && (places.leaves_place || !shadows.empty())) {
        const bool lit = !shadows.empty() || !keeps_foot(thing.standing, places.thing);
        auto healing = healed(edit, label, lit);
        shadow = std::move(healing.shadow_measured);
        if (places.leaves_place) {
            tell(healing);
            shadows.push_back(map_of_shadow(edit.scene, label, up, thing.standing.foot, places.thing));
            change.healing = std::move(healing.added);
            for (std::size_t row = 0; row < label.size(); ++row)
                if (label[row] == 0) change.gone[row] = healing.removed[row];
        }
    }
    change.changed = transformed(edit.scene, label, places.thing);
    if (places.anchor) {
        change.changed = transformed(change.changed, anchor, *places.anchor);
        change.moved = std::move(known);
    }
    take_shadow_along(edit, shadow, shadows, change);
    const GaussianSet rows = edit.scene.filtered(label);
    for (const auto& place : places.copies) change.copies.push_back(transformed(rows, place));
    return change;
}

}  // namespace

Edited rearranged_scene(const SceneEdit& edit) {
    const auto& label = edit.plan.label;
    GSE_CHECK_EQ(label.size(), edit.scene.size());
    if (std::find(label.begin(), label.end(), std::uint8_t{1}) == label.end())
        throw Error(ErrorCode::InvalidArgument, "nothing is labelled",
                    "label the thing by hand, or say it in other words");
    const double start = wall_seconds();
    const RowChange change = edit.plan.mode == edit::EditMode::Remove ? removal(edit) : transformation(edit);
    auto result = result_of(change);
    result.changed_outside_label = changed_elsewhere(edit.scene, change);
    result.unusable_before = count_unusable(edit.scene);
    result.unusable = count_unusable(result.set);
    result.seconds["rearrange"] = wall_seconds() - start;
    auto touched = touched_masks(edit, change, result);
    Edited edited = finished(edit, edit.recipe.request, std::move(result));
    edited.touched = std::move(touched);
    ContentHash hash;
    hash.text(edited.key);
    hash.fields(static_cast<const edit::RearrangeSettings&>(edit.recipe.request));
    edited.key = hash.key().hex();
    return edited;
}

}  // namespace gse::pipeline
