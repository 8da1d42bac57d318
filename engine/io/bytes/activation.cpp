// Ranges of values that tell sizes from logarithms and opacities from logits.
#include "engine/io/bytes/activation.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "engine/base/error.h"
#include "engine/io/bytes/encoding.h"
#include "engine/math/quantile.h"

namespace gse::io {
namespace {

// Logarithms that are all positive belong to splats of more than a unit; half of them below e units would be
// of nearly one size.
constexpr float LargestUsualSize = 1;
// The values of fewer splats lie in any range by chance.
constexpr std::size_t FewestRows = 5;

/// Range of the finite values.
struct ValueRange {
    float low = HUGE_VALF, high = -HUGE_VALF;

    explicit ValueRange(std::span<const float> values) {
        for (const float value : values)
            if (std::isfinite(value)) {
                low = std::min(low, value);
                high = std::max(high, value);
            }
    }
    bool within(float least, float most) const { return low >= least && high <= most && low <= high; }
};

float median(std::span<const float> values) {
    std::vector<float> finite;
    std::copy_if(values.begin(), values.end(), std::back_inserter(finite),
                 [](float value) { return std::isfinite(value); });
    return upper_median(finite);
}

/// Attributes that are not impossible as sizes and opacities.
ActivatedValues can_be_activated(const GaussianSpans& set) {
    return {ValueRange(set.log_scale).within(0, HUGE_VALF), ValueRange(set.opacity_logit).within(0, 1)};
}

}  // namespace

ActivatedValues looks_activated(const GaussianSpans& set) {
    ActivatedValues values = can_be_activated(set);
    if (!values.any() || set.size < FewestRows) return {};
    const ValueRange sizes(set.log_scale), opacities(set.opacity_logit);
    const bool small = values.sizes && sizes.high > 0 && median(set.log_scale) < LargestUsualSize;
    values.opacities = values.opacities && opacities.high > 0 && (small || opacities.low < opacities.high);
    values.sizes = small || (values.sizes && sizes.high > 0 && values.opacities);
    return values;
}

std::string activated_text(ActivatedValues values) {
    const char* what = values.sizes && values.opacities ? "the sizes and opacities"
                       : values.sizes                   ? "the sizes"
                                                        : "the opacities";
    const char* instead = values.sizes && values.opacities ? "logarithms and logits"
                          : values.sizes                   ? "logarithms"
                                                           : "logits";
    return std::string(what) + " look activated (not stored as " + instead +
           ") and are drawn as a fog; open the scene with --activated";
}

Scene with_raw_values(Scene scene) {
    const ActivatedValues values = can_be_activated(scene.gaussians.spans());
    if (!values.any())
        throw Error(ErrorCode::InvalidArgument,
                    "the scene has negative sizes and opacities outside of 0 to 1, so its values are not "
                    "activated",
                    "leave out --activated");
    const std::string hint = activated_text(looks_activated(scene.gaussians.spans()));
    GaussianData data = scene.gaussians.to_data();
    if (values.sizes)
        for (float& value : data.log_scale) value = static_cast<float>(std::log(static_cast<double>(value)));
    if (values.opacities)
        for (float& value : data.opacity_logit)
            if (!std::isnan(value)) value = logit_from_opacity(static_cast<double>(value));
    scene.gaussians = GaussianSet(std::move(data));
    std::erase(scene.info.warnings, hint);
    if (values.sizes != values.opacities)
        scene.info.warnings.push_back(values.sizes ? "the opacities are logits already and stay as they are"
                                                   : "the sizes are logarithms already and stay as they are");
    scene.info.activated = true;
    scene.info.looks_activated = false;
    return scene;
}

}  // namespace gse::io
