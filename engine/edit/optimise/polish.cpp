// Two states, one set of pictures.
#include "engine/edit/optimise/polish.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/check.h"
#include "engine/base/log.h"

namespace gse::edit {

double held_out_error(const std::vector<HeldOutView>& views, const GaussianSpans& rows,
                      const raster::Settings& settings, raster::Rasterizer& rasterizer) {
    double sum = 0, values = 0;
    raster::ForwardOutput output;
    for (const auto& view : views) {
        rasterizer.forward(rows, view.camera, settings, output);
        GSE_CHECK_EQ(output.colour.data.size(), view.target.data.size());
        for (std::size_t i = 0; i < view.target.data.size(); ++i) {
            if (view.mask.data[i / 3] == 0) continue;
            sum += std::abs(std::clamp(output.colour.data[i], 0.0f, 1.0f) - view.target.data[i]);
            values += 1;
        }
    }
    return values > 0 ? sum / values : 0;
}

Polish::Polish(std::vector<HeldOutView> views, EditSnapshot before, const GaussianSpans& rows,
               const raster::Settings& settings, raster::Rasterizer& rasterizer)
    : views_(std::move(views)) {
    GSE_CHECK(!views_.empty());
    begin_anew(std::move(before), rows, settings, rasterizer);
}

void Polish::begin_anew(EditSnapshot before, const GaussianSpans& rows, const raster::Settings& settings,
                        raster::Rasterizer& rasterizer) {
    before_ = std::move(before);
    error_before_ = held_out_error(views_, rows, settings, rasterizer);
}

PolishOutcome Polish::judged(int steps, const GaussianSpans& rows, const raster::Settings& settings,
                             raster::Rasterizer& rasterizer) const {
    PolishOutcome outcome{steps, error_before_, held_out_error(views_, rows, settings, rasterizer), false};
    outcome.kept = steps > 0 && outcome.after < outcome.before;
    log::info(
        "polished in {} steps: {} views that were not redrawn differ from the model's pictures of them by "
        "{:.4f}, {:.4f} before; {}",
        steps, views_.size(), outcome.after, outcome.before, outcome.kept ? "kept" : "dropped again");
    return outcome;
}

}  // namespace gse::edit
