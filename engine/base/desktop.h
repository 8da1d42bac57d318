// What the program asks of the desktop around it.
#pragma once

#include <filesystem>

namespace gse {

/// Shows the folder that holds `file` in the file manager (xdg-open). Returns at once. Throws Error
/// (NotFound) where there is no such program, or no such folder.
void show_folder_of(const std::filesystem::path& file);

}  // namespace gse
