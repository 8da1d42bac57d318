// Edits for the stack that move, turn, resize or copy rows.
#pragma once

#include <cstdint>
#include <span>

#include "engine/scene/document.h"
#include "engine/scene/transform/affine.h"

namespace gse {

/// Rows of a state's `current` [N], 1 = meant, and the map that is done to them.
struct PlacedRows {
    std::span<const std::uint8_t> rows;
    Affine placement;
};

/// Edit that does maps to rows of `current`, one after another. Rows keep their identity; those that stay
/// equal bit for bit do not enter.
EditNode transform_of(const DocumentState& state, std::span<const PlacedRows> parts, std::uint64_t id);
EditNode transform_of(const DocumentState& state, std::span<const std::uint8_t> rows, const Affine& placement,
                      std::uint64_t id);

/// Edit that adds a copy of the rows of `current` whose byte is set at each placement. The rows themselves
/// stay as they are. Copies stand one behind the other in the order of the placements. Throws Error
/// (InvalidArgument) for more copies than identities.
EditNode copies_of(const DocumentState& state, std::span<const std::uint8_t> rows,
                   std::span<const Affine> placements, std::uint64_t id);

}  // namespace gse
