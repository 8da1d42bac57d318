// Scene inputs of a UNet that denoises views of one scene together: cameras, the scene before the edit, and
// outlines of the new object.
#pragma once

#include <array>
#include <optional>

#include "engine/neural/diffusion/unet.h"
#include "engine/neural/weights/safetensors.h"

namespace gse::neural {

/// Numbers that a network is told of a camera.
inline constexpr std::int64_t CameraFeatures = 6;

/// Features of a camera: sine and cosine of the azimuth and of twice the azimuth, sine of the elevation, 1.
/// The azimuth is in radians from the object's front, positive to its left; the elevation in radians above
/// the horizontal. All are zero where the azimuth is not known.
std::array<float, CameraFeatures> camera_features(std::optional<double> azimuth, double elevation);

/// Inpainting channels [B,2+C,h,w] (Rombach et al. 2022, section 4.5): mask [B,1,h,w] (1 = may change), shown
/// [B,1,h,w] (1 = the latents before the edit are shown), and those latents [B,C,h,w].
torch::Tensor inpainting(const torch::Tensor& mask, const torch::Tensor& shown, const torch::Tensor& latents);

/// Pixels of an outline along the side of a latent cell: as many as the autoencoder has.
inline constexpr std::int64_t OutlineScale = 4;

/// Adds scene inputs to a network: an embedding of cameras and an inpainting convolution, both zero at first.
/// With `outlines` also layers for outlines that predict none. Shares all weights with `plain`.
UNet with_scene_inputs(const UNet& plain, bool outlines = true);
/// Tells whether a file has the weights of inpainting().
bool shows_scene(const SafetensorsFile& file);

/// The network with the scene inputs that a file holds; it has no part for which the file has no weights.
/// Throws Error (Model) where they do not fit.
UNet with_scene_inputs(const UNet& plain, const SafetensorsFile& file);
/// A network of its own for new things with all of these inputs: config.json as diffusers writes it, and
/// weights that may be quantized (QuantizationScale). Throws Error (NotFound, Malformed, Model).
UNet load_shape_unet(const std::filesystem::path& folder);
/// Tells whether the folder's network takes inpainting().
bool shape_unet_shows_scene(const std::filesystem::path& folder);

/// Groups of views that are denoised together in one step, each at most `together` long. With `around`, views
/// of a group lie far from each other around the object, else they are neighbours. `azimuths` in radians;
/// unknown ones keep the order of the views.
std::vector<std::vector<std::int64_t>> view_groups(const std::vector<std::optional<double>>& azimuths,
                                                   std::int64_t together, bool around);

/// Tells whether a weight of that name belongs to the scene inputs or outlines.
bool is_scene_input(const std::string& name);
/// The weights of both by name, "camera_embedding.linear_1.weight", "conv_inpaint.weight" and so on.
std::vector<std::pair<std::string, torch::Tensor>> scene_input_weights(const UNet& unet);

}  // namespace gse::neural
