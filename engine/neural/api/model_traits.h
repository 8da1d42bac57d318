// The traits that a model states in its bundle.
#pragma once

#include <filesystem>

#include "engine/edit/interfaces/model_traits.h"

namespace gse::neural {

/// "traits" of gseditpro.json beside the weights: the fields of edit::ModelTraits, "sky" [r, g, b],
/// "ground_colours" {word: [r, g, b]} and "usual_colours" {thing: colour}. What is not stated keeps its
/// default. Throws Error (Malformed) that names the entry and the file.
edit::ModelTraits model_traits(const std::filesystem::path& model);

}  // namespace gse::neural
