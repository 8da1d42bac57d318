// UNet: construction with the reference's names, time embedding, forward pass.
#include "engine/neural/diffusion/unet.h"

#include <cmath>

#include "engine/base/check.h"
#include "engine/neural/api/network_use.h"
#include "engine/neural/diffusion/transformer.h"

namespace gse::neural {

torch::Tensor guidance_embedding(const torch::Tensor& w, std::int64_t width) {
    const auto half = width / 2;
    const auto options = torch::TensorOptions().dtype(torch::kFloat32).device(w.device());
    const auto frequency =
        (torch::arange(half, options) * (-std::log(10000.0) / static_cast<double>(half - 1))).exp();
    const auto angle = (w.to(torch::kFloat32) * 1000.0).reshape({-1, 1}) * frequency;
    std::vector<torch::Tensor> parts{angle.sin(), angle.cos()};
    if (width % 2 == 1) parts.push_back(torch::zeros({w.numel(), 1}, options));
    return torch::cat(parts, 1);
}

/// One resolution of the network (or the middle).
struct UNetImpl::Level {
    std::vector<ResnetBlock> resnets;
    std::vector<SpatialTransformer> attentions;  // empty for a level without cross-attention
    Downsample downsampler{nullptr};
    Upsample upsampler{nullptr};
};

/// Makes the pieces with the shapes the configuration asks for.
struct UNetImpl::Builder {
    const UNetConfig& config;
    const WeightOptions& options;

    std::int64_t time_width() const { return config.block_out_channels.front() * 4; }

