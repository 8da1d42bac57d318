// SSIM and gradients inside a mask.
#include "engine/laboratory/eval/sharpness.h"

#include "engine/evaluate/metrics.h"
#include "engine/localize/clusters.h"

namespace gse::bench {

void SharpnessFigures::add(const Image& shown, const Image& truth, const Mask& outline) {
    const auto area = static_cast<double>(outline.count());
    if (area == 0) return;
    similar_ += area * evaluate::ssim(shown, truth, {&outline, true});
    pixels_ += area;
    const Mask within = localize::dilate(outline, -OutlineMarginPx);
    const evaluate::Region inner{&within, true};
    const auto weight = static_cast<double>(within.count());
    shown_energy_ += weight * evaluate::gradient_energy(shown, inner);
    true_energy_ += weight * evaluate::gradient_energy(truth, inner);
}

double SharpnessFigures::ssim() const { return pixels_ > 0 ? similar_ / pixels_ : 0; }

double SharpnessFigures::gradient_energy() const {
    return true_energy_ > 0 ? shown_energy_ / true_energy_ : 0;
}

}  // namespace gse::bench
