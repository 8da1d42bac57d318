// Masks of the thing, rendered from its rows.
#include "engine/edit/target_views/strategies/whole_thing.h"

#include "engine/base/check.h"
#include "engine/localize/clusters.h"

namespace gse::edit {
namespace {

constexpr float ThingSeen = 0.5f;  // share of a pixel from which it shows the thing

}  // namespace

WholeThing::WholeThing(MultiViewEditor& editor, raster::Rasterizer& rasterizer, const GaussianSet& set,
                       const std::vector<std::uint8_t>& thing, const raster::Settings& settings)
    : editor_(editor), rasterizer_(rasterizer), set_(set), thing_(thing.begin(), thing.end()),
      settings_(settings) {
    GSE_CHECK_EQ(thing.size(), set.size());
}

EditedViews WholeThing::edit(const std::vector<EditView>& views, const EditViewsRequest& request,
                             const JobControl& job) {
    auto whole = views;
    Image seen;
    for (auto& view : whole) {
        rasterizer_.forward_values(set_.spans(), view.view.camera, settings_, thing_, seen);
        GSE_CHECK_EQ(seen.data.size(), view.mask.data.size());
        for (std::size_t i = 0; i < seen.data.size(); ++i)
            if (seen.data[i] > ThingSeen) view.mask.data[i] = 1;
    }
    return editor_.edit(whole, request, job);
}

}  // namespace gse::edit
