// One forward pass per view.
#include "engine/edit/search/view_renders.h"

#include <algorithm>
#include <utility>

#include "engine/base/error.h"

namespace gse::edit {

ViewRenders render_views(const GaussianSet& set, const std::vector<View>& views,
                         const raster::Settings& settings, const std::optional<StudioBackground>& ground,
                         raster::Rasterizer& rasterizer, const JobControl& job) {
    ViewRenders seen;
    raster::ForwardOutput output;
    for (const auto& view : views) {
        if (job.stop_requested()) throw Error(ErrorCode::Cancelled, "the search was stopped");
        rasterizer.forward(set.spans(), view.camera, settings, output);
        Image colour =
            ground ? before_plain(*ground, view.camera, output.colour, output.alpha, settings.background)
                   : output.colour;
        for (auto& value : colour.data) value = std::clamp(value, 0.0f, 1.0f);
        seen.renders.push_back(std::move(colour));
        Image depth = output.depth;
        for (std::size_t i = 0; i < depth.data.size(); ++i)
            depth.data[i] = output.alpha.data[i] > 0.5f ? depth.data[i] / output.alpha.data[i] : 0.0f;
        seen.depths.push_back(std::move(depth));
        if (ground) {
            Image shown = shown_of(*ground, view.camera);
            for (std::size_t i = 0; i < shown.data.size(); ++i) shown.data[i] *= 1 - output.alpha.data[i];
            seen.grounds.push_back(std::move(shown));
        }
        job.report("rendering views", static_cast<int>(seen.renders.size()), static_cast<int>(views.size()));
    }
    return seen;
}

}  // namespace gse::edit
