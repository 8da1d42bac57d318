// Fields that servers know beside those that are always sent. A field that stands in the request of a plain
// order is the program's own.
#include "engine/remote/protocols/request_options.h"

#include <algorithm>
#include <array>
#include <cctype>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "engine/base/error.h"
#include "engine/base/printable.h"
#include "engine/remote/protocols/sdcpp_server.h"
#include "engine/remote/protocols/server_error.h"

namespace gse::remote {
namespace {

using Names = std::span<const std::string_view>;

constexpr std::array<std::string_view, 23> WebuiNames{"sampler_name",
                                                      "scheduler",
                                                      "eta",
                                                      "clip_skip",
                                                      "styles",
                                                      "tiling",
                                                      "restore_faces",
                                                      "subseed",
                                                      "subseed_strength",
                                                      "s_churn",
                                                      "s_noise",
                                                      "s_tmin",
                                                      "s_tmax",
                                                      "s_min_uncond",
                                                      "image_cfg_scale",
                                                      "refiner_checkpoint",
                                                      "refiner_switch_at",
                                                      "initial_noise_multiplier",
                                                      "script_name",
                                                      "script_args",
                                                      "alwayson_scripts",
                                                      "send_as_refimg",
                                                      "override_settings.NAME"};
constexpr std::array<std::string_view, 10> SdCppNames{"clip_skip",
                                                      "auto_resize_ref_image",
                                                      "increase_ref_index",
                                                      "vae_tiling_params.enabled",
                                                      "sample_params.sample_method",
                                                      "sample_params.scheduler",
                                                      "sample_params.eta",
                                                      "sample_params.custom_sigmas",
                                                      "sample_params.flow_shift",
                                                      "sample_params.guidance.img_cfg"};
constexpr std::array<std::string_view, 5> OpenAiNames{"quality", "background", "moderation",
                                                      "output_compression", "user"};
constexpr std::array<std::string_view, 2> VllmNames{"guidance_scale", "output_compression"};

// Settings of a WebUI that hold for one request. Those that change what is loaded hold for all its users.
constexpr std::string_view AllOverrides = "override_settings", Overrides = "override_settings.";
constexpr std::array<std::string_view, 5> LoadedParts{"checkpoint", "vae", "additional_modules", "unet",
                                                      "model"};

/// An order with all that an order can have, but for what only some families send.
RedrawOrder full_order() {
    RedrawOrder order;
    order.picture = Image(64, 64, 3);
    order.mask = Image(64, 64, 1, 1);
    order.references = {order.picture};
    order.prompt = order.negative_prompt = "x";
    return order;
}

/// True for a field of the body, and for one inside of a field that is no object.
bool is_set_in(const nlohmann::json& body, std::string_view name) {
    const auto* value = &body;
    while (!name.empty() && value->is_object()) {
        const auto dot = name.find('.');
        const auto found = value->find(std::string(name.substr(0, dot)));
        if (found == value->end()) return false;
        value = &*found;
        name = dot == std::string_view::npos ? std::string_view() : name.substr(dot + 1);
    }
    return true;
}

/// True for words of letters, digits, "_" and "-" with dots between them.
bool is_field_name(std::string_view name) {
    const auto plain = [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-' || c == '.';
    };
    return std::all_of(name.begin(), name.end(), plain) && !name.starts_with('.') && !name.ends_with('.') &&
           name.find("..") == std::string_view::npos;
}

bool knows(Names names, std::string_view name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

Error set_already(const std::string& name) {
    return {
        ErrorCode::InvalidArgument,
        fmt::format("the field \"{}\" of a server's request is set by the program", printable(name)),
        "leave it out; --server-steps, --server-guidance, --server-strength, --server-side and --lora set "
        "what can be chosen"};
}

Error unknown_option(const std::string& name, const std::string& product, Names known) {
    return {ErrorCode::InvalidArgument, fmt::format("{} has no option \"{}\"", product, printable(name)),
            fmt::format("it takes {}; force:NAME=VALUE sends one that is newer than this program",
                        fmt::join(known, ", "))};
}

/// Throws Error for settings that stay for all users of the server, or that it loads something else for.
void check_override(const std::string& name) {
    const bool whole = !name.starts_with(Overrides) || name.size() == Overrides.size();
    for (const auto part : LoadedParts)
        if (whole || name.find(part) != std::string::npos)
            throw Error(ErrorCode::InvalidArgument,
                        fmt::format("\"{}\" would change what the server has loaded for all its users",
                                    printable(name)),
                        "name a model by --server-model");
}

void check_in_body(const std::vector<ServerOption>& options, const nlohmann::json& body, Names known,
                   const std::string& product) {
    for (const auto& option : options) {
        if (is_set_in(body, option.name) || option.name == "lora") throw set_already(option.name);
        if (option.forced && !is_field_name(option.name))
            throw Error(ErrorCode::InvalidArgument,
                        fmt::format("\"{}\" is no name of a field", printable(option.name)),
                        "write letters, digits, \"_\" and \"-\", with dots between names of inner fields");
        if (!option.forced && !knows(known, option.name)) throw unknown_option(option.name, product, known);
    }
}

}  // namespace

void check_webui_options(const std::vector<ServerOption>& options, WebuiProduct product,
                         const ServerUrl& url) {
    std::vector<ServerOption> fields;
    for (const auto& option : options) {
        const bool named = option.name.starts_with(Overrides) && option.name.size() > Overrides.size();
        if (named || (option.forced && option.name.starts_with(AllOverrides))) check_override(option.name);
        else fields.push_back(option);
    }
    check_in_body(fields, webui_body(full_order(), product, "task"), WebuiNames,
                  fmt::format("{} ({})", url.nickname(), webui_product_name(product)));
}

void check_sdcpp_options(const std::vector<ServerOption>& options, const ServerUrl& url) {
    check_in_body(options, sdcpp_body(full_order()), SdCppNames,
                  fmt::format("{} (sd-server)", url.nickname()));
}

void check_offered_value(const std::vector<ServerOption>& options, std::string_view name,
                         const std::vector<std::string>& offered, const ServerUrl& url) {
    for (const auto& option : options) {
        if (option.name != name || option.forced || offered.empty()) continue;
        if (std::find(offered.begin(), offered.end(), option.value) == offered.end())
            throw Error(
                ErrorCode::InvalidArgument,
                fmt::format("{} has no \"{}\" for {}", url.nickname(), printable(option.value), option.name),
                "it has: " + listed(offered));
    }
}

void check_openai_options(const std::vector<ServerOption>& options, OpenAiProduct product,
                          const ServerUrl& url) {
    if (product == OpenAiProduct::SdServer) return check_sdcpp_options(options, url);
    nlohmann::json body{{"image", ""}};  // its name where nothing is beside it
    for (const auto& part : openai_parts(full_order(), product, "model")) body[part.name] = "";
    check_in_body(options, body, product == OpenAiProduct::Vllm ? Names(VllmNames) : Names(OpenAiNames),
                  fmt::format("{} ({})", url.nickname(), openai_product_name(product)));
}

void add_options(nlohmann::json& body, const std::vector<ServerOption>& options) {
    for (const auto& option : options) {
        auto* place = &body;
        std::string_view name = option.name;
        for (auto dot = name.find('.'); dot != std::string_view::npos; dot = name.find('.')) {
            place = &(*place)[std::string(name.substr(0, dot))];
            name.remove_prefix(dot + 1);
        }
        (*place)[std::string(name)] = json_value(option);
    }
}

}  // namespace gse::remote
