// Views of a part that a model has no word for: it is shown the whole thing to draw anew.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/edit/interfaces/interfaces.h"
#include "engine/raster/rasterizer.h"
#include "engine/scene/gaussian_set.h"

namespace gse::edit {

/// Gives the model masks of the thing in place of those of its part. What it draws beside the part is left
/// out by whoever asked.
class WholeThing final : public MultiViewEditor {
public:
    /// `thing` [N]: its rows among those of `set`. Editor, rasterizer and set stay alive.
    WholeThing(MultiViewEditor& editor, raster::Rasterizer& rasterizer, const GaussianSet& set,
               const std::vector<std::uint8_t>& thing, const raster::Settings& settings);
    EditedViews edit(const std::vector<EditView>& views, const EditViewsRequest& request,
                     const JobControl& job) override;
    bool supports_appearance_editing() const override { return editor_.supports_appearance_editing(); }

private:
    MultiViewEditor& editor_;
    raster::Rasterizer& rasterizer_;
    const GaussianSet& set_;
    std::vector<float> thing_;  // [N] 0 or 1
    raster::Settings settings_;
};

}  // namespace gse::edit
