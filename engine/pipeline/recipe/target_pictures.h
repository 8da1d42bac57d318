// Pictures of an artist's own that views shall look like.
#pragma once

#include <vector>

#include "engine/remote/api/server_settings.h"
#include "engine/remote/views/round_drawing.h"

namespace gse::pipeline {

/// Pictures [S,S,3] that the settings name. Throws Error (NotFound, Malformed), and (InvalidArgument) for one
/// that is not square as views are, is smaller than 64 pixels, or whose view is named twice.
std::vector<remote::OwnPicture> read_target_pictures(const remote::ServerSettings& settings);

}  // namespace gse::pipeline
