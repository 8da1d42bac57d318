// Orders for models on servers that are told what to do: whole sentences with articles.
#pragma once

#include <string>

#include "engine/edit/request/checked_request.h"

namespace gse::pipeline {

/// The artist's instruction, or one from the sentence: "turn the bear into a golden bear", "add a golden hat
/// to the bear", "replace the bear with a red panda".
std::string server_instruction(const edit::CheckedRequest& request, edit::EditMode mode);

}  // namespace gse::pipeline
