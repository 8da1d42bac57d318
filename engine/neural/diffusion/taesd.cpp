// The tiny autoencoder: layers and files.
#include "engine/neural/diffusion/taesd.h"

#include <fmt/format.h>

#include "engine/base/error.h"
#include "engine/neural/api/network_use.h"
#include "engine/neural/weights/safetensors.h"
#include "engine/neural/weights/weights.h"

namespace gse::neural {
namespace {

namespace fs = std::filesystem;

constexpr double LatentMagnitude = 3;  // the decoder was trained on latents within it

constexpr const char* DiffusersFile = "diffusion_pytorch_model.safetensors";
constexpr const char* EncoderFile = "taesd_encoder.safetensors";
constexpr const char* DecoderFile = "taesd_decoder.safetensors";

/// The faster layout; with a graph the plain one, in which sums round as the reference's do and the same
/// ReLUs let gradients through.
torch::Tensor laid_out(const torch::Tensor& x) {
    return x.contiguous(torch::GradMode::is_enabled() ? torch::MemoryFormat::Contiguous
                                                      : torch::MemoryFormat::ChannelsLast);
}

/// An original file holds one half, whose decoder counts the clamp as a layer of its own.
LoadPlan half_plan(std::int64_t layers_before) {
    LoadPlan plan{{}, {}, "tiny autoencoder"};
    plan.map = [layers_before](const std::string& parameter) {
        constexpr std::string_view list = "layers.";
        const auto dot = parameter.find('.', list.size());
        const auto place = std::stoll(parameter.substr(list.size(), dot - list.size())) + layers_before;
        return WeightSource{std::to_string(place) + parameter.substr(dot)};
    };
    return plan;
}

/// Calls use(module, file, plan) for each file and what it holds of `model`.
template <class Use> void for_each_file(TinyAutoencoder model, const fs::path& folder, Use use) {
    if (fs::exists(folder / DiffusersFile))
        return use(*model, SafetensorsFile(folder / DiffusersFile), LoadPlan{{}, {}, "tiny autoencoder"});
    TinyHalf encoder = model->encoder_half(), decoder = model->decoder_half();
    use(*encoder, SafetensorsFile(folder / EncoderFile), half_plan(0));
    use(*decoder, SafetensorsFile(folder / DecoderFile), half_plan(1));
}

}  // namespace

TinyBlockImpl::TinyBlockImpl(std::int64_t channels, const WeightOptions& options) {
    const Conv2dImpl::Shape shape{channels, channels};
    first = Conv2d(shape, options);
    second = Conv2d(shape, options);
    third = Conv2d(shape, options);
    torch::nn::ModuleList list;  // a ReLU stands between them
    for (const auto& layer : {first, second, third}) {
        list->push_back(layer.ptr());
        if (list->size() < 5) list->push_back(std::make_shared<torch::nn::Module>());
    }
    register_module("conv", list);
}

torch::Tensor TinyBlockImpl::forward(const torch::Tensor& x) const {
    const auto inner = third->forward(torch::relu(second->forward(torch::relu(first->forward(x)))));
    return torch::relu(inner + x);
}

void TinyHalfImpl::add_convolution(const Conv2dImpl::Shape& shape, const WeightOptions& options) {
    const Conv2d layer(shape, options);
    list_->push_back(layer.ptr());
    layers_.push_back([layer](const torch::Tensor& x) { return layer->forward(x); });
}

void TinyHalfImpl::add_blocks(std::int64_t count, std::int64_t channels, const WeightOptions& options) {
    for (std::int64_t i = 0; i < count; ++i) {
        const TinyBlock block(channels, options);
        list_->push_back(block.ptr());
        layers_.push_back([block](const torch::Tensor& x) { return block->forward(x); });
    }
}

void TinyHalfImpl::add_plain(std::function<torch::Tensor(const torch::Tensor&)> layer) {
    list_->push_back(std::make_shared<torch::nn::Module>());
    layers_.push_back(std::move(layer));
}

void TinyHalfImpl::finish() { register_module("layers", list_); }

std::shared_ptr<TinyHalfImpl> TinyHalfImpl::encoder(const TinyAutoencoderConfig& config,
                                                    const WeightOptions& options) {
    auto half = std::make_shared<TinyHalfImpl>();
    const auto channels = config.channels;
    for (std::size_t level = 0; level < config.encoder_blocks.size(); ++level) {
        if (level == 0) half->add_convolution({config.in_channels, channels}, options);
        else half->add_convolution({channels, channels, 3, 2, 1, false}, options);
        half->add_blocks(config.encoder_blocks[level], channels, options);
    }
    half->add_convolution({channels, config.latent_channels}, options);
    half->finish();
    return half;
}

std::shared_ptr<TinyHalfImpl> TinyHalfImpl::decoder(const TinyAutoencoderConfig& config,
                                                    const WeightOptions& options) {
    auto half = std::make_shared<TinyHalfImpl>();
    const auto channels = config.channels;
    half->add_convolution({config.latent_channels, channels}, options);
    half->add_plain([](const torch::Tensor& x) { return torch::relu(x); });
    for (std::size_t level = 0; level < config.decoder_blocks.size(); ++level) {
        half->add_blocks(config.decoder_blocks[level], channels, options);
        if (level + 1 == config.decoder_blocks.size()) break;
        half->add_plain([](const torch::Tensor& x) {
            return torch::upsample_nearest2d(x, {x.size(2) * 2, x.size(3) * 2});
        });
        half->add_convolution({channels, channels, 3, 1, 1, false}, options);
    }
    half->add_convolution({channels, config.out_channels}, options);
    half->finish();
    return half;
}

torch::Tensor TinyHalfImpl::forward(torch::Tensor x) const {
    for (const auto& layer : layers_) x = layer(x);
    return x;
}

TinyAutoencoderImpl::TinyAutoencoderImpl(const TinyAutoencoderConfig& config, const WeightOptions& options)
    : config_(config) {
    encoder = register_module("encoder", TinyHalf(TinyHalfImpl::encoder(config_, options)));
    decoder = register_module("decoder", TinyHalf(TinyHalfImpl::decoder(config_, options)));
}

torch::Tensor TinyAutoencoderImpl::encode(const torch::Tensor& image) const {
    thread_use().encoder += static_cast<std::uint64_t>(image.size(0));
    return encoder->forward(laid_out(image)) * config_.scaling_factor;
}

torch::Tensor TinyAutoencoderImpl::decode(const torch::Tensor& latents) const {
    thread_use().decoder += static_cast<std::uint64_t>(latents.size(0));
    const auto held = torch::tanh(latents / (config_.scaling_factor * LatentMagnitude)) * LatentMagnitude;
    return decoder->forward(laid_out(held));
}

bool has_tiny_autoencoder(const fs::path& folder) {
    std::error_code ignored;
    return fs::exists(folder / DiffusersFile, ignored) || fs::exists(folder / EncoderFile, ignored) ||
           fs::exists(folder / DecoderFile, ignored);
}

TinyAutoencoder load_tiny_autoencoder(const fs::path& folder) {
    if (!has_tiny_autoencoder(folder))
        throw Error(ErrorCode::NotFound, "there is no tiny autoencoder (TAESD) here",
                    fmt::format("its folder has {} and config.json, or {} and {}", DiffusersFile, EncoderFile,
                                DecoderFile),
                    folder);
    const auto stated = folder / "config.json";
    const auto config = fs::exists(stated) ? TinyAutoencoderConfig::from_json(read_json_file(stated), stated)
                                           : TinyAutoencoderConfig{};
    const TinyAutoencoder described(config, WeightOptions{torch::kMeta, torch::kFloat32, false});
    for_each_file(described, folder,
                  [](const torch::nn::Module& module, const SafetensorsFile& file, const LoadPlan& plan) {
                      check_weights(module, file.shapes(), plan, file.path());
                  });
    require_memory(weight_bytes(*described), "the tiny autoencoder");
    TinyAutoencoder model(config, WeightOptions{torch::kCPU, torch::kFloat32, false});
    for_each_file(model, folder,
                  [](torch::nn::Module& module, const SafetensorsFile& file, const LoadPlan& plan) {
                      load_weights(module, file, plan);
                  });
    model->eval();
    for (auto& parameter : model->parameters()) parameter.set_requires_grad(false);
    return model;
}

}  // namespace gse::neural
