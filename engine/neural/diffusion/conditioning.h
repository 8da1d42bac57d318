// Conditioning of one UNet call: classifier-free guidance, an embedded guidance scale (latent consistency
// models), or text and picture (InstructPix2Pix).
#pragma once

#include "engine/neural/diffusion/unet.h"

namespace gse::neural {

/// Conditioning of B pictures at one timestep.
struct Conditioning {
    torch::Tensor context;        // [B,2,T,D] negative, positive
    double guidance_scale = 7.5;  // 1 = the positive text alone
    torch::Tensor picture = {};   // [B,C,h,w] of a model that takes one: the posterior's mean, NOT scaled
                                  // (METHOD.md, InstructPix2Pix)
    double image_guidance_scale = 1.5;  // of such a model: 1 = two rows for each picture, others three
    SceneViews views = {};  // where the B pictures are of one scene, or of several with as many each
};

/// Guidance scale that a network distilled with it (LCM) is told where nobody asks for one: its reference's.
constexpr double UsualEmbeddedScale = 8.5;

/// Tells whether the UNet takes the latents of a picture beside its own (InstructPix2Pix).
bool takes_picture(const UNetConfig& config);

/// Into how many parts the call's rows fall.
int row_parts(const UNetConfig& config, const Conditioning& conditioning);

/// Rows of the call, part after part along the first dimension.
struct UNetRows {
    torch::Tensor input;           // [parts * B,C or 2C,h,w]
    torch::Tensor context;         // [parts * B,T,D]
    torch::Tensor time_condition;  // [parts * B,D], or undefined
    int parts = 1;
};

/// Rows for latents [B,C,h,w] as the UNet sees them.
/// Classifier-free guidance: [negative; positive]; the positive row alone where the scale turns guidance off.
/// Text and picture (Brooks et al. 2023, section 3.2): [text and picture; picture; neither], where neither
/// has a picture of zeros. At image scale 1 the third row cancels: [picture; text and picture].
/// A network distilled with its guidance scale: one row, whatever the scale.
UNetRows unet_rows(const UNetConfig& config, const torch::Tensor& latents, const Conditioning& conditioning);

/// Combines the outputs [parts * B,C,h,w] of the rows into [B,C,h,w].
torch::Tensor combine_rows(const torch::Tensor& output, int parts, const Conditioning& conditioning);

/// Both, and the call between them, at timestep `t` (a scalar). `capture` sees all rows; an outline is that
/// of the positive text.
torch::Tensor guided_output(const UNet& unet, const torch::Tensor& latents, const torch::Tensor& t,
                            const Conditioning& conditioning, AttentionCapture* capture = nullptr);

/// negative + scale (positive - negative), of a batch [negative; positive].
torch::Tensor guided(const torch::Tensor& output, double scale);

}  // namespace gse::neural
