// Recognises kinds of models and gathers their defaults.
#include "engine/neural/api/model_profile.h"

#include <fmt/format.h>

#include <algorithm>
#include <thread>

#include "engine/base/error.h"
#include "engine/base/safetensors_header.h"
#include "engine/edit/request/request.h"
#include "engine/neural/api/attention_parameters.h"
#include "engine/neural/api/config.h"
#include "engine/neural/api/dreambooth_parameters.h"
#include "engine/neural/api/model_traits.h"
#include "engine/neural/api/sds_parameters.h"

namespace gse::neural {
namespace {

namespace fs = std::filesystem;

// Channels of the UNet's first level; every Stable Diffusion has them.
constexpr std::int64_t LeastSdWidth = 320;
constexpr std::int64_t Sd2TextWidth = 1024;

/// Machine settings that a model states.
struct MachineDefaults {
    int threads = 1;

    template <class Self, class F> static void visit_fields(Self& self, F&& f) {
        f("threads", self.threads, "Threads of the networks.", Range{1, 256});
    }
};

/// Extents of a tensor; none when it is not in the header.
std::vector<std::int64_t> shape_of(const nlohmann::json& header, const std::string& name) {
    const auto key = "model.diffusion_model." + name;
    if (!header.contains(key) || !header[key].is_object() || !header[key].contains("shape")) return {};
    std::vector<std::int64_t> shape;
    for (const auto& extent : header[key]["shape"])
        if (extent.is_number_integer()) shape.push_back(extent.get<std::int64_t>());
    return shape;
}

/// The configuration in `path`, or what it would be without the file.
template <class Config> Config config_or(const fs::path& path, Config otherwise) {
    return fs::exists(path) ? Config::from_json(read_json_file(path), path) : otherwise;
}

ModelKind size_of(const UNetConfig& unet, const SchedulerConfig& scheduler) {
    if (unet.block_out_channels.empty() || unet.block_out_channels.front() < LeastSdWidth)
        return ModelKind::Small;
    if (!unet.use_linear_projection && unet.cross_attention_dim < Sd2TextWidth) return ModelKind::Sd1;
    return scheduler.prediction_type == "v_prediction" ? ModelKind::Sd2Velocity : ModelKind::Sd2;
}

/// "kind" of gseditpro.json beside the weights.
std::string stated_kind(const fs::path& folder) {
    const auto file = folder / "gseditpro.json";
    if (!fs::exists(file)) return {};
    const auto json = read_json_file(file);
    return json.is_object() && json.contains("kind") && json["kind"].is_string()
               ? json["kind"].get<std::string>()
               : std::string();
}

ModelNature nature_of(const UNetConfig& unet, const SchedulerConfig& scheduler, std::int64_t latent_channels,
                      Origin origin, const fs::path& folder) {
    return {size_of(unet, scheduler),
            bundle_kind(unet, scheduler, latent_channels, stated_kind(folder), origin, folder),
            unet.time_cond_proj_dim > 0};
}

ModelNature checkpoint_nature(const fs::path& path) {
    const auto header = safetensors_header(path);
    const auto first =
        header.is_object() ? shape_of(header, "input_blocks.0.0.weight") : std::vector<std::int64_t>{};
    if (first.empty()) return {};
    UNetConfig unet;
    unet.block_out_channels = {first.front()};
    if (first.size() == 4) unet.in_channels = first[1];
    const auto key = shape_of(header, "input_blocks.1.1.transformer_blocks.0.attn2.to_k.weight");
    if (key.size() == 2) unet.cross_attention_dim = key[1];
    unet.use_linear_projection = shape_of(header, "input_blocks.1.1.proj_in.weight").size() == 2;
    const auto beside = path.parent_path();
    unet = config_or(beside / "unet_config.json", unet);
    const auto scheduler = checkpoint_scheduler(path, header, unet.cross_attention_dim >= Sd2TextWidth);
    return nature_of(unet, config_or(beside / "scheduler_config.json", scheduler), unet.out_channels,
                     model_origin(path, header), beside);
}

/// Adds the settings of a kind that redraws views in its own way, over those of its size (METHOD.md).
void state_kind(Json& json, const ModelNature& nature) {
    if (nature.kind == BundleKind::Plain) return;
    Json request = json.value("request", Json::object()), guidance = json.value("guidance", Json::object());
    request["method"] = "views";
    request["rounds"] = 2;
    request["shape_guided_until"] = 0.0;
    double scale = 1;
    switch (nature.kind) {
        case BundleKind::Lcm:
        case BundleKind::Tcd:
            request["view_steps"] = 4;
            request["view_strength"] = 0.8;
            scale = nature.embeds_guidance ? 8.5 : 1.0;
            break;
        case BundleKind::Turbo:
            request["view_steps"] = 2;
            request["view_strength"] = 0.75;
            scale = 1.0;
            break;
        case BundleKind::InstructPix2Pix:
            request["view_steps"] = 6;
            request["view_strength"] = 0.98;
            scale = 7.5;
            guidance["image_guidance_scale"] = 1.0;
            break;
        case BundleKind::Plain: break;
    }
    guidance["view_guidance_scale"] = guidance["shape_guidance_scale"] = scale;
    json["request"] = std::move(request);
    json["guidance"] = std::move(guidance);
}

/// Settings by size. Fields that are not here have one default for all kinds.
Json stated_by_size(ModelKind kind) {
    if (kind == ModelKind::Small) return Json::object();
    Json json;
    json["request"] = {
        {"views", 16},
        {"image_size", kind == ModelKind::Sd2Velocity ? 768 : 512},
        {"label_threshold", 0.5},
        {"coverage_px", 1.0},
        {"iterations", 4000},
        {"geometry_share", 1.0},
        {"colour_coupling", 0.0},
        {"shape_views", 8},
        {"shape_steps", 8},
        {"view_steps", 8},
        {"shape_guided_until", 0.0},
        {"shape_rounds", 2},
        {"shape_strength", 0.9},
        {"add_rounds",
         2},  // one was measured with the starter only, which draws the views of a thing together
        {"add_noise", 1.0}};  // less was measured with the starter only
    json["guidance"] = {{"guidance_scale", 7.5},
                        {"view_guidance_scale", 7.5},
                        {"shape_guidance_scale", 7.5},
                        {"t_max_end", 0.5}};
    json["attention"] = {
        {"refinement", 1}};  // METHOD.md, Model profiles; the starter's own maps are as good without
    json["dreambooth"] = {{"steps", 400},
                          {"batch", 4},
                          {"class_images", 200},
                          {"class_steps", 50},
                          {"class_guidance", 7.5},
                          {"learning_rate", 5e-6},
                          {"lora_learning_rate", 1e-4},
                          {"train_text_encoder", false}};
    json["job"] = {{"threads", std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, 256)}};
    return json;
}

/// Throws Error for what there is no setting for, or that the setting cannot take.
void check_part(const std::string& part, const Json& fields) {
    if (!fields.is_object()) throw Error(ErrorCode::InvalidArgument, "it must be an object of settings");
    const auto check = [&](auto parameters) { fields_from_json(parameters, fields); };
    if (part == "request") {
        for (const char* word : {"source", "prompt", "target"})
            if (fields.contains(word))
                throw Error(ErrorCode::InvalidArgument, fmt::format("\"{}\" is the artist's to say", word));
        check(edit::EditRequest{});
    } else if (part == "guidance") {
        check(SdsParameters{});
    } else if (part == "attention") {
        check(AttentionParameters{});
    } else if (part == "dreambooth") {
        check(DreamBoothParameters{});
    } else if (part == "job") {
        check(MachineDefaults{});
    } else {
        throw Error(ErrorCode::InvalidArgument, "there are no such settings");
    }
}

void add(ModelProfile& profile, const Json& stated, const std::string& source) {
    for (const auto& [part, fields] : stated.items())
        for (const auto& [field, value] : fields.items()) {
            const auto same = [&, &part = part, &field = field](const auto& e) {
                return e.part == part && e.field == field;
            };
            std::erase_if(profile.entries, same);
            profile.entries.push_back({part, field, value, source});
        }
}

/// "profile" of the file, checked.
Json read_stated(const fs::path& file) {
    const auto json = read_json_file(file);
    if (!json.is_object() || !json.contains("profile")) return Json::object();
    const auto& stated = json["profile"];
    const char* hint = "correct or remove it";
    if (!stated.is_object())
        throw Error(ErrorCode::Malformed, "\"profile\" must be an object of settings", hint, file);
    for (const auto& [part, fields] : stated.items()) {
        try {
            check_part(part, fields);
        } catch (const Error& error) {
            throw Error(ErrorCode::Malformed,
                        fmt::format("in the model's profile, in \"{}\": {}", part, error.message()), hint,
                        file);
        }
    }
    return stated;
}

}  // namespace

