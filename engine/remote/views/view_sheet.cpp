// Cells in two rows and two columns.
#include "engine/remote/views/view_sheet.h"

#include "engine/base/check.h"

namespace gse::remote {
namespace {

constexpr float Grey = 0.5f;

struct Corner {
    int left = 0, top = 0;
};

Corner corner_of(std::size_t cell, int side) {
    const int step = side - cell_side(side);
    return {cell % 2 == 0 ? 0 : step, cell < 2 ? 0 : step};
}

}  // namespace

int cell_side(int side) { return (side - SheetGutter) / 2; }

Image sheet_of(const std::vector<Image>& pictures, int side) {
    GSE_CHECK(pictures.size() <= SheetCells);
    Image sheet(side, side, 3, Grey);
    for (std::size_t cell = 0; cell < pictures.size(); ++cell) {
        const auto& picture = pictures[cell];
        GSE_CHECK_EQ(picture.width, cell_side(side));
        const auto corner = corner_of(cell, side);
        for (int y = 0; y < picture.height; ++y)
            for (int x = 0; x < picture.width; ++x)
                for (int c = 0; c < 3; ++c)
                    sheet.at(corner.left + x, corner.top + y, c) = picture.at(x, y, c);
    }
    return sheet;
}

Mask sheet_mask(const std::vector<Mask>& masks, int side) {
    GSE_CHECK(masks.size() <= SheetCells);
    Mask sheet(side, side);
    for (std::size_t cell = 0; cell < masks.size(); ++cell) {
        const auto corner = corner_of(cell, side);
        for (int y = 0; y < masks[cell].height; ++y)
            for (int x = 0; x < masks[cell].width; ++x)
                sheet.at(corner.left + x, corner.top + y) = masks[cell].at(x, y);
    }
    return sheet;
}

Image cut_cell(const Image& sheet, std::size_t cell) {
    const int side = cell_side(sheet.width);
    const auto corner = corner_of(cell, sheet.width);
    Image picture(side, side, 3);
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x)
            for (int c = 0; c < 3; ++c) picture.at(x, y, c) = sheet.at(corner.left + x, corner.top + y, c);
    return picture;
}

}  // namespace gse::remote
