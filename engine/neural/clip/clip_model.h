// The contrastive image-text model CLIP (transformers' CLIPModel): a vision transformer and the text encoder,
// each with a projection into one space.
#pragma once

#include "engine/neural/diffusion/text_encoder.h"
#include "engine/neural/weights/weights.h"

namespace gse::neural {

/// Output of the image encoder; N = 1 + patches, the class token first.
struct VisionEncoding {
    std::vector<torch::Tensor> hidden_states;  // [B,N,D]; [0] after pre_layrnorm, [i] output of layer i-1
    torch::Tensor pooled;                      // [B,D] class token after post_layernorm
    torch::Tensor image_embeds;                // [B,P]
};

class ClipVisionEncoderImpl : public torch::nn::Module {
public:
    ClipVisionEncoderImpl(const VisionEncoderConfig& config, std::int64_t projection_dim,
                          const WeightOptions& options = {});
    /// pixels [B,3,H,W], normalised, sides multiples of the patch size; other sizes than the trained one get
    /// bicubically resized positions.
    VisionEncoding forward(const torch::Tensor& pixels) const;
    const VisionEncoderConfig& config() const { return config_; }

private:
    torch::Tensor positions(std::int64_t rows, std::int64_t columns) const;

    VisionEncoderConfig config_;
    torch::Tensor class_embedding_, patch_weight_, position_weight_;
    std::vector<ClipLayer> layers_;
    LayerNorm pre_norm_{nullptr}, post_norm_{nullptr};
    Linear visual_projection_{nullptr};
};
TORCH_MODULE(ClipVisionEncoder);

class ClipModelImpl : public torch::nn::Module {
public:
    explicit ClipModelImpl(const ClipConfig& config, const WeightOptions& options = {});

    /// Unit vectors [B,P] of normalised pixels [B,3,H,W] and of token ids [B,T].
    torch::Tensor image_vectors(const torch::Tensor& pixels) const;
    torch::Tensor text_vectors(const torch::Tensor& ids) const;
    const ClipConfig& config() const { return config_; }

    ClipTextEncoder text{nullptr};
    ClipVisionEncoder vision{nullptr};
    torch::Tensor logit_scale;  // [] natural logarithm of what cosines are multiplied with in training

private:
    ClipConfig config_;
};
TORCH_MODULE(ClipModel);

/// transformers' names: our "text." and "vision." are not in the file, its position_ids are counters.
LoadPlan clip_plan();
std::string clip_key(const std::string& parameter);

/// Preprocessing of pictures for the image encoder.
struct ClipPreprocessing {
    std::int64_t size = 224;
    std::vector<double> mean = {0.48145466, 0.4578275, 0.40821073};  // OpenAI CLIP's
    std::vector<double> deviation = {0.26862954, 0.26130258, 0.27577711};

    /// The configuration's size; mean and deviation from preprocessor_config.json in `folder`, if there is
    /// one.
    static ClipPreprocessing read(const ClipConfig& config, const std::filesystem::path& folder);
    /// Normalised pixels [B,3,size,size] of pictures [B,3,H,W] in [0,1]: the middle square, resized
    /// bicubically (averaging over the covered area when it shrinks).
    torch::Tensor pixels(const torch::Tensor& pictures) const;
};

}  // namespace gse::neural
