// Names, sizes and what a picture goes through before and after.
#include "engine/neural/sam/sam_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/error.h"

namespace gse::neural {
namespace {

using Renaming = std::pair<const char*, const char*>;

// Names of segment-anything -> transformers, in the order in which they are applied.
constexpr Renaming EncoderNames[] = {{"image_encoder.", "vision_encoder."},
                                     {".patch_embed.proj.", ".patch_embed.projection."},
                                     {".blocks.", ".layers."},
                                     {".norm", ".layer_norm"},
                                     {".neck.0.", ".neck.conv1."},
                                     {".neck.1.", ".neck.layer_norm1."},
                                     {".neck.2.", ".neck.conv2."},
                                     {".neck.3.", ".neck.layer_norm2."}};
constexpr Renaming PromptNames[] = {{"prompt_encoder.pe_layer.positional_encoding_gaussian_matrix",
                                     "shared_image_embedding.positional_embedding"},
                                    {".point_embeddings.", ".point_embed."},
                                    {".mask_downscaling.0.", ".mask_embed.conv1."},
                                    {".mask_downscaling.1.", ".mask_embed.layer_norm1."},
                                    {".mask_downscaling.3.", ".mask_embed.conv2."},
                                    {".mask_downscaling.4.", ".mask_embed.layer_norm2."},
                                    {".mask_downscaling.6.", ".mask_embed.conv3."}};
constexpr Renaming DecoderNames[] = {{".norm", ".layer_norm"},
                                     {".output_upscaling.0.", ".upscale_conv1."},
                                     {".output_upscaling.1.", ".upscale_layer_norm."},
                                     {".output_upscaling.3.", ".upscale_conv2."}};

template <std::size_t N> std::string renamed(std::string name, const Renaming (&names)[N]) {
    for (const auto& [from, to] : names)
        if (const auto at = name.find(from); at != std::string::npos)
            name.replace(at, std::string_view(from).size(), to);
    return name;
}

/// The first, the last and the other layers of a perceptron of `count` have names of their own there.
std::string perceptron_name(std::string name, std::int64_t count) {
    const auto at = name.find(".layers.");
    if (at == std::string::npos) return name;
    const auto begin = at + 1, number = at + std::string_view(".layers.").size(),
               end = name.find('.', number);
    const auto layer = std::stoll(name.substr(number, end - number));
    const auto to = layer == 0           ? "proj_in"
                    : layer + 1 == count ? "proj_out"
                                         : fmt::format("layers.{}", layer - 1);
    return name.replace(begin, end - begin, to);
}

std::string transformers_name(const std::string& name, std::int64_t iou_layers) {
    if (name.starts_with("image_encoder.")) return renamed(name, EncoderNames);
    if (name.starts_with("prompt_encoder.")) return renamed(name, PromptNames);
    constexpr std::int64_t hypernetwork_layers = 3;
    if (name.find("output_hypernetworks_mlps.") != std::string::npos)
        return perceptron_name(name, hypernetwork_layers);
    if (name.find("iou_prediction_head.") != std::string::npos) return perceptron_name(name, iou_layers);
    return renamed(name, DecoderNames);
}

/// Keys that files hold besides: counters, an unused classifier, tables that follow from sizes, a second
/// name.
bool is_left_over(const std::string& key) {
    return key.ends_with(".num_batches_tracked") || key.starts_with("image_encoder.norm_head.") ||
           key.starts_with("image_encoder.head.") || key.ends_with(".attention_bias_idxs") ||
           key.ends_with(".attn.ab") || key == "pixel_mean" || key == "pixel_std" ||
           key == "prompt_encoder.shared_embedding.positional_embedding";
}

/// Shapes by the names of segment-anything.
class Shapes {
public:
    Shapes(const KeyShapes& shapes, const LoadPlan& plan, const std::filesystem::path& path)
        : shapes_(shapes), plan_(plan), path_(path) {}

    bool has(const std::string& name) const { return shapes_.contains(key(name)); }
    std::int64_t size(const std::string& name, std::size_t dimension) const {
        const auto found = shapes_.find(key(name));
        if (found == shapes_.end()) refuse(fmt::format("they have no tensor \"{}\"", key(name)));
        if (dimension >= found->second.size() || found->second[dimension] <= 0)
            refuse(fmt::format("the tensor \"{}\" has another shape", key(name)));
        return found->second[dimension];
    }
    /// Counts `prefix`0`suffix`, `prefix`1`suffix`, ...
    std::int64_t count(const std::string& prefix, const std::string& suffix) const {
        std::int64_t count = 0;
        while (has(fmt::format("{}{}{}", prefix, count, suffix))) ++count;
        return count;
    }
    [[noreturn]] void refuse(const std::string& why) const {
        throw Error(ErrorCode::Model, fmt::format("these are no weights of SAM or MobileSAM: {}", why),
                    "use sam_vit_b, sam_vit_l, sam_vit_h or mobile_sam, as .pth, .pt or .safetensors", path_);
    }

private:
    std::string key(const std::string& name) const { return plan_.map ? plan_.map(name).key : name; }