ModelKind model_kind(const fs::path& model) { return model_nature(model).size; }

ModelNature model_nature(const fs::path& model, const std::vector<LoraSpec>& loras) {
    ModelNature nature;
    try {
        if (!fs::is_directory(model)) {
            nature = checkpoint_nature(model);
        } else if (fs::exists(model / "unet/config.json")) {
            nature = nature_of(config_or(model / "unet/config.json", UNetConfig{}),
                               config_or(model / "scheduler/scheduler_config.json", SchedulerConfig{}),
                               config_or(model / "vae/config.json", VaeConfig{}).latent_channels,
                               model_origin(model), model);
        }
    } catch (const Error&) {  // said when it is loaded
        return {};
    }
    for (const auto& lora : loras) {
        const auto mark = lora_mark(lora.file);
        if (nature.kind == BundleKind::Plain && lora.strength != 0 && mark != LoraMark::None)
            nature.kind = mark == LoraMark::Tcd ? BundleKind::Tcd : BundleKind::Lcm;
    }
    return nature;
}

ModelProfile model_profile(const fs::path& model, const std::vector<LoraSpec>& loras) {
    const auto nature = model_nature(model, loras);
    ModelProfile profile;
    profile.kind = nature.size;
    profile.bundle = nature.kind;
    Json stated = stated_by_size(nature.size);
    state_kind(stated, nature);
    add(profile, stated, "model");
    const auto file = (fs::is_directory(model) ? model : model.parent_path()) / "gseditpro.json";
    if (fs::exists(file)) add(profile, read_stated(file), "file gseditpro.json");
    profile.traits = model_traits(model);
    return profile;
}

}  // namespace gse::neural
