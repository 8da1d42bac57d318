// Requests to the desktop around the program.
#pragma once

#include <filesystem>

namespace gse {

/// Shows the folder that holds `file` in the file manager (xdg-open). Returns at once. Throws Error
/// (NotFound) without such a program or folder.
void show_folder_of(const std::filesystem::path& file);

/// Opens a document with the desktop's program for it (xdg-open). Returns at once. Throws Error (NotFound)
/// where there is no such program, or no such document.
void open_document(const std::filesystem::path& file);

}  // namespace gse
