// Forward, backward, contributions and composited values by a device: uploads, launches, downloads.
#include "engine/raster/cuda/device_rasterizer.h"

#include <algorithm>

#include "engine/base/check.h"
#include "engine/raster/cuda/device_frame.h"

namespace gse::raster::cuda {
namespace {

/// The gradients' arrays in a device's memory.
struct DeviceGradients {
    explicit DeviceGradients(Device& device)
        : position(device), log_scale(device), rotation(device), opacity_logit(device), sh(device),
          mean2d_norm(device), visible(device) {}

    GradientArrays at_least(std::size_t rows, std::size_t sh_stride) {
        return {position.at_least(rows * 3),  log_scale.at_least(rows * 3),  rotation.at_least(rows * 4),
                opacity_logit.at_least(rows), sh.at_least(rows * sh_stride), mean2d_norm.at_least(rows),
                visible.at_least(rows)};
    }

    void download(std::size_t rows, std::size_t sh_stride, Gradients& to) const {
        const auto fetch = [](auto& values, const auto& from, std::size_t count) {
            values.resize(count);
            from.download({values.data(), count});
        };
        fetch(to.position, position, rows * 3);
        fetch(to.log_scale, log_scale, rows * 3);
        fetch(to.rotation, rotation, rows * 4);
        fetch(to.opacity_logit, opacity_logit, rows);
        fetch(to.sh, sh, rows * sh_stride);
        fetch(to.mean2d_norm, mean2d_norm, rows);
        fetch(to.visible, visible, rows);
    }

    DeviceArray<float> position, log_scale, rotation, opacity_logit, sh, mean2d_norm;
    DeviceArray<std::uint8_t> visible;
};

class DeviceRasterizer final : public Rasterizer {
public:
    DeviceRasterizer(std::unique_ptr<Device> device, std::string name)
        : device_(std::move(device)), name_(std::move(name)), frame_(*device_), side_frame_(*device_),
          d_colour_(*device_), d_alpha_(*device_), mask_(*device_), gradients_(*device_), weights_(*device_) {
    }

    void forward(const GaussianSpans& gaussians, const Camera& camera, const Settings& settings,
                 ForwardOutput& output) override {
        frame_.prepare(gaussians, camera, settings, {});
        frame_.blend(settings.background, 3);
        output.colour.resize(camera.width, camera.height, 3);
        output.alpha.resize(camera.width, camera.height, 1);
        output.depth.resize(camera.width, camera.height, 1);
        output.blended.resize(frame_.pixel_count());
        frame_.colour().download(output.colour.data);
        frame_.transmittance().download(output.alpha.data);
        frame_.depth().download(output.depth.data);
        frame_.blended().download(output.blended);
        for (float& value : output.alpha.data) value = 1.0f - value;
        output.pairs = frame_.pair_count();
        output.pairs_reached = output.block_pairs = 0;
        output.dropped_rows = frame_.unusable_rows();
    }

    void backward(const Image& d_colour, const Image& d_alpha, std::size_t first_row,
                  Gradients& output) override {
        GSE_CHECK(first_row <= frame_.row_count());
        GSE_CHECK_EQ(d_colour.data.size(), frame_.pixel_count() * 3);
        GSE_CHECK(d_alpha.data.empty() || d_alpha.data.size() == frame_.pixel_count());
        const std::size_t rows = frame_.row_count() - first_row, stride = frame_.source().sh_stride;
        BackwardArguments args{};
        args.lists = frame_.lists();
        args.table = frame_.assign_slots(first_row, SlotFloats);
        args.colour = frame_.colour().data();
        args.transmittance = frame_.transmittance().data();
        args.d_colour = d_colour_.upload(d_colour.data);
        args.d_alpha = d_alpha.data.empty() ? nullptr : d_alpha_.upload(d_alpha.data);
        if (rows > 0) device_->launch(kernels::backward, frame_.tile_count(), args);
        GradientArguments chain{};
        chain.source = frame_.source();
        chain.view = frame_.view();
        chain.records = frame_.records();
        chain.pair_counts = frame_.pair_counts();
        chain.slot_begins = args.table.slot_begins;
        chain.slots = args.table.slots;
        chain.first_row = static_cast<std::uint32_t>(first_row);
        chain.rows = static_cast<std::uint32_t>(frame_.row_count());
        chain.out = gradients_.at_least(rows, stride);
        device_->launch(kernels::gradient, blocks_for(rows), chain);
        gradients_.download(rows, stride, output);
    }

    void contributions(const GaussianSpans& gaussians, const Camera& camera, const Settings& settings,
                       const Image& mask, std::span<double> masked, std::span<double> total) override {
        GSE_CHECK_EQ(masked.size(), gaussians.size);
        GSE_CHECK_EQ(total.size(), gaussians.size);
        GSE_CHECK(mask.width == camera.width && mask.height == camera.height && mask.channels == 1);
        side_frame_.prepare(gaussians, camera, settings, {});
        ContributeArguments args{};
        args.lists = side_frame_.lists();
        args.table = side_frame_.assign_slots(0, WeightFloats);
        args.mask = mask_.upload(mask.data);
        device_->launch(kernels::contribute, side_frame_.tile_count(), args);
        const std::size_t rows = gaussians.size;
        double* sums = weights_.at_least(2 * rows);
        device_->launch(kernels::weigh, blocks_for(rows),
                        {side_frame_.pair_counts(), args.table.slot_begins, args.table.slots,
                         static_cast<std::uint32_t>(rows), sums, sums + rows});
        sums_.resize(2 * rows);
        weights_.download(sums_);
        for (std::size_t row = 0; row < rows; ++row) {
            total[row] += sums_[row];
            masked[row] += sums_[rows + row];
        }
    }

    void forward_values(const GaussianSpans& gaussians, const Camera& camera, const Settings& settings,
                        std::span<const float> values, Image& output) override {
        GSE_CHECK_EQ(values.size(), gaussians.size);
        side_frame_.prepare(gaussians, camera, settings, values);
        side_frame_.blend({0, 0, 0}, 1);
        output.resize(camera.width, camera.height, 1);
        side_frame_.colour().download(output.data);
    }

    std::string name() const override { return name_; }

private:
    std::unique_ptr<Device> device_;  // outlives the arrays
    std::string name_;
    DeviceFrame frame_;       // of the last forward(), for backward()
    DeviceFrame side_frame_;  // of contributions() and forward_values(), which leave forward's state alone
    DeviceArray<float> d_colour_, d_alpha_, mask_;
    DeviceGradients gradients_;
    DeviceArray<double> weights_;
    std::vector<double> sums_;
};

}  // namespace

std::unique_ptr<Rasterizer> make_device_rasterizer(std::unique_ptr<Device> device, std::string name) {
    return std::make_unique<DeviceRasterizer>(std::move(device), std::move(name));
}

}  // namespace gse::raster::cuda
