// Settings that a model states and nobody chose: how they enter a recipe, and where each of its values came
// from.
#pragma once

#include <set>
#include <string>

#include "engine/neural/api/model_profile.h"
#include "engine/pipeline/recipe/recipe.h"

namespace gse::pipeline {

/// The profile of the recipe's model; an empty one in a build without networks. Throws Error (Malformed) for
/// a wrong gseditpro.json.
neural::ModelProfile profile_of(const JobParameters& job);

/// The traits of the recipe's model. Throws Error (Malformed) for wrong ones.
edit::ModelTraits traits_of(const JobParameters& job);

/// Gives the settings that the profile states, and that are not among `set_by_user` ("request.image_size"),
/// the model's values; recipe.sources says where they and the user's come from.
void apply_profile(const neural::ModelProfile& profile, EditRecipe& recipe,
                   const std::set<std::string>& set_by_user);

/// [{"field": "request.image_size", "value": 512, "source": "model"}, ...]: every setting of the recipe that
/// is not left at the program's default; sources are "model", "file gseditpro.json" and "user".
nlohmann::ordered_json settings_from(const EditRecipe& recipe);

/// Names, with the part before them, of the settings in which the two differ; of the job the threads alone.
std::set<std::string> changed_settings(const EditRecipe& now, const EditRecipe& before);

/// Fields that still are as `before` has them become as `after` has them.
template <class P> void move_defaults(P& settings, const P& before, const P& after) {
    const auto values = fields_to_json(settings), old = fields_to_json(before);
    auto moved = fields_to_json(after);
    for (const auto& [name, value] : values.items())
        if (value != old[name]) moved.erase(name);
    fields_from_json(settings, moved);
}

}  // namespace gse::pipeline
