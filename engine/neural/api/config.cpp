// Reading and writing the networks' configurations; what the code does not implement is refused by name.
#include "engine/neural/api/config.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/json.h"

namespace gse::neural {
namespace {

// Reads the fields of one config file and complains with its path.
class Reader {
public:
    Reader(const Json& json, const std::filesystem::path& path) : json_(json), path_(path) {
        if (!json.is_object())
            throw Error(ErrorCode::Malformed, "the network's configuration is not a JSON object", {}, path);
    }

    template <class T> void get(const char* key, T& value) const {
        if (!has(key)) return;
        if constexpr (std::is_same_v<T, std::int64_t>) {  // 1e300 is no whole number, and its conversion
                                                          // means nothing
            constexpr double largest = 1e15;
            if (json_.at(key).is_number_float() &&
                !(std::abs(json_.at(key).template get<double>()) <= largest))
                throw Error(ErrorCode::Malformed,
                            fmt::format("the configuration's \"{}\" is out of range", key), {}, path_);
        }
        try {
            json_.at(key).get_to(value);
        } catch (const nlohmann::json::exception&) {
            throw Error(ErrorCode::Malformed,
                        fmt::format("the configuration's \"{}\" has the wrong type", key), {}, path_);
        }
    }
    bool has(const char* key) const { return json_.contains(key) && !json_.at(key).is_null(); }

