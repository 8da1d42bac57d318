// Edits for the stack: rows taken off the scene, colours adjusted by hand, and what a finished run made of
// it.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "engine/scene/colour_adjustment.h"
#include "engine/scene/document.h"

namespace gse {

/// Takes the rows of `current` whose byte is set off the scene. Its delta removes nothing where none is set.
EditNode removal_of(const DocumentState& state, std::span<const std::uint8_t> rows, std::uint64_t id);

/// The state with the colours of the rows of `current` whose byte is set adjusted, as an edit of that
/// identity on top of the stack; `before` itself for an adjustment that changes nothing. Throws Error
/// (InvalidArgument).
DocumentState with_adjustment(const DocumentState& before, std::span<const std::uint8_t> rows,
                              const ColourAdjustment& adjustment, std::uint64_t id);

/// The state with `node` (with its delta) on top of the stack. Rows that it added belong to a label, so that
/// they can be edited further: to a new one named `target` where the edit put something beside what is there
/// (`beside`) or no label is active, else to the active one.
DocumentState with_edit(const DocumentState& state, EditNode node, const std::string& target, bool beside);

}  // namespace gse
