// The plain functions once per scene, every kernel against them.
#include "engine/laboratory/bench/raster/stability.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/random.h"
#include "engine/raster/plain.h"
#include "engine/raster/view_session.h"

namespace gse::bench {
namespace {

using Wide = std::vector<double>;

Image noise(int width, int height, int channels, std::uint64_t seed) {
    Image image(width, height, channels);
    Random random(seed);
    for (float& value : image.data) value = static_cast<float>(random.uniform(-1, 1));
    return image;
}

void blank(Image& image, const std::vector<std::uint8_t>& pixels) {
    const auto channels = static_cast<std::size_t>(image.channels);
    for (std::size_t i = 0; i < image.data.size(); ++i)
        if (pixels[i / channels] != 0) image.data[i] = 0;
}

Wide widened(const std::vector<float>& values) { return {values.begin(), values.end()}; }

/// Squares of differences and of what is expected, per row and of all.
struct Squares {
    double difference = 0, size = 0;
    /// The ratio of the lengths; of a gradient that is all zero, the difference itself.
    double relative(double least = 0) const {
        const double of = std::max(size, least);
        return std::sqrt(of > 0 ? difference / of : difference);
    }
};

Squares squares_of(const float* found, const double* expected, std::size_t count, double factor) {
    Squares sum;
    for (std::size_t i = 0; i < count; ++i) {
        const double difference = factor * (static_cast<double>(found[i]) - expected[i]),
                     size = factor * expected[i];
        sum.difference += difference * difference, sum.size += size * size;
    }
    return sum;
}

std::array<const LineFloats*, 6> tensors(const raster::Gradients& g) {
    return {&g.position, &g.log_scale, &g.rotation, &g.opacity_logit, &g.sh, &g.mean2d_norm};
}

bool all_finite(std::span<const float> values) {
    return std::all_of(values.begin(), values.end(), [](float value) { return std::isfinite(value); });
}

bool same(const raster::ForwardOutput& a, const raster::ForwardOutput& b) {
    return a.colour.data == b.colour.data && a.alpha.data == b.alpha.data && a.depth.data == b.depth.data &&
           a.blended == b.blended && a.dropped_rows == b.dropped_rows;
}

bool same(const raster::Gradients& a, const raster::Gradients& b) {
    const auto of_a = tensors(a), of_b = tensors(b);
    return std::equal(of_a.begin(), of_a.end(), of_b.begin(), [](auto* x, auto* y) { return *x == *y; }) &&
           a.visible == b.visible;
}

}  // namespace

StabilityTruth::StabilityTruth(const HostileScene& scene) : scene_(scene) {
    const GaussianData& data = scene.data;
    const auto position = widened(data.position), log_scale = widened(data.log_scale),
               rotation = widened(data.rotation), logit = widened(data.opacity_logit), sh = widened(data.sh);
    const raster::plain::Inputs inputs{data.size(), data.sh_degree, position, log_scale, rotation, logit, sh};
    const raster::Settings settings = raster::with_depth_range(scene.settings, spans(data), scene.camera);
    const raster::plain::View view{scene.camera, settings};
    raster::plain::SplatList list;
    raster::plain::Picture picture;
    raster::plain::project_all(inputs, view, list);
    raster::plain::composite(list, view, picture);
    for (const auto& splat : list.splats) {
        for (const double channel : splat.colour) brightest_ = std::max(brightest_, channel);
        deepest_ = std::max(deepest_, splat.depth);
    }
    d_colour_ = noise(scene.camera.width, scene.camera.height, 3, 1);
    d_alpha_ = noise(scene.camera.width, scene.camera.height, 1, 2);
    blank(d_colour_, picture.ambiguous);
    blank(d_alpha_, picture.ambiguous);
    std::vector<raster::plain::SplatGradient> splat_gradients;
    raster::plain::composite_backward(list, view, {widened(d_colour_.data), widened(d_alpha_.data)},
                                      splat_gradients);
    strides_ = {3, 3, 4, 1, data.sh_stride(), 1};
    for (std::size_t k = 0; k < strides_.size(); ++k) gradients_[k].assign(data.size() * strides_[k], 0.0);
    for (std::size_t row = 0; row < data.size(); ++row) {
        double sum = 0;
        for (std::size_t i = row * 4; i < row * 4 + 4; ++i) sum += rotation[i] * rotation[i];
        turn_.push_back(std::sqrt(sum));
    }
    raster::plain::RowGradient g;
    for (std::size_t i = 0; i < list.splats.size(); ++i) {
        const auto& d = splat_gradients[i];
        const std::size_t row = list.splats[i].row;
        if (!d.blended) continue;
        raster::plain::project_backward(inputs, view, row, d, g);
        const auto put = [&](std::size_t k, const double* values) {
            std::copy_n(values, strides_[k], &gradients_[k][row * strides_[k]]);
        };
        const double screen = std::hypot(d.x * 0.5 * scene.camera.width, d.y * 0.5 * scene.camera.height);
        put(0, g.position.data()), put(1, g.log_scale.data()), put(2, g.rotation.data()),
            put(3, &g.opacity_logit);
        put(4, g.sh.data()), put(5, &screen);
    }
    colour_ = std::move(picture.colour), alpha_ = std::move(picture.alpha), depth_ = std::move(picture.depth);
    blended_ = std::move(picture.blended), unclear_ = std::move(picture.ambiguous);
}

double StabilityTruth::clear_share() const {
    return static_cast<double>(std::count(unclear_.begin(), unclear_.end(), 0)) /
           static_cast<double>(unclear_.size());
}

KernelStability::KernelStability(const std::string& kernels)
    : KernelStability(kernels, [&](ThreadPool& pool) { return raster::make_rasterizer_of(kernels, pool); }) {}

KernelStability::KernelStability(std::string name,
                                 const std::function<std::unique_ptr<raster::Rasterizer>(ThreadPool&)>& make)
    : kernels_(std::move(name)), single_(make(one_)), threaded_(make(three_)) {}

Disagreement KernelStability::measure(const StabilityTruth& truth) {
    const HostileScene& scene = truth.scene_;
    const auto rows = spans(scene.data);
    Disagreement result;
    single_->forward(rows, scene.camera, scene.settings, picture_);
    single_->backward(truth.d_colour_, truth.d_alpha_, 0, gradients_);
    result.finite = all_finite(picture_.colour.data) && all_finite(picture_.alpha.data) &&
                    all_finite(picture_.depth.data);
    for (std::size_t i = 0; i < truth.unclear_.size(); ++i) {
        double worst = std::abs(static_cast<double>(picture_.alpha.data[i]) - truth.alpha_[i]);
        for (std::size_t c = i * 3; c < i * 3 + 3; ++c)
            worst =
                std::max(worst, std::abs(static_cast<double>(picture_.colour.data[c]) - truth.colour_[c]) /
                                    truth.brightest_);
        const double depth = std::abs(static_cast<double>(picture_.depth.data[i]) - truth.depth_[i]);
        if (depth > 0) worst = std::max(worst, depth / truth.deepest_);
        const bool clear = truth.unclear_[i] == 0;
        double& largest = clear ? result.picture : result.unclear_picture;
        largest = std::max(largest, worst);
        if (clear && picture_.blended[i] != truth.blended_[i]) ++result.miscounted;
    }
    compare_gradients(truth, result);
    threaded_->forward(rows, scene.camera, scene.settings, other_picture_);
    threaded_->backward(truth.d_colour_, truth.d_alpha_, 0, other_gradients_);
    result.same_bits =
        same(picture_, other_picture_) && same(gradients_, other_gradients_) && same_in_session(truth);
    return result;
}

void KernelStability::compare_gradients(const StabilityTruth& truth, Disagreement& result) const {
    constexpr double LeastOfLargest = 1e-3;
    const auto found = tensors(gradients_);
    std::vector<Squares> rows(truth.turn_.size());
    for (std::size_t k = 0; k < found.size(); ++k) {
        result.finite = result.finite && all_finite(*found[k]);
        const std::size_t stride = truth.strides_[k];
        Squares all;
        double largest = 0;
        for (std::size_t row = 0; row < rows.size(); ++row) {
            rows[row] = squares_of(found[k]->data() + row * stride, truth.gradients_[k].data() + row * stride,
                                   stride, k == 2 ? truth.turn_[row] : 1.0);
            all.difference += rows[row].difference, all.size += rows[row].size;
            largest = std::max(largest, rows[row].size);
        }
        const double error = all.relative();
        if (result.tensor.empty() || error > result.gradient)
            result.gradient = error, result.tensor = GradientNames[k];
        for (const auto& row : rows)
            result.row = std::max(result.row, row.relative(LeastOfLargest * LeastOfLargest * largest));
    }
}

/// The last quarter of the rows change: first they are elsewhere, then where they belong.
bool KernelStability::same_in_session(const StabilityTruth& truth) {
    constexpr std::size_t Ample = std::size_t{256} << 20;
    const HostileScene& scene = truth.scene_;
    const std::size_t first = scene.data.size() - scene.data.size() / 4;
    GaussianData moved = scene.data;
    Random random(7);
    for (std::size_t i = first * 3; i < moved.position.size(); ++i)
        moved.position[i] *= 1 + static_cast<float>(0.1 * random.normal());
    const auto session = threaded_->view_session(1, Ample);
    session->forward(0, spans(moved), first, scene.camera, scene.settings, other_picture_);
    session->forward(0, spans(scene.data), first, scene.camera, scene.settings, other_picture_);
    session->backward(truth.d_colour_, truth.d_alpha_, other_gradients_);
    if (!same(picture_, other_picture_)) return false;
    single_->backward(truth.d_colour_, truth.d_alpha_, first, gradients_);
    return same(gradients_, other_gradients_);
}

}  // namespace gse::bench
