// A thing that is pointed at, or that stands alone, for labelling without a word.
#pragma once

#include <string>

#include "engine/base/progress.h"
#include "engine/edit/interfaces/interfaces.h"
#include "engine/localize/grow_thing.h"
#include "engine/pipeline/scene/scene_tools.h"
#include "engine/scene/label_field.h"

namespace gse::pipeline {

/// A click on a picture of the scene.
struct ClickRequest {
    Camera camera;
    double x = 0, y = 0;                      // in the camera's pixels
    raster::Settings settings;                // of the picture
    Vec3 up{0, -1, 0};                        // of the world
    bool ground = false;                      // the ground is meant, not what stands on it
    ThingNature nature = ThingNature::Other;  // of the thing that is meant
    bool part = false;                        // a part of what is linked there is meant
};

/// Click of --at: "X,Y", shares of the picture that `render` makes of the scene by default. Another picture
/// is named by ",AZIMUTH,ELEVATION" or ",AZIMUTH,ELEVATION,ZOOM" behind it. Throws Error (InvalidArgument).
ClickRequest click_request(const std::string& text, const Scene& scene, const std::string& up);

/// Azimuth of that picture, degrees.
double azimuth_of_click(const std::string& text);

/// Thing under the click, on all its sides (localize::grow_thing). No row where the picture shows nothing
/// within a fiftieth of its height. Throws Error (Cancelled).
localize::GrownThing thing_at(const GaussianSet& set, const ClickRequest& request,
                              const JobControl& control = {});

/// The largest thing that stands alone. No row in an empty scene. Throws Error (Cancelled).
localize::GrownThing largest_thing(const GaussianSet& set, const Vec3& up, const JobControl& control = {});

/// Reason to look at the label of a click that means a part: it may end elsewhere, or nothing parts it from
/// the rest. Empty for a thing of its own.
std::string part_doubt(const localize::GrownThing& thing, const ClickRequest& request);

/// Rows [N] of a boxed part, and the reason to look at them; empty = none.
struct BoxedPart {
    std::vector<std::uint8_t> rows;
    std::string doubt;
};

/// Part in a box, `cut` [N] out of it. Where another part grows from the middle of the box, that which fills
/// the box better is taken. `middle`: a click there. Throws Error (Cancelled).
BoxedPart boxed_part(const GaussianSet& set, const ClickRequest& middle, const edit::BoxPrompt& box,
                     std::vector<std::uint8_t> cut, const JobControl& control = {});

/// "the thing was parted from what it stands on", and so on; empty where nothing was cut.
std::string parted_text(const localize::GrownThing& thing);

}  // namespace gse::pipeline
