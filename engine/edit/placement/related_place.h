// Place of an object that the sentence puts beside, behind, before, under or on the source.
#pragma once

#include <optional>

#include "engine/edit/placement/region_frame.h"
#include "engine/language/lexicon.h"

namespace gse::edit {

/// Level place on a thing that carries another: the seat of a chair, the top of a table.
struct RestingPlace {
    Vec3 centre;        // on the surface, frame coordinates
    double radius = 0;  // of the largest disc that lies on it
};

/// The widest level place on top of a thing with these visible points, in frame coordinates. Nothing where
/// none is wide enough to carry what suits the thing.
std::optional<RestingPlace> resting_place(const std::vector<Vec3>& points);

/// The room that a relation leaves, in frame coordinates: what the views vote in, and where the thing goes
/// unasked.
class RelatedPlace {
public:
    /// `source` and `others`: visible points of the source (at least one) and of the rest of the scene.
    RelatedPlace(language::Relation relation, const std::vector<Vec3>& source,
                 const std::vector<Vec3>& others);
    /// Tells whether the relation leaves a room of its own: none without a place that a thing on top needs.
    bool found() const { return found_; }
    /// Box in which the views vote.
    const Box& box() const { return box_; }
    /// Tells whether a point of it stands in the relation to the source.
    bool allows(const Vec3& p) const;
    /// Tells whether a region stands on what carries it there, or nearly, and is no wider than a thing that
    /// suits the source.
    bool suits(const VoxelRegion& region, const Frame& frame) const;
    /// A round thing next to the source, which rests on the ground the source stands on; under a source that
    /// stands on the ground, a flat one at its foot.
    VoxelRegion usual(const Frame& frame, int cells) const;

private:
    void find_room_above(const std::vector<Vec3>& source);
    void find_room_below(const std::vector<Vec3>& others);
    void choose_side(const std::vector<Vec3>& others);
    Box thing() const;

    language::Relation relation_;
    Box source_, box_;
    double radius_ = 0;                // of a thing that suits the source
    double sign_ = 1;                  // of x, where either side would do: the emptier one
    double below_ = 0;                 // free height under the source; 0 = it stands on something
    std::optional<RestingPlace> top_;  // of the source, for what is put on it
    bool found_ = true;
};

}  // namespace gse::edit
