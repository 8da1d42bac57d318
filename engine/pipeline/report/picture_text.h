// Record of an edit in the PNG text chunks of its pictures.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "engine/io/image/image_file.h"
#include "engine/pipeline/recipe/recipe.h"

namespace gse::pipeline {

/// Text of the keyword "parameters", in the form of other tools. It is the sentence, and in the last line
/// "Name: value" pairs with commas between them: source, seed, model, and every setting that is not the
/// program's own. Values with a comma, colon or line end are JSON strings.
std::string parameters_text(const EditRecipe& recipe);

/// Chunks of a picture that the edit made: "parameters", "Software", and "Recipe" (`recipe_json`), which
/// opens it again.
PngText picture_text(const EditRecipe& recipe, const nlohmann::ordered_json& recipe_json);

}  // namespace gse::pipeline
