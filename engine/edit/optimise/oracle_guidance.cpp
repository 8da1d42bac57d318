// Mean squared error to the target's renders.
#include "engine/edit/optimise/oracle_guidance.h"

#include "engine/base/check.h"

namespace gse::edit {

OracleGuidance::OracleGuidance(const GaussianSet& target, const std::vector<View>& views,
                               const raster::Settings& settings, raster::Rasterizer& rasterizer) {
    raster::ForwardOutput output;
    for (const auto& view : views) {
        rasterizer.forward(target.spans(), view.camera, settings, output);
        targets_.push_back(output.colour);
    }
}

GuidanceOutput OracleGuidance::evaluate(const GuidanceInput& input) {
    const Image& target = targets_.at(input.view_index);
    GSE_CHECK_EQ(target.data.size(), input.rendered.data.size());
    GuidanceOutput result;
    result.gradient = Image(target.width, target.height, 3);
    const double scale = 1.0 / static_cast<double>(target.data.size());
    double loss = 0;
    for (std::size_t i = 0; i < target.data.size(); ++i) {
        const double difference = static_cast<double>(input.rendered.data[i]) - target.data[i];
        loss += scale * difference * difference;
        result.gradient.data[i] = static_cast<float>(2 * scale * difference);
    }
    result.scalars["loss"] = loss;
    return result;
}

}  // namespace gse::edit