    /// Keys that change the network in ways that are not implemented: only these values are accepted.
    void expect(const char* key, std::initializer_list<Json> allowed) const {
        if (!has(key) || std::find(allowed.begin(), allowed.end(), json_.at(key)) != allowed.end()) return;
        refuse(fmt::format("the configuration's \"{}\": {} is not supported", key, json_.at(key).dump()));
    }
    void expect_absent(const char* key) const {
        if (has(key)) refuse(fmt::format("the configuration asks for \"{}\", which is not supported", key));
    }
    /// Reads a key that tells what the model is.
    void expect_absent(const char* key, const char* model) const {
        if (has(key))
            refuse(fmt::format("this is {}: the configuration asks for \"{}\", which is not supported", model,
                               key));
    }
    void positive(const char* key, std::int64_t value, std::int64_t limit) const {
        if (value < 1 || value > limit)
            throw Error(ErrorCode::Malformed,
                        fmt::format("the configuration's \"{}\" is {}, outside 1..{}", key, value, limit), {},
                        path_);
    }
    [[noreturn]] void refuse(const std::string& message) const {
        throw Error(ErrorCode::Model, message, "only Stable Diffusion 1.x and 2.x structures can be loaded",
                    path_);
    }
    [[noreturn]] void malformed(const std::string& message) const {
        throw Error(ErrorCode::Malformed, message, {}, path_);
    }
    const Json& json() const { return json_; }

private:
    const Json& json_;
    const std::filesystem::path& path_;
};

constexpr std::int64_t MaxWidth = 1 << 16;
constexpr std::int64_t MaxLevels = 8;
constexpr std::int64_t MaxSide = 8192;  // latent cells, or pixels

void check_levels(const Reader& reader, const std::vector<std::int64_t>& channels, std::int64_t groups,
                  std::int64_t layers) {
    reader.positive("norm_num_groups", groups, MaxWidth);
    reader.positive("layers_per_block", layers, 16);
    reader.positive("block_out_channels (count)", static_cast<std::int64_t>(channels.size()), MaxLevels);
    for (const auto width : channels) {
        reader.positive("block_out_channels", width, MaxWidth);
        if (width % groups != 0)
            reader.malformed(fmt::format("{} channels cannot be split into {} norm groups", width, groups));
    }
}

std::vector<std::int64_t> read_heads(const Reader& reader, std::size_t levels) {
    // "attention_head_dim" is the number of heads; "num_attention_heads" is its later,
    // right name.
    const char* key = reader.has("num_attention_heads") ? "num_attention_heads" : "attention_head_dim";
    std::vector<std::int64_t> heads(levels, 8);
    if (!reader.has(key)) return heads;
    if (reader.json().at(key).is_array()) {
        reader.get(key, heads);
    } else {
        std::int64_t same = 8;
        reader.get(key, same);
        heads.assign(levels, same);
    }
    return heads;
}

void check_attention(const Reader& reader, const UNetConfig& config) {
    const auto levels = config.block_out_channels.size();
    if (config.heads.size() != levels || config.down_block_types.size() != levels ||
        config.up_block_types.size() != levels)
        reader.malformed("the lists of block types, channels and heads have different lengths");
    for (std::size_t i = 0; i < levels; ++i) {
        reader.positive("attention_head_dim", config.heads[i], 1024);
        if (config.block_out_channels[i] % config.heads[i] != 0)
            reader.malformed(fmt::format("{} channels cannot be split into {} heads",
                                         config.block_out_channels[i], config.heads[i]));
        const auto& down = config.down_block_types[i];
        const auto& up = config.up_block_types[levels - 1 - i];
        if (down != "DownBlock2D" && down != "CrossAttnDownBlock2D")
            reader.refuse("unknown block type \"" + down + "\"");
        if (up != "UpBlock2D" && up != "CrossAttnUpBlock2D")
            reader.refuse("unknown block type \"" + up + "\"");
    }
}

/// Keys a text encoder's configuration has; absent ones keep their value.
void read_text_keys(const Reader& reader, TextEncoderConfig& config) {
    reader.expect("model_type", {"clip_text_model"});
    reader.expect("hidden_act", {"quick_gelu", "gelu"});
    reader.get("vocab_size", config.vocab_size);
    reader.get("hidden_size", config.hidden_size);
    reader.get("intermediate_size", config.intermediate_size);
    reader.get("projection_dim", config.projection_dim);
    reader.get("num_hidden_layers", config.num_hidden_layers);
    reader.get("num_attention_heads", config.num_attention_heads);
    reader.get("max_position_embeddings", config.max_position_embeddings);
    reader.get("hidden_act", config.hidden_act);
    reader.get("layer_norm_eps", config.layer_norm_eps);
    reader.get("bos_token_id", config.bos_token_id);
    reader.get("eos_token_id", config.eos_token_id);
    reader.get("pad_token_id", config.pad_token_id);
    reader.positive("vocab_size", config.vocab_size, 1 << 24);
    reader.positive("hidden_size", config.hidden_size, MaxWidth);
    reader.positive("intermediate_size", config.intermediate_size, MaxWidth);
    reader.positive("num_hidden_layers", config.num_hidden_layers, 256);
    reader.positive("num_attention_heads", config.num_attention_heads, 1024);
    reader.positive("max_position_embeddings", config.max_position_embeddings, MaxWidth);
    if (config.hidden_size % config.num_attention_heads != 0)
        reader.malformed("the text encoder's hidden_size is not a multiple of its number of heads");
}

}  // namespace

Json read_json_file(const std::filesystem::path& path) {
    try {
        return parse_json<Json>(read_file(path), "the file");
    } catch (const Error& error) {
        if (!error.path().empty()) throw;
        throw Error(error.code(), error.message(), {}, path);
    }
}

UNetConfig UNetConfig::from_json(const Json& json, const std::filesystem::path& path) {
    const Reader reader(json, path);
    reader.expect("_class_name", {"UNet2DConditionModel"});
    reader.expect("act_fn", {"silu", "swish"});
    reader.expect("center_input_sample", {false});
    reader.expect("mid_block_scale_factor", {1, 1.0});
    reader.expect("mid_block_type", {"UNetMidBlock2DCrossAttn"});
    reader.expect("dual_cross_attention", {false});
    reader.expect("only_cross_attention", {false});
    reader.expect("resnet_time_scale_shift", {"default"});
    reader.expect("transformer_layers_per_block", {1});
    reader.expect("time_embedding_type", {"positional"});
    reader.expect("conv_in_kernel", {3});
    reader.expect("conv_out_kernel", {3});
    reader.expect_absent("addition_embed_type", "SDXL or a later model");
    reader.expect_absent("num_class_embeds", "an upscaler or another model of classes");
    reader.expect_absent("class_embed_type", "a model of classes or unCLIP");
    reader.expect_absent("encoder_hid_dim", "a model that is told by another encoder (Kandinsky, IF)");
    for (const char* key : {"time_embedding_dim", "time_embedding_act_fn", "timestep_post_act"})
        reader.expect_absent(key);
    UNetConfig config;
    if (reader.has("sample_size") && json.at("sample_size").is_number())
        reader.get("sample_size", config.sample_size);
    reader.positive("sample_size", config.sample_size, MaxSide);
    reader.get("in_channels", config.in_channels);
    reader.get("out_channels", config.out_channels);
    reader.get("flip_sin_to_cos", config.flip_sin_to_cos);
    reader.get("freq_shift", config.freq_shift);
    reader.get("down_block_types", config.down_block_types);
    reader.get("up_block_types", config.up_block_types);
    reader.get("block_out_channels", config.block_out_channels);
    reader.get("layers_per_block", config.layers_per_block);
    reader.get("downsample_padding", config.downsample_padding);
    reader.get("norm_num_groups", config.norm_num_groups);
    reader.get("norm_eps", config.norm_eps);
    reader.get("cross_attention_dim", config.cross_attention_dim);
    reader.get("use_linear_projection", config.use_linear_projection);
    reader.get("upcast_attention", config.upcast_attention);
    if (reader.has("time_cond_proj_dim")) {
        reader.get("time_cond_proj_dim", config.time_cond_proj_dim);
        reader.positive("time_cond_proj_dim", config.time_cond_proj_dim, MaxWidth);
    }
    config.heads = read_heads(reader, config.block_out_channels.size());
    reader.positive("in_channels", config.in_channels, 64);
    reader.positive("out_channels", config.out_channels, 64);
    reader.positive("cross_attention_dim", config.cross_attention_dim, MaxWidth);
    check_levels(reader, config.block_out_channels, config.norm_num_groups, config.layers_per_block);
    check_attention(reader, config);
    return config;
}

Json UNetConfig::to_json() const {
    Json json = {
        {"_class_name", "UNet2DConditionModel"}, {"_diffusers_version", "0.6.0"}, {"act_fn", "silu"}};
    json["attention_head_dim"] = heads;
    json["block_out_channels"] = block_out_channels;
    json["center_input_sample"] = false;
    json["cross_attention_dim"] = cross_attention_dim;
    json["down_block_types"] = down_block_types;
    json["downsample_padding"] = downsample_padding;
    json["flip_sin_to_cos"] = flip_sin_to_cos;
    json["freq_shift"] = freq_shift;
    json["in_channels"] = in_channels;
    json["layers_per_block"] = layers_per_block;
    json["mid_block_scale_factor"] = 1;
    json["norm_eps"] = norm_eps;
    json["norm_num_groups"] = norm_num_groups;
    json["out_channels"] = out_channels;
    json["sample_size"] = sample_size;
    if (time_cond_proj_dim > 0) json["time_cond_proj_dim"] = time_cond_proj_dim;
    json["up_block_types"] = up_block_types;
    json["upcast_attention"] = upcast_attention;
    json["use_linear_projection"] = use_linear_projection;
    return json;
}

VaeConfig VaeConfig::from_json(const Json& json, const std::filesystem::path& path) {
    const Reader reader(json, path);
    reader.expect("_class_name", {"AutoencoderKL"});
    reader.expect("act_fn", {"silu", "swish"});
    reader.expect("mid_block_add_attention", {true});
    reader.expect("use_quant_conv", {true});
    reader.expect("use_post_quant_conv", {true});
    for (const char* key : {"shift_factor", "latents_mean", "latents_std"}) reader.expect_absent(key);
    VaeConfig config;
    if (reader.has("sample_size") && json.at("sample_size").is_number())
        reader.get("sample_size", config.sample_size);
    reader.positive("sample_size", config.sample_size, MaxSide);
    reader.get("in_channels", config.in_channels);
    reader.get("out_channels", config.out_channels);
    reader.get("latent_channels", config.latent_channels);
    reader.get("block_out_channels", config.block_out_channels);
    reader.get("layers_per_block", config.layers_per_block);
    reader.get("norm_num_groups", config.norm_num_groups);
    reader.get("scaling_factor", config.scaling_factor);
    reader.positive("in_channels", config.in_channels, 16);
    reader.positive("out_channels", config.out_channels, 16);
    reader.positive("latent_channels", config.latent_channels, 64);
    check_levels(reader, config.block_out_channels, config.norm_num_groups, config.layers_per_block);
    return config;
}

Json VaeConfig::to_json() const {
    const auto levels = block_out_channels.size();
    Json json = {{"_class_name", "AutoencoderKL"}, {"_diffusers_version", "0.6.0"}, {"act_fn", "silu"}};
    json["block_out_channels"] = block_out_channels;
    json["down_block_types"] = std::vector<std::string>(levels, "DownEncoderBlock2D");
    json["in_channels"] = in_channels;
    json["latent_channels"] = latent_channels;
    json["layers_per_block"] = layers_per_block;
    json["norm_num_groups"] = norm_num_groups;
    json["out_channels"] = out_channels;
    json["sample_size"] = sample_size;
    json["scaling_factor"] = scaling_factor;
    json["up_block_types"] = std::vector<std::string>(levels, "UpDecoderBlock2D");
    return json;
}

TinyAutoencoderConfig TinyAutoencoderConfig::from_json(const Json& json, const std::filesystem::path& path) {
    const Reader reader(json, path);
    reader.expect("_class_name", {"AutoencoderTiny"});
    reader.expect("act_fn", {"relu"});
    reader.expect("upsampling_scaling_factor", {2});
    reader.expect("latent_magnitude", {3, 3.0});
    TinyAutoencoderConfig config;
    std::vector<std::int64_t> encoder_widths, decoder_widths;
    reader.get("in_channels", config.in_channels);
    reader.get("out_channels", config.out_channels);
    reader.get("latent_channels", config.latent_channels);
    reader.get("encoder_block_out_channels", encoder_widths);
    reader.get("decoder_block_out_channels", decoder_widths);
    reader.get("num_encoder_blocks", config.encoder_blocks);
    reader.get("num_decoder_blocks", config.decoder_blocks);
    reader.get("scaling_factor", config.scaling_factor);
    encoder_widths.insert(encoder_widths.end(), decoder_widths.begin(), decoder_widths.end());
    if (!encoder_widths.empty()) config.channels = encoder_widths.front();
    for (const auto width : encoder_widths)
        if (width != config.channels)
            reader.refuse("a tiny autoencoder whose layers differ in width is not supported");
    reader.positive("in_channels", config.in_channels, 16);
    reader.positive("out_channels", config.out_channels, 16);
    reader.positive("latent_channels", config.latent_channels, 64);
    reader.positive("encoder_block_out_channels", config.channels, MaxWidth);
    for (const auto* blocks : {&config.encoder_blocks, &config.decoder_blocks}) {
        reader.positive("num_encoder_blocks (count)", static_cast<std::int64_t>(blocks->size()), MaxLevels);
        for (const auto count : *blocks) reader.positive("num_encoder_blocks", count, 64);
    }
    if (config.encoder_blocks.size() != config.decoder_blocks.size())
        reader.malformed("the tiny autoencoder's halves have different numbers of levels");
    if (!(config.scaling_factor > 0))
        reader.malformed("the tiny autoencoder's \"scaling_factor\" must be above 0");
    return config;
}

Json TinyAutoencoderConfig::to_json() const {
    const auto levels = encoder_blocks.size();
    Json json = {{"_class_name", "AutoencoderTiny"}, {"_diffusers_version", "0.20.0"}, {"act_fn", "relu"}};
    json["decoder_block_out_channels"] = std::vector<std::int64_t>(levels, channels);
    json["encoder_block_out_channels"] = std::vector<std::int64_t>(levels, channels);
    json["in_channels"] = in_channels;
    json["latent_channels"] = latent_channels;
    json["latent_magnitude"] = 3;
    json["num_decoder_blocks"] = decoder_blocks;
    json["num_encoder_blocks"] = encoder_blocks;
    json["out_channels"] = out_channels;
    json["scaling_factor"] = scaling_factor;
    json["upsampling_scaling_factor"] = 2;
    return json;
}

TextEncoderConfig TextEncoderConfig::from_json(const Json& json, const std::filesystem::path& path) {
    const Reader reader(json, path);
    TextEncoderConfig config;
    if (reader.has("architectures") && json.at("architectures").is_array())
        for (const auto& name : json.at("architectures"))
            config.with_projection |= name == "CLIPTextModelWithProjection";
    read_text_keys(reader, config);
    return config;
}

Json TextEncoderConfig::to_json() const {
    Json json;
    json["architectures"] = {with_projection ? "CLIPTextModelWithProjection" : "CLIPTextModel"};
    json["attention_dropout"] = 0.0;
    json["bos_token_id"] = bos_token_id;
    json["eos_token_id"] = eos_token_id;
    json["hidden_act"] = hidden_act;
    json["hidden_size"] = hidden_size;
    json["initializer_factor"] = 1.0;
    json["initializer_range"] = 0.02;
    json["intermediate_size"] = intermediate_size;
    json["layer_norm_eps"] = layer_norm_eps;
    json["max_position_embeddings"] = max_position_embeddings;
    json["model_type"] = "clip_text_model";
    json["num_attention_heads"] = num_attention_heads;
    json["num_hidden_layers"] = num_hidden_layers;
    json["pad_token_id"] = pad_token_id;
    json["projection_dim"] = projection_dim;
    json["vocab_size"] = vocab_size;
    return json;
}

VisionEncoderConfig VisionEncoderConfig::from_json(const Json& json, const std::filesystem::path& path) {
    const Reader reader(json, path);
    reader.expect("model_type", {"clip_vision_model", "clipseg_vision_model"});
    reader.expect("hidden_act", {"quick_gelu", "gelu"});
    VisionEncoderConfig config;
    reader.get("hidden_size", config.hidden_size);
    reader.get("intermediate_size", config.intermediate_size);
    reader.get("num_hidden_layers", config.num_hidden_layers);
    reader.get("num_attention_heads", config.num_attention_heads);
    reader.get("num_channels", config.num_channels);
    reader.get("image_size", config.image_size);
    reader.get("patch_size", config.patch_size);
    reader.get("hidden_act", config.hidden_act);
    reader.get("layer_norm_eps", config.layer_norm_eps);
    reader.positive("hidden_size", config.hidden_size, MaxWidth);
    reader.positive("intermediate_size", config.intermediate_size, MaxWidth);
    reader.positive("num_hidden_layers", config.num_hidden_layers, 256);
    reader.positive("num_attention_heads", config.num_attention_heads, 1024);
    reader.positive("image_size", config.image_size, 8192);
    reader.positive("patch_size", config.patch_size, config.image_size);
    if (config.num_channels != 3) reader.malformed("the image encoder does not take three channels");
    if (config.image_size % config.patch_size != 0)
        reader.malformed("the image encoder's image_size is not a multiple of its patch_size");
    if (config.hidden_size % config.num_attention_heads != 0)
        reader.malformed("the image encoder's hidden_size is not a multiple of its number of heads");
    return config;
}

Json VisionEncoderConfig::to_json() const {
    Json json;
    json["hidden_act"] = hidden_act;
    json["hidden_size"] = hidden_size;
    json["image_size"] = image_size;
    json["intermediate_size"] = intermediate_size;
    json["layer_norm_eps"] = layer_norm_eps;
    json["model_type"] = "clip_vision_model";
    json["num_attention_heads"] = num_attention_heads;
    json["num_channels"] = num_channels;
    json["num_hidden_layers"] = num_hidden_layers;
    json["patch_size"] = patch_size;
    return json;
}

namespace {

ClipConfig read_towers(const Reader& reader, const std::filesystem::path& path) {
    const Json& json = reader.json();
    ClipConfig config;
    reader.get("projection_dim", config.projection_dim);
    reader.positive("projection_dim", config.projection_dim, MaxWidth);
    // Defaults are those of CLIP ViT-B/32, which transformers leaves out of the file.
    config.text.hidden_size = 512;
    config.text.intermediate_size = 2048;
    config.text.num_attention_heads = 8;
    if (reader.has("text_config")) read_text_keys(Reader(json.at("text_config"), path), config.text);
    if (reader.has("vision_config"))
        config.vision = VisionEncoderConfig::from_json(json.at("vision_config"), path);
    config.text.projection_dim = config.projection_dim;
    config.text.with_projection = true;
    return config;
}

}  // namespace

ClipConfig ClipConfig::from_json(const Json& json, const std::filesystem::path& path) {
    const Reader reader(json, path);
    reader.expect("model_type", {"clip"});
    return read_towers(reader, path);
}

ClipSegConfig ClipSegConfig::from_json(const Json& json, const std::filesystem::path& path) {
    const Reader reader(json, path);
    if (!reader.has("model_type") || json.at("model_type") != "clipseg")
        throw Error(ErrorCode::Model, "this is no CLIPSeg model",
                    "its config.json says \"model_type\": \"clipseg\"", path);
    ClipSegConfig config;
    config.clip = read_towers(reader, path);
    reader.get("extract_layers", config.extract_layers);
    reader.get("reduce_dim", config.reduce_dim);
    reader.get("decoder_num_attention_heads", config.decoder_num_attention_heads);
    reader.get("decoder_intermediate_size", config.decoder_intermediate_size);
    reader.get("conditional_layer", config.conditional_layer);
    reader.get("use_complex_transposed_convolution", config.use_complex_transposed_convolution);
    reader.positive("reduce_dim", config.reduce_dim, MaxWidth);
    reader.positive("decoder_num_attention_heads", config.decoder_num_attention_heads, config.reduce_dim);
    reader.positive("decoder_intermediate_size", config.decoder_intermediate_size, MaxWidth);
    reader.positive("extract_layers (count)", static_cast<std::int64_t>(config.extract_layers.size()),
                    config.clip.vision.num_hidden_layers);
    for (const auto layer : config.extract_layers)
        if (layer < 0 || layer >= config.clip.vision.num_hidden_layers)
            reader.malformed(fmt::format("\"extract_layers\" names the layer {}, which is not there", layer));
    if (config.reduce_dim % config.decoder_num_attention_heads != 0)
        reader.malformed("\"reduce_dim\" is not a multiple of \"decoder_num_attention_heads\"");
    if (config.use_complex_transposed_convolution && config.clip.vision.patch_size % 4 != 0)
        reader.malformed("the image encoder's patch_size is not a multiple of 4");
    return config;
}

Json ClipConfig::to_json() const {
    return {{"architectures", {"CLIPModel"}},
            {"model_type", "clip"},
            {"projection_dim", projection_dim},
            {"text_config", text.to_json()},
            {"vision_config", vision.to_json()}};
}

SchedulerConfig SchedulerConfig::from_json(const Json& json, const std::filesystem::path& path) {
    const Reader reader(json, path);
    reader.expect("beta_schedule", {"scaled_linear", "linear", "squaredcos_cap_v2"});
    reader.expect("prediction_type", {"epsilon", "v_prediction", "sample"});
    reader.expect("timestep_spacing", {"leading", "linspace", "trailing"});
    reader.expect_absent("trained_betas");
    SchedulerConfig config;
    config.steps_offset = 0;
    reader.get("_class_name", config.class_name);
    config.set_alpha_to_one = config.class_name == "DDIMScheduler";  // diffusers' default; PNDM's is false
    reader.get("num_train_timesteps", config.num_train_timesteps);
    config.beta_start = 0.0001;
    config.beta_end = 0.02;
    config.beta_schedule = "linear";
    reader.get("beta_start", config.beta_start);
    reader.get("beta_end", config.beta_end);
    reader.get("beta_schedule", config.beta_schedule);
    reader.get("prediction_type", config.prediction_type);
    reader.get("timestep_spacing", config.timestep_spacing);
    reader.get("steps_offset", config.steps_offset);
    reader.get("set_alpha_to_one", config.set_alpha_to_one);
    reader.get("clip_sample", config.clip_sample);
    reader.get("clip_sample_range", config.clip_sample_range);
    reader.get("original_inference_steps", config.original_inference_steps);
    reader.get("timestep_scaling", config.timestep_scaling);
    reader.get("rescale_betas_zero_snr", config.rescale_betas_zero_snr);
    reader.positive("num_train_timesteps", config.num_train_timesteps, 1 << 20);
    reader.positive("original_inference_steps", config.original_inference_steps, config.num_train_timesteps);
    if (config.clip_sample_range <= 0 || config.timestep_scaling <= 0)
        reader.malformed("the scheduler's \"clip_sample_range\" and \"timestep_scaling\" must be above 0");
    return config;
}

Json SchedulerConfig::to_json() const {
    Json json = {{"_class_name", class_name}, {"_diffusers_version", "0.8.0"}};
    json["beta_end"] = beta_end;
    json["beta_schedule"] = beta_schedule;
    json["beta_start"] = beta_start;
    json["clip_sample"] = clip_sample;
    json["num_train_timesteps"] = num_train_timesteps;
    if (class_name == "LCMScheduler" || class_name == "TCDScheduler") {
        json["original_inference_steps"] = original_inference_steps;
        json["timestep_scaling"] = timestep_scaling;
    }
    json["prediction_type"] = prediction_type;
    if (rescale_betas_zero_snr) json["rescale_betas_zero_snr"] = true;
    json["set_alpha_to_one"] = set_alpha_to_one;
    json["skip_prk_steps"] = true;
    json["steps_offset"] = steps_offset;
    if (!timestep_spacing.empty()) json["timestep_spacing"] = timestep_spacing;
    json["trained_betas"] = nullptr;
    return json;
}

}  // namespace gse::neural
