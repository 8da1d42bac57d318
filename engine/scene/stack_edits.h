// Edits for the stack: rows removed, colours adjusted by hand, results of finished runs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/scene/colour_adjustment.h"
#include "engine/scene/document.h"

namespace gse {

/// Edit that removes the rows of `current` whose byte is set. Its delta removes nothing if none is set.
EditNode removal_of(const DocumentState& state, std::span<const std::uint8_t> rows, std::uint64_t id);

/// Edit that removes the rows of `current` whose byte is set and adds others of its SH degree.
EditNode exchange_of(const DocumentState& state, std::span<const std::uint8_t> rows, GaussianData added,
                     std::uint64_t id);

/// The state with an edit of that identity on top of the stack: the colours adjusted of the rows of `current`
/// whose byte is set. Returns `before` itself for an adjustment that changes nothing. Throws Error
/// (InvalidArgument).
DocumentState with_adjustment(const DocumentState& before, std::span<const std::uint8_t> rows,
                              const ColourAdjustment& adjustment, std::uint64_t id);

/// The state with `node` (with its delta) on top of the stack. Added rows join a label, so that they can be
/// edited further. A new label named `target` (with a number where that is taken) takes them if the edit put
/// something beside the scene (`beside`) or no label is active. Otherwise the active one does. Added rows
/// with apart[i] != 0 stay out of labels: they fill a hole. `apart` may be empty.
DocumentState with_edit(const DocumentState& state, EditNode node, const std::string& target, bool beside,
                        std::span<const std::uint8_t> apart = {});

/// Results of one edit of the stack, made with several seeds, any of which can take its place.
struct EditVariations {
    std::uint64_t edit = 0;            // identity on the stack, which all of them have
    std::vector<EditNode> nodes;       // in the order in which they were made
    std::vector<std::uint64_t> seeds;  // [nodes]

    /// Index of the one that the stack holds, by its delta. Nothing where it holds another one, or the edit
    /// is not on it.
    std::optional<std::size_t> applied(const std::vector<EditNode>& stack) const;
};

/// Names of later edits, switched on, that change or remove rows which the edit `id` added or changed. They
/// build on it: with it switched off, some of them is not seen. Oldest first.
std::vector<std::string> edits_built_on(const std::vector<EditNode>& stack, std::uint64_t id);

}  // namespace gse
