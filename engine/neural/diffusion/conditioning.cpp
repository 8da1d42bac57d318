// Rows of a UNet call by kind of model, and what their outputs come to.
#include "engine/neural/diffusion/conditioning.h"

#include "engine/base/check.h"

namespace gse::neural {
namespace {

UNetRows picture_rows(const torch::Tensor& latents, const Conditioning& conditioning, int parts) {
    const auto& picture = conditioning.picture;
    GSE_CHECK(picture.defined());
    const auto negative = conditioning.context.select(1, 0), positive = conditioning.context.select(1, 1);
    const auto shown = torch::cat({latents, picture.to(latents.scalar_type())}, 1);
    if (parts == 1) return {shown, positive, {}, 1};
    if (parts == 2) return {torch::cat({shown, shown}), torch::cat({negative, positive}), {}, 2};
    const auto hidden = torch::cat({latents, torch::zeros_like(latents)}, 1);
    return {torch::cat({shown, shown, hidden}), torch::cat({positive, negative, negative}), {}, 3};
}

}  // namespace

bool takes_picture(const UNetConfig& config) { return config.in_channels == 2 * config.out_channels; }

int row_parts(const UNetConfig& config, const Conditioning& conditioning) {
    const double text = conditioning.guidance_scale, image = conditioning.image_guidance_scale;
    if (takes_picture(config)) return text <= 1 || image < 1 ? 1 : image == 1 ? 2 : 3;
    return config.time_cond_proj_dim > 0 || text == 1 ? 1 : 2;
}

UNetRows unet_rows(const UNetConfig& config, const torch::Tensor& latents, const Conditioning& conditioning) {
    const int parts = row_parts(config, conditioning);
    if (takes_picture(config)) return picture_rows(latents, conditioning, parts);
    const auto positive = conditioning.context.select(1, 1);
    if (config.time_cond_proj_dim > 0) {
        const auto w = torch::full({latents.size(0)}, conditioning.guidance_scale - 1, torch::kFloat32);
        return {latents, positive, guidance_embedding(w, config.time_cond_proj_dim), 1};
    }
    if (parts == 1) return {latents, positive, {}, 1};
    return {torch::cat({latents, latents}), torch::cat({conditioning.context.select(1, 0), positive}), {}, 2};
}

torch::Tensor guided(const torch::Tensor& output, double scale) {
    const auto halves = output.chunk(2, 0);
    return halves[0] + scale * (halves[1] - halves[0]);
}

torch::Tensor combine_rows(const torch::Tensor& output, int parts, const Conditioning& conditioning) {
    if (parts == 1) return output;
    if (parts == 2) return guided(output, conditioning.guidance_scale);
    const auto thirds = output.chunk(3, 0);
    return thirds[2] + conditioning.guidance_scale * (thirds[0] - thirds[1]) +
           conditioning.image_guidance_scale * (thirds[1] - thirds[2]);
}

torch::Tensor guided_output(const UNet& unet, const torch::Tensor& latents, const torch::Tensor& t,
                            const Conditioning& conditioning, AttentionCapture* capture) {
    const auto rows = unet_rows(unet->config(), latents, conditioning);
    auto views = conditioning.views;
    if (views.cameras.defined()) views.cameras = views.cameras.repeat({rows.parts, 1});
    if (views.inpaint.defined()) views.inpaint = views.inpaint.repeat({rows.parts, 1, 1, 1});
    const auto output = unet->forward(rows.input, t, rows.context, capture, rows.time_condition, views);
    if (views.outline != nullptr && views.outline->defined() && rows.parts == 2)
        *views.outline = views.outline->chunk(2, 0)[1];
    return combine_rows(output, rows.parts, conditioning);
}

}  // namespace gse::neural
