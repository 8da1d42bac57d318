// Rows of pictures side by side, as PNG.
#include "engine/laboratory/eval/eval_sheet.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/io/image/image_file.h"
#include "engine/localize/clusters.h"

namespace gse::bench {
namespace {

constexpr int Gap = 4;
constexpr float CleanPlate = 0.16f;

void paste(const Image& cell, int side, int left, int top, Image& sheet) {
    if (cell.data.empty()) return;
    const bool fits = cell.width == side && cell.height == side;
    const Image scaled = fits ? cell : localize::resize_image(cell, side, side);
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x)
            for (int c = 0; c < 3; ++c)
                sheet.at(left + x, top + y, c) =
                    std::clamp(scaled.at(x, y, std::min(c, scaled.channels - 1)), 0.0f, 1.0f);
}

}  // namespace

ContactSheets::ContactSheets(std::filesystem::path folder, std::string stem, int rows, int cell_side)
    : folder_(std::move(folder)), stem_(std::move(stem)), rows_(static_cast<std::size_t>(rows)),
      cell_side_(cell_side) {}

void ContactSheets::add(const std::vector<Image>& cells, const std::string& title) {
    cells_.push_back(cells);
    titles_.push_back(title);
    if (cells_.size() == rows_) write();
}

std::vector<std::string> ContactSheets::finish() {
    if (!cells_.empty()) write();
    return files_;
}

void ContactSheets::write() {
    std::size_t columns = 0;
    for (const auto& row : cells_) columns = std::max(columns, row.size());
    const auto extent = [&](std::size_t cells) { return static_cast<int>(cells) * (cell_side_ + Gap) + Gap; };
    Image sheet(extent(columns), extent(cells_.size()), 3, CleanPlate);
    std::string titles;
    for (std::size_t row = 0; row < cells_.size(); ++row) {
        for (std::size_t column = 0; column < cells_[row].size(); ++column)
            paste(cells_[row][column], cell_side_, extent(column), extent(row), sheet);
        titles += (row == 0 ? "" : "\n") + titles_[row];
    }
    files_.push_back(fmt::format("{}_{:03}.png", stem_, files_.size()));
    write_png(folder_ / files_.back(), sheet, {{"Rows", titles}});
    cells_.clear();
    titles_.clear();
}

Image with_mask(const Image& picture, const Mask& mask) {
    constexpr float outside = 0.3f;
    Image shown = picture;
    const Mask inner = localize::dilate(mask, -1);
    for (std::size_t p = 0; p < mask.data.size(); ++p) {
        float* pixel = &shown.data[p * 3];
        if (mask.data[p] != 0 && inner.data[p] == 0) {
            pixel[0] = 1;
            pixel[1] = 0.9f;
            pixel[2] = 0.1f;
        } else if (mask.data[p] == 0) {
            for (int c = 0; c < 3; ++c) pixel[c] *= outside;
        }
    }
    return shown;
}

}  // namespace gse::bench
