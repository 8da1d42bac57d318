// Fields of img2img. Those whose default differs from what is wanted are always sent, others never.
#include "engine/remote/protocols/webui_request.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "engine/base/json.h"
#include "engine/remote/picture/base64.h"
#include "engine/remote/picture/picture_codec.h"
#include "engine/remote/protocols/sdcpp_server.h"
#include "engine/remote/protocols/server_link.h"

namespace gse::remote {
namespace {

std::string file_in_base64(const std::string& file) { return base64_encoded(std::as_bytes(std::span(file))); }

void add_mask(nlohmann::json& body, const Image& mask) {
    body["mask"] = file_in_base64(mask_png(mask));
    body["inpaint_full_res"] = false;  // the picture is cropped already
    body["inpainting_fill"] = 1;       // the picture itself
    body["inpainting_mask_invert"] = 0;
    body["mask_blur"] = 0;
    body["mask_round"] = true;
}

}  // namespace

std::string webui_product_name(WebuiProduct product) {
    switch (product) {
        case WebuiProduct::A1111: return "A1111";
        case WebuiProduct::Forge: return "Forge";
        case WebuiProduct::SdNext: return "SD.Next";
        case WebuiProduct::KoboldCpp: return "koboldcpp";
        case WebuiProduct::SdServer: return "sd-server";
        case WebuiProduct::Other: return "WebUI";
    }
    return {};
}

std::size_t webui_references(WebuiProduct product) {
    return product == WebuiProduct::SdServer || product == WebuiProduct::KoboldCpp ? 4 : 0;
}

bool webui_lists_loras(WebuiProduct product) {
    return product == WebuiProduct::SdServer || product == WebuiProduct::KoboldCpp;
}

bool webui_has_tasks(WebuiProduct product) {
    return product == WebuiProduct::A1111 || product == WebuiProduct::Forge;
}

int webui_steps(WebuiProduct product, int real, double strength) {
    if (product != WebuiProduct::SdNext) return steps_to_ask_of_levels(real, strength);
    return std::max(1,
                    static_cast<int>(std::ceil(real / strength - 1e-9)));  // diffusers: int(strength * steps)
}

nlohmann::json webui_body(const RedrawOrder& order, WebuiProduct product, const std::string& task) {
    nlohmann::json body{{"prompt", order.prompt},
                        {"negative_prompt", order.negative_prompt},
                        {"init_images", nlohmann::json::array({file_in_base64(picture_png(order.picture))})},
                        {"width", order.picture.width},
                        {"height", order.picture.height},
                        {"denoising_strength", order.strength},
                        {"steps", webui_steps(product, order.steps, order.strength)},
                        {"cfg_scale", order.guidance_scale},
                        {"seed", order.seed},
                        {"resize_mode", 0},
                        {"batch_size", 1},
                        {"n_iter", 1},
                        {"save_images", false},
                        {"send_images", true},
                        {"include_init_images", false}};
    if (!order.mask.data.empty()) add_mask(body, order.mask);
    if (!order.sampler.empty()) body["sampler_name"] = order.sampler;
    if (order.distilled_guidance > 0 && product == WebuiProduct::Forge)
        body["distilled_cfg_scale"] = order.distilled_guidance;
    if (webui_has_tasks(product)) body["force_task_id"] = task;
    for (const auto& reference : order.references)
        body["extra_images"].push_back(file_in_base64(picture_png(reference)));
    return body;
}

std::string webui_model(const nlohmann::json& answer) {
    const auto info = try_parse_json(text_of(answer, "info"));
    return text_of(info, "sd_model_name");
}

}  // namespace gse::remote
