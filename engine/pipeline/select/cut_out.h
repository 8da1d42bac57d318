// An object on the screen, cut out of the picture, for labelling by hand.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/base/progress.h"
#include "engine/edit/interfaces/interfaces.h"
#include "engine/raster/rasterizer.h"
#include "engine/scene/label_field.h"
#include "engine/scene/label_ops.h"
#include "engine/scene/scene.h"

namespace gse::pipeline {

/// Settings of the picture, and the area picked in it.
struct CutOutRequest {
    Camera camera;
    ScreenArea area;                          // around the thing, in the camera's pixels
    raster::Settings settings;                // of the pictures, their background too
    Vec3 up{0, -1, 0};                        // of the world: the other sides are looked at around it
    bool ground = false;                      // not what stands on it
    ThingNature nature = ThingNature::Other;  // of the thing that is meant
    bool part = false;                        // a part of what is linked there is meant
};

/// Box of --cut-out: "LEFT,TOP,RIGHT,BOTTOM", shares of the picture that `render` makes of the scene by
/// default. Another picture is named by ",AZIMUTH,ELEVATION,ZOOM" behind it, as `render` takes them. Throws
/// Error (InvalidArgument).
CutOutRequest cut_out_request(const std::string& text, const Scene& scene, const std::string& up);

/// Azimuth of that picture, degrees.
double azimuth_of_box(const std::string& text);

/// An object that was cut out.
struct CutOutThing {
    std::vector<std::uint8_t> rows;  // [N] 1 for the object, from all sides
    std::string cut_sides;           // sides of the box that cut through it ("above"); box_cut.h
    std::string part_doubt = {};     // reason to look at the label of a part (point_out.h)
};

/// Cuts an object out of `set`. `segmenter` cuts it out of a picture of the view, prompted by the box around
/// the area. Then it cuts it out of views around the object (cut_out_sides.h). Null = the segmenter without
/// weights. If the first cut is empty, the area itself is the outline. Throws Error (Cancelled).
CutOutThing cut_out(const GaussianSet& set, const CutOutRequest& request, edit::Segmenter* segmenter,
                    const JobControl& control = {});

/// Reason to look at the label: a box that cuts through the thing, or a part in doubt. Empty = none.
std::string cut_text(const CutOutThing& thing);

}  // namespace gse::pipeline
