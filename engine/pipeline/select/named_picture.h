// Places in a picture of the scene, as the command line names them.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "engine/pipeline/scene/scene_tools.h"

namespace gse::pipeline {

/// Place in the picture that `render` makes of a scene.
struct NamedPicture {
    std::vector<double> place;    // numbers that name the place
    RenderParameters parameters;  // of the picture: the default ones, or those named behind the place
};

/// Reads "X,Y" or "X,Y,AZIMUTH,ELEVATION,ZOOM": `count` numbers of the place, then as many of the picture as
/// one entry of `picture_counts` says. Nothing for another text.
std::optional<NamedPicture> named_picture(const std::string& text, std::size_t count,
                                          const std::vector<std::size_t>& picture_counts);

}  // namespace gse::pipeline
