// Reader and writer of 3DGS PLY files, the exact format.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/io/formats/scene_format.h"

namespace gse::io {

/// Reads a file in memory. Throws Error.
Scene parse_gaussian_ply(Bytes bytes);
/// Reads without ever holding the whole file. Nothing when it is no such file, or one that only
/// parse_gaussian_ply() can read or refuse.
std::optional<Scene> load_gaussian_ply(const InputFile& file);
/// Hands on the file's bytes. Throws Error before the first piece or not at all. Returns no order, since rows
/// stay in place.
std::vector<std::uint32_t> write_gaussian_ply(const Scene& scene, const SaveOptions& options,
                                              const TakePiece& take);

/// True when a PLY's start can be that of splats. PLY files hold meshes and points too.
bool may_be_gaussian_ply(std::string_view start);
/// Type of all PLY files.
MimeType ply_mime();

}  // namespace gse::io
