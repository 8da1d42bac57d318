// Weights in eight bits, as packaging/train_shapes writes them.
#pragma once

#include <limits>

#include "engine/base/file.h"
#include "engine/neural/diffusion/scene_views.h"
#include "engine/neural/weights/safetensors.h"

namespace gse::test {

/// Matrices and kernels as whole numbers of -127 to 127 with one factor per row; each number is off by half a
/// factor at most. Everything else in fp16.
inline neural::NamedTensors quantized(const neural::NamedTensors& tensors) {
    constexpr double Largest = 127;
    neural::NamedTensors result;
    for (const auto& [name, tensor] : tensors) {
        const auto values = tensor.detach().to(torch::kCPU, torch::kFloat32);
        if (values.dim() < 2) {
            result.emplace_back(name, values.to(torch::kHalf));
            continue;
        }
        const auto rows = values.flatten(1);
        const auto scale = (rows.abs().amax(1) / Largest).clamp_min(std::numeric_limits<float>::min());
        result.emplace_back(name, (rows / scale.unsqueeze(1))
                                      .round()
                                      .clamp(-Largest, Largest)
                                      .to(torch::kInt8)
                                      .view(values.sizes()));
        result.emplace_back(name + neural::QuantizationScale, scale);
    }
    return result;
}

/// A folder that load_shape_unet() reads.
inline void write_shape_unet(const neural::UNet& unet, const std::filesystem::path& folder) {
    neural::NamedTensors weights;
    for (const auto& item : unet->named_parameters()) weights.emplace_back(item.key(), item.value());
    neural::write_safetensors(folder / "diffusion_pytorch_model.safetensors", quantized(weights));
    write_file(folder / "config.json", unet->config().to_json().dump(2) + "\n");
}

}  // namespace gse::test
