// Between plain images and tensors.
#pragma once

#include <torch/torch.h>

#include "engine/base/image.h"

namespace gse::neural {

/// [1,C,H,W] fp32 on `device`, values unchanged; a copy.
torch::Tensor to_tensor(const Image& image, const torch::Device& device);
/// From [1,C,H,W].
Image to_image(const torch::Tensor& tensor);

/// Resizes to a square of `size` pixels: bilinear where the image is not larger, else the mean over the
/// covered area. Bilinear would skip most pixels of a large render. Differentiable.
torch::Tensor resize_square(const torch::Tensor& image, std::int64_t size);

}  // namespace gse::neural
