// Upscaler: layers, configuration, file.
#include "engine/neural/diffusion/upscaler.h"

#include "engine/base/error.h"
#include "engine/base/json.h"
#include "engine/neural/weights/safetensors.h"
#include "engine/neural/weights/weights.h"

namespace gse::neural {
namespace {

constexpr std::int64_t MostUpscalerWidth = 1024, MostUpscalerBlocks = 64, MostLatentChannels = 64;

void require_upscaler(bool holds, const std::string& key, const std::filesystem::path& path) {
    if (!holds) throw Error(ErrorCode::Model, "\"" + key + "\" of the upscaler is out of range", {}, path);
}

std::filesystem::path upscaler_file(const std::filesystem::path& path) {
    if (!std::filesystem::exists(path))
        throw Error(ErrorCode::NotFound, "the upscaler is incomplete",
                    "it has config.json and model.safetensors", path);
    return path;
}

}  // namespace

UpscalerConfig UpscalerConfig::from_json(const Json& json, const std::filesystem::path& path) {
    UpscalerConfig config;
    try {
        config.latent_channels = json.value("latent_channels", config.latent_channels);
        config.width = json.value("width", config.width);
        config.blocks = json.value("blocks", config.blocks);
    } catch (const Json::exception&) {
        throw Error(ErrorCode::Malformed,
                    "the configuration of the upscaler holds something that is no number",
                    "take the model from where it came once more", path);
    }
    require_upscaler(config.latent_channels >= 1 && config.latent_channels <= MostLatentChannels,
                     "latent_channels", path);
    require_upscaler(config.width >= 4 && config.width <= MostUpscalerWidth && config.width % 4 == 0, "width",
                     path);
    require_upscaler(config.blocks >= 1 && config.blocks <= MostUpscalerBlocks, "blocks", path);
    return config;
}

Json UpscalerConfig::to_json() const {
    return {{"latent_channels", latent_channels}, {"width", width}, {"blocks", blocks}};
}

UpscalerBlockImpl::UpscalerBlockImpl(std::int64_t width, const WeightOptions& options) {
    const Conv2dImpl::Shape shape{width, width};
    first = register_module("conv1", Conv2d(shape, options));
    second = register_module("conv2", Conv2d(shape, options));
}

torch::Tensor UpscalerBlockImpl::forward(const torch::Tensor& x) const {
    return x + second->forward(apply_silu(first->forward(x)));
}

UpscalerImpl::UpscalerImpl(const UpscalerConfig& config, const WeightOptions& options) : config_(config) {
    const auto width = config.width, half = width / 2, quarter = width / 4;
    conv_in =
        register_module("conv_in", Conv2d(Conv2dImpl::Shape{3 + config.latent_channels, width}, options));
    for (std::int64_t i = 0; i < config.blocks; ++i) blocks_.push_back(UpscalerBlock(width, options));
    register_list(*this, "blocks", blocks_);
    grow_1 = register_module("grow_1", Conv2d(Conv2dImpl::Shape{width, 4 * half}, options));
    grow_2 = register_module("grow_2", Conv2d(Conv2dImpl::Shape{half, 4 * quarter}, options));
    conv_out = register_module("conv_out", Conv2d(Conv2dImpl::Shape{quarter, 3}, options));
    if (!options.initialize) return;
    const torch::NoGradGuard no_grad;
    conv_out->weight.zero_();
    conv_out->bias.zero_();
}

torch::Tensor UpscalerImpl::forward(const torch::Tensor& picture, const torch::Tensor& latents) const {
    const auto height = picture.size(2), width = picture.size(3);
    const auto cells = torch::upsample_nearest2d(latents, {height, width});
    auto x = conv_in->forward(torch::cat({picture, cells}, 1).contiguous(torch::MemoryFormat::ChannelsLast));
    for (const auto& block : blocks_) x = block->forward(x);
    x = apply_silu(torch::pixel_shuffle(grow_1->forward(x), 2));
    x = apply_silu(torch::pixel_shuffle(grow_2->forward(x), 2));
    return conv_out->forward(x) +
           torch::upsample_bicubic2d(picture, {UpscaleFactor * height, UpscaleFactor * width}, false);
}

Upscaler load_upscaler(const std::filesystem::path& folder, const torch::Device& device) {
    const auto stated = upscaler_file(folder / "config.json");
    auto network = loaded_network<Upscaler>(UpscalerConfig::from_json(read_json_file(stated), stated),
                                            SafetensorsFile(upscaler_file(folder / "model.safetensors")),
                                            LoadPlan{{}, {}, "upscaler"});
    for (auto& parameter : network->parameters()) parameter.set_requires_grad(false);
    network->to(device);
    network->eval();
    return network;
}

}  // namespace gse::neural
