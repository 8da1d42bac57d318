// Parts of a picture edit. The mask is right for servers that read colour and for those that read alpha.
#include "engine/remote/protocols/openai_request.h"

#include <fmt/format.h>

#include "engine/base/json.h"
#include "engine/remote/picture/picture_codec.h"
#include "engine/remote/protocols/request_options.h"
#include "engine/remote/protocols/sdcpp_server.h"

namespace gse::remote {
namespace {

HttpPart text_part(const std::string& name, const std::string& text) { return {name, text}; }

HttpPart picture_part(const std::string& name, std::string file) {
    return {name, std::move(file), name.starts_with("mask") ? "mask.png" : "image.png", "image/png"};
}

std::string plain_number(double value) { return fmt::format("{}", value); }

/// Settings that sd-server reads inside the prompt, on one line.
std::string sd_server_prompt(const RedrawOrder& order, const OpenAiExtras& extras) {
    nlohmann::json guidance{{"txt_cfg", order.guidance_scale}};
    if (order.distilled_guidance > 0) guidance["distilled_guidance"] = order.distilled_guidance;
    nlohmann::json sampling{{"sample_steps", steps_to_ask_of_levels(order.steps, order.strength)},
                            {"guidance", guidance}};
    if (!order.sampler.empty()) sampling["sample_method"] = sdcpp_sampler(order.sampler);
    nlohmann::json settings{{"seed", order.seed},
                            {"strength", order.strength},
                            {"negative_prompt", order.negative_prompt},
                            {"sample_params", sampling}};
    if (!extras.loras.empty()) settings["lora"] = lora_list(extras.loras);
    add_options(settings, extras.options);
    return order.prompt + " <sd_cpp_extra_args>" + json_text(settings) + "</sd_cpp_extra_args>";
}

void add_vllm_fields(std::vector<HttpPart>& parts, const RedrawOrder& order) {
    parts.push_back(text_part("seed", fmt::format("{}", order.seed)));
    parts.push_back(text_part("num_inference_steps", fmt::format("{}", order.steps)));
    parts.push_back(text_part("true_cfg_scale", plain_number(order.guidance_scale)));
    if (order.distilled_guidance > 0)
        parts.push_back(text_part("guidance_scale", plain_number(order.distilled_guidance)));
    if (!order.negative_prompt.empty()) parts.push_back(text_part("negative_prompt", order.negative_prompt));
}

void add_pictures(std::vector<HttpPart>& parts, const RedrawOrder& order, OpenAiProduct product) {
    const bool one_name = product == OpenAiProduct::Vllm || order.references.empty();
    const std::string name = one_name ? "image" : "image[]";
    parts.push_back(picture_part(name, picture_png(order.picture)));
    for (const auto& reference : order.references)
        parts.push_back(picture_part(name, picture_png(reference)));
    if (order.mask.data.empty()) return;
    if (product == OpenAiProduct::Vllm) parts.push_back(picture_part("mask_image", mask_png(order.mask)));
    else parts.push_back(picture_part("mask", two_way_mask_png(order.mask)));
}

}  // namespace

std::string openai_product_name(OpenAiProduct product) {
    switch (product) {
        case OpenAiProduct::SdServer: return "sd-server";
        case OpenAiProduct::Vllm: return "vLLM-Omni";
        case OpenAiProduct::OpenAi: return "OpenAI";
        case OpenAiProduct::Other: return "OpenAI look-alike";
    }
    return {};
}

std::vector<HttpPart> openai_parts(const RedrawOrder& order, OpenAiProduct product, const std::string& model,
                                   const OpenAiExtras& extras) {
    std::vector<HttpPart> parts;
    const bool in_prompt = product == OpenAiProduct::SdServer;
    if (!model.empty()) parts.push_back(text_part("model", model));
    parts.push_back(text_part("prompt", in_prompt ? sd_server_prompt(order, extras) : order.prompt));
    parts.push_back(text_part("n", "1"));
    parts.push_back(text_part("size", fmt::format("{}x{}", order.picture.width, order.picture.height)));
    if (product != OpenAiProduct::OpenAi) parts.push_back(text_part("response_format", "b64_json"));
    if (product == OpenAiProduct::OpenAi) parts.push_back(text_part("input_fidelity", "high"));
    parts.push_back(text_part("output_format", "png"));
    if (product == OpenAiProduct::Vllm) add_vllm_fields(parts, order);
    if (!in_prompt && !extras.loras.empty())
        parts.push_back(text_part("lora", json_text(vllm_loras(extras.loras))));
    for (const auto& option : extras.options) {
        if (in_prompt) break;
        std::erase_if(parts, [&](const auto& part) { return part.name == option.name; });
        parts.push_back(text_part(option.name, option.value));
    }
    add_pictures(parts, order, product);
    return parts;
}

}  // namespace gse::remote
