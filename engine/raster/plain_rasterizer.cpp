// The plain double-precision functions behind the Rasterizer interface.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "engine/base/check.h"
#include "engine/raster/plain.h"

namespace gse::raster {
namespace {

/// The arrays of a GaussianSpans widened to double.
struct WideArrays {
    std::vector<double> position, log_scale, rotation, opacity_logit, sh;
    plain::Inputs inputs;

    void assign(const GaussianSpans& gaussians) {
        const auto widen = [](std::vector<double>& to, std::span<const float> from) {
            to.assign(from.begin(), from.end());
        };
        widen(position, gaussians.position);
        widen(log_scale, gaussians.log_scale);
        widen(rotation, gaussians.rotation);
        widen(opacity_logit, gaussians.opacity_logit);
        widen(sh, gaussians.sh);
        inputs = {gaussians.size, gaussians.sh_degree, position, log_scale, rotation, opacity_logit, sh};
    }
};

/// Narrows to float. Never makes an infinity of a finite number.
float narrow(double value) {
    constexpr double limit = std::numeric_limits<float>::max();
    return static_cast<float>(std::clamp(value, -limit, limit));
}

void resize_zero(Gradients& g, std::size_t rows, std::size_t sh_stride) {
    g.position.assign(rows * 3, 0.0f);
    g.log_scale.assign(rows * 3, 0.0f);
    g.rotation.assign(rows * 4, 0.0f);
    g.opacity_logit.assign(rows, 0.0f);
    g.sh.assign(rows * sh_stride, 0.0f);
    g.mean2d_norm.assign(rows, 0.0f);
    g.visible.assign(rows, 0);
}

class PlainRasterizer final : public Rasterizer {
public:
    void forward(const GaussianSpans& gaussians, const Camera& camera, const Settings& settings,
                 ForwardOutput& output) override {
        prepare(gaussians, camera, settings);
        plain::composite(list_, {camera_, settings_}, picture_);
        write(picture_.colour, 3, output.colour);
        write(picture_.alpha, 1, output.alpha);
        write(picture_.depth, 1, output.depth);
        output.blended = picture_.blended;
        output.pairs = picture_.pairs_tested;
        output.dropped_rows = list_.unusable_rows;
    }

    void backward(const Image& d_colour, const Image& d_alpha, std::size_t first_row,
                  Gradients& output) override {
        const plain::View view{camera_, settings_};
        GSE_CHECK(first_row <= arrays_.inputs.size);
        GSE_CHECK_EQ(d_colour.data.size(), pixel_count() * 3);
        plain::PictureGradient gradient;
        gradient.colour.assign(d_colour.data.begin(), d_colour.data.end());
        gradient.alpha.assign(d_alpha.data.begin(), d_alpha.data.end());
        gradient.alpha.resize(pixel_count(), 0.0);
        plain::composite_backward(list_, view, gradient, splat_gradients_);
        const std::size_t stride =
            static_cast<std::size_t>(sh_coefficient_count(arrays_.inputs.sh_degree)) * 3;
        resize_zero(output, arrays_.inputs.size - first_row, stride);
        plain::RowGradient row_gradient;
        for (std::size_t i = 0; i < list_.splats.size(); ++i) {
            const std::size_t row = list_.splats[i].row;
            const plain::SplatGradient& d = splat_gradients_[i];
            if (row < first_row || !d.blended) continue;
            plain::project_backward(arrays_.inputs, view, row, d, row_gradient);
            store(row_gradient, row - first_row, stride, output);
            output.visible[row - first_row] = 1;
            output.mean2d_norm[row - first_row] =
                narrow(std::hypot(d.x * 0.5 * camera_.width, d.y * 0.5 * camera_.height));
        }
    }

    void contributions(const GaussianSpans& gaussians, const Camera& camera, const Settings& settings,
                       const Image& mask, std::span<double> masked, std::span<double> total) override {
        GSE_CHECK_EQ(masked.size(), gaussians.size);
        GSE_CHECK_EQ(total.size(), gaussians.size);
        WideArrays arrays;
        plain::SplatList list;
        arrays.assign(gaussians);
        plain::project_all(arrays.inputs, {camera, with_depth_range(settings, gaussians, camera)}, list);
        std::vector<double> transmittance;
        plain::for_each_blended(list, camera, transmittance, [&](const plain::Pair& pair) {
            const double weight = pair.alpha * pair.before;
            const std::size_t row = list.splats[pair.splat].row;
            masked[row] += weight * static_cast<double>(mask.data[pair.pixel]);
            total[row] += weight;
        });
    }

    void forward_values(const GaussianSpans& gaussians, const Camera& camera, const Settings& settings,
                        std::span<const float> values, Image& output) override {
        GSE_CHECK_EQ(values.size(), gaussians.size);
        WideArrays arrays;
        plain::SplatList list;
        arrays.assign(gaussians);
        plain::project_all(arrays.inputs, {camera, with_depth_range(settings, gaussians, camera)}, list);
        std::vector<double> transmittance;
        std::vector<double> sums(static_cast<std::size_t>(camera.width) *
                                 static_cast<std::size_t>(camera.height));
        plain::for_each_blended(list, camera, transmittance, [&](const plain::Pair& pair) {
            sums[pair.pixel] +=
                pair.alpha * pair.before * static_cast<double>(values[list.splats[pair.splat].row]);
        });
        output.resize(camera.width, camera.height, 1);
        std::transform(sums.begin(), sums.end(), output.data.begin(), narrow);
    }

    std::string name() const override { return "plain"; }

private:
    void prepare(const GaussianSpans& gaussians, const Camera& camera, const Settings& settings) {
        arrays_.assign(gaussians);
        camera_ = camera;
        settings_ = with_depth_range(settings, gaussians, camera);
        plain::project_all(arrays_.inputs, {camera_, settings_}, list_);
    }

    void write(const std::vector<double>& from, int channels, Image& to) const {
        to.resize(camera_.width, camera_.height, channels);
        std::transform(from.begin(), from.end(), to.data.begin(), narrow);
    }

    static void store(const plain::RowGradient& from, std::size_t row, std::size_t sh_stride, Gradients& to) {
        std::transform(from.position.begin(), from.position.end(), &to.position[row * 3], narrow);
        std::transform(from.log_scale.begin(), from.log_scale.end(), &to.log_scale[row * 3], narrow);
        std::transform(from.rotation.begin(), from.rotation.end(), &to.rotation[row * 4], narrow);
        to.opacity_logit[row] = narrow(from.opacity_logit);
        for (std::size_t k = 0; k < sh_stride; ++k) to.sh[row * sh_stride + k] = narrow(from.sh[k]);
    }

    std::size_t pixel_count() const {
        return static_cast<std::size_t>(camera_.width) * static_cast<std::size_t>(camera_.height);
    }

    WideArrays arrays_;
    Camera camera_;
    Settings settings_;
    plain::SplatList list_;
    plain::Picture picture_;
    std::vector<plain::SplatGradient> splat_gradients_;
};

}  // namespace

std::unique_ptr<Rasterizer> make_plain_rasterizer() { return std::make_unique<PlainRasterizer>(); }

}  // namespace gse::raster
