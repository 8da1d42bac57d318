// Camera features, and networks that share weights.
#include "engine/neural/diffusion/scene_views.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/json.h"
#include "engine/neural/weights/key_map.h"

namespace gse::neural {
namespace {

constexpr std::string_view CameraEmbedding = "camera_embedding.", Inpaint = "conv_inpaint.",
                           Outline = "outline.";
constexpr const char *ShapeConfig = "config.json", *ShapeWeights = "diffusion_pytorch_model.safetensors";
constexpr double FirstOutline = -3;  // logit before anything is known: little of a picture is new

/// A network with the weights of another, each of the type it has; those that the other has not are left
/// undrawn.
UNet sharing(const UNet& from, const UNetConfig& config) {
    const auto weights = from->named_parameters();
    const auto& first = weights["conv_in.weight"];
    UNet unet(config, WeightOptions{first.device(), first.scalar_type(), false});
    for (auto& item : unet->named_parameters())
        if (const auto* weight = weights.find(item.key())) item.value().set_data(*weight);
    return unet;
}

}  // namespace

std::array<float, CameraFeatures> camera_features(std::optional<double> azimuth, double elevation) {
    if (!azimuth) return {};
    const auto f = [](double value) { return static_cast<float>(value); };
    return {f(std::sin(*azimuth)),     f(std::cos(*azimuth)),  f(std::sin(2 * *azimuth)),
            f(std::cos(2 * *azimuth)), f(std::sin(elevation)), 1.0f};
}

torch::Tensor inpainting(const torch::Tensor& mask, const torch::Tensor& shown,
                         const torch::Tensor& latents) {
    return torch::cat({mask, shown, shown * latents}, 1);
}

namespace {

/// Weights of layers that begin as layers do.
template <class Layer> void draw_weights(UNet& unet, std::string_view part) {
    for (auto& item : unet->named_modules())
        if (auto* layer = dynamic_cast<Layer*>(item.value().get());
            layer != nullptr && item.key().starts_with(part))
            layer->reset();
}

UNet with_inputs(const UNet& plain, bool inpaint, bool outline) {
    auto config = plain->config();
    config.camera_dim = CameraFeatures;
    config.inpaint_channels = inpaint ? config.in_channels + 2 : 0;
    config.outline_scale = outline ? OutlineScale : 0;
    auto unet = sharing(plain, config);
    const torch::NoGradGuard no_grad;
    draw_weights<LinearImpl>(unet, CameraEmbedding);
    draw_weights<Conv2dImpl>(unet, Outline);
    for (auto& [name, weight] : scene_input_weights(unet)) {
        if (name.starts_with(Inpaint) || name.find("_2.") != std::string::npos)
            weight.zero_();  // the last layers say nothing
        if (name.starts_with(Outline) && name.ends_with("conv_2.bias")) weight.fill_(FirstOutline);
    }
    return unet;
}

}  // namespace

UNet with_scene_inputs(const UNet& plain, bool outlines) { return with_inputs(plain, true, outlines); }

bool shows_scene(const SafetensorsFile& file) { return file.contains(std::string(Inpaint).append("weight")); }

UNet with_scene_inputs(const UNet& plain, const SafetensorsFile& file) {
    const bool inpaints = shows_scene(file),
               outlines = file.contains(std::string(Outline).append("conv_1.weight"));
    auto unet = with_inputs(plain, inpaints, outlines);
    constexpr const char* Hint = "take it and the LoRA for shapes from one training run";
    for (auto& [name, weight] : scene_input_weights(unet)) {
        if (!file.contains(name))
            throw Error(ErrorCode::Model, "the embedding of cameras has no \"" + name + "\"", Hint,
                        file.path());
        if (torch::IntArrayRef(file.entries().at(name).shape) != weight.sizes())
            throw Error(ErrorCode::Model, "\"" + name + "\" of the embedding of cameras has another shape",
                        Hint, file.path());
        file.copy_to(name, weight);
    }
    for (auto& parameter : unet->parameters()) parameter.set_requires_grad(false);
    return unet;
}

UNet load_shape_unet(const std::filesystem::path& folder) {
    const SafetensorsFile file(folder / ShapeWeights);
    auto config = UNetConfig::from_json(read_json_file(folder / ShapeConfig), folder / ShapeConfig);
    config.camera_dim = CameraFeatures;
    config.inpaint_channels = shows_scene(file) ? config.in_channels + 2 : 0;
    config.outline_scale = file.contains(std::string(Outline).append("conv_1.weight")) ? OutlineScale : 0;
    LoadPlan plan = unet_plan();
    plan.what = "UNet for new things";
    plan.ignore = [](const std::string& name) { return name.ends_with(QuantizationScale); };
    check_weights(*UNet(config, WeightOptions{torch::kMeta, torch::kFloat32, false}), file.shapes(), plan,
                  file.path());  // before memory is taken
    UNet unet(config, WeightOptions{torch::kCPU, torch::kFloat32, false});
    load_weights(*unet, file, plan);
    for (auto& parameter : unet->parameters()) parameter.set_requires_grad(false);
    unet->eval();
    return unet;
}

bool shape_unet_shows_scene(const std::filesystem::path& folder) {
    return shows_scene(SafetensorsFile(folder / ShapeWeights));
}

bool is_scene_input(const std::string& name) {
    return name.starts_with(CameraEmbedding) || name.starts_with(Inpaint) || name.starts_with(Outline);
}

std::vector<std::pair<std::string, torch::Tensor>> scene_input_weights(const UNet& unet) {
    std::vector<std::pair<std::string, torch::Tensor>> weights;
    for (auto& item : unet->named_parameters())
        if (is_scene_input(item.key())) weights.emplace_back(item.key(), item.value());
    return weights;
}

std::vector<std::vector<std::int64_t>> view_groups(const std::vector<std::optional<double>>& azimuths,
                                                   std::int64_t together, bool around) {
    const auto count = static_cast<std::int64_t>(azimuths.size());
    std::vector<std::int64_t> order(azimuths.size());
    std::iota(order.begin(), order.end(), std::int64_t{0});
    if (std::all_of(azimuths.begin(), azimuths.end(),
                    [](const auto& azimuth) { return azimuth.has_value(); }))
        std::stable_sort(order.begin(), order.end(), [&](std::int64_t a, std::int64_t b) {
            const auto turned = [&](std::int64_t v) {
                return std::remainder(*azimuths[static_cast<std::size_t>(v)], 2 * std::numbers::pi);
            };
            return turned(a) < turned(b);
        });
    const std::int64_t groups = (count + together - 1) / std::max<std::int64_t>(together, 1);
    std::vector<std::vector<std::int64_t>> result(static_cast<std::size_t>(groups));
    for (std::int64_t i = 0; i < count; ++i)
        result[static_cast<std::size_t>(around ? i % groups : i * groups / count)].push_back(
            order[static_cast<std::size_t>(i)]);
    return result;
}

}  // namespace gse::neural
