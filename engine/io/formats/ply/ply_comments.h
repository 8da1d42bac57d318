// Facts of a scene in the comments of PLY headers, plain and compressed ones alike.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "engine/io/formats/ply/ply_header.h"
#include "engine/scene/scene.h"

namespace gse::io {

/// Takes the up axis and the way of drawing from the comments. The last of contradicting ones counts. Returns
/// the name of the label.
std::string read_comments(const PlyHeader& header, SceneInfo& info);

/// Lines that read_comments() understands.
std::string comment_lines(const SceneInfo& info);

/// Beginnings of comments that state a scene's offset: of files that hold the coordinates of the world, and
/// of those that hold them less the offset.
constexpr std::string_view OffsetComment = "GSEditPro offset";
constexpr std::string_view LessOffsetComment = "GSEditPro positions less offset";

/// Offset that the last comment of that beginning states.
std::optional<Vec3> read_offset(const PlyHeader& header, std::string_view beginning);
/// Line that read_offset() understands. Empty without an offset.
std::string offset_line(std::string_view beginning, const Vec3& offset);

}  // namespace gse::io
