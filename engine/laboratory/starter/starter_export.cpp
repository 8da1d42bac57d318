// Writes the trained starter as a diffusers folder: fp16 weights, configurations, tokenizer, and what the
// model states about itself (gseditpro.json).
#include <fmt/format.h>

#include <algorithm>

#include "engine/base/file.h"
#include "engine/base/log.h"
#include "engine/laboratory/starter/starter_stages.h"
#include "engine/neural/weights/key_map.h"
#include "engine/neural/weights/safetensors.h"

namespace gse::training {
namespace {

/// Measured on held-out synthetic scenes by `gseditpro locate`-style sweeps; the bundle may state another
/// value.
constexpr double DefaultAttentionThreshold = 0.5;

template <class Module>
void write_weights(
    const std::filesystem::path& path, const Module& module,
    const std::function<std::string(const std::string&)>& key = [](const auto& name) { return name; }) {
    torch::NoGradGuard no_grad;
    std::vector<std::pair<std::string, torch::Tensor>> tensors;
    for (const auto& item : module->named_parameters())
        tensors.emplace_back(key(item.key()),
                             item.value().detach().to(torch::kCPU).to(torch::kHalf).contiguous());
    write_safetensors(path, tensors);
}

void write_json(const std::filesystem::path& path, const Json& json) {
    write_file(path, json.dump(2) + "\n");
}

Json tokenizer_config() {
    return {{"tokenizer_class", "CLIPTokenizer"},
            {"model_max_length", StarterTokenCount},
            {"bos_token", "<|startoftext|>"},
            {"eos_token", "<|endoftext|>"},
            {"unk_token", "<|endoftext|>"},
            {"pad_token", "<|endoftext|>"},
            {"do_lower_case", true}};
}

/// Tells whether the initial model's UNet and text encoder are exported as they were.
bool keeps_networks(const StarterTrainParameters& parameters) {
    return !parameters.initial.empty() && parameters.average.empty() && parameters.unet_steps == 0 &&
           parameters.unet_minutes == 0;
}

/// Tells whether the VAE is exported as it was: an upscaler speaks of its latents and pictures.
bool keeps_vae(const StarterTrainParameters& parameters) {
    return !parameters.initial.empty() && parameters.vae_steps == 0 && parameters.vae_minutes == 0;
}

/// Facts of the initial model; empty where it has none.
Json initial_facts(const StarterTrainParameters& parameters) {
    const auto file = std::filesystem::path(parameters.initial) / "gseditpro.json";
    return !parameters.initial.empty() && std::filesystem::exists(file) ? read_json_file(file)
                                                                        : Json::object();
}

/// Copies the files that the initial model's facts name.
void copy_named(const StarterTrainParameters& parameters, const std::vector<std::string>& keys,
                const std::filesystem::path& output) {
    const std::filesystem::path initial = parameters.initial;
    const auto facts = initial_facts(parameters);
    for (const auto& key : keys) {
        const auto named = facts.value(key, std::string());
        if (named.empty() || std::filesystem::equivalent(initial, output)) continue;
        std::filesystem::copy(
            initial / named, output / named,
            std::filesystem::copy_options::recursive | std::filesystem::copy_options::overwrite_existing);
    }
}

/// Facts of the model; those that an initial model was measured to work best with stay.
Json facts_of(const UNetTraining& training) {
    Json facts{{"name", "GSEditPro starter"},
               {"image_size", training.parameters.image_size},
               {"attention_threshold", DefaultAttentionThreshold},
               {"attention_layers", "up_blocks"},
               // Measured: `gseditpro-lab bench locate`, points "noise levels", and on scans, of which it
               // labels the ground, too, at less noise.
               {"attention_timesteps", {0.3}},
               // Places of absent objects were learned at every noise level; less noise shows more of the
               // picture.
               {"attention_absent_timesteps", {0.3, 0.5, 0.7}}};
    facts.update(initial_facts(training.parameters));
    if (!keeps_networks(training.parameters) &&
        (facts.contains("shape_unet") || facts.contains("shape_lora"))) {
        log::warning(
            "what the initial model draws new things with is left out: it was learned beside another UNet; "
            "train it anew with packaging/train_shapes");
        for (const char* key : {"shape_unet", "shape_lora", "shape_cameras", "shape_views", "shape_training"})
            facts.erase(key);
    }
    if (!keeps_vae(training.parameters)) facts.erase("upscaler");
    const auto words = training.source.vocabulary();
    facts["vocabulary"] = words;
    if (std::find(words.begin(), words.end(), "left") != words.end())
        facts["profile"]["request"]["sided_view_words"] = true;
    facts["training"] = fields_to_json(training.parameters);
    return facts;
}

}  // namespace

void export_clip(const ClipModel& clip, const std::filesystem::path& folder) {
    write_weights(folder / "model.safetensors", clip, clip_key);
    write_json(folder / "config.json", clip->config().to_json());
}

void export_starter(const UNetTraining& training, AutoencoderKl& vae, StarterNetworks& networks,
                    const std::filesystem::path& output) {
    const auto& configs = training.configs;
    const auto& vocabulary = training.vocabulary;
    write_weights(output / "vae/diffusion_pytorch_model.safetensors", vae);
    write_weights(output / "unet/diffusion_pytorch_model.safetensors", networks.unet);
    write_weights(output / "text_encoder/model.safetensors", networks.text);
    write_json(output / "vae/config.json", configs.vae.to_json());
    write_json(output / "unet/config.json", configs.unet.to_json());
    write_json(output / "text_encoder/config.json", configs.text.to_json());
    SchedulerConfig scheduler;
    scheduler.prediction_type = "v_prediction";
    write_json(output / "scheduler/scheduler_config.json", scheduler.to_json());
    write_file(output / "tokenizer/vocab.json", vocabulary.vocab_json + "\n");
    write_file(output / "tokenizer/merges.txt", vocabulary.merges_txt);
    write_json(output / "tokenizer/tokenizer_config.json", tokenizer_config());
    write_json(output / "tokenizer/special_tokens_map.json", {{"bos_token", "<|startoftext|>"},
                                                              {"eos_token", "<|endoftext|>"},
                                                              {"unk_token", "<|endoftext|>"},
                                                              {"pad_token", "<|endoftext|>"}});
    write_json(output / "model_index.json", {{"_class_name", "StableDiffusionPipeline"},
                                             {"text_encoder", {"transformers", "CLIPTextModel"}},
                                             {"tokenizer", {"transformers", "CLIPTokenizer"}},
                                             {"unet", {"diffusers", "UNet2DConditionModel"}},
                                             {"vae", {"diffusers", "AutoencoderKL"}},
                                             {"scheduler", {"diffusers", "DDIMScheduler"}}});
    copy_named(training.parameters, {"viewpoint"}, output);  // it has nothing to do with the other networks
    if (keeps_vae(training.parameters)) copy_named(training.parameters, {"upscaler"}, output);
    if (keeps_networks(training.parameters))
        copy_named(training.parameters, {"shape_unet", "shape_lora", "shape_cameras"}, output);
    write_json(output / "gseditpro.json", facts_of(training));
}

}  // namespace gse::training
