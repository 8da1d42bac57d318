// Sheets of pictures: as large as the room lets them be.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>

#include "ui/model/context.h"

namespace gse::ui {

/// Columns of a sheet and the size of a cell's picture, in pixels.
struct SheetPlan {
    int columns = 1;
    float side = 0;
};

/// Cells of a sheet: a picture of `pictures` sides beside each other, and `below` more height under it.
struct SheetCells {
    int count = 0;
    float pictures = 1;
    float below = 0, gap = 0;  // pixels
};

/// Largest side from `least` to `most` at which all cells fit into width x height. Where none does, as many
/// columns of the least side as fit, in a sheet that scrolls.
inline SheetPlan fitted_sheet(const SheetCells& cells, float width, float height, float least, float most) {
    SheetPlan best;
    for (int columns = 1; columns <= std::max(1, cells.count); ++columns) {
        const auto rows = std::ceil(static_cast<float>(cells.count) / static_cast<float>(columns));
        const float across = ((width + cells.gap) / static_cast<float>(columns) - cells.gap) / cells.pictures;
        const float down = (height + cells.gap) / std::max(1.0f, rows) - cells.gap - cells.below;
        const float side = std::floor(std::min({across, down, most}));
        if (side > best.side) best = {columns, side};
    }
    if (best.side >= least) return best;
    const float cell = cells.pictures * least + cells.gap;
    return {std::max(1, static_cast<int>((width + cells.gap) / cell)), std::floor(least)};
}

/// Draws the middle of a picture into a rectangle that it fills, whatever the shapes are.
inline void add_filling_picture(Context& context, const std::shared_ptr<const Image>& picture, ImVec2 low,
                                ImVec2 high, float round) {
    const float shape = static_cast<float>(picture->width) / static_cast<float>(picture->height),
                wanted = (high.x - low.x) / std::max(1.0f, high.y - low.y);
    const float across = 0.5f * std::min(1.0f, wanted / shape), down = 0.5f * std::min(1.0f, shape / wanted);
    ImGui::GetWindowDrawList()->AddImageRounded(imgui_texture(context.textures.texture(picture)), low, high,
                                                {0.5f - across, 0.5f - down}, {0.5f + across, 0.5f + down},
                                                IM_COL32_WHITE, round);
}

}  // namespace gse::ui
