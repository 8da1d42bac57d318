// The denoising network of Stable Diffusion 1.x and 2.x (UNet2DConditionModel), with capture of its
// cross-attention.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/neural/api/config.h"
#include "engine/neural/layers/blocks.h"

namespace gse::neural {

/// Selection of cross-attention maps of one forward pass. Maps are appended in execution order (down, mid,
/// up).
struct AttentionCapture {
    struct Map {
        std::string layer;  // "up_blocks.1.attentions.0.transformer_blocks.0.attn2"
        std::int64_t height = 0, width = 0;
        torch::Tensor probabilities;  // [B or B/2, heads, height*width, k] fp32
    };

    std::vector<std::int64_t> columns;   // token columns wanted, in this order; empty = all
    bool conditional_half_only = false;  // the batch is [negative; positive]: keep the second half
    bool keep_graph = false;             // gradients flow through the kept probabilities
    bool stop_after_last = false;        // the pass ends after the last wanted layer and predicts nothing
    // Above 0: keeps `affinities` of wanted layers of at most that side.
    std::int64_t self_attention_side = 0;
    /// Filter of layers; empty = all.
    std::function<bool(std::string_view layer, std::int64_t height, std::int64_t width)> wants;

    std::vector<Map> maps;
    /// Self-attention beside wanted cross-attention, mean over heads: probabilities
    /// [B,height*width,height*width], rows sum to 1.
    std::vector<Map> affinities;
};

/// Pictures of one scene that are denoised together (MVDream, Shi et al. 2023, sections 3.1 and 3.2).
/// Self-attention goes across all of their tokens, and each is told its camera. Maps of the latents' own size
/// stay apart: their scores would be most of a pass.
struct SceneViews {
    std::int64_t together = 1;   // consecutive rows of the batch that show one scene; divides the batch
    torch::Tensor cameras = {};  // [B,camera_dim]; undefined = nothing is known of them
    // [B,inpaint_channels,h,w], inpainting(); undefined = they are not shown what was there.
    torch::Tensor inpaint = {};
    /// Receives the outline of the new object where not null: logits [B,1,s h,s w] in fp32, s =
    /// outline_scale. One network predicts a picture and its transparency (Zhang and Agrawala 2024). Networks
    /// without outlines leave it alone.
    torch::Tensor* outline = nullptr;
};

/// Embedding [B,width] of guidance scales w [B] in fp32 (Luo et al. 2023, section 4.2); LCM's w is the scale
/// - 1. Sines, then cosines, of 1000 w f_i with f_i = 10000^(-i / (width/2 - 1)); an odd width ends in 0.
torch::Tensor guidance_embedding(const torch::Tensor& w, std::int64_t width);

class UNetImpl : public torch::nn::Module {
public:
    explicit UNetImpl(const UNetConfig& config, const WeightOptions& options = {});
    ~UNetImpl() override;

    /// sample [B,C,h,w]; timesteps [B] or a scalar, integer or float; words [B,T,D], the context.
    /// `time_condition` [B,time_cond_proj_dim] or undefined: guidance_embedding(), for networks that were
    /// distilled with it. Computes in the weights' type; returns the prediction [B,out,h,w] in the sample's,
    /// undefined where the capture stopped the pass.
    torch::Tensor forward(const torch::Tensor& sample, const torch::Tensor& timesteps,
                          const torch::Tensor& words, AttentionCapture* capture = nullptr,
                          const torch::Tensor& time_condition = {}, const SceneViews& views = {}) const;

    /// Sinusoid [B,C0] in fp32, and what the two linear layers make of it (for tests).
    torch::Tensor time_projection(const torch::Tensor& timesteps, std::int64_t batch) const;
    torch::Tensor time_embedding(const torch::Tensor& projection,
                                 const torch::Tensor& time_condition = {}) const;

    const UNetConfig& config() const { return config_; }

private:
    struct Level;
    struct Builder;
    void build_down(const Builder& build, std::vector<std::int64_t>& skips);
    void build_middle(const Builder& build);
    void build_up(const Builder& build, std::vector<std::int64_t>& skips);
    std::pair<std::size_t, std::size_t> last_wanted(const AttentionCapture& capture,
                                                    const std::vector<torch::Tensor>& skips) const;

    UNetConfig config_;
    Conv2d conv_in{nullptr}, conv_out{nullptr};
    Linear time_linear_1{nullptr}, time_linear_2{nullptr}, time_cond_proj{nullptr};
    Linear camera_linear_1{nullptr}, camera_linear_2{nullptr};  // where it is told of cameras
    Conv2d conv_inpaint{nullptr};                               // where it is shown what was there
    Conv2d conv_outline_1{nullptr}, conv_outline_2{nullptr};    // where it tells outlines
    GroupNorm conv_norm_out{nullptr};
    std::vector<Level> down_, up_;
    std::unique_ptr<Level> mid_;
};
TORCH_MODULE(UNet);

}  // namespace gse::neural
