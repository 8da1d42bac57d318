// L1 and structural similarity with hand-written gradients, on the part of the picture that differs.
#include "engine/edit/optimise/preservation_loss.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/check.h"

namespace gse::edit {
namespace {

constexpr int WindowRadius = 5;
constexpr float SsimC1 = 1e-4f, SsimC2 = 9e-4f;

std::array<float, 2 * WindowRadius + 1> make_window() {
    std::array<double, 2 * WindowRadius + 1> window{};
    double sum = 0;
    for (int i = -WindowRadius; i <= WindowRadius; ++i)
        sum += window[static_cast<std::size_t>(i + WindowRadius)] = std::exp(-i * i / (2 * 1.5 * 1.5));
    std::array<float, 2 * WindowRadius + 1> result{};
    for (std::size_t i = 0; i < result.size(); ++i) result[i] = static_cast<float>(window[i] / sum);
    return result;
}

/// Adds `weight` times `from` to `to`, `count` values: the inner loop of both passes of the blur.
void add_scaled(float* to, const float* from, float weight, int count) {
    for (int i = 0; i < count; ++i) to[i] += weight * from[i];
}

/// Blurs a plane [height,width] with the 11-tap Gaussian window of SSIM (sigma 1.5), zero padding; in place.
void blur(std::vector<float>& plane, std::vector<float>& scratch, int width, int height) {
    static const auto window = make_window();
    scratch.assign(plane.size(), 0.0f);
    for (int y = 0; y < height; ++y)
        for (int k = -WindowRadius; k <= WindowRadius; ++k) {
            const int begin = std::max(0, -k), end = std::min(width, width - k);
            const std::ptrdiff_t row = static_cast<std::ptrdiff_t>(y) * width;
            add_scaled(scratch.data() + row + begin, plane.data() + row + begin + k,
                       window[static_cast<std::size_t>(k + WindowRadius)], std::max(0, end - begin));
        }
    std::fill(plane.begin(), plane.end(), 0.0f);
    for (int y = 0; y < height; ++y)
        for (int k = -WindowRadius; k <= WindowRadius; ++k) {
            if (y + k < 0 || y + k >= height) continue;
            add_scaled(plane.data() + static_cast<std::ptrdiff_t>(y) * width,
                       scratch.data() + static_cast<std::ptrdiff_t>(y + k) * width,
                       window[static_cast<std::size_t>(k + WindowRadius)], width);
        }
}

}  // namespace

PreservationLoss::Box PreservationLoss::grown(const Box& box, int by, const Image& image) {
    return {std::max(0, box.x0 - by), std::max(0, box.y0 - by), std::min(image.width, box.x1 + by),
            std::min(image.height, box.y1 + by)};
}

double PreservationLoss::add_gradient(const Image& rendered, const Image& original, const Mask& may_change,
                                      Image& gradient, const Image* trust) {
    GSE_CHECK_EQ(rendered.data.size(), original.data.size());
    GSE_CHECK_EQ(rendered.data.size(), gradient.data.size());
    GSE_CHECK_EQ(may_change.data.size(), rendered.pixel_count());
    if (trust != nullptr) GSE_CHECK_EQ(trust->data.size(), rendered.pixel_count());
    double loss = 0;
    const Box changed = add_l1(rendered, original, may_change, trust, gradient, loss);
    const double scale = weights_.multiplier * weights_.ssim / static_cast<double>(rendered.data.size());
    if (scale > 0 && !changed.empty()) ssim_gradient(rendered, changed, scale, gradient, loss);
    return loss;
}

/// Fills target_ and returns the box of the pixels where it differs from the render.
PreservationLoss::Box PreservationLoss::add_l1(const Image& rendered, const Image& original,
                                               const Mask& may_change, const Image* trust, Image& gradient,
                                               double& loss) {
    target_.resize(rendered.width, rendered.height, 3);
    const double scale = weights_.multiplier * weights_.l1 / static_cast<double>(rendered.data.size());
    const auto push = static_cast<float>(scale);
    Box box{rendered.width, rendered.height, 0, 0};
    for (int y = 0; y < rendered.height; ++y)
        for (int x = 0; x < rendered.width; ++x) {
            const auto pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(rendered.width) +
                               static_cast<std::size_t>(x);
            const Image& source = may_change.data[pixel] != 0 ? rendered : original;
            const float share = trust != nullptr ? trust->data[pixel] : 1.0f;
            bool differs = false;
            for (std::size_t i = pixel * 3; i < pixel * 3 + 3; ++i) {
                target_.data[i] = source.data[i];
                const float difference = rendered.data[i] - target_.data[i];
                if (difference == 0) continue;
                differs = true;
                loss += scale * static_cast<double>(share) * std::abs(static_cast<double>(difference));
                gradient.data[i] += difference > 0 ? share * push : -share * push;
            }
            if (differs)
                box = {std::min(box.x0, x), std::min(box.y0, y), std::max(box.x1, x + 1),
                       std::max(box.y1, y + 1)};
        }
    return box;
}

void PreservationLoss::load(const Image& rendered, const Box& work, std::size_t channel) {
    const auto count = static_cast<std::size_t>(work.width()) * static_cast<std::size_t>(work.height());
    for (auto* plane : {&x_, &y_, &xx_, &yy_, &xy_}) plane->resize(count);
    std::size_t i = 0;
    for (int v = work.y0; v < work.y1; ++v)
        for (int u = work.x0; u < work.x1; ++u, ++i) {
            const float x = rendered.at(u, v, static_cast<int>(channel)),
                        y = target_.at(u, v, static_cast<int>(channel));
            x_[i] = x;
            y_[i] = y;
            xx_[i] = x * x;
            yy_[i] = y * y;
            xy_[i] = x * y;
        }
    for (auto* plane : {&x_, &y_, &xx_, &yy_, &xy_}) blur(*plane, scratch_, work.width(), work.height());
}

/// Turns x_, xx_, xy_ into the derivative of the summed SSIM map by E[x], E[x^2] and E[xy]. Returns sum(1 -
/// SSIM).
double PreservationLoss::differentiate(const Box& work, const Box& live) {
    double loss = 0;
    std::size_t i = 0;
    for (int v = work.y0; v < work.y1; ++v)
        for (int u = work.x0; u < work.x1; ++u, ++i) {
            if (u < live.x0 || u >= live.x1 || v < live.y0 || v >= live.y1) {
                // The pictures are equal in the whole window: SSIM is 1 and flat.
                x_[i] = xx_[i] = xy_[i] = 0;
                continue;
            }
            const float mx = x_[i], my = y_[i];
            const float a1 = 2 * mx * my + SsimC1, a2 = 2 * (xy_[i] - mx * my) + SsimC2;
            const float b1 = mx * mx + my * my + SsimC1, b2 = xx_[i] - mx * mx + yy_[i] - my * my + SsimC2;
            const float value = a1 * a2 / (b1 * b2);
            loss += 1 - static_cast<double>(value);
            const float by_xy = 2 * a1 / (b1 * b2), by_xx = -value / b2;
            x_[i] = 2 * my * a2 / (b1 * b2) - 2 * mx * value / b1 - my * by_xy - 2 * mx * by_xx;
            xx_[i] = by_xx;
            xy_[i] = by_xy;
        }
    return loss;
}

/// Skips the picture outside `changed`, where both pictures are equal. SSIM differs from 1 only within a
/// window of it, and its gradient from 0 only within two.
void PreservationLoss::ssim_gradient(const Image& rendered, const Box& changed, double scale, Image& gradient,
                                     double& loss) {
    const Box live = grown(changed, WindowRadius, rendered),
              work = grown(changed, 2 * WindowRadius, rendered);
    for (std::size_t channel = 0; channel < 3; ++channel) {
        load(rendered, work, channel);
        loss += scale * differentiate(work, live);
        for (auto* plane : {&x_, &xx_, &xy_}) blur(*plane, scratch_, work.width(), work.height());
        std::size_t i = 0;
        for (int v = work.y0; v < work.y1; ++v)
            for (int u = work.x0; u < work.x1; ++u, ++i) {
                const int c = static_cast<int>(channel);
                const float x = rendered.at(u, v, c), y = target_.at(u, v, c);
                gradient.at(u, v, c) -= static_cast<float>(scale) * (x_[i] + 2 * x * xx_[i] + y * xy_[i]);
            }
    }
}

}  // namespace gse::edit
