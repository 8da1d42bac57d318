// Key tables: diffusers and transformers names to ldm ("single file"), legacy VAE and OpenCLIP names.
#include "engine/neural/weights/key_map.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <charconv>

#include "engine/base/check.h"
#include "engine/base/error.h"

namespace gse::neural {
namespace {

using Words = std::vector<std::string>;

Words split(const std::string& name) {
    Words words;
    std::size_t begin = 0;
    for (std::size_t dot = name.find('.'); dot != std::string::npos; dot = name.find('.', begin)) {
        words.push_back(name.substr(begin, dot - begin));
        begin = dot + 1;
    }
    words.push_back(name.substr(begin));
    return words;
}

std::string join(const Words& words, std::size_t from) {
    return fmt::format("{}", fmt::join(words.begin() + static_cast<std::ptrdiff_t>(from), words.end(), "."));
}

struct Rename {
    std::string_view from, to;
};

/// Replaces the beginning of `name` by the first rule that fits.
template <std::size_t N> std::string renamed(const std::string& name, const std::array<Rename, N>& rules) {
    for (const auto& rule : rules)
        if (name.starts_with(rule.from)) return std::string(rule.to) + name.substr(rule.from.size());
    return name;
}

constexpr std::string_view UNetPrefix = "model.diffusion_model.";
constexpr std::string_view VaePrefix = "first_stage_model.";
constexpr std::string_view TextPrefix = "cond_stage_model.";

constexpr std::array UNetResnet{
    Rename{"norm1.", "in_layers.0."},          Rename{"conv1.", "in_layers.2."},
    Rename{"time_emb_proj.", "emb_layers.1."}, Rename{"norm2.", "out_layers.0."},
    Rename{"conv2.", "out_layers.3."},         Rename{"conv_shortcut.", "skip_connection."}};
constexpr std::array UNetTop{Rename{"conv_in.", "input_blocks.0.0."},
                             Rename{"time_embedding.linear_1.", "time_embed.0."},
                             Rename{"time_embedding.linear_2.", "time_embed.2."},
                             Rename{"conv_norm_out.", "out.0."},
                             Rename{"conv_out.", "out.2."},
                             Rename{"mid_block.attentions.0.", "middle_block.1."}};

/// "resnets.j.norm1.weight" and the like, within block number `block` of the list.
std::string unet_block_key(const Words& words, std::int64_t block, bool up, const UNetConfig& config) {
    const std::int64_t per_level = config.layers_per_block + 1;
    const auto& part = words[2];
    const std::int64_t j = std::stoll(words[3]);
    const char* list = up ? "output_blocks" : "input_blocks";
    const std::int64_t index = (up ? 0 : 1) + block * per_level + j;
    if (part == "resnets") return fmt::format("{}.{}.0.{}", list, index, renamed(join(words, 4), UNetResnet));
    if (part == "attentions") return fmt::format("{}.{}.1.{}", list, index, join(words, 4));
    if (part == "downsamplers")
        return fmt::format("input_blocks.{}.0.op.{}", (block + 1) * per_level, words.back());
    const bool attention = config.up_block_types[static_cast<std::size_t>(block)] == "CrossAttnUpBlock2D";
    return fmt::format("output_blocks.{}.{}.conv.{}", block * per_level + config.layers_per_block,
                       attention ? 2 : 1, words.back());
}

std::string unet_key(const std::string& name, const UNetConfig& config) {
    const auto words = split(name);
    if (words[0] == "down_blocks") return unet_block_key(words, std::stoll(words[1]), false, config);
    if (words[0] == "up_blocks") return unet_block_key(words, std::stoll(words[1]), true, config);
    if (words[0] == "mid_block" && words[1] == "resnets")
        return fmt::format("middle_block.{}.{}", words[2] == "0" ? 0 : 2,
                           renamed(join(words, 3), UNetResnet));
    return renamed(name, UNetTop);
}

constexpr std::array VaeAttentionNames{Rename{"group_norm.", "norm."}, Rename{"to_q.", "q."},
                                       Rename{"to_k.", "k."}, Rename{"to_v.", "v."},
                                       Rename{"to_out.0.", "proj_out."}};
constexpr std::array VaeResnetNames{Rename{"conv_shortcut.", "nin_shortcut."}};
constexpr std::array VaeHalf{Rename{"conv_norm_out.", "norm_out."}};

std::string vae_half_key(const Words& words, std::int64_t levels) {
    if (words[1] == "down_blocks" || words[1] == "up_blocks") {
        const bool up = words[1] == "up_blocks";
        const std::int64_t block = up ? levels - 1 - std::stoll(words[2]) : std::stoll(words[2]);
        const char* list = up ? "up" : "down";
        if (words[3] == "resnets")
            return fmt::format("{}.{}.block.{}.{}", list, block, words[4],
                               renamed(join(words, 5), VaeResnetNames));
        return fmt::format("{}.{}.{}.conv.{}", list, block, up ? "upsample" : "downsample", words.back());
    }
    if (words[1] == "mid_block") {
        if (words[2] == "attentions") return "mid.attn_1." + renamed(join(words, 4), VaeAttentionNames);
        return fmt::format("mid.block_{}.{}", words[3] == "0" ? 1 : 2,
                           renamed(join(words, 4), VaeResnetNames));
    }
    return renamed(join(words, 1), VaeHalf);
}

std::string vae_key(const std::string& name, std::int64_t levels) {
    const auto words = split(name);
    if (words[0] != "encoder" && words[0] != "decoder") return name;
    return words[0] + "." + vae_half_key(words, levels);
}

std::string vae_prefix(VaeNames names) { return std::string(names == VaeNames::Checkpoint ? VaePrefix : ""); }

std::string legacy_vae_key(std::string name) {
    constexpr std::array rules{Rename{"to_q.", "query."}, Rename{"to_k.", "key."}, Rename{"to_v.", "value."},
                               Rename{"to_out.0.", "proj_attn."}};
    constexpr std::string_view marker = ".attentions.0.";
    const auto at = name.find(marker);
    if (at == std::string::npos) return name;
    const auto cut = at + marker.size();
    return name.substr(0, cut) + renamed(name.substr(cut), rules);
}

WeightSource open_clip_source(const std::string& name) {
    constexpr std::string_view layers = "text_model.encoder.layers.";
    constexpr std::array top{
        Rename{"text_model.embeddings.token_embedding.", "token_embedding."},
        Rename{"text_model.embeddings.position_embedding.weight", "positional_embedding"},
        Rename{"text_model.final_layer_norm.", "ln_final."},
    };
    constexpr std::array inner{Rename{"self_attn.out_proj.", "attn.out_proj."},
                               Rename{"layer_norm1.", "ln_1."}, Rename{"layer_norm2.", "ln_2."},
                               Rename{"mlp.fc1.", "mlp.c_fc."}, Rename{"mlp.fc2.", "mlp.c_proj."}};
    const std::string prefix = std::string(TextPrefix) + "model.";
    if (name == "text_projection.weight") return {prefix + "text_projection", -1, 1, true};
    if (!name.starts_with(layers)) return {prefix + renamed(name, top)};
    const auto words = split(name);  // text_model encoder layers i rest...
    const auto rest = join(words, 4);
    const auto block = fmt::format("{}transformer.resblocks.{}.", prefix, words[3]);
    constexpr std::array stacked{"self_attn.q_proj.", "self_attn.k_proj.", "self_attn.v_proj."};
    for (std::size_t row = 0; row < stacked.size(); ++row)
        if (rest.starts_with(stacked[row]))
            return {block + "attn.in_proj_" + words.back(), static_cast<std::int64_t>(row), 3, false};
    return {block + renamed(rest, inner)};
}

bool ignored_open_clip(const std::string& key, std::int64_t layers) {
    const std::string prefix = std::string(TextPrefix) + "model.";
    if (!key.starts_with(TextPrefix)) return true;
    for (const char* unused : {"attn_mask", "logit_scale", "text_projection"})
        if (key == prefix + unused) return true;
    const std::string blocks = prefix + "transformer.resblocks.";
    if (!key.starts_with(blocks)) return false;
    std::int64_t layer = 0;
    const char* digits = key.data() + blocks.size();
    const auto read = std::from_chars(digits, key.data() + key.size(), layer);
    return read.ec == std::errc() ? layer >= layers
                                  : read.ec == std::errc::result_out_of_range && *digits != '-';
}

const std::vector<std::int64_t>& shape_at(const SafetensorsFile& file, const std::string& key) {
    const auto found = file.entries().find(key);
    if (found == file.entries().end() || found->second.shape.empty())
        throw Error(ErrorCode::Model, fmt::format("the checkpoint has no tensor \"{}\"", key),
                    "only Stable Diffusion 1.x and 2.x checkpoints can be loaded", file.path());
    return found->second.shape;
}

}  // namespace

LoadPlan unet_plan() { return {{}, {}, "UNet"}; }

LoadPlan vae_plan(bool legacy_names) {
    LoadPlan plan{{}, {}, "VAE"};
    if (legacy_names) plan.map = [](const std::string& name) { return WeightSource{legacy_vae_key(name)}; };
    return plan;
}

LoadPlan vae_plan(const SafetensorsFile& file) {
    return vae_plan(file.contains("decoder.mid_block.attentions.0.query.weight"));
}

LoadPlan text_encoder_plan() {
    // position_ids is a counter that older files hold; text_projection is not needed for conditioning.
    return {{},
            [](const std::string& key) {
                return key == "text_model.embeddings.position_ids" || key == "text_projection.weight";
            },
            "text encoder"};
}

LoadPlan single_file_unet_plan(const UNetConfig& config) {
    return {[config](const std::string& name) {
                return WeightSource{std::string(UNetPrefix) + unet_key(name, config)};
            },
            [](const std::string& key) { return !key.starts_with(UNetPrefix); }, "checkpoint's UNet"};
}

LoadPlan single_file_vae_plan(const VaeConfig& config, VaeNames names) {
    const auto levels = static_cast<std::int64_t>(config.block_out_channels.size());
    const auto prefix = vae_prefix(names);
    return {
        [levels, prefix](const std::string& name) { return WeightSource{prefix + vae_key(name, levels)}; },
        [prefix](const std::string& key) {
            return !key.starts_with(prefix) || key.starts_with(prefix + "loss.") ||
                   key.starts_with(prefix + "model_ema.");
        },
        names == VaeNames::Checkpoint ? "checkpoint's VAE" : "VAE"};
}

LoadPlan single_file_text_plan(const TextEncoderConfig& config, SingleFileText layout) {
    LoadPlan plan;
    plan.what = "checkpoint's text encoder";
    if (layout == SingleFileText::OpenClip) {
        plan.map = open_clip_source;
        plan.ignore = [layers = config.num_hidden_layers](const std::string& key) {
            return ignored_open_clip(key, layers);
        };
        return plan;
    }
    const bool bare = layout == SingleFileText::TransformersBare;
    plan.map = [bare](const std::string& name) {
        constexpr std::string_view text_model = "text_model.";
        const bool cut = bare && name.starts_with(text_model);
        return WeightSource{std::string(TextPrefix) + "transformer." +
                            (cut ? name.substr(text_model.size()) : name)};
    };
    plan.ignore = [](const std::string& key) {
        return !key.starts_with(TextPrefix) || key.ends_with("embeddings.position_ids") ||
               key.ends_with("text_projection.weight");
    };
    return plan;
}

bool is_single_file(const SafetensorsFile& file) {
    return file.contains(fmt::format("{}input_blocks.0.0.weight", UNetPrefix));
}

bool has_vae(const SafetensorsFile& file, VaeNames names) {
    return file.contains(vae_prefix(names) + "decoder.conv_in.weight") ||
           file.contains(vae_prefix(names) + "post_quant_conv.weight");
}

VaeNames vae_names_of(const SafetensorsFile& file) {
    if (has_vae(file, VaeNames::Checkpoint)) return VaeNames::Checkpoint;
    if (file.contains("decoder.mid.block_1.conv1.weight")) return VaeNames::Bare;
    if (file.contains("decoder.mid_block.resnets.0.conv1.weight")) return VaeNames::Folder;
    throw Error(ErrorCode::Model, "this file holds no VAE of Stable Diffusion",
                "use one with encoder and decoder, of Stable Diffusion 1.x or 2.x", file.path());
}

SingleFileText single_file_text_layout(const SafetensorsFile& file) {
    const std::string prefix(TextPrefix);
    if (file.contains(prefix + "transformer.text_model.embeddings.token_embedding.weight"))
        return SingleFileText::Transformers;
    if (file.contains(prefix + "transformer.embeddings.token_embedding.weight"))
        return SingleFileText::TransformersBare;
    if (file.contains(prefix + "model.token_embedding.weight")) return SingleFileText::OpenClip;
    throw Error(ErrorCode::Model, "the checkpoint has no text encoder of Stable Diffusion 1.x or 2.x",
                "SDXL, SD 3, Flux and LoRA files cannot be used", file.path());
}

UNetConfig infer_unet_config(const SafetensorsFile& file, SingleFileText layout) {
    const std::string prefix(UNetPrefix);
    UNetConfig config;
    const auto& first = shape_at(file, prefix + "input_blocks.0.0.weight");
    if (first.size() == 4) config.in_channels = first[1];
    config.out_channels = shape_at(file, prefix + "out.2.weight")[0];
    for (std::size_t level = 0; level < config.block_out_channels.size(); ++level)
        config.block_out_channels[level] =
            shape_at(file, fmt::format("{}input_blocks.{}.0.out_layers.3.weight", prefix, 1 + 3 * level))[0];
    const auto& key = shape_at(file, prefix + "input_blocks.1.1.transformer_blocks.0.attn2.to_k.weight");
    if (key.size() == 2) config.cross_attention_dim = key[1];
    config.use_linear_projection = shape_at(file, prefix + "input_blocks.1.1.proj_in.weight").size() == 2;
    constexpr std::int64_t HeadWidth = 64;  // of SD 2.x; SD 1.x has 8 heads everywhere
    if (layout == SingleFileText::OpenClip) {
        for (std::size_t level = 0; level < config.heads.size(); ++level)
            config.heads[level] = std::max<std::int64_t>(1, config.block_out_channels[level] / HeadWidth);
        config.upcast_attention = true;
        config.sample_size = 96;
    }
    return UNetConfig::from_json(config.to_json(), file.path());
}

VaeConfig infer_vae_config(const SafetensorsFile& file, VaeNames names) {
    VaeConfig config;
    if (names == VaeNames::Folder) return config;
    const auto prefix = vae_prefix(names);
    for (std::size_t level = 0; level < config.block_out_channels.size(); ++level)
        config.block_out_channels[level] =
            shape_at(file, fmt::format("{}encoder.down.{}.block.0.conv2.weight", prefix, level))[0];
    config.latent_channels = shape_at(file, prefix + "post_quant_conv.weight")[0];
    return VaeConfig::from_json(config.to_json(), file.path());
}

TextEncoderConfig infer_text_config(const SafetensorsFile& file, SingleFileText layout) {
    const bool open_clip = layout == SingleFileText::OpenClip;
    const std::string prefix =
        std::string(TextPrefix) + (open_clip                                ? "model."
                                   : layout == SingleFileText::Transformers ? "transformer.text_model."
                                                                            : "transformer.");
    TextEncoderConfig config;
    const auto& table =
        shape_at(file, prefix + (open_clip ? "token_embedding.weight" : "embeddings.token_embedding.weight"));
    config.vocab_size = table[0];
    config.hidden_size = table.back();
    config.max_position_embeddings = shape_at(
        file, prefix + (open_clip ? "positional_embedding" : "embeddings.position_embedding.weight"))[0];
    const std::string layers = prefix + (open_clip ? "transformer.resblocks." : "encoder.layers.");
    config.num_hidden_layers = 0;
    while (file.contains(
        fmt::format("{}{}.{}.weight", layers, config.num_hidden_layers, open_clip ? "ln_1" : "layer_norm1")))
        ++config.num_hidden_layers;
    config.intermediate_size =
        shape_at(file, layers + (open_clip ? "0.mlp.c_fc.weight" : "0.mlp.fc1.weight"))[0];
    constexpr std::int64_t HeadWidth = 64;  // of CLIP-L and OpenCLIP-H
    config.num_attention_heads = std::max<std::int64_t>(1, config.hidden_size / HeadWidth);
    if (open_clip) {
        config.hidden_act = "gelu";
        // Stable Diffusion 2 takes the layer before the last, then the final norm.
        config.num_hidden_layers -= 1;
    }
    return TextEncoderConfig::from_json(config.to_json(), file.path());
}

}  // namespace gse::neural
