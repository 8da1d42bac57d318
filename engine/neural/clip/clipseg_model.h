// CLIPSeg (Lüddecke and Ecker 2022): which pixels show what a sentence names, from CLIP's layers and a small
// decoder.
#pragma once

#include <vector>

#include "engine/neural/clip/clip_model.h"

namespace gse::neural {

/// Names are those of transformers' CLIPSegForImageSegmentation.
class ClipSegDecoderImpl : public torch::nn::Module {
public:
    ClipSegDecoderImpl(const ClipSegConfig& config, const WeightOptions& options);
    /// Layers of the image encoder as `extract_layers` names them [B,N,D], and a condition [B,P] -> logits
    /// [B,H,W]; `layers` (may be null) gets the output of each of the decoder's.
    torch::Tensor forward(const std::vector<torch::Tensor>& activations, const torch::Tensor& condition,
                          std::vector<torch::Tensor>* layers) const;

private:
    struct Layer {
        Linear q{nullptr}, k{nullptr}, v{nullptr}, out{nullptr}, fc1{nullptr}, fc2{nullptr};
        LayerNorm first_norm{nullptr}, second_norm{nullptr};
    };
    struct Convolution {
        torch::Tensor weight, bias;
    };
    Layer make_layer(torch::nn::ModuleList& list, const WeightOptions& options);
    torch::Tensor run_layer(const Layer& layer, const torch::Tensor& x) const;
    void make_enlarging(const WeightOptions& options);
    torch::Tensor enlarge(const torch::Tensor& x) const;

    ClipSegConfig config_;
    std::vector<Linear> reduces_;
    std::vector<Layer> layers_;
    Linear film_mul_{nullptr}, film_add_{nullptr};
    std::vector<Convolution> enlarging_;  // the first is a plain convolution where there are three
};
TORCH_MODULE(ClipSegDecoder);

class ClipSegModelImpl : public torch::nn::Module {
public:
    explicit ClipSegModelImpl(const ClipSegConfig& config, const WeightOptions& options = {});

    /// Features that the decoder takes, of normalised pixels [B,3,H,W]; sides are multiples of the patch
    /// size.
    std::vector<torch::Tensor> activations(const torch::Tensor& pixels) const;
    /// Logits [B,H,W] of a condition [B,P]: the text encoder's text_embeds, or the image encoder's
    /// image_embeds.
    torch::Tensor logits(const std::vector<torch::Tensor>& activations, const torch::Tensor& condition,
                         std::vector<torch::Tensor>* layers = nullptr) const {
        return decoder_->forward(activations, condition, layers);
    }
    const ClipSegConfig& config() const { return config_; }

    ClipModel clip{nullptr};

private:
    ClipSegConfig config_;
    ClipSegDecoder decoder_{nullptr};
};
TORCH_MODULE(ClipSegModel);

LoadPlan clipseg_plan();

}  // namespace gse::neural
