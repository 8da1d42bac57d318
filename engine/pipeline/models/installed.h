// Folders of the program's own files: beside the sources, or installed.
#pragma once

#include <filesystem>

namespace gse::pipeline {

std::filesystem::path assets_path();
std::filesystem::path starter_model_path();
/// First page of the artist's guide: among the installed files, else where the build made it.
std::filesystem::path guide_path();

}  // namespace gse::pipeline
