// Several views in one picture, so that a model sees and changes them together.
#pragma once

#include <vector>

#include "engine/base/image.h"

namespace gse::remote {

/// Views of a sheet, in rows of two.
inline constexpr std::size_t SheetCells = 4;
/// Grey between the views, px.
inline constexpr int SheetGutter = 16;

/// Side of a view on a square sheet of `side` px.
int cell_side(int side);

/// Sheet [side,side,3] of at most SheetCells pictures of cell_side(); empty cells are grey.
Image sheet_of(const std::vector<Image>& pictures, int side);
/// Mask of a sheet; nothing changes between the views and in empty cells.
Mask sheet_mask(const std::vector<Mask>& masks, int side);
/// View number `cell` of a sheet that came back, [cell_side,cell_side,3]. `sheet` is a square of any side
/// that holds the cells.
Image cut_cell(const Image& sheet, std::size_t cell);

}  // namespace gse::remote
