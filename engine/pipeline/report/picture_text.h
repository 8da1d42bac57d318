// What a picture of an edit says about how it was made, in its PNG text chunks.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "engine/io/image/image_file.h"
#include "engine/pipeline/run/recipe.h"

namespace gse::pipeline {

/// The sentence, and in the last line "Name: value" pairs with commas between them: source, seed, model, and
/// every setting that is not the program's own. The form that other tools write and read under the keyword
/// "parameters"; values with a comma, colon or line end are JSON strings.
std::string parameters_text(const EditRecipe& recipe);

/// Chunks of a picture that the edit made: "parameters", "Software", and "Recipe" (`recipe_json`), which
/// opens it again.
PngText picture_text(const EditRecipe& recipe, const nlohmann::ordered_json& recipe_json);

}  // namespace gse::pipeline