    const KeyShapes& shapes_;
    const LoadPlan& plan_;
    const std::filesystem::path& path_;
};

/// Side of a square of `area`, or nothing.
std::int64_t square_root(const Shapes& shapes, std::int64_t area) {
    const auto side = static_cast<std::int64_t>(std::llround(std::sqrt(static_cast<double>(area))));
    if (side * side != area) shapes.refuse("a window is no square");
    return side;
}

SamVitShape infer_vit(const Shapes& shapes) {
    const std::string first = "image_encoder.blocks.0.";
    SamVitShape vit;
    vit.width = shapes.size("image_encoder.pos_embed", 3);
    vit.side = shapes.size("image_encoder.pos_embed", 1);
    vit.patch = shapes.size("image_encoder.patch_embed.proj.weight", 2);
    vit.heads = std::max<std::int64_t>(1, vit.width / shapes.size(first + "attn.rel_pos_h", 1));
    vit.inner = shapes.size(first + "mlp.lin1.weight", 0);
    vit.out = shapes.size("image_encoder.neck.0.weight", 0);
    const auto depth = shapes.count("image_encoder.blocks.", ".attn.rel_pos_h");
    for (std::int64_t i = 0; i < depth; ++i)
        vit.windows.push_back((shapes.size(fmt::format("image_encoder.blocks.{}.attn.rel_pos_h", i), 0) + 1) /
                              2);
    return vit;
}

TinyVitShape infer_tiny_vit(const Shapes& shapes, std::int64_t image_size) {
    TinyVitShape tiny;
    tiny.image_size = image_size;
    tiny.out = shapes.size("image_encoder.neck.0.weight", 0);
    tiny.widths[0] = shapes.size("image_encoder.patch_embed.seq.2.c.weight", 0);
    tiny.depths[0] = shapes.count("image_encoder.layers.0.blocks.", ".conv1.c.weight");
    tiny.convolution_inner = shapes.size("image_encoder.layers.0.blocks.0.conv1.c.weight", 0);
    for (std::size_t i = 1; i < tiny.widths.size(); ++i) {
        const auto layer = fmt::format("image_encoder.layers.{}.blocks.", i), first = layer + "0.";
        tiny.depths[i] = shapes.count(layer, ".attn.proj.weight");
        tiny.widths[i] = shapes.size(first + "attn.proj.weight", 0);
        tiny.heads[i] = shapes.size(first + "attn.attention_biases", 0);
        tiny.windows[i] = square_root(shapes, shapes.size(first + "attn.attention_biases", 1));
        tiny.inner[i] = shapes.size(first + "mlp.fc1.weight", 0);
    }
    return tiny;
}

std::string vit_name(std::int64_t width) {
    return width == 768 ? "SAM ViT-B" : width == 1024 ? "SAM ViT-L" : width == 1280 ? "SAM ViT-H" : "SAM";
}

}  // namespace

LoadPlan sam_plan(const KeyShapes& shapes) {
    LoadPlan plan{{}, is_left_over, "segmenter"};
    if (!shapes.contains("vision_encoder.pos_embed")) return plan;
    std::int64_t between = 0;  // layers of the head but the first and the last
    while (shapes.contains(fmt::format("mask_decoder.iou_prediction_head.layers.{}.weight", between)))
        ++between;
    plan.map = [iou_layers = between + 2](const std::string& name) {
        return WeightSource{transformers_name(name, iou_layers)};
    };
    return plan;
}

SamShape infer_sam_shape(const KeyShapes& keys, const LoadPlan& plan, const std::filesystem::path& path,
                         std::int64_t mobile_image_size) {
    const Shapes shapes(keys, plan, path);
    SamShape result;
    auto& decoder = result.decoder;
    if (shapes.has("image_encoder.pos_embed")) {
        const auto vit = infer_vit(shapes);
        decoder.side = vit.side;
        decoder.image_size = vit.side * vit.patch;
        result.name = vit_name(vit.width);
        result.encoder = vit;
    } else if (shapes.has("image_encoder.patch_embed.seq.0.c.weight")) {
        constexpr std::int64_t stride = 16;
        decoder.side = mobile_image_size / stride;
        decoder.image_size = mobile_image_size;
        result.name = "MobileSAM";
        result.encoder = infer_tiny_vit(shapes, mobile_image_size);
    } else {
        shapes.refuse("they have no image encoder");
    }
    decoder.width = shapes.size("mask_decoder.iou_token.weight", 1);
    decoder.inner = shapes.size("mask_decoder.transformer.layers.0.mlp.lin1.weight", 0);
    decoder.layers = shapes.count("mask_decoder.transformer.layers.", ".norm1.weight");
    decoder.mask_tokens = shapes.size("mask_decoder.mask_tokens.weight", 0);
    decoder.mask_channels = shapes.size("prompt_encoder.mask_downscaling.3.weight", 0);
    decoder.iou_inner = shapes.size("mask_decoder.iou_prediction_head.layers.0.weight", 0);
    // By the names of transformers the number follows from the plan itself.
    constexpr std::int64_t usual_iou_layers = 3;
    decoder.iou_layers =
        plan.map ? usual_iou_layers : shapes.count("mask_decoder.iou_prediction_head.layers.", ".weight");
    return result;
}

SamModelImpl::SamModelImpl(const SamShape& shape, const WeightOptions& options) : shape_(shape) {
    if (const auto* vit = std::get_if<SamVitShape>(&shape.encoder)) encoder_ = make_sam_vit(*vit, options);
    else encoder_ = make_tiny_vit(std::get<TinyVitShape>(shape.encoder), options);
    register_module("image_encoder", encoder_);
    prompt_encoder_ = register_module("prompt_encoder", SamPromptEncoder(shape.decoder, options));
    mask_decoder_ = register_module("mask_decoder", SamMaskDecoder(shape.decoder, options));
}

namespace {

struct Sides {
    std::int64_t height, width;
};

/// Sides in whole pixels of the picture whose longer one becomes `image_size`
/// (ResizeLongestSide.get_preprocess_shape).
Sides resized(std::int64_t image_size, std::int64_t height, std::int64_t width) {
    const double ratio = static_cast<double>(image_size) / static_cast<double>(std::max(height, width));
    const auto side = [&](std::int64_t length) {
        return std::max<std::int64_t>(1,
                                      static_cast<std::int64_t>(static_cast<double>(length) * ratio + 0.5));
    };
    return {side(height), side(width)};
}

}  // namespace

SamScale sam_scale(std::int64_t image_size, std::int64_t height, std::int64_t width) {
    const auto to = resized(image_size, height, width);
    return {static_cast<double>(to.width) / static_cast<double>(width),
            static_cast<double>(to.height) / static_cast<double>(height)};
}

torch::Tensor SamModelImpl::pixels(const torch::Tensor& picture) const {
    const auto height = picture.size(2), width = picture.size(3), size = shape_.image_size();
    const auto to = resized(size, height, width);
    const auto channels = [&](std::initializer_list<double> values) {
        return torch::tensor(std::vector<double>(values), torch::kFloat32)
            .to(picture.device())
            .view({1, 3, 1, 1});
    };
    auto values = (picture.clamp(0, 1) * 255).round();
    // Rounded after each direction, as Pillow resizes.
    values = at::_upsample_bilinear2d_aa(values.contiguous(), {height, to.width}, false).round();
    values = at::_upsample_bilinear2d_aa(values, {to.height, to.width}, false).round();
    const auto normalised =
        (values - channels({123.675, 116.28, 103.53})) / channels({58.395, 57.12, 57.375});
    return torch::constant_pad_nd(normalised, {0, size - to.width, 0, size - to.height});
}

torch::Tensor SamModelImpl::enlarge(const torch::Tensor& logits, std::int64_t height,
                                    std::int64_t width) const {
    const auto size = shape_.image_size();
    const auto from = resized(size, height, width);
    const auto whole = torch::upsample_bilinear2d(logits, {size, size}, false);
    const auto seen = whole.narrow(2, 0, from.height).narrow(3, 0, from.width);
    return torch::upsample_bilinear2d(seen.contiguous(), {height, width}, false);
}

SamModel load_sam(const std::filesystem::path& path, const torch::Device& device,
                  std::int64_t mobile_image_size) {
    const auto file =
        open_tensor_file(std::filesystem::is_directory(path) ? path / "model.safetensors" : path);
    const auto shapes = file->shapes();
    const auto plan = sam_plan(shapes);
    const auto shape = infer_sam_shape(shapes, plan, file->path(), mobile_image_size);
    auto model = loaded_network<SamModel>(shape, *file, plan, device);
    model->eval();
    for (auto& parameter : model->parameters()) parameter.set_requires_grad(false);
    return model;
}

}  // namespace gse::neural
