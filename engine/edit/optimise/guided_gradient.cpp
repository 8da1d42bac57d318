// Gate and calibration of a guidance's gradient (METHOD.md, Score distillation).
#include "engine/edit/optimise/guided_gradient.h"

#include <algorithm>
#include <cmath>

#include "engine/base/check.h"

namespace gse::edit {
namespace {

constexpr std::size_t CalibrationSteps = 20;

bool finite(const Image& image) {
    return std::all_of(image.data.begin(), image.data.end(),
                       [](float value) { return std::isfinite(value); });
}

}  // namespace

double norm(const Image& image) {
    double sum = 0;
    for (const float value : image.data) sum += static_cast<double>(value) * value;
    return std::sqrt(sum);
}

bool GuidedGradient::add(const GuidanceInput& input, const Image& rendered, const Mask& mask, Image& gradient,
                         IterationRecord& record) {
    GuidanceOutput guidance = guidance_->evaluate(input);
    std::erase_if(guidance.scalars, [](const auto& scalar) { return !std::isfinite(scalar.second); });
    record.guidance = std::move(guidance.scalars);
    GSE_CHECK_EQ(guidance.gradient.data.size(), gradient.data.size());
    if (!finite(guidance.gradient)) return false;
    gate(rendered, mask, guidance.gradient);
    record.guidance_norm = norm(guidance.gradient);
    const auto factor = static_cast<float>(calibrated_weight(record.guidance_norm, gradient.data.size()));
    for (std::size_t i = 0; i < gradient.data.size(); ++i)
        gradient.data[i] += factor * guidance.gradient.data[i];
    return true;
}

/// Takes away what would act outside the mask, and what would push a colour further beyond [0,1].
void GuidedGradient::gate(const Image& rendered, const Mask& mask, Image& gradient) const {
    for (std::size_t i = 0; i < gradient.data.size(); ++i) {
        const bool outside = settings_.gate_guidance && mask.data[i / 3] == 0;
        const bool beyond =
            (rendered.data[i] > 1 && gradient.data[i] < 0) || (rendered.data[i] < 0 && gradient.data[i] > 0);
        if (outside || beyond) gradient.data[i] = 0;
    }
}

/// Brings the gradient to the norm that the preservation loss has when every pixel differs. Neither drowns
/// the other then, whatever the model's scale is. The median of the first steps decides, then it is fixed.
double GuidedGradient::calibrated_weight(double norm, std::size_t values) {
    if (norms_.size() < CalibrationSteps && norm > 0) {
        norms_.push_back(norm);
        std::vector<double> sorted = norms_;
        std::sort(sorted.begin(), sorted.end());
        // Without preservation the default one is the measure: the anchors keep their relative strength.
        const double weight = settings_.preserve * settings_.l1;
        const double full = (weight > 0 ? weight : LoopSettings{}.preserve * LoopSettings{}.l1) /
                            std::sqrt(static_cast<double>(values));
        scale_ = settings_.guidance_weight * std::max(full, 1e-6) / sorted[sorted.size() / 2];
    }
    return scale_;
}

}  // namespace gse::edit
