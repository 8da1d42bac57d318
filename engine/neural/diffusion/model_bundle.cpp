// Finding, checking and loading the parts of a text-to-image model.
#include "engine/neural/diffusion/model_bundle.h"
#include "engine/language/lexicon.h"
#include "engine/language/vocabulary.h"
#include "engine/neural/diffusion/shared_tokenizer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>

#include "engine/base/error.h"
#include "engine/base/memory.h"
#include "engine/base/safetensors_header.h"
#include "engine/neural/api/checkpoint.h"
#include "engine/neural/api/files/weight_use.h"
#include "engine/neural/layers/precision.h"
#include "engine/neural/layers/torch_errors.h"
#include "engine/neural/weights/key_map.h"

namespace gse::neural {
namespace {

namespace fs = std::filesystem;

/// Everything about a model except its weights.
struct Parts {
    bool single_file = false;
    fs::path root;
    fs::path unet_file, vae_file, text_file;  // the same file for a single-file checkpoint
    SingleFileText text_layout = SingleFileText::Transformers;
    VaeNames vae_names = VaeNames::Folder;
    UNetConfig unet;
    VaeConfig vae;
    TextEncoderConfig text;
    SchedulerConfig scheduler;
    fs::path tokenizer;
    std::string pad_token;
    ModelFacts facts;
    BundleKind kind = BundleKind::Plain;
    std::vector<std::string> notes;

