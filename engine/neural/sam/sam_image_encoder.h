// Image encoders of the Segment Anything model (Kirillov et al. 2023). One is a vision transformer with
// windows and relative positions (Li et al. 2022, ViTDet), the other MobileSAM's TinyViT (Zhang et al. 2023).
#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "engine/neural/layers/layers.h"

namespace gse::neural {

/// Outputs of the layers on the way, for tests: [.., tokens or pixels, ..] under the reference's names.
using SamTrace = std::vector<std::pair<std::string, torch::Tensor>>;

class SamImageEncoderImpl : public torch::nn::Module {
public:
    /// Normalised pixels [B,3,S,S] -> embedding [B,C,S/16,S/16]; `trace` may be null.
    virtual torch::Tensor forward(const torch::Tensor& pixels, SamTrace* trace) const = 0;
};

/// Layer normalisation of the channels of [B,C,H,W].
class ChannelNormImpl : public torch::nn::Module {
public:
    ChannelNormImpl(std::int64_t channels, const WeightOptions& options);
    torch::Tensor forward(const torch::Tensor& x) const;

private:
    torch::Tensor weight_, bias_;
};
TORCH_MODULE(ChannelNorm);

/// 1x1 and 3x3 convolution, each with a norm: the last layers of both encoders.
class SamNeckImpl : public torch::nn::Module {
public:
    SamNeckImpl(std::int64_t in, std::int64_t out, const WeightOptions& options);
    torch::Tensor forward(torch::Tensor x, SamTrace* trace) const;

private:
    Conv2d reduce_{nullptr}, refine_{nullptr};
    ChannelNorm first_{nullptr}, second_{nullptr};
};
TORCH_MODULE(SamNeck);

struct SamVitShape {
    std::int64_t width = 768, heads = 12, inner = 3072, out = 256;
    std::int64_t patch = 16, side = 64;  // pixels; tokens along the side of the picture
    std::vector<std::int64_t> windows;   // of each block, in tokens; `side` = attention to everything
};
std::shared_ptr<SamImageEncoderImpl> make_sam_vit(const SamVitShape& shape, const WeightOptions& options);

struct TinyVitShape {
    std::array<std::int64_t, 4> widths{64, 128, 160, 320};
    std::array<std::int64_t, 4> depths{2, 2, 6, 2};
    std::array<std::int64_t, 4> heads{2, 4, 5, 10};
    std::array<std::int64_t, 4> windows{7, 7, 14, 7};  // the first has none
    std::int64_t convolution_inner = 256;              // of the first layer's blocks
    std::array<std::int64_t, 4> inner{0, 512, 640, 1280};
    std::int64_t out = 256;
    std::int64_t image_size = 1024;
};
std::shared_ptr<SamImageEncoderImpl> make_tiny_vit(const TinyVitShape& shape, const WeightOptions& options);

/// [B,H,W,C] -> windows [B * rows * columns, w, w, C] of a picture enlarged with zeros at the right and the
/// bottom, and back.
torch::Tensor to_windows(const torch::Tensor& x, std::int64_t window);
torch::Tensor from_windows(const torch::Tensor& windows, std::int64_t window, std::int64_t height,
                           std::int64_t width);

}  // namespace gse::neural
