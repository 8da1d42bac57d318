// Folder of the program's own files: beside the sources, or installed.
#pragma once

#include <filesystem>

namespace gse {

/// ../share/gseditpro of the folder `program` if it is there (an installed program), else `checkout`.
std::filesystem::path assets_beside(const std::filesystem::path& program,
                                    const std::filesystem::path& checkout);

/// Folder of the assets of the running program.
std::filesystem::path assets_folder(const std::filesystem::path& checkout);

}  // namespace gse
