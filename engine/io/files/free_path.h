// Names for files that must not replace others.
#pragma once

#include <filesystem>

namespace gse {

/// The first of "shot.png", "shot-2.png", ... that is free; an empty folder is.
std::filesystem::path first_free(const std::filesystem::path& wanted);

}  // namespace gse
