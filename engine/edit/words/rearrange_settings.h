// Settings of a change of place, size or number, in words or in numbers.
#pragma once

#include <string>

#include "engine/base/fields.h"

namespace gse::edit {

/// Rearrangement of the labelled thing: the words first, then the numbers on top. Left, right and forward are
/// those of who looks at the scene's front.
struct RearrangeSettings {
    std::string change;
    double move_right = 0, move_up = 0, move_forward = 0;  // scene units
    double turn = 0, tilt = 0, roll = 0;                   // degrees
    double resize = 1;
    bool mirror = false;
    int copies = 1;

    bool operator==(const RearrangeSettings&) const = default;

    template <class Self, class F> static void visit_fields(Self& self, F&& f) {
        constexpr double Far = 1e6, Around = 360;
        f("change", self.change,
          "Change of place or size in words. Sizes: bigger, smaller, taller, shorter, wider, narrower, "
          "thicker, "
          "thinner, longer, scale N, same size as. Places: move left|right|up|down|forward|back [N m], move "
          "on|beside|left of|right of|behind|in front of|under|above|in another thing, swap with. Turns: "
          "rotate "
          "[N] [clockwise|counterclockwise|left|right], face left|right|back, flip, mirror.");
        f("move_right", self.move_right, "Move to the right of who looks at the front, in scene units.",
          Range{-Far, Far});
        f("move_up", self.move_up, "Move up, in scene units.", Range{-Far, Far});
        f("move_forward", self.move_forward, "Move towards who looks at the front, in scene units.",
          Range{-Far, Far});
        f("turn", self.turn, "Turn about the upright axis, degrees, counter-clockwise as seen from above.",
          Range{-Around, Around});
        f("tilt", self.tilt, "Lean towards who looks at the front, degrees.", Range{-Around, Around});
        f("roll", self.roll, "Lean to the right of who looks at the front, degrees.", Range{-Around, Around});
        f("resize", self.resize, "Factor of the size; the foot stays where it is.", Range{0.01, 100});
        f("mirror", self.mirror, "Exchange left and right of the thing.");
        f("copies", self.copies, "How many there are afterwards; 1 = no copy is made.", Range{1, 100});
    }
};

}  // namespace gse::edit
