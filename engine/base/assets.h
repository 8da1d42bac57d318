// Where the program's own files are: beside the sources, or installed.
#pragma once

#include <filesystem>

namespace gse {

/// ../share/gseditpro of the folder `program` where that is there (an installed program), else `checkout`.
std::filesystem::path assets_beside(const std::filesystem::path& program,
                                    const std::filesystem::path& checkout);

/// The same for the program that runs.
std::filesystem::path assets_folder(const std::filesystem::path& checkout);

}  // namespace gse
