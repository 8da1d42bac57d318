// Changes of place and size as the notation of plans writes them: "scale 2", "move left 2 m", "face left".
#pragma once

#include <string_view>

namespace gse::edit {

enum class ChangeKind {
    Resize,    // by `amount`, a factor
    Stretch,   // along `extent` by `amount`
    Move,      // to `way` by `amount` in `unit`; its own size without an amount
    Place,     // in `place` of another thing
    Turn,      // about the upright axis by `amount` degrees, counter-clockwise as seen from above
    Face,      // so that the front looks to `way`
    Flip,      // upside down
    Mirror,    // left and right exchanged
    Swap,      // places with another thing
    MatchSize  // of another thing
};

enum class MoveDirection { Left, Right, Up, Down, Forward, Back };

/// Extent that a stretch changes: the height, the width as seen from the front, all around, or the longest.
enum class StretchExtent { Height, Width, Girth, Length };

enum class MoveUnit { OwnSize, SceneUnit };

/// Place relative to another thing.
enum class AnchorPlace { On, Beside, Left, Right, Behind, Front, Under, Above, In };

/// A change in numbers; which members say something depends on the kind.
struct PlacementChange {
    ChangeKind kind = ChangeKind::Resize;
    double amount = 1;
    MoveDirection way = MoveDirection::Left;
    StretchExtent extent = StretchExtent::Height;
    MoveUnit unit = MoveUnit::OwnSize;
    AnchorPlace place = AnchorPlace::On;

    /// True when another thing is named beside the change.
    bool needs_anchor() const {
        return kind == ChangeKind::Place || kind == ChangeKind::Swap || kind == ChangeKind::MatchSize;
    }
    bool operator==(const PlacementChange&) const = default;
};

/// Reads the text of a transform step. A metre counts as a scene unit. Throws Error (InvalidArgument) for
/// what is no change, cannot be done to a thing that is there, or has no number where one belongs.
PlacementChange placement_change(std::string_view text);

/// Number of a duplicate step: "2", "some" (three). Throws Error (InvalidArgument) for others.
int number_of_copies(std::string_view text);

}  // namespace gse::edit
