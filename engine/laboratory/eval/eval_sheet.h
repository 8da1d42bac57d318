// Contact sheets: one edit per row, one stage per column.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "engine/base/image.h"

namespace gse::bench {

/// Collects rows and writes a picture whenever a sheet is full. Cells are scaled to one size.
class ContactSheets {
public:
    /// Files are named `stem`_000.png and so on; `rows` per sheet. `cell_side`: pixels of each picture.
    ContactSheets(std::filesystem::path folder, std::string stem, int rows, int cell_side = UsualCellSide);
    /// Pictures [H,W,3]; an empty one leaves its cell dark. `title` goes into the file's text.
    void add(const std::vector<Image>& cells, const std::string& title);
    /// Writes what is left; the names of all files.
    std::vector<std::string> finish();

    static constexpr int UsualCellSide = 160;  // five columns fit a small screen

private:
    void write();
    std::filesystem::path folder_;
    std::string stem_;
    std::size_t rows_;
    int cell_side_;
    std::vector<std::vector<Image>> cells_;
    std::vector<std::string> titles_, files_;
};

/// The picture with a mask's outline in yellow and its outside darkened.
Image with_mask(const Image& picture, const Mask& mask);

}  // namespace gse::bench
