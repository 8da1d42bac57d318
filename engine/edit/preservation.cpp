// L1 and structural similarity with hand-written gradients, in double.
#include "engine/edit/preservation.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/check.h"

namespace gse::edit {
namespace {

constexpr int WindowRadius = 5;
constexpr double SsimC1 = 1e-4, SsimC2 = 9e-4;

std::array<double, 2 * WindowRadius + 1> make_window() {
    std::array<double, 2 * WindowRadius + 1> window{};
    double sum = 0;
    for (int i = -WindowRadius; i <= WindowRadius; ++i)
        sum += window[static_cast<std::size_t>(i + WindowRadius)] = std::exp(-i * i / (2 * 1.5 * 1.5));
    for (auto& weight : window) weight /= sum;
    return window;
}

/// One pass of the separable blur: `count` lines of `length` samples, `stride` apart.
void blur_lines(const std::vector<double>& from, std::vector<double>& to, std::array<int, 4> shape) {
    static const auto window = make_window();
    const auto [lines, length, line_stride, stride] = shape;
    for (int line = 0; line < lines; ++line)
        for (int i = 0; i < length; ++i) {
            const int first = std::max(-WindowRadius, -i), last = std::min(WindowRadius, length - 1 - i);
            double sum = 0;
            for (int k = first; k <= last; ++k)
                sum += window[static_cast<std::size_t>(k + WindowRadius)] *
                       from[static_cast<std::size_t>(line * line_stride + (i + k) * stride)];
            to[static_cast<std::size_t>(line * line_stride + i * stride)] = sum;
        }
}

}  // namespace

void ssim_blur(std::vector<double>& plane, std::vector<double>& scratch, int width, int height) {
    scratch.resize(plane.size());
    blur_lines(plane, scratch, {height, width, width, 1});
    blur_lines(scratch, plane, {width, height, 1, width});
}

double Preservation::add_gradient(const Image& rendered, const Image& original, const Mask& may_change, Image& gradient) {
    GSE_CHECK_EQ(rendered.data.size(), original.data.size());
    GSE_CHECK_EQ(rendered.data.size(), gradient.data.size());
    GSE_CHECK_EQ(may_change.data.size(), rendered.pixel_count());
    target_.resize(rendered.width, rendered.height, 3);
    const double count = static_cast<double>(rendered.data.size());
    const double l1_scale = weights_.multiplier * weights_.l1 / count;
    double loss = 0;
    for (std::size_t pixel = 0; pixel < rendered.pixel_count(); ++pixel)
        for (std::size_t i = pixel * 3; i < pixel * 3 + 3; ++i) {
            const bool free = may_change.data[pixel] != 0;
            target_.data[i] = free ? rendered.data[i] : original.data[i];
            const double difference = static_cast<double>(rendered.data[i]) - target_.data[i];
            loss += l1_scale * std::abs(difference);
            gradient.data[i] += static_cast<float>(difference > 0 ? l1_scale : difference < 0 ? -l1_scale : 0);
        }
    if (weights_.ssim > 0)
        for (int channel = 0; channel < 3; ++channel)
            ssim_gradient(rendered, channel, weights_.multiplier * weights_.ssim / count, gradient, loss);
    return loss;
}

void Preservation::ssim_gradient(const Image& rendered, int channel, double scale, Image& gradient, double& loss) {
    const std::size_t count = rendered.pixel_count();
    for (auto* plane : {&x_, &y_, &xx_, &yy_, &xy_}) plane->resize(count);
    const auto at = [channel](std::size_t pixel) { return pixel * 3 + static_cast<std::size_t>(channel); };
    for (std::size_t i = 0; i < count; ++i) {
        const double x = rendered.data[at(i)], y = target_.data[at(i)];
        x_[i] = x;
        y_[i] = y;
        xx_[i] = x * x;
        yy_[i] = y * y;
        xy_[i] = x * y;
    }
    for (auto* plane : {&x_, &y_, &xx_, &yy_, &xy_}) ssim_blur(*plane, scratch_, rendered.width, rendered.height);
    // From here x_, xx_, xy_ hold the derivative of the summed SSIM map by E[x], E[x^2] and E[xy].
    for (std::size_t i = 0; i < count; ++i) {
        const double mx = x_[i], my = y_[i];
        const double a1 = 2 * mx * my + SsimC1, a2 = 2 * (xy_[i] - mx * my) + SsimC2;
        const double b1 = mx * mx + my * my + SsimC1, b2 = xx_[i] - mx * mx + yy_[i] - my * my + SsimC2;
        const double value = a1 * a2 / (b1 * b2);
        loss += scale * (1 - value);
        const double by_xy = 2 * a1 / (b1 * b2), by_xx = -value / b2;
        x_[i] = 2 * my * a2 / (b1 * b2) - 2 * mx * value / b1 - my * by_xy - 2 * mx * by_xx;
        xx_[i] = by_xx;
        xy_[i] = by_xy;
    }
    for (auto* plane : {&x_, &xx_, &xy_}) ssim_blur(*plane, scratch_, rendered.width, rendered.height);
    for (std::size_t i = 0; i < count; ++i) {
        const double x = rendered.data[at(i)], y = target_.data[at(i)];
        gradient.data[at(i)] -= static_cast<float>(scale * (x_[i] + 2 * x * xx_[i] + y * xy_[i]));
    }
}

}  // namespace gse::edit