    ResnetBlock resnet(std::int64_t in, std::int64_t out) const {
        return ResnetBlock(ResnetShape{in, out, config.norm_num_groups, config.norm_eps, time_width()},
                           options);
    }
    SpatialTransformer attention(std::int64_t channels, std::int64_t heads, const std::string& name) const {
        const TransformerShape shape{channels,
                                     heads,
                                     config.cross_attention_dim,
                                     config.norm_num_groups,
                                     config.use_linear_projection,
                                     config.upcast_attention};
        SpatialTransformer module(shape, options);
        module->layer_name = name;
        return module;
    }
};

UNetImpl::UNetImpl(const UNetConfig& config, const WeightOptions& options) : config_(config) {
    const Builder build{config_, options};
    const auto& widths = config_.block_out_channels;
    conv_in = register_module("conv_in", Conv2d(Conv2dImpl::Shape{config_.in_channels, widths[0]}, options));
    auto time = std::make_shared<torch::nn::Module>();
    time_linear_1 =
        time->register_module("linear_1", Linear(LinearImpl::Shape{widths[0], build.time_width()}, options));
    time_linear_2 = time->register_module(
        "linear_2", Linear(LinearImpl::Shape{build.time_width(), build.time_width()}, options));
    if (config_.time_cond_proj_dim > 0)
        time_cond_proj = time->register_module(
            "cond_proj", Linear(LinearImpl::Shape{config_.time_cond_proj_dim, widths[0], false}, options));
    register_module("time_embedding", time);
    if (config_.camera_dim > 0) {
        auto camera = std::make_shared<torch::nn::Module>();
        camera_linear_1 = camera->register_module(
            "linear_1", Linear(LinearImpl::Shape{config_.camera_dim, build.time_width()}, options));
        camera_linear_2 = camera->register_module(
            "linear_2", Linear(LinearImpl::Shape{build.time_width(), build.time_width()}, options));
        register_module("camera_embedding", camera);
    }
    if (config_.inpaint_channels > 0)
        conv_inpaint = register_module(
            "conv_inpaint", Conv2d(Conv2dImpl::Shape{config_.inpaint_channels, widths[0]}, options));

    std::vector<std::int64_t> skips = {widths[0]};  // channels of the stored activations
    build_down(build, skips);
    build_middle(build);
    build_up(build, skips);
    conv_norm_out = register_module("conv_norm_out",
                                    GroupNorm(widths[0], config_.norm_num_groups, config_.norm_eps, options));
    conv_out =
        register_module("conv_out", Conv2d(Conv2dImpl::Shape{widths[0], config_.out_channels}, options));
    if (config_.outline_scale > 0) {
        auto outline = std::make_shared<torch::nn::Module>();
        conv_outline_1 =
            outline->register_module("conv_1", Conv2d(Conv2dImpl::Shape{widths[0], widths[0]}, options));
        conv_outline_2 = outline->register_module(
            "conv_2",
            Conv2d(Conv2dImpl::Shape{widths[0], config_.outline_scale * config_.outline_scale}, options));
        register_module("outline", outline);
    }
}

void UNetImpl::build_down(const Builder& build, std::vector<std::int64_t>& skips) {
    const auto& widths = config_.block_out_channels;
    torch::nn::ModuleList downs;
    for (std::size_t i = 0; i < widths.size(); ++i) {
        auto block = std::make_shared<torch::nn::Module>();
        Level level;
        for (std::int64_t j = 0; j < config_.layers_per_block; ++j) {
            level.resnets.push_back(build.resnet(skips.back(), widths[i]));
            if (config_.down_block_types[i] == "CrossAttnDownBlock2D")
                level.attentions.push_back(
                    build.attention(widths[i], config_.heads[i],
                                    "down_blocks." + std::to_string(i) + ".attentions." + std::to_string(j)));
            skips.push_back(widths[i]);
        }
        register_list(*block, "resnets", level.resnets);
        if (!level.attentions.empty()) register_list(*block, "attentions", level.attentions);
        if (i + 1 < widths.size()) {
            level.downsampler = Downsample(widths[i], false, config_.downsample_padding, build.options);
            register_list(*block, "downsamplers", std::vector{level.downsampler});
            skips.push_back(widths[i]);
        }
        downs->push_back(block);
        down_.push_back(std::move(level));
    }
    register_module("down_blocks", downs);
}

void UNetImpl::build_middle(const Builder& build) {
    const auto width = config_.block_out_channels.back();
    mid_ = std::make_unique<Level>();
    auto mid = std::make_shared<torch::nn::Module>();
    mid_->resnets =
        register_list(*mid, "resnets", std::vector{build.resnet(width, width), build.resnet(width, width)});
    mid_->attentions =
        register_list(*mid, "attentions",
                      std::vector{build.attention(width, config_.heads.back(), "mid_block.attentions.0")});
    register_module("mid_block", mid);
}

void UNetImpl::build_up(const Builder& build, std::vector<std::int64_t>& skips) {
    const auto& widths = config_.block_out_channels;
    const auto levels = widths.size();
    torch::nn::ModuleList ups;
    auto channels = widths.back();
    for (std::size_t i = 0; i < levels; ++i) {
        auto block = std::make_shared<torch::nn::Module>();
        const auto width = widths[levels - 1 - i];
        Level level;
        for (std::int64_t j = 0; j <= config_.layers_per_block; ++j) {
            level.resnets.push_back(build.resnet(channels + skips.back(), width));
            skips.pop_back();
            channels = width;
            if (config_.up_block_types[i] == "CrossAttnUpBlock2D")
                level.attentions.push_back(
                    build.attention(width, config_.heads[levels - 1 - i],
                                    "up_blocks." + std::to_string(i) + ".attentions." + std::to_string(j)));
        }
        register_list(*block, "resnets", level.resnets);
        if (!level.attentions.empty()) register_list(*block, "attentions", level.attentions);
        if (i + 1 < levels) {
            level.upsampler = Upsample(width, build.options);
            register_list(*block, "upsamplers", std::vector{level.upsampler});
        }
        ups->push_back(block);
        up_.push_back(std::move(level));
    }
    register_module("up_blocks", ups);
}

UNetImpl::~UNetImpl() = default;

torch::Tensor UNetImpl::time_projection(const torch::Tensor& timesteps, std::int64_t batch) const {
    const auto half = config_.block_out_channels.front() / 2;
    auto t = timesteps.to(conv_in->weight.device(), torch::kFloat32).reshape({-1, 1});
    if (t.size(0) != batch) t = t.expand({batch, 1});
    auto frequency = torch::arange(half, torch::TensorOptions().dtype(torch::kFloat32).device(t.device()));
    frequency = (frequency * -std::log(10000.0) / (static_cast<double>(half) - config_.freq_shift)).exp();
    const auto angle = t * frequency;
    return config_.flip_sin_to_cos ? torch::cat({angle.cos(), angle.sin()}, 1)
                                   : torch::cat({angle.sin(), angle.cos()}, 1);
}

torch::Tensor UNetImpl::time_embedding(const torch::Tensor& projection,
                                       const torch::Tensor& time_condition) const {
    auto sum = projection;
    if (time_condition.defined()) {
        GSE_CHECK(!time_cond_proj.is_empty());
        sum = sum + time_cond_proj->forward(time_condition.to(projection.device(), projection.scalar_type()));
    }
    return time_linear_2->forward(apply_silu(time_linear_1->forward(sum)));
}

/// Level and place of the last wanted layer on the way up; level 0, place 0 where none is wanted there.
std::pair<std::size_t, std::size_t> UNetImpl::last_wanted(const AttentionCapture& capture,
                                                          const std::vector<torch::Tensor>& skips) const {
    std::pair<std::size_t, std::size_t> last{0, 0};
    std::size_t left = skips.size();
    for (std::size_t i = 0; i < up_.size(); ++i)
        for (std::size_t j = 0; j < up_[i].resnets.size(); ++j) {
            const auto& skip = skips[--left];
            if (up_[i].attentions.empty()) continue;
            if (!capture.wants ||
                capture.wants(up_[i].attentions[j]->capture_name(), skip.size(2), skip.size(3)))
                last = {i, j};
        }
    return last;
}

torch::Tensor UNetImpl::forward(const torch::Tensor& sample, const torch::Tensor& timesteps,
                                const torch::Tensor& words, AttentionCapture* capture,
                                const torch::Tensor& time_condition, const SceneViews& views) const {
    GSE_CHECK_EQ(sample.dim(), std::int64_t{4});
    GSE_CHECK_EQ(sample.size(0) % views.together, std::int64_t{0});
    const auto type = conv_in->weight.scalar_type();
    const auto context = words.to(type);
    thread_use().unet += static_cast<std::uint64_t>(sample.size(0));
    auto embedded = time_embedding(time_projection(timesteps, sample.size(0)).to(type), time_condition);
    if (views.cameras.defined() && !camera_linear_1.is_empty())
        embedded =
            embedded + camera_linear_2->forward(apply_silu(camera_linear_1->forward(views.cameras.to(type))));
    const auto time = apply_silu(embedded);
    const auto together = [&](const torch::Tensor& map) {
        return map.size(2) < sample.size(2) ? views.together : 1;
    };
    auto x = conv_in->forward(sample.to(type).contiguous(torch::MemoryFormat::ChannelsLast));
    if (views.inpaint.defined() && !conv_inpaint.is_empty())
        x = x + conv_inpaint->forward(views.inpaint.to(type).contiguous(torch::MemoryFormat::ChannelsLast));
    std::vector<torch::Tensor> skips = {x};
    for (const auto& level : down_) {
        for (std::size_t j = 0; j < level.resnets.size(); ++j) {
            x = level.resnets[j]->forward(x, time);
            if (!level.attentions.empty()) x = level.attentions[j]->forward(x, context, capture, together(x));
            skips.push_back(x);
        }
        if (level.downsampler.is_empty()) continue;
        x = level.downsampler->forward(x);
        skips.push_back(x);
    }
    x = mid_->resnets[0]->forward(x, time);
    x = mid_->attentions[0]->forward(x, context, capture, together(x));
    x = mid_->resnets[1]->forward(x, time);
    const bool stops = capture != nullptr && capture->stop_after_last;
    const auto last = stops ? last_wanted(*capture, skips) : std::pair<std::size_t, std::size_t>{};
    for (std::size_t i = 0; i < up_.size(); ++i) {
        const auto& level = up_[i];
        for (std::size_t j = 0; j < level.resnets.size(); ++j) {
            x = level.resnets[j]->forward(torch::cat({x, skips.back()}, 1), time);
            skips.pop_back();
            if (!level.attentions.empty()) x = level.attentions[j]->forward(x, context, capture, together(x));
            if (stops && last == std::pair{i, j}) return {};
        }
        // To the next skip's size: latents need not be a multiple of 2^levels.
        if (!level.upsampler.is_empty())
            x = level.upsampler->forward(x, skips.back().size(2), skips.back().size(3));
    }
    x = conv_norm_out->forward_silu(x);
    if (views.outline != nullptr && config_.outline_scale > 0) {
        const auto parts = conv_outline_2->forward(apply_silu(conv_outline_1->forward(x)));
        *views.outline = torch::pixel_shuffle(parts.to(torch::kFloat), config_.outline_scale);
    }
    return conv_out->forward(x).to(sample.scalar_type());
}

}  // namespace gse::neural
