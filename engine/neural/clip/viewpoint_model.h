// From where a picture shows the thing in it: a small convolutional classifier of azimuths.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "engine/base/image.h"
#include "engine/neural/api/config.h"
#include "engine/neural/layers/blocks.h"

namespace gse::neural {

/// config.json of the folder "viewpoint".
struct ViewpointConfig {
    std::int64_t image_size = 64;
    // Sectors of the full turn; the first is centred on the front, the next lie to the left.
    std::int64_t sectors = 24;
    std::vector<std::int64_t> widths = {
        24, 48, 96, 128};  // channels; each level has half the pixels per side of the one before
    std::int64_t hidden = 160;
    std::int64_t groups = 8;

    /// Throws Error (Model, Malformed) naming the key that is wrong.
    static ViewpointConfig from_json(const Json& json, const std::filesystem::path& path);
};

/// Per level a 3x3 convolution with stride 2 and a residual block, then a hidden layer over all that is left.
class ViewpointModelImpl : public torch::nn::Module {
public:
    ViewpointModelImpl(const ViewpointConfig& config, const WeightOptions& options);
    /// [B,3,S,S] in [-1,1] to [B,sectors]: logarithms of the shares.
    torch::Tensor forward(const torch::Tensor& pictures) const;

private:
    std::vector<Conv2d> down_;
    std::vector<ResnetBlock> blocks_;
    GroupNorm norm_{nullptr};
    Linear hidden_{nullptr}, out_{nullptr};
};
TORCH_MODULE(ViewpointModel);

/// A folder with config.json and model.safetensors.
class ViewpointReader {
public:
    /// Throws Error (NotFound, Malformed, Model) with one sentence.
    ViewpointReader(const std::filesystem::path& folder, torch::Device device);
    /// [sectors] shares that sum to 1, of a picture [H,W,3] in [0,1]; of one that is not square the middle is
    /// seen.
    std::vector<float> shares(const Image& picture) const;

private:
    ViewpointConfig config_;
    torch::Device device_;
    ViewpointModel model_{nullptr};
};

}  // namespace gse::neural
