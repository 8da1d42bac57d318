// What a UNet needs for denoising views of one scene together: what it is told of their cameras, and the network that takes it.
#pragma once

#include <array>
#include <optional>

#include "engine/neural/safetensors.h"
#include "engine/neural/unet.h"

namespace gse::neural {

/// Numbers that a network is told of a camera.
inline constexpr std::int64_t CameraFeatures = 6;

/// Sine and cosine of azimuth (radians from the thing's front, positive to its left) and of twice the azimuth, sine of the elevation
/// (radians above the horizontal), 1. Zeros where the azimuth is not known.
std::array<float, CameraFeatures> camera_features(std::optional<double> azimuth, double elevation);

/// The same network, with an embedding of cameras that says nothing yet; shares all weights with `plain`.
UNet with_cameras(const UNet& plain);
/// The same with the embedding that a file holds. Throws Error (Model) where it does not fit.
UNet with_cameras(const UNet& plain, const SafetensorsFile& file);
/// The same network without that embedding; shares all weights.
UNet without_cameras(const UNet& unet);

/// Which views are denoised together in one step, each list at most `together` long: with `around`, those far from each other on
/// the way around the thing, else neighbours. `azimuths` in radians; where one is not known, in the order of the views.
std::vector<std::vector<std::int64_t>> view_groups(const std::vector<std::optional<double>>& azimuths, std::int64_t together, bool around);

/// The embedding's weights by name, "camera_embedding.linear_1.weight" and so on.
std::vector<std::pair<std::string, torch::Tensor>> camera_weights(const UNet& unet);

}  // namespace gse::neural
