// Files found by name in any case: other systems do not tell "Images" and "images" apart.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace gse::io {

/// Search for files. Listings of folders are read once and kept while the object lives.
class AnyCase {
public:
    /// The file or folder at `relative` ("sparse/0") below `folder`. Names as written come first, then those
    /// that differ in case only. Nothing where there is none.
    std::optional<std::filesystem::path> find(const std::filesystem::path& folder,
                                              const std::filesystem::path& relative);
    /// The first folders in `folder` that are named by a number, the smallest first.
    std::vector<std::filesystem::path> numbered(const std::filesystem::path& folder);

private:
    using Names = std::map<std::string, std::filesystem::path>;  // lower case -> as written
    const Names& names_in(const std::filesystem::path& folder);

    std::map<std::filesystem::path, Names> listings_;
};

}  // namespace gse::io
