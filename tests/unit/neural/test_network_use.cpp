// The arithmetic that is counted, against figures worked out by hand from the published configurations.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>
#include <torch/library.h>
#include <torch/torch.h>

#include "engine/neural/api/network_use.h"
#include "engine/neural/diffusion/unet.h"
#include "engine/neural/diffusion/vae.h"

using namespace gse::neural;

namespace {

/// torch 1.13 leaves the shapes of some results without numbers to whoever needs them.
torch::Tensor convolved_shape(const torch::Tensor& input, const torch::Tensor& weight,
                              const c10::optional<torch::Tensor>&, at::IntArrayRef stride,
                              at::IntArrayRef padding, at::IntArrayRef dilation, bool, at::IntArrayRef,
                              std::int64_t) {
    std::vector<std::int64_t> sizes{input.size(0), weight.size(0)};
    for (std::size_t axis = 0; axis < 2; ++axis) {
        const auto at = static_cast<std::int64_t>(axis) + 2;
        sizes.push_back((input.size(at) + 2 * padding[axis] - dilation[axis] * (weight.size(at) - 1) - 1) /
                            stride[axis] +
                        1);
    }
    return torch::empty(sizes, input.options());
}

using Normed = std::tuple<torch::Tensor, torch::Tensor, torch::Tensor>;

Normed same_shape_by_groups(const torch::Tensor& input, const c10::optional<torch::Tensor>&,
                            const c10::optional<torch::Tensor>&, std::int64_t, std::int64_t, std::int64_t,
                            std::int64_t, double) {
    return {torch::empty_like(input), torch::empty_like(input), torch::empty_like(input)};
}

Normed same_shape_by_layer(const torch::Tensor& input, at::IntArrayRef, const c10::optional<torch::Tensor>&,
                           const c10::optional<torch::Tensor>&, double) {
    return {torch::empty_like(input), torch::empty_like(input), torch::empty_like(input)};
}

TORCH_LIBRARY_IMPL(aten, Meta, library) {
    library.impl("convolution_overrideable", convolved_shape);
    library.impl("native_group_norm", same_shape_by_groups);
    library.impl("native_layer_norm", same_shape_by_layer);
}

/// Networks without numbers: shapes go through them, and nothing is computed.
const WeightOptions& without_weights() {
    static const WeightOptions options{.device = torch::kMeta, .initialize = false};
    return options;
}

torch::Tensor shape_only(std::vector<std::int64_t> sizes) {
    return torch::empty(sizes, torch::TensorOptions().device(torch::kMeta));
}

template <class F> NetworkUse use_of(F&& pass) {
    const torch::NoGradGuard no_grad;
    const auto before = thread_use();
    pass();
    return thread_use() - before;
}

}  // namespace

DOCTEST_TEST_CASE("the passes of Stable Diffusion 1.5 cost what its configuration says") {
    constexpr double tolerance = 0.02;
    const UNet unet(UNetConfig{}, without_weights());
    const AutoencoderKl vae(VaeConfig{}, without_weights());
    const auto timestep = torch::full({1}, 500.0);
    struct Size {
        std::int64_t pixels;
        double unet, encoder, decoder;  // GFLOP, 2 per multiply-add
    };
    for (const Size& size :
         {Size{512, 803, 1117, 2515}, Size{384, 423, 620, 1406}, Size{256, 180, 273, 622}}) {
        DOCTEST_CAPTURE(size.pixels);
        const auto cells = size.pixels / 8;
        const auto redraw = use_of([&] {
            unet->forward(shape_only({1, 4, cells, cells}), timestep, shape_only({1, 77, 768}));
        });
        DOCTEST_CHECK(redraw.unet == 1);
        DOCTEST_CHECK(redraw.flop * 1e-9 == doctest::Approx(size.unet).epsilon(tolerance));
        const auto encode = use_of([&] {
            vae->encode_moments(shape_only({1, 3, size.pixels, size.pixels}));
        });
        DOCTEST_CHECK(encode.encoder == 1);
        DOCTEST_CHECK(encode.flop * 1e-9 == doctest::Approx(size.encoder).epsilon(tolerance));
        const auto decode = use_of([&] { vae->decode(shape_only({1, 4, cells, cells})); });
        DOCTEST_CHECK(decode.decoder == 1);
        DOCTEST_CHECK(decode.flop * 1e-9 == doctest::Approx(size.decoder).epsilon(tolerance));
    }
}
