// Colour space that a PLY file states: a comment, or the element "color_space" of SHARP's files.
#pragma once

#include "engine/io/formats/ply/ply_header.h"
#include "engine/io/formats/scene_format.h"

namespace gse::io {

/// True when the header has a word on the colour space. The value of an element lies behind it.
bool states_colour_space(const PlyHeader& header);

/// Turns colours that the file states as linear light into sRGB, which is shown. Says so in the warnings, and
/// also where the colour space is not known. `file` holds the header and the body.
void show_as_srgb(Scene& scene, const PlyHeader& header, Bytes file);

}  // namespace gse::io
