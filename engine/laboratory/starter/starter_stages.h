// The stages of the starter model: the VAE, text encoder and UNet on its latents, the image-text encoder.
#pragma once

#include "engine/laboratory/starter/starter_training.h"
#include "engine/neural/clip/clip_model.h"
#include "engine/neural/diffusion/model_bundle.h"
#include "engine/neural/diffusion/text_encoder.h"
#include "engine/neural/diffusion/unet.h"
#include "engine/neural/diffusion/vae.h"

namespace gse::training {

/// Structure of the starter model.
struct StarterConfigs {
    VaeConfig vae;
    TextEncoderConfig text;
    UNetConfig unet;
    ClipConfig clip;
};
inline constexpr int StarterTokenCount = 32;  // model_max_length of the tokenizer
StarterConfigs starter_configs(const StarterTrainParameters& parameters, const StarterVocabulary& vocabulary);

/// Trains the VAE and leaves the averaged weights in it.
void train_vae(AutoencoderKl& vae, const StarterTrainParameters& parameters, const StarterPictures& pictures,
               const std::filesystem::path& work, const JobControl& job);

/// Posterior means of all pictures, [N,4,G,G] float, before scaling; also their standard deviation.
struct StarterLatents {
    torch::Tensor mean;
    double deviation = 1;
};
StarterLatents encode_pictures(AutoencoderKl& vae, const StarterTrainParameters& parameters,
                               const StarterPictures& pictures);

struct StarterNetworks {
    ClipTextEncoder text{nullptr};
    UNet unet{nullptr};
};

/// The networks a run begins with.
struct StarterParts {
    AutoencoderKl vae{nullptr};
    StarterNetworks networks;
    double scaling_factor = 0;  // of the VAE's latents; 0 = not known before they are seen
};
StarterParts fresh_parts(const StarterConfigs& configs, std::uint64_t seed);
/// The weights of a starter folder; words that are new to it begin untrained. Throws Error when its structure
/// is another or it has words that `vocabulary` has not.
StarterParts initial_parts(const std::filesystem::path& folder, const StarterConfigs& configs,
                           const StarterVocabulary& vocabulary);

/// The image-text encoder of a starter folder, or fresh weights where it has none. Throws Error as
/// initial_parts() does.
ClipModel initial_clip(const std::filesystem::path& folder, const ClipConfig& config,
                       const StarterVocabulary& vocabulary);

/// Replaces the text encoder and UNet by their mean with another's (stochastic weight averaging, Izmailov et
/// al. 2018). Throws Error when the other's VAE is another one: its UNet would speak of other latents.
void average_networks(StarterParts& parts, StarterParts& other, const std::filesystem::path& folder);

/// Input of the UNet stage. `preview`, if set, receives the averaged networks at every checkpoint.
struct UNetTraining {
    const StarterConfigs& configs;
    const StarterTrainParameters& parameters;
    const StarterPictures& pictures;
    const StarterLatents& latents;
    const StarterSource& source;
    const StarterVocabulary& vocabulary;
    std::function<void(StarterNetworks& networks)> preview;
};

/// Trains text encoder and UNet (v-prediction) with the attention losses and leaves the averaged weights in
/// them.
void train_unet(StarterNetworks& networks, const UNetTraining& training, const std::filesystem::path& work,
                const JobControl& job);

/// Input of the contrastive stage; `pictures` are those of `pairs`.
struct ClipTraining {
    const StarterTrainParameters& parameters;
    const StarterPictures& pictures;
    const ContrastivePairs& pairs;
    const StarterVocabulary& vocabulary;
};

/// Trains the image-text encoder and leaves the averaged weights in it.
void train_clip(ClipModel& clip, const ClipTraining& training, const std::filesystem::path& work,
                const JobControl& job);
/// Writes config.json and model.safetensors (fp16) as transformers does; the tokenizer is the bundle's.
void export_clip(const ClipModel& clip, const std::filesystem::path& folder);

/// Trains an upscaler for a finished model and writes config.json and model.safetensors (fp16) into `folder`.
/// Pictures of the source are drawn at the model's size and at the upscaler's.
void train_upscaler(const ModelBundle& model, const StarterTrainParameters& parameters,
                    const StarterSource& source, const std::filesystem::path& work,
                    const std::filesystem::path& folder, const JobControl& job);

/// Writes the diffusers folder in fp16. Files that the initial model's gseditpro.json names go along while
/// they fit.
void export_starter(const UNetTraining& training, AutoencoderKl& vae, StarterNetworks& networks,
                    const std::filesystem::path& output);

}  // namespace gse::training
