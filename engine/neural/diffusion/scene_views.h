// What a UNet needs for denoising views of one scene together: what it is told of their cameras and shown of
// the scene as it was, what it tells of the new thing's outlines, and the network that has it.
#pragma once

#include <array>
#include <optional>

#include "engine/neural/diffusion/unet.h"
#include "engine/neural/weights/safetensors.h"

namespace gse::neural {

/// Numbers that a network is told of a camera.
inline constexpr std::int64_t CameraFeatures = 6;

/// Sine and cosine of azimuth (radians from the thing's front, positive to its left) and of twice the
/// azimuth, sine of the elevation (radians above the horizontal), 1. Zeros where the azimuth is not known.
std::array<float, CameraFeatures> camera_features(std::optional<double> azimuth, double elevation);

/// What a network is shown of the picture before the edit, as inpainting models are (Rombach et al. 2022,
/// section 4.5), [B,2+C,h,w]: where it may change (`mask`, [B,1,h,w], 1), where the latents [B,C,h,w] of what
/// was there are shown (`shown`, [B,1,h,w], 1), and these.
torch::Tensor inpainting(const torch::Tensor& mask, const torch::Tensor& shown, const torch::Tensor& latents);

/// Pixels of an outline along the side of a latent cell: as many as the autoencoder has.
inline constexpr std::int64_t OutlineScale = 4;

/// The same network, with an embedding of cameras and a convolution of what it is shown that say nothing yet,
/// and layers for outlines that find none (with `outlines`); shares all weights with `plain`.
UNet with_scene_inputs(const UNet& plain, bool outlines = true);
/// Whether the weights of a file include that of inpainting().
bool shows_scene(const SafetensorsFile& file);

/// The network with the scene inputs that a file holds; it has no part for which the file has no weights.
/// Throws Error (Model) where they do not fit.
UNet with_scene_inputs(const UNet& plain, const SafetensorsFile& file);
/// A network of its own for new things with all of these inputs: config.json as diffusers writes it, and
/// weights that may be quantized (QuantizationScale). Throws Error (NotFound, Malformed, Model).
UNet load_shape_unet(const std::filesystem::path& folder);
/// Whether the folder's network is shown the scene.
bool shape_unet_shows_scene(const std::filesystem::path& folder);

/// Which views are denoised together in one step, each list at most `together` long: with `around`, those far
/// from each other on the way around the thing, else neighbours. `azimuths` in radians; where one is not
/// known, in the order of the views.
std::vector<std::vector<std::int64_t>> view_groups(const std::vector<std::optional<double>>& azimuths,
                                                   std::int64_t together, bool around);

/// Whether a weight of that name belongs to these inputs, or to the outlines.
bool is_scene_input(const std::string& name);
/// The weights of both by name, "camera_embedding.linear_1.weight", "conv_inpaint.weight" and so on.
std::vector<std::pair<std::string, torch::Tensor>> scene_input_weights(const UNet& unet);

}  // namespace gse::neural
