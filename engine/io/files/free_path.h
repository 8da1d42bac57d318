// Names for files that must not replace others.
#pragma once

#include <filesystem>

namespace gse {

/// First free name of "shot.png", "shot-2.png", ... An empty folder counts as free.
std::filesystem::path first_free(const std::filesystem::path& wanted);

}  // namespace gse
