// CLIP's image encoder, the pair of encoders, and what a picture goes through before.
#include "engine/neural/clip/clip_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/base/check.h"
#include "engine/base/error.h"

namespace gse::neural {
namespace {

constexpr double InitialStd = 0.02;           // of class token and positions
constexpr double InitialLogitScale = 2.6592;  // ln(1 / 0.07), Radford et al. 2021

/// A bare parameter that can draw its own values.
class TableImpl : public torch::nn::Module, public Resettable {
public:
    TableImpl(const char* name, torch::IntArrayRef shape, double std, const WeightOptions& options)
        : std_(std) {
        const auto as = torch::TensorOptions().device(options.device).dtype(options.dtype);
        weight = register_parameter(name, torch::empty(shape, as));
        if (options.initialize) TableImpl::reset();
    }
    void reset() override {
        const torch::NoGradGuard no_grad;
        if (!weight.is_meta()) weight.normal_(0.0, std_);
    }
    torch::Tensor weight;

private:
    double std_;
};
TORCH_MODULE(Table);

torch::Tensor per_channel(const std::vector<double>& values, const torch::Tensor& like) {
    return torch::tensor(values, torch::kFloat32).to(like.device()).view({1, -1, 1, 1});
}

std::vector<double> read_channels(const Json& json, const char* key, std::vector<double> otherwise,
                                  const std::filesystem::path& path) {
    if (!json.is_object() || !json.contains(key)) return otherwise;
    std::vector<double> values;
    try {
        values = json.at(key).get<std::vector<double>>();
    } catch (const nlohmann::json::exception&) { values.clear(); }
    if (values.size() != 3 ||
        !std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); }))
        throw Error(ErrorCode::Malformed, fmt::format("\"{}\" is not a list of three numbers", key), {},
                    path);
    return values;
}

}  // namespace

ClipVisionEncoderImpl::ClipVisionEncoderImpl(const VisionEncoderConfig& config, std::int64_t projection_dim,
                                             const WeightOptions& options)
    : config_(config) {
    const auto width = config_.hidden_size, patch = config_.patch_size, side = config_.image_size / patch;
    auto model = std::make_shared<torch::nn::Module>();
    // The class embedding is a parameter of "embeddings" itself, the others of modules below it.
    Table embeddings("class_embedding", torch::IntArrayRef{width}, InitialStd, options);
    class_embedding_ = embeddings->weight;
    const double fan_in = static_cast<double>(config_.num_channels * patch * patch);
    patch_weight_ =
        embeddings
            ->register_module("patch_embedding",
                              Table("weight", torch::IntArrayRef{width, config_.num_channels, patch, patch},
                                    1.0 / std::sqrt(fan_in), options))
            ->weight;
    position_weight_ = embeddings
                           ->register_module("position_embedding",
                                             Table("weight", torch::IntArrayRef{side * side + 1, width},
                                                   InitialStd, options))
                           ->weight;
    model->register_module("embeddings", embeddings.ptr());
    pre_norm_ = model->register_module("pre_layrnorm", LayerNorm(width, config_.layer_norm_eps, options));
    auto encoder = std::make_shared<torch::nn::Module>();
    const ClipLayerImpl::Shape shape{width, config_.intermediate_size, config_.num_attention_heads,
                                     config_.hidden_act, config_.layer_norm_eps};
    for (std::int64_t i = 0; i < config_.num_hidden_layers; ++i) layers_.push_back(ClipLayer(shape, options));
    register_list(*encoder, "layers", layers_);
    model->register_module("encoder", encoder);
    post_norm_ = model->register_module("post_layernorm", LayerNorm(width, config_.layer_norm_eps, options));
    register_module("vision_model", model);
    visual_projection_ = register_module("visual_projection",
                                         Linear(LinearImpl::Shape{width, projection_dim, false}, options));
}

