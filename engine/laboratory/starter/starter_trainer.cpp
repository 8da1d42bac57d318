// Runs the stages of the starter model in order.
#include "engine/laboratory/starter/starter_trainer.h"

#include <thread>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/json.h"
#include "engine/base/log.h"
#include "engine/laboratory/starter/starter_stages.h"

namespace gse::training {

namespace {

constexpr int ClipProjection = 96;  // numbers per picture or sentence
constexpr int ClipPatches = 8;      // patches along a side
constexpr const char* UpscalerFolder = "upscaler";

}  // namespace

StarterConfigs starter_configs(const StarterTrainParameters& parameters,
                               const StarterVocabulary& vocabulary) {
    StarterConfigs configs;
    const int c = parameters.vae_channels;
    configs.vae.block_out_channels = {c, 3 * c, 6 * c};
    configs.vae.layers_per_block = 1;
    configs.vae.latent_channels = 4;
    configs.vae.norm_num_groups = 8;
    configs.vae.sample_size = parameters.image_size;

    configs.text.vocab_size = vocabulary.size;
    configs.text.hidden_size = parameters.text_width;
    configs.text.intermediate_size = 4 * parameters.text_width;
    configs.text.num_hidden_layers = 3;
    configs.text.num_attention_heads = 4;
    configs.text.max_position_embeddings = StarterTokenCount;
    configs.text.hidden_act = "quick_gelu";
    configs.text.bos_token_id = vocabulary.bos;
    configs.text.eos_token_id = vocabulary.eos;

    const int u = parameters.unet_channels;
    configs.unet.sample_size = parameters.image_size / 4;
    configs.unet.in_channels = configs.unet.out_channels = 4;
    configs.unet.block_out_channels = {u, u * 8 / 5, u * 2};
    configs.unet.layers_per_block = 1;
    configs.unet.down_block_types = {"CrossAttnDownBlock2D", "CrossAttnDownBlock2D", "DownBlock2D"};
    configs.unet.up_block_types = {"UpBlock2D", "CrossAttnUpBlock2D", "CrossAttnUpBlock2D"};
    configs.unet.heads = {u / 40, u / 20, u / 16};
    configs.unet.cross_attention_dim = parameters.text_width;
    configs.unet.norm_num_groups = 16;

    configs.clip.text = configs.text;
    configs.clip.text.num_hidden_layers = 2;
    configs.clip.text.with_projection = true;
    configs.clip.projection_dim = configs.clip.text.projection_dim = ClipProjection;
    auto& vision = configs.clip.vision;
    vision.image_size = parameters.image_size;
    vision.patch_size = parameters.image_size / ClipPatches;
    vision.hidden_size = parameters.clip_width;
    vision.intermediate_size = 4 * parameters.clip_width;
    vision.num_hidden_layers = 4;
    vision.num_attention_heads = 4;
    return configs;
}

namespace {

bool trains(int steps, double minutes) { return steps > 0 || minutes > 0; }

StarterTrainParameters checked(StarterTrainParameters parameters, const StarterSource& source) {
    if (parameters.threads == 0)
        parameters.threads = parameters.device == "cpu"
                                 ? static_cast<int>(std::max(1u, std::thread::hardware_concurrency()))
                                 : 1;
    const bool all = trains(parameters.vae_steps, parameters.vae_minutes) &&
                     trains(parameters.unet_steps, parameters.unet_minutes);
    if (trains(parameters.clip_steps, parameters.clip_minutes) && source.contrastive_pairs() == nullptr)
        throw Error(ErrorCode::InvalidArgument,
                    "the picture source has no contrastive pairs to train the image-text encoder on",
                    "give it neither minutes nor steps");
    if (parameters.initial.empty() && !all)
        throw Error(ErrorCode::InvalidArgument, "a part of the model would stay untrained",
                    "give every stage minutes or steps, or name the model to keep it from with --initial");
    if (parameters.initial.empty() && !parameters.average.empty())
        throw Error(ErrorCode::InvalidArgument, "there is nothing to average with",
                    "name the other model with --initial");
    return parameters;
}

/// Trains the image-text encoder into `folder`, or takes over what the initial model has.
void add_clip(const StarterTrainParameters& parameters, const StarterSource& source,
              const std::filesystem::path& work, const std::filesystem::path& folder, const JobControl& job) {
    const bool trained = trains(parameters.clip_steps, parameters.clip_minutes);
    const auto kept = std::filesystem::path(parameters.initial) / "clip/model.safetensors";
    if (!trained && (parameters.initial.empty() || !std::filesystem::exists(kept))) return;
    const auto vocabulary = build_vocabulary(source.vocabulary());
    torch::manual_seed(parameters.seed + 2);
    ClipModel clip =
        initial_clip(parameters.initial, starter_configs(parameters, vocabulary).clip, vocabulary);
    if (trained) {
        auto twin_parameters = parameters;
        twin_parameters.pictures = parameters.clip_pictures;
        const auto pictures =
            load_or_render_pictures(twin_parameters, *source.contrastive_pairs(), work, job);
        train_clip(clip, {parameters, pictures, *source.contrastive_pairs(), vocabulary}, work, job);
    }
    export_clip(clip, folder);
}

/// Trains an upscaler for the model in `output`, which comes to name it.
void add_upscaler(const StarterTrainParameters& parameters, const StarterSource& source,
                  const std::filesystem::path& work, const std::filesystem::path& output,
                  const JobControl& job) {
    if (!trains(parameters.upscaler_steps, parameters.upscaler_minutes)) return;
    train_upscaler(load_bundle(output), parameters, source.drawn_pictures(), work, output / UpscalerFolder,
                   job);
    const auto file = output / "gseditpro.json";
    auto facts = read_json_file(file);
    facts["upscaler"] = UpscalerFolder;
    write_file(file, facts.dump(2) + "\n");
}

/// Tells whether a finished model gets an upscaler and stays as it is otherwise, whatever its words are.
bool trains_upscaler_alone(const StarterTrainParameters& parameters) {
    return !parameters.initial.empty() && parameters.average.empty() &&
           trains(parameters.upscaler_steps, parameters.upscaler_minutes) &&
           !trains(parameters.vae_steps, parameters.vae_minutes) &&
           !trains(parameters.unet_steps, parameters.unet_minutes) &&
           !trains(parameters.clip_steps, parameters.clip_minutes);
}

void copy_model(const std::filesystem::path& from, const std::filesystem::path& to) {
    namespace fs = std::filesystem;
    if (fs::exists(to) && fs::equivalent(from, to)) return;
    fs::create_directories(to);
    fs::copy(from, to, fs::copy_options::recursive | fs::copy_options::overwrite_existing);
}

}  // namespace

void train_starter(const StarterTrainParameters& requested, const StarterSource& source,
                   const std::filesystem::path& work, const std::filesystem::path& output,
                   const JobControl& job) {
    const StarterTrainParameters parameters = checked(requested, source);
    if (trains_upscaler_alone(parameters)) {
        std::filesystem::create_directories(work);
        copy_model(parameters.initial, output);
        return add_upscaler(parameters, source, work, output, job);
    }
    const bool new_vae = trains(parameters.vae_steps, parameters.vae_minutes);
    const bool new_unet = trains(parameters.unet_steps, parameters.unet_minutes);
    const auto vocabulary = build_vocabulary(source.vocabulary());
    auto configs = starter_configs(parameters, vocabulary);
    auto parts = parameters.initial.empty() ? fresh_parts(configs, parameters.seed)
                                            : initial_parts(parameters.initial, configs, vocabulary);
    if (!parameters.average.empty()) {
        auto other = initial_parts(parameters.average, configs, vocabulary);
        average_networks(parts, other, parameters.average);
    }
    std::filesystem::create_directories(work);
    StarterPictures pictures;
    if (new_vae || new_unet) pictures = load_or_render_pictures(parameters, source, work, job);

    if (new_vae) train_vae(parts.vae, parameters, pictures, work, job);
    StarterLatents latents;
    if (new_vae || new_unet) latents = encode_pictures(parts.vae, parameters, pictures);
    if (!new_vae) latents.deviation = 1.0 / parts.scaling_factor;  // what the UNet was trained with
    log::info("latents have a standard deviation of {:.3f}", latents.deviation);

    configs.vae.scaling_factor = new_vae ? 1.0 / latents.deviation : parts.scaling_factor;
    UNetTraining training{configs, parameters, pictures, latents, source, vocabulary, {}};
    // The unfinished model can be tried while the training goes on.
    training.preview = [&](StarterNetworks& averaged) {
        export_starter(training, parts.vae, averaged, work / "preview");
    };
    if (new_unet) train_unet(parts.networks, training, work, job);
    export_starter(training, parts.vae, parts.networks, output);
    pictures = {};
    add_clip(parameters, source, work, output / "clip", job);
    add_upscaler(parameters, source, work, output, job);
    log::info("the model is in {}", output.string());
}

}  // namespace gse::training
