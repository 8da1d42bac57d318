// Single searches from given views: for a word, for a part within a thing, and none at all.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "engine/pipeline/run/search.h"

namespace gse::pipeline {

/// Looks for a ground, where it is wanted; the first views that are looked at decide.
void look_for_ground(RunContext& context, const CheckedRecipe& recipe, const Views& views);

/// The ground on which words are looked for; a label is what it is.
std::optional<edit::StudioBackground> ground_shown(RunContext& context, const CheckedRecipe& recipe,
                                                   const Views& views);

/// Adds rows [N] to others; an empty list holds none.
void add_to(std::vector<std::uint8_t>& rows, const std::vector<std::uint8_t>& more);

/// Settings and views of a search by what the server of the context changes: few views, at the size that it
/// draws. The recipe is changed, since the edit goes on from them.
Views difference_views(const RunContext& context, CheckedRecipe& recipe, const Views& views);

/// One search. `label`: made by hand, or null. `within`, `beside`: as in LocateInput.
edit::LocateResult search_from(RunContext& context, const Views& views, const CheckedRecipe& recipe,
                               const std::vector<std::uint8_t>* label, const JobControl& control,
                               const std::vector<std::uint8_t>* within = nullptr,
                               const std::vector<std::uint8_t>* beside = nullptr);

/// The part that the recipe looks for, within the thing `located.within`. Its word is looked for from the
/// views of the thing; where the model has none, the thing's shape tells the part.
Located locate_part(RunContext& context, Located located, const JobControl& control);

/// Every splat may change, wherever a picture shows it. Nothing is looked for.
Located located_everywhere(RunContext& context, const CheckedRecipe& recipe, const Views& views,
                           const JobControl& control);

/// The finding with what the views left out of its thing, by the thing's shape (whole_thing.h): scans alone,
/// whose pictures are strange to the networks. Something worn is in doubt then.
Located completed_by_shape(RunContext& context, Located located);

}  // namespace gse::pipeline
