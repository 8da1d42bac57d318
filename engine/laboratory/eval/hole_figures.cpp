// Sums weighted by the pixels of a hole.
#include "engine/laboratory/eval/hole_figures.h"

#include <array>
#include <cmath>
#include <string>

#include "engine/evaluate/metrics.h"
#include "engine/localize/clusters.h"

namespace gse::bench {
namespace {

constexpr double RingPx = 8;  // around the hole, whose mean colour fills it

}  // namespace

Image mean_filled(const Image& picture, const Mask& hole) {
    const Mask wide = localize::dilate(hole, RingPx);
    std::array<double, 3> sum{};
    double count = 0;
    for (std::size_t p = 0; p < hole.data.size(); ++p) {
        if (wide.data[p] == 0 || hole.data[p] != 0) continue;
        for (std::size_t c = 0; c < 3; ++c) sum[c] += picture.data[p * 3 + c];
        count += 1;
    }
    Image filled = picture;
    for (std::size_t p = 0; p < hole.data.size() && count > 0; ++p)
        if (hole.data[p] != 0)
            for (std::size_t c = 0; c < 3; ++c) filled.data[p * 3 + c] = static_cast<float>(sum[c] / count);
    return filled;
}

void HoleFigures::Sums::add(const Image& shown, const Image& truth, const Mask& hole) {
    const auto area = static_cast<double>(hole.count());
    const evaluate::Region inside{&hole, true};
    squared += area * std::pow(10, -evaluate::psnr_db(shown, truth, inside) / 10);
    similar += area * evaluate::ssim(shown, truth, inside);
}

void HoleFigures::add(const Image& truth, const Image& deleted, const Image& healed, const Mask& hole) {
    all_ += static_cast<double>(hole.data.size());
    if (hole.count() == 0) return;
    pixels_ += static_cast<double>(hole.count());
    healed_.add(healed, truth, hole);
    deleted_.add(deleted, truth, hole);
    mean_.add(mean_filled(deleted, hole), truth, hole);
}

nlohmann::ordered_json HoleFigures::json() const {
    nlohmann::ordered_json json{{"hole_share", all_ > 0 ? pixels_ / all_ : 0}};
    const auto put = [&](const std::string& ending, const Sums& sums) {
        json["psnr_hole" + ending + "_db"] = nullptr;
        json["ssim_hole" + ending] = nullptr;
        if (pixels_ == 0) return;
        json["psnr_hole" + ending + "_db"] =
            sums.squared > 0 ? -10 * std::log10(sums.squared / pixels_) : evaluate::PsnrLimitDb;
        json["ssim_hole" + ending] = sums.similar / pixels_;
    };
    put("", healed_);
    put("_deleted", deleted_);
    put("_mean", mean_);
    return json;
}

}  // namespace gse::bench
