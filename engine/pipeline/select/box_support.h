// A boxed thing and what it stands on, told apart where the support goes on beyond the label.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/image.h"
#include "engine/pipeline/scene/scene_tools.h"
#include "engine/pipeline/select/box_cut.h"

namespace gse::pipeline {

/// Picture of a boxed thing.
struct BoxedView {
    Camera camera;      // of the picture
    Mask mask;          // the thing's outline
    double extent = 1;  // height of the whole view over its focal length: how fine things are looked at
    Vec3 up{0, -1, 0};  // of the world
    PictureDepth picture = {};
};

/// Label [N] without the support of the thing. The thing grows from the middle of its outline as under a
/// click (localize/grow_thing.h). Labelled rows beside it are support where more of the support surrounds
/// them in the picture. A pedestal that the label holds whole stays labelled.
std::vector<std::uint8_t> without_support(const GaussianSet& set, std::vector<std::uint8_t> bits,
                                          const BoxedView& view, const raster::Settings& settings,
                                          Painter& painter);

}  // namespace gse::pipeline
