// Guidance with a known answer: pulls each view towards the render of a given target scene (METHOD.md, Oracle
// guidance).
#pragma once

#include <vector>

#include "engine/edit/interfaces/interfaces.h"
#include "engine/raster/rasterizer.h"

namespace gse::edit {

/// Weighted L2 to the target's renders. With the perfect denoiser of a diffusion model, SDS becomes this up
/// to a factor sqrt(abar (1 - abar)). The whole engine can be tested without any network.
class OracleGuidance : public Guidance {
public:
    /// Renders the target from every view at once.
    OracleGuidance(const GaussianSet& target, const std::vector<View>& views,
                   const raster::Settings& settings, raster::Rasterizer& rasterizer);
    GuidanceOutput evaluate(const GuidanceInput& input) override;

private:
    std::vector<Image> targets_;
};

}  // namespace gse::edit
