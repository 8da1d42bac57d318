// The decoder: a few transformer layers with the norm behind them, one per layer that is shown, the deepest
// first.
#include "engine/neural/clip/clipseg_model.h"

#include <cmath>
#include <string_view>

#include "engine/base/check.h"

namespace gse::neural {

ClipSegDecoderImpl::ClipSegDecoderImpl(const ClipSegConfig& config, const WeightOptions& options)
    : config_(config) {
    const auto width = config.reduce_dim, projection = config.clip.projection_dim;
    film_mul_ = register_module("film_mul", Linear(LinearImpl::Shape{projection, width}, options));
    film_add_ = register_module("film_add", Linear(LinearImpl::Shape{projection, width}, options));
    torch::nn::ModuleList list;
    for (std::size_t i = 0; i < config.extract_layers.size(); ++i) {
        reduces_.push_back(Linear(LinearImpl::Shape{config.clip.vision.hidden_size, width}, options));
        layers_.push_back(make_layer(list, options));
    }
    register_list(*this, "reduces", reduces_);
    register_module("layers", list);
    make_enlarging(options);
}

ClipSegDecoderImpl::Layer ClipSegDecoderImpl::make_layer(torch::nn::ModuleList& list,
                                                         const WeightOptions& options) {
    const auto width = config_.reduce_dim, inner = config_.decoder_intermediate_size;
    const double eps = config_.clip.vision.layer_norm_eps;
    auto all = std::make_shared<torch::nn::Module>(), attention = std::make_shared<torch::nn::Module>(),
         mlp = std::make_shared<torch::nn::Module>();
    Layer layer;
    layer.q = attention->register_module("q_proj", Linear(LinearImpl::Shape{width, width}, options));
    layer.k = attention->register_module("k_proj", Linear(LinearImpl::Shape{width, width}, options));
    layer.v = attention->register_module("v_proj", Linear(LinearImpl::Shape{width, width}, options));
    layer.out = attention->register_module("out_proj", Linear(LinearImpl::Shape{width, width}, options));
    layer.fc1 = mlp->register_module("fc1", Linear(LinearImpl::Shape{width, inner}, options));
    layer.fc2 = mlp->register_module("fc2", Linear(LinearImpl::Shape{inner, width}, options));
    all->register_module("self_attn", attention);
    all->register_module("mlp", mlp);
    layer.first_norm = all->register_module("layer_norm1", LayerNorm(width, eps, options));
    layer.second_norm = all->register_module("layer_norm2", LayerNorm(width, eps, options));
    list->push_back(all);
    return layer;
}

/// From a patch back to its pixels: in one step, or in a convolution and two steps.
void ClipSegDecoderImpl::make_enlarging(const WeightOptions& options) {
    const auto as = torch::TensorOptions().device(options.device).dtype(options.dtype);
    const auto width = config_.reduce_dim, patch = config_.clip.vision.patch_size;
    const auto add = [&](torch::nn::Module& module, torch::IntArrayRef shape, std::int64_t out) {
        enlarging_.push_back({module.register_parameter("weight", torch::zeros(shape, as)),
                              module.register_parameter("bias", torch::zeros({out}, as))});
    };
    auto enlarging = std::make_shared<torch::nn::Module>();
    if (!config_.use_complex_transposed_convolution) {
        add(*enlarging, {width, 1, patch, patch}, 1);
    } else {
        const auto step = patch / 4;
        const auto below = [&](const char* name, torch::IntArrayRef shape, std::int64_t out) {
            auto module = std::make_shared<torch::nn::Module>();
            add(*module, shape, out);
            enlarging->register_module(name, module);
        };
        below("0", {width, width, 3, 3}, width);
        below("2", {width, width / 2, step, step}, width / 2);
        below("4", {width / 2, 1, step, step}, 1);
    }
    register_module("transposed_convolution", enlarging);
}

torch::Tensor ClipSegDecoderImpl::enlarge(const torch::Tensor& x) const {
    if (enlarging_.size() == 1)
        return torch::conv_transpose2d(x, enlarging_[0].weight, enlarging_[0].bias,
                                       config_.clip.vision.patch_size);
    const auto step = config_.clip.vision.patch_size / 4;
    auto large = torch::relu(torch::conv2d(x, enlarging_[0].weight, enlarging_[0].bias, 1, 1));
    large = torch::relu(torch::conv_transpose2d(large, enlarging_[1].weight, enlarging_[1].bias, step));
    return torch::conv_transpose2d(large, enlarging_[2].weight, enlarging_[2].bias, step);
}

torch::Tensor ClipSegDecoderImpl::run_layer(const Layer& layer, const torch::Tensor& x) const {
    AttentionRequest request;
    request.heads = config_.decoder_num_attention_heads;
    const auto seen = layer.out->forward(
        attend(layer.q->forward(x), layer.k->forward(x), layer.v->forward(x), request).output);
    const auto mixed = layer.first_norm->forward(x + seen);
    // ReLU, whatever the configuration calls its activation: so the weights were trained.
    return layer.second_norm->forward(mixed + layer.fc2->forward(torch::relu(layer.fc1->forward(mixed))));
}

torch::Tensor ClipSegDecoderImpl::forward(const std::vector<torch::Tensor>& activations,
                                          const torch::Tensor& condition,
                                          std::vector<torch::Tensor>* layers) const {
    GSE_CHECK_EQ(activations.size(), layers_.size());
    torch::Tensor x;
    for (std::size_t i = 0; i < layers_.size(); ++i) {
        const auto shown = reduces_[i]->forward(activations[activations.size() - 1 - i]);
        x = x.defined() ? shown + x : shown;
        if (static_cast<std::int64_t>(i) == config_.conditional_layer)
            x = film_mul_->forward(condition).unsqueeze(1) * x + film_add_->forward(condition).unsqueeze(1);
        x = run_layer(layers_[i], x);
        if (layers != nullptr) layers->push_back(x);
    }
    // Without the class token. Pictures are squares here, as in the reference.
    const auto tokens = x.slice(1, 1);
    const auto rows = static_cast<std::int64_t>(std::llround(std::sqrt(static_cast<double>(tokens.size(1)))));
    GSE_CHECK_EQ(rows * rows, tokens.size(1));
    return enlarge(tokens_to_image(tokens.contiguous(), rows, rows).contiguous()).squeeze(1);
}

ClipSegModelImpl::ClipSegModelImpl(const ClipSegConfig& config, const WeightOptions& options)
    : config_(config) {
    clip = register_module("clip", ClipModel(config.clip, options));
    decoder_ = register_module("decoder", ClipSegDecoder(config, options));
}

std::vector<torch::Tensor> ClipSegModelImpl::activations(const torch::Tensor& pixels) const {
    const auto encoding = clip->vision->forward(pixels);
    std::vector<torch::Tensor> shown;
    for (const auto layer : config_.extract_layers)
        shown.push_back(encoding.hidden_states[static_cast<std::size_t>(layer) + 1]);
    return shown;
}

LoadPlan clipseg_plan() {
    static constexpr std::string_view towers = "clip.";
    return {
        [](const std::string& name) {
            return WeightSource{
                name.starts_with(towers) ? std::string(towers) + clip_key(name.substr(towers.size())) : name};
        },
        [](const std::string& key) { return key.ends_with(".embeddings.position_ids"); }, "text segmenter"};
}

}  // namespace gse::neural
