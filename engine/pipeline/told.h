// What a model is told of an edit: the artist's sentences, or, where it does not know the thing's name, the same with another noun.
#pragma once

#include <string>
#include <vector>

#include "engine/edit/interfaces.h"
#include "engine/edit/request.h"

namespace gse::pipeline {

/// The scene before and after an edit, as the model is told them. Words as as_told() has them.
struct Told {
    std::string before, after;
    bool stands_in = false;   // another noun stands in for the source
};

/// Of a validated request. What keeps its shape and has a name that a model of a fixed vocabulary (`known`; empty = it takes any word) does not
/// know is told as `stand_in`, a noun that it does know: shapes are taken from the pictures, and with a name that means nothing to it a model
/// hardly follows the colour beside it either. An empty `stand_in` leaves the sentences as they are.
Told told_of(const edit::EditRequest& request, edit::EditMode mode, const std::vector<std::string>& known, const std::string& stand_in);

}  // namespace gse::pipeline
