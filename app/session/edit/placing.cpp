// Frames of labelled things, and edits that are remade at every change.
#include "app/session/edit/placing.h"

#include <fmt/format.h>

#include <numeric>
#include <set>
#include <utility>

#include "engine/heal/carried_shade.h"
#include "engine/pipeline/scene/placed_shadow.h"
#include "engine/scene/transform/transform_edits.h"

namespace gse::app {

namespace {

/// True where each of the rows came with an edit that does nothing but add: another scene.
bool all_put_in(const DocumentState& state, const std::vector<std::uint8_t>& rows) {
    std::set<std::uint64_t> guests;
    for (const auto& node : state.stack)
        if (node.recipe.empty() && node.delta->changed.empty() && node.delta->removed.empty())
            guests.insert(node.id);
    for (std::size_t row = 0; row < rows.size(); ++row)
        if (rows[row] != 0 && !guests.contains((*state.row_ids)[row] >> EditIdShift)) return false;
    return true;
}

}  // namespace

Placing::Placing(DocumentState before, std::shared_ptr<const std::vector<std::uint8_t>> rows,
                 const Vec3& front)
    : before_(std::move(before)), rows_(std::move(rows)),
      thing_(edit::thing_frame(before_.current, *rows_, before_.info.up, front)),
      put_in_(all_put_in(before_, *rows_)) {}

bool Placing::is_of(const DocumentState& state,
                    const std::shared_ptr<const std::vector<std::uint8_t>>& rows) const {
    return rows == rows_ && state.current.shares_all_with(before_.current);
}

ui::PlacedThing Placing::shown() const {
    const auto& standing = thing_.standing;
    return {standing.foot,      thing_.frame.side, thing_.frame.up,
            thing_.frame.front, standing.height,   standing.width()};
}

edit::Rearrangement Placing::places(const edit::RearrangeSettings& settings) const {
    if (settings.copies > 1 && others_.empty())
        others_ = edit::other_points(before_.current, *rows_, thing_.frame);
    return edit::rearrangement(settings, thing_, nullptr, others_);
}

bool Placing::shadow_leaves(const edit::Rearrangement& places) const {
    return places.leaves_place && !pipeline::keeps_foot(thing_.standing, places.thing);
}

/// Maps of the shadow that the thing has where it stands now, and those of its copies.
std::vector<Affine> Placing::shadow_maps(const edit::Rearrangement& places) const {
    std::vector<Affine> maps;
    const auto add = [&](const Affine& place) {
        maps.push_back(
            pipeline::map_of_shadow(before_.current, *rows_, before_.info.up, thing_.standing.foot, place));
    };
    for (const auto& place : places.copies) add(place);
    if (shadow_leaves(places)) add(places.thing);
    return maps;
}

GaussianData Placing::in_its_shadow(const GaussianData& ground, const edit::RearrangeSettings& settings,
                                    const heal::Shadow& shadow) const {
    const GaussianSet set(ground);
    return heal::lit(set, pipeline::light_in_shadows(set, shadow, shadow_maps(places(settings)))).to_data();
}

namespace {

/// Changes of the rows whose light is not 1.
SceneDelta light_delta(const DocumentState& state, const std::vector<Vec3>& light, std::uint64_t id) {
    std::vector<std::uint8_t> rows(light.size());
    std::vector<RowId> ids;
    std::vector<Vec3> some_light;
    for (std::size_t row = 0; row < light.size(); ++row) {
        rows[row] = light[row] == Vec3(1) ? 0 : 1;
        if (rows[row] == 0) continue;
        ids.push_back((*state.row_ids)[row]);
        some_light.push_back(light[row]);
    }
    const GaussianSet some = state.current.filtered(rows);  // of a large scene little is in a shadow
    std::vector<std::int64_t> kept(some.size());
    std::iota(kept.begin(), kept.end(), std::int64_t{0});
    return make_delta(some, ids, heal::lit(some, some_light), kept, id);
}

/// Adds the changes of other rows, in the order of their identities.
void add_changes(SceneDelta& delta, const SceneDelta& more) {
    SceneDelta both;
    both.changed_rows.sh_degree = delta.changed_rows.sh_degree;
    std::size_t i = 0, k = 0;
    while (i < delta.changed.size() || k < more.changed.size()) {
        const bool first =
            k == more.changed.size() || (i < delta.changed.size() && delta.changed[i] < more.changed[k]);
        const SceneDelta& from = first ? delta : more;
        std::size_t& at = first ? i : k;
        both.changed.push_back(from.changed[at]);
        both.changed_rows.append_row(from.changed_rows, at++);
    }
    delta.changed = std::move(both.changed);
    delta.changed_rows = std::move(both.changed_rows);
}

}  // namespace

DocumentState Placing::placed(const edit::RearrangeSettings& settings, std::uint64_t id,
                              const heal::Shadow* shadow) const {
    const auto where = places(settings);
    EditNode node = transform_of(before_, *rows_, where.thing, id);
    SceneDelta delta = *node.delta;
    if (!where.copies.empty()) {
        const EditNode copies = copies_of(before_, *rows_, where.copies, id);
        delta.added = copies.delta->added;
        delta.added_rows = copies.delta->added_rows;
    }
    if (shadow != nullptr) {
        const auto light =
            pipeline::light_after(before_.current, *rows_, *shadow, shadow_maps(where), shadow_leaves(where));
        const SceneDelta ground = light_delta(before_, light, id);
        node.changed_outside_label = ground.changed.size();
        add_changes(delta, ground);
    }
    node.delta = std::make_shared<const SceneDelta>(std::move(delta));
    node.name = placing_text(settings);
    auto stack = before_.stack;
    stack.push_back(std::move(node));
    return with_stack(before_, std::move(stack));
}

std::string placing_text(const edit::RearrangeSettings& settings) {
    std::string text;
    const edit::RearrangeSettings standard;
    edit::RearrangeSettings::visit_fields(
        settings, [&](const char* name, const auto& value, const char*, auto...) {
            using Value = std::remove_cvref_t<decltype(value)>;
            Value usual{};
            edit::RearrangeSettings::visit_fields(
                standard, [&](const char* other, const auto& of, const char*, auto...) {
                    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(of)>, Value>)
                        if (std::string_view(other) == name) usual = of;
                });
            if (value == usual) return;
            std::string said(name);
            for (auto& letter : said)
                if (letter == '_') letter = ' ';
            if constexpr (std::is_same_v<Value, double>) said += fmt::format(" {:.3g}", value);
            else if constexpr (std::is_same_v<Value, int>) said += fmt::format(" {}", value);
            text += (text.empty() ? "Place: " : ", ") + said;
        });
    return text.empty() ? "Place" : text;
}

}  // namespace gse::app
