// Facts of a scene in the comments of PLY headers, plain and compressed ones alike.
#pragma once

#include <string>

#include "engine/io/formats/ply/ply_header.h"
#include "engine/scene/scene.h"

namespace gse::io {

/// Takes the up axis and the way of drawing from the comments. The last of contradicting ones counts. Returns
/// the name of the label.
std::string read_comments(const PlyHeader& header, SceneInfo& info);

/// Lines that read_comments() understands.
std::string comment_lines(const SceneInfo& info);

}  // namespace gse::io
