// What a model that edits pictures by instructions is told (InstructPix2Pix): an order, not a description.
#pragma once

#include <string>

#include "engine/edit/request/request.h"

namespace gse::edit {

/// The request's instruction; without one "turn the <source> into <prompt without its article>" (views.md 3),
/// "make it <prompt without its article>" where no source is named.
std::string instruction_of(const EditRequest& request);

}  // namespace gse::edit
