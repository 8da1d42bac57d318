// Segment Anything model (Kirillov et al. 2023) and MobileSAM (Zhang et al. 2023). A picture is encoded once;
// every set of clicks then costs a hundredth of that.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <variant>

#include "engine/neural/sam/sam_decoder.h"
#include "engine/neural/weights/weights.h"

namespace gse::neural {

/// Sizes of the networks, as the tensors of a file tell them; only the side of MobileSAM's pictures stands in
/// none.
struct SamShape {
    std::variant<SamVitShape, TinyVitShape> encoder;
    SamDecoderShape decoder;
    std::string name;  // "SAM ViT-B", "MobileSAM"
    std::int64_t image_size() const { return decoder.image_size; }
};

constexpr std::int64_t MobileSamImageSize = 1024;

/// Names of segment-anything, or those of transformers' SamModel; which, the keys tell.
LoadPlan sam_plan(const KeyShapes& shapes);
/// Throws Error (Model) when these are no SAM weights. `mobile_image_size`: of MobileSAM.
SamShape infer_sam_shape(const KeyShapes& shapes, const LoadPlan& plan, const std::filesystem::path& path,
                         std::int64_t mobile_image_size = MobileSamImageSize);

/// Pixels of the encoder's picture per pixel of a picture, along each side.
struct SamScale {
    double x = 1, y = 1;
};
/// The scale of a picture whose longer side becomes `image_size` pixels. Both sides are rounded to whole
/// pixels, so the two ratios differ (segment-anything, ResizeLongestSide.apply_coords).
SamScale sam_scale(std::int64_t image_size, std::int64_t height, std::int64_t width);

class SamModelImpl : public torch::nn::Module {
public:
    explicit SamModelImpl(const SamShape& shape, const WeightOptions& options = {});

    const SamShape& shape() const { return shape_; }
    /// Normalised pixels [1,3,S,S] of a picture [1,3,H,W] in [0,1]: longer side S, antialiased, zeros at the
    /// right and the bottom. Values lie in steps of 1/255, as the weights have seen them.
    torch::Tensor pixels(const torch::Tensor& picture) const;
    /// [1,C,S/16,S/16].
    torch::Tensor embed(const torch::Tensor& pixels, SamTrace* trace = nullptr) const {
        return encoder_->forward(pixels, trace);
    }
    SamPromptEncoding encode(const SamPrompts& prompts) const { return prompt_encoder_->forward(prompts); }
    torch::Tensor dense_positions() const { return prompt_encoder_->dense_positions(); }
    SamMasks masks(const torch::Tensor& embedding, const SamPromptEncoding& prompts, bool several) const {
        return mask_decoder_->forward(embedding, dense_positions(), prompts, several);
    }
    /// Logits [B,n,s,s] at the size of the picture [B,n,height,width].
    torch::Tensor enlarge(const torch::Tensor& logits, std::int64_t height, std::int64_t width) const;
    /// sam_scale() of the encoder's picture.
    SamScale scale(std::int64_t height, std::int64_t width) const {
        return sam_scale(shape_.image_size(), height, width);
    }

private:
    SamShape shape_;
    std::shared_ptr<SamImageEncoderImpl> encoder_;
    SamPromptEncoder prompt_encoder_{nullptr};
    SamMaskDecoder mask_decoder_{nullptr};
};
TORCH_MODULE(SamModel);

/// From a file (.safetensors, .pth, .pt) or a folder with model.safetensors; fp32. Throws Error (NotFound,
/// Malformed, Unsupported, Model).
SamModel load_sam(const std::filesystem::path& path, const torch::Device& device,
                  std::int64_t mobile_image_size = MobileSamImageSize);

}  // namespace gse::neural
