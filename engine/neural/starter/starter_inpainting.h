// What the training of new shapes hides and shows of a picture: regions like those that an edit redraws.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/random.h"

namespace gse::neural {

/// How a group of views of one scene is shown the scene before the edit.
enum class InpaintTask {
    Nothing,     // not at all: all may change
    Around,      // only what lies around the region that changes: a thing takes the place of another
    Background,  // also what will be hidden by the new thing, but for a hole
    Scene,       // all of it: something is added, the place of which is known
    Place,       // the same, where it may be anywhere around the thing that it belongs to
};

/// Of a scene with or without an accessory (that is what is added then).
InpaintTask draw_inpaint_task(bool accessory, Random& random);

/// Cells [G,G], 0 or 1 each.
struct InpaintCells {
    std::vector<float> mask;   // may change
    std::vector<float> shown;  // what was there is shown
};

/// `covered` [G,G]: how much of each cell what is new covers, 0..255; `room` [G,G]: of that of an old thing,
/// or of the one that gets something. Where another thing takes its place the mask mostly is the room, for
/// `Place` always (where any of it is seen). Otherwise it holds all that is covered and a cell around it: a
/// box, an ellipse or a grown outline of random extent, since the place of an edit says little about the
/// outline of what comes there.
InpaintCells draw_inpaint_cells(InpaintTask task, std::span<const std::uint8_t> covered,
                                std::span<const std::uint8_t> room, int side, Random& random);

}  // namespace gse::neural
