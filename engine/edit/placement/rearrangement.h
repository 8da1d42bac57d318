// Places of a thing that is moved, turned, resized or copied, from words or numbers and its bounds.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/edit/placement/region_frame.h"
#include "engine/edit/placement/upright_bounds.h"
#include "engine/edit/words/rearrange_settings.h"
#include "engine/scene/document.h"
#include "engine/scene/transform/affine.h"

namespace gse::edit {

/// A labelled thing in the frame of the scene: side (to the right of who looks at the front), up, front.
struct ThingFrame {
    UprightBounds standing;
    Frame frame;
    Box box;                   // of its visible rows, frame coordinates; the outermost rows do not count
    std::vector<Vec3> points;  // those rows, frame coordinates; may be empty

    bool found() const { return standing.found(); }
    /// Foot in frame coordinates.
    Vec3 foot() const { return frame.to_frame(standing.foot); }
};

/// Frame of the rows that `bits` [N] label; not found() if none can be seen.
ThingFrame thing_frame(const GaussianSet& set, std::span<const std::uint8_t> bits, const Vec3& up,
                       const Vec3& front);

/// Visible rows of the scene that `bits` [N] do not mark, in frame coordinates.
std::vector<Vec3> other_points(const GaussianSet& set, std::span<const std::uint8_t> bits,
                               const Frame& frame);

/// Result: maps of the scene's space.
struct Rearrangement {
    Affine thing;                  // of the thing itself
    std::vector<Affine> copies;    // of the copies beside it
    std::optional<Affine> anchor;  // of the other thing, where both change places
    bool leaves_place = false;     // something behind or below the thing comes to light
    bool drop = false;             // it was put down on the ground of its new place
};

/// Maps that the settings ask for. Sizes without a number change by the factor 1.3, turns by a quarter. Moves
/// without a distance go as far as the thing is wide, deep, or half as high.
///
/// Sizes change about the foot. What moves along the ground stands as high above it as before. `anchor`: the
/// other thing of the words, in the same frame; may be null. `others`: other_points() of the rest of the
/// scene. They carry what is put on them, and copies keep clear of them; may be empty. Throws Error
/// (InvalidArgument) for what cannot be done.
Rearrangement rearrangement(const RearrangeSettings& settings, const ThingFrame& thing,
                            const ThingFrame* anchor = nullptr, std::span<const Vec3> others = {});

/// Edit for the stack that does a rearrangement: rows of the thing and of the other one change, copies are
/// added. `rows` and `of_anchor` mark rows of `current` [N]; the latter may be empty where there is no other
/// thing. with_edit() labels the copies.
EditNode rearrangement_edit(const DocumentState& state, std::span<const std::uint8_t> rows,
                            std::span<const std::uint8_t> of_anchor, const Rearrangement& places,
                            std::uint64_t id);

}  // namespace gse::edit
