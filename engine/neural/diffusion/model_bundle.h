// A whole text-to-image model: tokenizer, text encoder, UNet, VAE, noise schedule, and what the model says
// about itself.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "engine/neural/api/bundle_kind.h"
#include "engine/neural/api/tokenizer.h"
#include "engine/neural/diffusion/schedulers.h"
#include "engine/neural/diffusion/taesd.h"
#include "engine/neural/diffusion/text_encoder.h"
#include "engine/neural/diffusion/unet.h"
#include "engine/neural/diffusion/upscaler.h"
#include "engine/neural/diffusion/vae.h"
#include "engine/neural/weights/lora.h"

namespace gse::neural {

/// gseditpro.json beside model_index.json; every key may be missing.
struct ModelFacts {
    std::string name;
    /// 0 = the UNet's sample_size times the VAE's factor.
    std::int64_t image_size = 0;
    /// Binarisation of the maps; the paper's value unless the model was measured to work better with another.
    double attention_threshold = 0.5;
    /// Beginnings of the names of the layers looked at; empty = "down_blocks" and "up_blocks".
    std::vector<std::string> attention_layers;
    /// Heights of the maps looked at; empty = latent size, and its half and quarter unless layers are named.
    std::vector<std::int64_t> attention_sizes;
    /// Noise levels probed, as shares of the schedule; empty = 0.3, 0.5, 0.7.
    std::vector<double> attention_timesteps;
    /// Noise levels for objects that are not in the image yet; empty = 0.8, 0.85, 0.9.
    std::vector<double> attention_absent_timesteps;
    /// Words the model was trained on; empty = an open vocabulary.
    std::vector<std::string> vocabulary;
    /// Words that only the network of `shape_unet` was trained on besides: it is told them where it draws,
    /// nothing else is.
    std::vector<std::string> drawn_vocabulary;
    /// "plain", "lcm", "tcd" or "turbo" where the configurations do not tell; see bundle_kind().
    std::string kind;
    /// Folder of the tiny autoencoder, relative to the model's; "none" = the one beside it is not used.
    std::string taesd;
    /// LoRA for redrawing views in which a new thing comes to be, relative to the model's folder. Such a
    /// model is told the side exactly: it knows the eight of edit::side_blend(), and what lies between two by
    /// the mixture of both sentences. Empty = it has none.
    std::string shape_lora;
    /// File of that LoRA's scene inputs (with_scene_inputs()), relative to the model's folder. Empty = the
    /// LoRA has none.
    std::string shape_cameras;
    /// Folder of a UNet of its own for new objects (load_shape_unet()), relative to the model's folder. It
    /// takes the place of LoRA and scene inputs; tunings and LoRAs do not change it. Empty = none.
    std::string shape_unet;
    /// Tells whether that network can change colour, material or ground of what it is shown.
    bool shape_restyles = false;
    /// Folder of the classifier that tells from where a picture shows a thing (ViewpointReader), relative to
    /// the model's; it needs an image-text encoder beside it. Empty = it has none.
    std::string viewpoint;
    /// Folder of the decoder to pictures of UpscaleFactor times the size, relative to the model's. It takes
    /// the place of a plain enlargement where new objects are drawn. Empty = it has none.
    std::string upscaler;
    /// Views of a scene that are denoised together with it (SceneViews).
    std::int64_t shape_views = 1;

    static ModelFacts from_json(const Json& json, const std::filesystem::path& path);
};

/// Description of a model, read from its small files and headers only.
struct ModelDescription {
    std::string name;
    std::string layout;  // "diffusers folder" or "single file"
    std::int64_t image_size = 0;
    std::int64_t parameters = 0;
    std::string prediction;  // "epsilon" or "v_prediction"
    std::vector<std::string> vocabulary;
    BundleKind kind = BundleKind::Plain;
};

struct ModelBundle {
    std::filesystem::path path;
    Tokenizer tokenizer;
    ClipTextEncoder text_encoder;
    UNet unet;
    AutoencoderKl vae;
    NoiseSchedule schedule;
    ModelFacts facts;
    torch::Device device = torch::kCPU;
    BundleKind kind = BundleKind::Plain;
    TinyAutoencoder tiny{nullptr};        // where its files are
    std::vector<std::string> notes = {};  // TextToImage::notes()

    Upscaler upscaler{nullptr};  // where its facts name one

    bool has_tiny() const { return !tiny.is_empty(); }
    std::int64_t latent_channels() const { return vae->config().latent_channels; }
    /// Tokens of a prompt: the tokenizer's length, at most what the text encoder can take.
    std::int64_t token_count() const;
    std::int64_t image_size() const { return facts.image_size; }
    std::int64_t latent_size() const { return facts.image_size / vae->config().factor(); }
    double scaling_factor() const { return vae->config().scaling_factor; }
    /// The sentence as the text encoder is given it: without words that a model of a fixed vocabulary was not
    /// trained on. In pieces of letters that mean nothing to it they disturb all others: "a shiny blue bear"
    /// was not blue.
    std::string model_prompt(const std::string& sentence) const;
    /// Token ids [B,T] and conditioning [B,T,D] of some prompts, without a graph.
    torch::Tensor token_ids(const std::vector<std::string>& prompts) const;
    torch::Tensor encode_prompts(const std::vector<std::string>& prompts) const;
};

/// Loads a diffusers folder or a single-file checkpoint (.safetensors). All weights are frozen, and fp32 but
/// for those of the UNet, where `precision` says otherwise (choose_precision). `taesd`: folder of the tiny
/// autoencoder; empty = as the model says, or "taesd" beside the weights, "none" = none. Throws Error
/// (NotFound, Malformed, Model, Unsupported, InvalidArgument) with one sentence.
ModelBundle load_bundle(const std::filesystem::path& path, const torch::Device& device = torch::kCPU,
                        const std::string& taesd = {}, const std::string& precision = "fp32");

/// Fits a LoRA to the model's networks, from their configurations. Throws as fit_lora() does.
void fit_lora(const std::filesystem::path& model, LoraWeights& weights);

/// Checks that every file is there and every tensor has the right name and shape, without reading any weight.
ModelDescription describe_model(const std::filesystem::path& path);

}  // namespace gse::neural
