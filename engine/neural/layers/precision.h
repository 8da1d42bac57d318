// In which numbers a UNet computes: single precision, or bfloat16 where the processor is faster with it.
#pragma once

#include <torch/torch.h>

#include <string>

#include "engine/neural/api/config.h"

namespace gse::neural {

/// Tells whether libtorch multiplies bfloat16 matrices here with sums in single precision. Processors need
/// AVX-512 BF16 or AMX, where oneDNN does it; libtorch's own loops sum in bfloat16. Always true for a GPU.
bool multiplies_bfloat16(const torch::Device& device);

/// Seconds of a 3x3 convolution and a linear layer as the widest maps of such a UNet have them, the least of
/// a few runs.
double layer_seconds(const UNetConfig& config, torch::Dtype dtype);

/// Number type of a UNet's weights for a setting: "fp32", "bf16" or "auto". "auto" is bfloat16 where layers
/// of that size were measured to be faster with it; small models compute in fp32. Throws Error
/// (InvalidArgument) for another word, and for "bf16" where this processor cannot.
torch::Dtype choose_precision(const std::string& setting, const UNetConfig& config,
                              const torch::Device& device);

}  // namespace gse::neural
