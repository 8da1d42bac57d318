// Prompt encoder and mask decoder of the Segment Anything model (Kirillov et al. 2023, appendix A). MobileSAM
// shares them.
#pragma once

#include <vector>

#include "engine/neural/sam/sam_image_encoder.h"

namespace gse::neural {

struct SamDecoderShape {
    std::int64_t width = 256;
    std::int64_t inner = 2048;  // of the transformer's perceptrons
    std::int64_t layers = 2, heads = 8;
    std::int64_t mask_channels = 16;  // of the mask given as a prompt, on its way
    std::int64_t mask_tokens = 4;     // one for a single mask, the others for three
    std::int64_t iou_layers = 3, iou_inner = 256;
    std::int64_t side = 64;  // of the embedding
    std::int64_t image_size = 1024;
};

/// Prompts of B masks, in the pixels of the encoder's picture.
struct SamPrompts {
    torch::Tensor points;  // [B,n,2] x, y; undefined = none
    torch::Tensor labels;  // [B,n] int64: 1 inside, 0 outside
    torch::Tensor boxes;   // [B,4]; undefined = none
    torch::Tensor mask;    // [B,1,4 side,4 side] logits; undefined = none
};

struct SamPromptEncoding {
    torch::Tensor sparse;  // [B,n,C]
    torch::Tensor dense;   // [B,C,side,side]
};

class SamPromptEncoderImpl : public torch::nn::Module {
public:
    SamPromptEncoderImpl(const SamDecoderShape& shape, const WeightOptions& options);
    SamPromptEncoding forward(const SamPrompts& prompts) const;
    /// [1,C,side,side]: where each place of the embedding is.
    torch::Tensor dense_positions() const;

private:
    torch::Tensor encode(const torch::Tensor& places) const;
    torch::Tensor encode_points(const SamPrompts& prompts) const;
    torch::Tensor encode_boxes(const torch::Tensor& boxes) const;
    torch::Tensor encode_mask(const torch::Tensor& mask) const;

    SamDecoderShape shape_;
    torch::Tensor frequencies_;
    std::vector<Embedding> kinds_;  // outside, inside, first and second corner
    Embedding not_a_point_{nullptr}, no_mask_{nullptr};
    Conv2d mask_first_{nullptr}, mask_second_{nullptr}, mask_third_{nullptr};
    ChannelNorm mask_first_norm_{nullptr}, mask_second_norm_{nullptr};
};
TORCH_MODULE(SamPromptEncoder);

struct SamMasks {
    torch::Tensor logits;  // [B,n,4 side,4 side]
    torch::Tensor iou;     // [B,n] what the model thinks of them
};

class SamTransformerImpl;
class SamPerceptronImpl;

class SamMaskDecoderImpl : public torch::nn::Module {
public:
    SamMaskDecoderImpl(const SamDecoderShape& shape, const WeightOptions& options);
    /// `embedding` [1,C,side,side]; three masks of an ambiguous prompt (`several`), or one.
    SamMasks forward(const torch::Tensor& embedding, const torch::Tensor& positions,
                     const SamPromptEncoding& prompts, bool several) const;

private:
    SamDecoderShape shape_;
    Embedding iou_token_{nullptr}, mask_tokens_{nullptr};
    std::shared_ptr<SamTransformerImpl> transformer_;
    torch::Tensor first_weight_, first_bias_, second_weight_, second_bias_;  // of the enlarging convolutions
    ChannelNorm enlarging_norm_{nullptr};
    std::vector<std::shared_ptr<SamPerceptronImpl>> hypernetworks_;
    std::shared_ptr<SamPerceptronImpl> iou_head_;
};
TORCH_MODULE(SamMaskDecoder);

}  // namespace gse::neural
