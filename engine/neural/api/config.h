// Configurations of the networks as diffusers and transformers write them (config.json), with their defaults.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace gse::neural {

using Json = nlohmann::ordered_json;

/// Contents of unet/config.json. The kind of prediction (noise or velocity) stands in the scheduler's config.
struct UNetConfig {
    std::int64_t sample_size = 64;  // side of the latent the model was trained at
    std::int64_t in_channels = 4;
    std::int64_t out_channels = 4;
    bool flip_sin_to_cos = true;
    double freq_shift = 0;
    std::vector<std::string> down_block_types = {"CrossAttnDownBlock2D", "CrossAttnDownBlock2D",
                                                 "CrossAttnDownBlock2D", "DownBlock2D"};
    std::vector<std::string> up_block_types = {"UpBlock2D", "CrossAttnUpBlock2D", "CrossAttnUpBlock2D",
                                               "CrossAttnUpBlock2D"};
    std::vector<std::int64_t> block_out_channels = {320, 640, 1280, 1280};
    std::int64_t layers_per_block = 2;
    std::int64_t downsample_padding = 1;
    std::int64_t norm_num_groups = 32;
    double norm_eps = 1e-5;
    std::int64_t cross_attention_dim = 768;
    std::vector<std::int64_t> heads = {8, 8, 8, 8};  // per down block; "attention_head_dim" in the file
    bool use_linear_projection = false;
    bool upcast_attention = false;
    /// Width of the embedding of a guidance scale that the network takes beside the timestep (LCM); 0 = none.
    std::int64_t time_cond_proj_dim = 0;
    /// Width of what it is told of each picture's camera (camera_features()); 0 = nothing. Not in the file: a
    /// LoRA for shapes brings it.
    std::int64_t camera_dim = 0;
    /// Channels in which it is shown the picture that is to change (inpainting()); 0 = none. Not in the file
    /// either.
    std::int64_t inpaint_channels = 0;
    /// Pixels of an outline along the side of a latent cell; 0 = the network predicts no outlines. Not in the
    /// file either.
    std::int64_t outline_scale = 0;

    /// Throws Error (Model, Malformed) naming the key that is wrong or not supported.
    static UNetConfig from_json(const Json& json, const std::filesystem::path& path);
    Json to_json() const;
};

/// vae/config.json.
struct VaeConfig {
    std::int64_t sample_size = 512;
    std::int64_t in_channels = 3;
    std::int64_t out_channels = 3;
    std::int64_t latent_channels = 4;
    std::vector<std::int64_t> block_out_channels = {128, 256, 512, 512};
    std::int64_t layers_per_block = 2;
    std::int64_t norm_num_groups = 32;
    double scaling_factor = 0.18215;  // absent in old files

    /// Pixels per latent cell.
    std::int64_t factor() const { return std::int64_t{1} << (block_out_channels.size() - 1); }
    static VaeConfig from_json(const Json& json, const std::filesystem::path& path);
    Json to_json() const;
};

/// config.json of a tiny autoencoder (AutoencoderTiny); the defaults are TAESD's.
struct TinyAutoencoderConfig {
    std::int64_t in_channels = 3;
    std::int64_t out_channels = 3;
    std::int64_t latent_channels = 4;
    std::int64_t channels = 64;  // of every layer between
    std::vector<std::int64_t> encoder_blocks = {1, 3, 3, 3};
    std::vector<std::int64_t> decoder_blocks = {3, 3, 3, 1};
    double scaling_factor = 1;

    /// Pixels per latent cell.
    std::int64_t factor() const { return std::int64_t{1} << (encoder_blocks.size() - 1); }
    static TinyAutoencoderConfig from_json(const Json& json, const std::filesystem::path& path);
    Json to_json() const;
};

/// text_encoder/config.json (CLIPTextModel, CLIPTextModelWithProjection).
struct TextEncoderConfig {
    std::int64_t vocab_size = 49408;
    std::int64_t hidden_size = 768;
    std::int64_t intermediate_size = 3072;
    std::int64_t projection_dim = 768;
    bool with_projection = false;  // has a text_projection layer
    std::int64_t num_hidden_layers = 12;
    std::int64_t num_attention_heads = 12;
    std::int64_t max_position_embeddings = 77;
    std::string hidden_act = "quick_gelu";
    double layer_norm_eps = 1e-5;
    std::int64_t bos_token_id = 0;
    std::int64_t eos_token_id = 2;  // 2 is the legacy value: then the largest id marks the end
    std::int64_t pad_token_id = 1;

    static TextEncoderConfig from_json(const Json& json, const std::filesystem::path& path);
    Json to_json() const;
};

/// "vision_config" of a CLIP model's config.json (CLIPVisionModel).
struct VisionEncoderConfig {
    std::int64_t hidden_size = 768;
    std::int64_t intermediate_size = 3072;
    std::int64_t num_hidden_layers = 12;
    std::int64_t num_attention_heads = 12;
    std::int64_t num_channels = 3;
    std::int64_t image_size = 224;
    std::int64_t patch_size = 32;
    std::string hidden_act = "quick_gelu";
    double layer_norm_eps = 1e-5;

    static VisionEncoderConfig from_json(const Json& json, const std::filesystem::path& path);
    Json to_json() const;
};

/// config.json of a contrastive image-text model (CLIPModel).
struct ClipConfig {
    TextEncoderConfig text;  // with projection
    VisionEncoderConfig vision;
    std::int64_t projection_dim = 512;

    static ClipConfig from_json(const Json& json, const std::filesystem::path& path);
    Json to_json() const;
};

/// config.json of CLIPSeg (CLIPSegForImageSegmentation): CLIP's towers and a small decoder on top.
struct ClipSegConfig {
    ClipConfig clip;
    std::vector<std::int64_t> extract_layers = {3, 6, 9};  // of the image encoder, that the decoder is shown
    std::int64_t reduce_dim = 64;
    std::int64_t decoder_num_attention_heads = 4;
    std::int64_t decoder_intermediate_size = 2048;
    std::int64_t conditional_layer = 0;  // where the words come in
    bool use_complex_transposed_convolution = false;

    static ClipSegConfig from_json(const Json& json, const std::filesystem::path& path);
};

/// scheduler/scheduler_config.json.
struct SchedulerConfig {
    std::string class_name = "DDIMScheduler";
    std::int64_t num_train_timesteps = 1000;
    double beta_start = 0.00085;
    double beta_end = 0.012;
    std::string beta_schedule = "scaled_linear";
    std::string prediction_type = "epsilon";
    std::string timestep_spacing;  // empty = the default of each scheduler
    std::int64_t steps_offset = 1;
    bool set_alpha_to_one = false;
    bool clip_sample = false;
    double clip_sample_range = 1;
    // Models distilled to few steps (LCM, TCD)
    std::int64_t original_inference_steps = 50;  // of the solver they were distilled from
    double timestep_scaling = 10;
    bool rescale_betas_zero_snr = false;  // the last noise level is pure noise (Lin et al. 2024, algorithm 1)

    static SchedulerConfig from_json(const Json& json, const std::filesystem::path& path);
    Json to_json() const;
};

/// Parses a JSON file. Throws Error (NotFound, Malformed).
Json read_json_file(const std::filesystem::path& path);

}  // namespace gse::neural
