// Plain double-precision compositing and its derivative, and the Rasterizer made of it.
#include "engine/raster/plain.h"

#include <algorithm>
#include <cmath>

#include "engine/base/check.h"

namespace gse::raster::plain {
namespace {

// Relative distance to a cut below which float32 may decide otherwise (as the goldens mark their pixels).
constexpr double AlphaCutDoubt = 1e-3;
constexpr double AlphaLimitDoubt = 1e-4;
constexpr double TransmittanceDoubt = 2e-3;

bool near_to(double value, double cut, double doubt) { return std::abs(value - cut) <= doubt * cut; }

}  // namespace

void project_all(const Inputs& inputs, const View& view, SplatList& list) {
    list.splats.clear();
    list.unusable_rows = 0;
    Splat splat;
    for (std::size_t row = 0; row < inputs.size; ++row) {
        const Fate fate = project(inputs, row, view, splat);
        if (fate == Fate::Drawn) list.splats.push_back(splat);
        if (fate == Fate::Unusable) ++list.unusable_rows;
    }
    std::stable_sort(list.splats.begin(), list.splats.end(), [](const Splat& a, const Splat& b) {
        return static_cast<float>(a.depth) < static_cast<float>(b.depth);
    });
}

void composite(const SplatList& list, const View& view, Picture& picture) {
    const std::size_t pixels =
        static_cast<std::size_t>(view.camera.width) * static_cast<std::size_t>(view.camera.height);
    picture.colour.assign(pixels * 3, 0.0);
    picture.alpha.assign(pixels, 0.0);
    picture.depth.assign(pixels, 0.0);
    picture.blended.assign(pixels, 0);
    picture.ambiguous.assign(pixels, 0);
    picture.pairs_blended = 0;
    const auto visit = [&](const Pair& pair) {
        const Splat& splat = list.splats[pair.splat];
        const double weight = pair.alpha * pair.before;
        for (std::size_t channel = 0; channel < 3; ++channel)
            picture.colour[pair.pixel * 3 + channel] += weight * splat.colour[channel];
        picture.depth[pair.pixel] += weight * splat.depth;
        ++picture.blended[pair.pixel];
        ++picture.pairs_blended;
    };
    const auto watch = [&](const Decision& d) {
        if (near_to(d.unclamped_alpha, AlphaCut, AlphaCutDoubt) ||
            near_to(d.unclamped_alpha, AlphaLimit, AlphaLimitDoubt) ||
            near_to(d.after, TransmittanceCut, TransmittanceDoubt))
            picture.ambiguous[d.pixel] = 1;
    };
    picture.pairs_tested = walk_pairs(list, view.camera, picture.transmittance, visit, watch);
    for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
        const double rest = picture.transmittance[pixel];
        picture.alpha[pixel] = 1 - rest;
        for (std::size_t channel = 0; channel < 3; ++channel)
            picture.colour[pixel * 3 + channel] += rest * view.background[channel];
    }
}

void composite_backward(const SplatList& list, const View& view, const PictureGradient& gradient,
                        std::vector<SplatGradient>& result) {
    Picture picture;
    composite(list, view, picture);
    result.assign(list.splats.size(), {});
    // remaining[p]: gradient-weighted light of everything behind the pair under way, transmittance term
    // included.
    std::vector<double> remaining(picture.alpha.size());
    for (std::size_t pixel = 0; pixel < remaining.size(); ++pixel) {
        remaining[pixel] = -gradient.alpha[pixel] * picture.transmittance[pixel];
        for (std::size_t channel = 0; channel < 3; ++channel)
            remaining[pixel] += gradient.colour[pixel * 3 + channel] * picture.colour[pixel * 3 + channel];
    }
    for_each_blended(list, view.camera, picture.transmittance, [&](const Pair& pair) {
        const Splat& splat = list.splats[pair.splat];
        SplatGradient& d = result[pair.splat];
        const double weight = pair.alpha * pair.before;
        double light = 0;
        for (std::size_t channel = 0; channel < 3; ++channel) {
            light += splat.colour[channel] * gradient.colour[pair.pixel * 3 + channel];
            d.colour[channel] += weight * gradient.colour[pair.pixel * 3 + channel];
        }
        d.blended = true;
        remaining[pair.pixel] -= weight * light;
        if (pair.clamped) return;
        const double d_alpha = pair.before * light - remaining[pair.pixel] / (1 - pair.alpha);
        const double d_log = d_alpha * pair.alpha;  // = dL/d ln(opacity) = -dL/dsigma
        d.log_opacity += d_log;
        d.a -= 0.5 * pair.dx * pair.dx * d_log;
        d.b -= pair.dx * pair.dy * d_log;
        d.c -= 0.5 * pair.dy * pair.dy * d_log;
        d.x -= (splat.a * pair.dx + splat.b * pair.dy) * d_log;
        d.y -= (splat.b * pair.dx + splat.c * pair.dy) * d_log;
    });
}

}  // namespace gse::raster::plain
