// Projects of SuperSplat (.ssproj): a zip archive of document.json and a PLY for each part.
#pragma once

#include <memory>

#include "engine/io/scene/scene_content.h"

namespace gse::io {

/// Files of the project in the archive, or null when there is none.
std::unique_ptr<PartFiles> supersplat_project_in(const PartArchive& files);

/// Reads the visible parts of the project in their places, in the frame of 3DGS files. Says what of the
/// project is not taken over. Throws Error.
Scene read_supersplat_project(const PartFiles& files, const Wrapping& wrapping);

}  // namespace gse::io