torch::Tensor ClipVisionEncoderImpl::positions(std::int64_t rows, std::int64_t columns) const {
    const auto side = config_.image_size / config_.patch_size;
    if (rows == side && columns == side) return position_weight_;
    const auto grid = position_weight_.slice(0, 1).t().reshape({1, config_.hidden_size, side, side});
    const auto resized = torch::upsample_bicubic2d(grid, {rows, columns}, false);
    return torch::cat({position_weight_.slice(0, 0, 1), resized.flatten(2).squeeze(0).t()});
}

VisionEncoding ClipVisionEncoderImpl::forward(const torch::Tensor& pixels) const {
    const auto patch = config_.patch_size;
    GSE_CHECK(pixels.size(2) % patch == 0 && pixels.size(3) % patch == 0);
    const auto patches = torch::conv2d(pixels, patch_weight_, {}, patch);  // [B,D,h,w]
    const auto tokens = patches.flatten(2).transpose(1, 2);
    const auto first = class_embedding_.expand({pixels.size(0), 1, config_.hidden_size});
    VisionEncoding result;
    auto x = torch::cat({first, tokens}, 1) + positions(patches.size(2), patches.size(3));
    x = pre_norm_->forward(x);
    result.hidden_states.push_back(x);
    for (const auto& layer : layers_) {
        x = layer->forward(x, {});
        result.hidden_states.push_back(x);
    }
    result.pooled = post_norm_->forward(x.select(1, 0));
    result.image_embeds = visual_projection_->forward(result.pooled);
    return result;
}

ClipModelImpl::ClipModelImpl(const ClipConfig& config, const WeightOptions& options) : config_(config) {
    text = register_module("text", ClipTextEncoder(config.text, options));
    vision = register_module("vision", ClipVisionEncoder(config.vision, config.projection_dim, options));
    logit_scale = register_parameter(
        "logit_scale", torch::full({}, InitialLogitScale,
                                   torch::TensorOptions().device(options.device).dtype(options.dtype)));
}

torch::Tensor ClipModelImpl::image_vectors(const torch::Tensor& pixels) const {
    return torch::nn::functional::normalize(vision->forward(pixels).image_embeds);
}

torch::Tensor ClipModelImpl::text_vectors(const torch::Tensor& ids) const {
    return torch::nn::functional::normalize(text->forward(ids).text_embeds);
}

std::string clip_key(const std::string& parameter) {
    for (const std::string prefix : {"text.", "vision."})
        if (parameter.starts_with(prefix)) return parameter.substr(prefix.size());
    return parameter;
}

LoadPlan clip_plan() {
    return {[](const std::string& name) { return WeightSource{clip_key(name)}; },
            [](const std::string& key) { return key.ends_with(".embeddings.position_ids"); },
            "image-text encoder"};
}

ClipPreprocessing ClipPreprocessing::read(const ClipConfig& config, const std::filesystem::path& folder) {
    ClipPreprocessing result;
    result.size = config.vision.image_size;
    const auto path = folder / "preprocessor_config.json";
    if (!std::filesystem::exists(path)) return result;
    const auto json = read_json_file(path);
    result.mean = read_channels(json, "image_mean", result.mean, path);
    result.deviation = read_channels(json, "image_std", result.deviation, path);
    if (std::any_of(result.deviation.begin(), result.deviation.end(), [](double v) { return !(v > 0); }))
        throw Error(ErrorCode::Malformed, "\"image_std\" is not positive", {}, path);
    return result;
}

torch::Tensor ClipPreprocessing::pixels(const torch::Tensor& pictures) const {
    const auto height = pictures.size(2), width = pictures.size(3), side = std::min(height, width);
    auto square = pictures.narrow(2, (height - side) / 2, side).narrow(3, (width - side) / 2, side);
    if (side != size) {
        // Antialiased, as Pillow resizes for transformers; the overshoot of the cubic is cut off as there.
        square = at::_upsample_bicubic2d_aa(square.contiguous(), {size, size}, false).clamp(0.0, 1.0);
    }
    return (square - per_channel(mean, square)) / per_channel(deviation, square);
}

}  // namespace gse::neural