    /// Paths of what belongs to the model beside its weights.
    fs::path folder() const { return single_file ? root.parent_path() : root; }
};

constexpr std::int64_t LargestImageSize = 8192;  // pixels of a side
/// Side of the latents of an SD 2.x that predicts noise; infer_unet_config() has that of 768-v.
constexpr std::int64_t Sd2BaseSampleSize = 64;

constexpr const char* FolderHint =
    "a model folder has model_index.json, tokenizer, text_encoder, unet, vae and scheduler, as diffusers "
    "writes it";

[[noreturn]] void refuse_pickle(const fs::path& path) {
    throw Error(ErrorCode::Unsupported, "pickled weights can run code when they are read and are not opened",
                "convert once in Python: safetensors.torch.save_file(torch.load(FILE, "
                "weights_only=True)[\"state_dict\"], "
                "\"model.safetensors\")",
                path);
}

fs::path find_weights(const fs::path& folder, const char* stem) {
    if (!fs::is_directory(folder))
        throw Error(ErrorCode::NotFound, "the model folder is incomplete", FolderHint, folder);
    for (const char* variant : {"", ".fp16", ".non_ema"}) {
        const auto path = folder / fmt::format("{}{}.safetensors", stem, variant);
        if (fs::exists(path)) return path;
    }
    if (fs::exists(folder / fmt::format("{}.safetensors.index.json", stem)))
        throw Error(ErrorCode::Unsupported, "weights in several shards cannot be loaded",
                    "merge them into one file", folder);
    const auto pickle = folder / fmt::format("{}.bin", std::string(stem) == "model" ? "pytorch_model" : stem);
    if (fs::exists(pickle)) refuse_pickle(pickle);
    throw Error(ErrorCode::NotFound, "the model has no weights here", FolderHint,
                folder / fmt::format("{}.safetensors", stem));
}

Json config_of(const fs::path& path) {
    if (!fs::exists(path))
        throw Error(ErrorCode::NotFound, "the model folder is incomplete", FolderHint, path);
    return read_json_file(path);
}

Parts folder_parts(const fs::path& root) {
    Parts parts;
    parts.root = root;
    const auto index = config_of(root / "model_index.json");
    if (index.is_object() && index.contains("text_encoder_2"))
        throw Error(ErrorCode::Unsupported, "the model has two text encoders (SDXL or later)",
                    "only Stable Diffusion 1.x and 2.x can be used", root / "model_index.json");
    if (index.is_object() && index.contains("transformer") && !fs::exists(root / "unet"))
        throw Error(ErrorCode::Unsupported,
                    fmt::format("this is a {}, which has a transformer instead of a UNet",
                                index.contains("_class_name") && index["_class_name"].is_string()
                                    ? index["_class_name"].get<std::string>()
                                    : std::string("model of another kind")),
                    "only Stable Diffusion 1.x and 2.x structures can be loaded", root / "model_index.json");
    parts.unet_file = find_weights(root / "unet", "diffusion_pytorch_model");
    parts.vae_file = find_weights(root / "vae", "diffusion_pytorch_model");
    parts.text_file = find_weights(root / "text_encoder", "model");
    parts.unet = UNetConfig::from_json(config_of(root / "unet/config.json"), root / "unet/config.json");
    parts.vae = VaeConfig::from_json(config_of(root / "vae/config.json"), root / "vae/config.json");
    parts.text = TextEncoderConfig::from_json(config_of(root / "text_encoder/config.json"),
                                              root / "text_encoder/config.json");
    const auto scheduler = root / "scheduler/scheduler_config.json";
    parts.scheduler = SchedulerConfig::from_json(config_of(scheduler), scheduler);
    parts.tokenizer = root / "tokenizer";
    return parts;
}

/// A configuration beside the checkpoint (unet_config.json, ...), else what the tensors' shapes tell.
template <class Config, class Infer> Config beside_or(const fs::path& path, Infer infer) {
    return fs::exists(path) ? Config::from_json(read_json_file(path), path) : infer();
}

/// The checkpoint's own VAE, or the one beside it.
void find_vae(Parts& parts, const SafetensorsFile& file) {
    const auto& path = file.path();
    const auto config = path.parent_path() / "vae_config.json";
    parts.vae_file = path;
    parts.vae_names = VaeNames::Checkpoint;
    if (has_vae(file, parts.vae_names)) {
        parts.vae =
            beside_or<VaeConfig>(config, [&] { return infer_vae_config(file, VaeNames::Checkpoint); });
        return;
    }
    parts.vae_file = vae_beside(path);
    if (parts.vae_file.empty())
        throw Error(ErrorCode::Model, "the checkpoint has no VAE", vae_hint(path), path);
    const SafetensorsFile vae(parts.vae_file);
    parts.vae_names = vae_names_of(vae);
    const bool in_folder = parts.vae_file.stem().extension() != ".vae";
    parts.vae = beside_or<VaeConfig>(in_folder ? parts.vae_file.parent_path() / "config.json" : config,
                                     [&] { return infer_vae_config(vae, parts.vae_names); });
    parts.notes.push_back(fmt::format("{}: it has no VAE; the one in {}{} is used", path.filename().string(),
                                      in_folder ? "vae/" : "", parts.vae_file.filename().string()));
}

Parts single_file_parts(const fs::path& path) {
    Parts parts;
    parts.single_file = true;
    parts.root = path;
    parts.unet_file = parts.text_file = path;
    const SafetensorsFile file(path);
    if (!is_single_file(file))
        throw Error(ErrorCode::Model, "the file is not a Stable Diffusion checkpoint",
                    "single parts (a VAE, a LoRA, an embedding) cannot be used as a model", path);
    parts.text_layout = single_file_text_layout(file);
    const auto beside = path.parent_path();
    const bool second = parts.text_layout == SingleFileText::OpenClip;
    parts.unet = beside_or<UNetConfig>(beside / "unet_config.json",
                                       [&] { return infer_unet_config(file, parts.text_layout); });
    find_vae(parts, file);
    parts.text = beside_or<TextEncoderConfig>(beside / "text_encoder_config.json",
                                              [&] { return infer_text_config(file, parts.text_layout); });
    parts.scheduler = beside_or<SchedulerConfig>(beside / "scheduler_config.json", [&] {
        const auto header = safetensors_header(path);
        auto scheduler = checkpoint_scheduler(path, header, second);
        // The tensors do not tell the 768-v models from the 512 base ones.
        if (scheduler.prediction_type == "v_prediction" && stated_prediction(path, header).type.empty())
            parts.notes.push_back(fmt::format(
                "{}: taken for a velocity model (SD 2.x, 768); put a scheduler_config.json beside "
                "it if it predicts noise (SD 2.x base)",
                path.filename().string()));
        return scheduler;
    });
    if (second && parts.scheduler.prediction_type == "epsilon" && !fs::exists(beside / "unet_config.json"))
        parts.unet.sample_size = Sd2BaseSampleSize;
    parts.tokenizer = find_tokenizer(beside);
    if (second) parts.pad_token = "!";
    return parts;
}

/// gseditpro.json beside the weights. A checkpoint may share its folder with others: of its name and looks it
/// tells nothing.
void read_facts(Parts& parts) {
    const auto file = parts.folder() / "gseditpro.json";
    if (!fs::exists(file)) return;
    auto facts = ModelFacts::from_json(read_json_file(file), file);
    if (!parts.single_file) {
        for (const auto& named :
             {facts.shape_lora, facts.shape_cameras, facts.shape_unet, facts.viewpoint,
              facts.upscaler})  // read when something new is drawn: too late to learn of it
            if (!named.empty() && !fs::exists(parts.folder() / named))
                throw Error(ErrorCode::NotFound,
                            fmt::format("the model has no \"{}\", which this file names", named),
                            "copy the whole folder of the model, or take the line out", file);
        parts.facts = std::move(facts);
    } else {
        parts.facts.kind = std::move(facts.kind);
        parts.facts.taesd = std::move(facts.taesd);
    }
}

/// The folder of the tiny autoencoder; empty where there is none. `asked` is the run's own setting.
fs::path tiny_folder(const Parts& parts, const std::string& asked) {
    if (!asked.empty()) return asked == "none" ? fs::path() : fs::path(asked);
    const auto& stated = parts.facts.taesd;
    if (!stated.empty()) return stated == "none" ? fs::path() : parts.folder() / stated;
    const auto beside = parts.folder() / "taesd";
    return has_tiny_autoencoder(beside) ? beside : fs::path();
}

/// Loaded, and checked against the VAE that it stands in for.
TinyAutoencoder load_tiny(const fs::path& folder, const VaeConfig& vae) {
    auto tiny = load_tiny_autoencoder(folder);
    const auto& config = tiny->config();
    if (config.latent_channels != vae.latent_channels || config.factor() != vae.factor() ||
        config.in_channels != 3 || config.out_channels != 3)
        throw Error(ErrorCode::Model,
                    fmt::format("the tiny autoencoder has {} latent channels and {} pixels per cell, the "
                                "model's VAE {} and {}",
                                config.latent_channels, config.factor(), vae.latent_channels, vae.factor()),
                    "use the one that was made for this model, or none", folder);
    return tiny;
}

/// Loaded, and checked against the VAE whose pictures it lifts.
Upscaler load_fitting_upscaler(const fs::path& folder, const VaeConfig& vae, const torch::Device& device) {
    auto upscaler = load_upscaler(folder, device);
    if (upscaler->config().latent_channels != vae.latent_channels)
        throw Error(ErrorCode::Model,
                    fmt::format("the upscaler takes {} latent channels, and the model's VAE has {}",
                                upscaler->config().latent_channels, vae.latent_channels),
                    "use the one that was made for this model, or take \"upscaler\" out of gseditpro.json",
                    folder);
    return upscaler;
}

Origin origin_of(const Parts& parts) {
    return model_origin(parts.root, parts.single_file ? safetensors_header(parts.root) : nlohmann::json());
}

Parts find_parts(const fs::path& path) {
    std::error_code ignored;
    if (!fs::exists(path, ignored))
        throw Error(ErrorCode::NotFound, "there is no model here",
                    "name a diffusers folder or a .safetensors checkpoint", path);
    auto parts = [&] {
        if (fs::is_directory(path)) return folder_parts(path);
        if (is_pickle_name(path)) refuse_pickle(path);
        refuse_foreign_model(path);
        if (!is_safetensors_name(path))
            throw Error(ErrorCode::Unsupported, "this is not a model",
                        "name a diffusers folder or a .safetensors checkpoint", path);
        return single_file_parts(path);
    }();
    read_facts(parts);
    // The projection is not part of the conditioning and is often missing.
    parts.text.with_projection = false;
    if (parts.facts.image_size == 0) parts.facts.image_size = parts.unet.sample_size * parts.vae.factor();
    if (parts.facts.name.empty()) parts.facts.name = path.stem().string();
    parts.kind = bundle_kind(parts.unet, parts.scheduler, parts.vae.latent_channels, parts.facts.kind,
                             origin_of(parts), path);
    if (parts.kind == BundleKind::Turbo) parts.scheduler.timestep_spacing = "trailing";
    if (parts.unet.cross_attention_dim != parts.text.hidden_size)
        throw Error(ErrorCode::Model,
                    fmt::format("the UNet expects text of width {} but the text encoder gives {}",
                                parts.unet.cross_attention_dim, parts.text.hidden_size),
                    {}, path);
    if (parts.facts.image_size > LargestImageSize)
        throw Error(ErrorCode::Model,
                    fmt::format("the model's pictures would be {} pixels wide, more than {}",
                                parts.facts.image_size, LargestImageSize),
                    "look at \"sample_size\" in the UNet's config.json", path);
    if (parts.facts.image_size % parts.vae.factor() != 0)
        throw Error(ErrorCode::Model, "the model's image size is not a multiple of the VAE's factor", {},
                    path);
    return parts;
}

struct Plans {
    LoadPlan unet, vae, text;
};

Plans plans_of(const Parts& parts, const SafetensorsFile& vae_file) {
    const auto vae = parts.vae_names == VaeNames::Folder ? vae_plan(vae_file)
                                                         : single_file_vae_plan(parts.vae, parts.vae_names);
    if (parts.single_file)
        return {single_file_unet_plan(parts.unet), vae, single_file_text_plan(parts.text, parts.text_layout)};
    return {unet_plan(), vae, text_encoder_plan()};
}

void check_tokenizer(const Tokenizer& tokenizer, const Parts& parts) {
    if (tokenizer.vocabulary_size() > parts.text.vocab_size)
        throw Error(ErrorCode::Model,
                    fmt::format("the tokenizer has {} tokens but the text encoder only {}",
                                tokenizer.vocabulary_size(), parts.text.vocab_size),
                    {}, parts.tokenizer);
}

template <class Holder> void freeze(Holder& module, const torch::Device& device) {
    for (auto& parameter : module->parameters()) parameter.set_requires_grad(false);
    module->to(device);
    module->eval();
}

}  // namespace

ModelFacts ModelFacts::from_json(const Json& json, const std::filesystem::path& path) {
    ModelFacts facts;
    const auto get = [&](const char* key, auto& value) {
        if (!json.contains(key) || json[key].is_null()) return;
        try {
            json[key].get_to(value);
        } catch (const nlohmann::json::exception&) {
            throw Error(ErrorCode::Malformed, fmt::format("\"{}\" has the wrong type", key), {}, path);
        }
    };
    if (!json.is_object())
        throw Error(ErrorCode::Malformed, "the model's facts are not a JSON object", {}, path);
    get("name", facts.name);
    get("image_size", facts.image_size);
    get("attention_threshold", facts.attention_threshold);
    if (json.contains("attention_layers") && json["attention_layers"].is_string())
        facts.attention_layers = {json["attention_layers"].get<std::string>()};
    else get("attention_layers", facts.attention_layers);
    get("attention_sizes", facts.attention_sizes);
    get("attention_timesteps", facts.attention_timesteps);
    get("attention_absent_timesteps", facts.attention_absent_timesteps);
    get("vocabulary", facts.vocabulary);
    get("drawn_vocabulary", facts.drawn_vocabulary);
    get("kind", facts.kind);
    get("taesd", facts.taesd);
    get("shape_lora", facts.shape_lora);
    get("shape_cameras", facts.shape_cameras);
    get("shape_unet", facts.shape_unet);
    get("shape_restyles", facts.shape_restyles);
    get("viewpoint", facts.viewpoint);
    get("upscaler", facts.upscaler);
    get("shape_views", facts.shape_views);
    if (facts.image_size < 0 || facts.image_size > LargestImageSize)
        throw Error(ErrorCode::Malformed, fmt::format("\"image_size\" is outside 0..{}", LargestImageSize),
                    {}, path);
    if (facts.shape_views < 1 || facts.shape_views > 64)
        throw Error(ErrorCode::Malformed, "\"shape_views\" is outside 1..64", {}, path);
    return facts;
}

std::int64_t ModelBundle::token_count() const {
    return std::min(tokenizer.max_length(), text_encoder->config().max_position_embeddings);
}

std::string ModelBundle::model_prompt(const std::string& sentence) const {
    return facts.vocabulary.empty()
               ? sentence
               : language::filter_to_vocabulary(sentence, facts.vocabulary, language::Identifier);
}

torch::Tensor ModelBundle::token_ids(const std::vector<std::string>& prompts) const {
    std::vector<torch::Tensor> rows;
    for (const auto& prompt : prompts) {
        const auto encoding = tokenizer.encode(model_prompt(prompt), token_count());
        rows.push_back(torch::tensor(encoding.ids, torch::kInt64));
    }
    return torch::stack(rows).to(device);
}

torch::Tensor ModelBundle::encode_prompts(const std::vector<std::string>& prompts) const {
    const torch::NoGradGuard no_grad;
    return text_encoder->forward(token_ids(prompts)).last_hidden;
}

namespace {

/// The weights' files of a model, opened once.
struct WeightFiles {
    SafetensorsFile unet, vae, text;
    explicit WeightFiles(const Parts& parts)
        : unet(parts.unet_file), vae(parts.vae_file), text(parts.text_file) {}
};

/// Compares configurations and files without memory for a single weight; returns the bytes of the parameters.
std::uint64_t check_files(const Parts& parts, const WeightFiles& files, const Plans& plans) {
    const WeightOptions described{torch::kMeta, torch::kFloat32, false};
    const UNet unet(parts.unet, described);
    const AutoencoderKl vae(parts.vae, described);
    const ClipTextEncoder text(parts.text, described);
    check_weights(*text, files.text.shapes(), plans.text, parts.text_file);
    check_weights(*unet, files.unet.shapes(), plans.unet, parts.unet_file);
    check_weights(*vae, files.vae.shapes(), plans.vae, parts.vae_file);
    return weight_bytes(*unet) + weight_bytes(*vae) + weight_bytes(*text);
}

}  // namespace

ModelBundle load_bundle(const std::filesystem::path& path, const torch::Device& device,
                        const std::string& taesd, const std::string& precision) {
    const auto parts = find_parts(path);
    return guard_torch("loading the model", [&] {
        const WeightFiles files(parts);
        const auto plans = plans_of(parts, files.vae);
        require_memory(check_files(parts, files, plans), fmt::format("the model \"{}\"", parts.facts.name));
        const WeightOptions empty{torch::kCPU, torch::kFloat32, false};
        const WeightOptions unet{torch::kCPU, choose_precision(precision, parts.unet, device), false};
        ModelBundle bundle{path,
                           Tokenizer(parts.tokenizer, parts.pad_token),
                           ClipTextEncoder(parts.text, empty),
                           UNet(parts.unet, unet),
                           AutoencoderKl(parts.vae, empty),
                           NoiseSchedule(parts.scheduler),
                           parts.facts,
                           device};
        check_tokenizer(bundle.tokenizer, parts);
        load_weights(*bundle.text_encoder, files.text, plans.text);
        load_weights(*bundle.unet, files.unet, plans.unet);
        load_weights(*bundle.vae, files.vae, plans.vae);
        freeze(bundle.text_encoder, device);
        freeze(bundle.unet, device);
        freeze(bundle.vae, device);
        bundle.kind = parts.kind;
        bundle.notes = parts.notes;
        if (const auto folder = tiny_folder(parts, taesd); !folder.empty()) {
            bundle.tiny = load_tiny(folder, parts.vae);
            freeze(bundle.tiny, device);
        }
        if (!parts.facts.upscaler.empty())
            bundle.upscaler = load_fitting_upscaler(parts.folder() / parts.facts.upscaler, parts.vae, device);
        return bundle;
    });
}

ModelDescription describe_model(const std::filesystem::path& path) {
    const auto parts = find_parts(path);
    return guard_torch("describing the model", [&] {
        const WeightFiles files(parts);
        return ModelDescription{
            parts.facts.name,
            parts.single_file ? "single file" : "diffusers folder",
            parts.facts.image_size,
            static_cast<std::int64_t>(check_files(parts, files, plans_of(parts, files.vae)) / sizeof(float)),
            parts.scheduler.prediction_type,
            parts.facts.vocabulary,
            parts.kind};
    });
}

void fit_lora(const std::filesystem::path& model, LoraWeights& weights) {
    const auto parts = find_parts(model);
    const WeightOptions described{torch::kMeta, torch::kFloat32, false};
    fit_lora(weights, *UNet(parts.unet, described), *ClipTextEncoder(parts.text, described));
}

}  // namespace gse::neural
