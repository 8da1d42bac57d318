// Images to tensors and back.
#include "engine/neural/layers/images.h"

#include <algorithm>

#include "engine/base/check.h"

namespace gse::neural {

torch::Tensor to_tensor(const Image& image, const torch::Device& device) {
    const auto rows = torch::from_blob(const_cast<float*>(image.data.data()),
                                       {1, image.height, image.width, image.channels}, torch::kFloat32);
    return rows.permute({0, 3, 1, 2}).to(device).clone(torch::MemoryFormat::Contiguous);
}

Image to_image(const torch::Tensor& tensor) {
    GSE_CHECK_EQ(tensor.dim(), std::int64_t{4});
    GSE_CHECK_EQ(tensor.size(0), std::int64_t{1});
    const auto rows = tensor.detach().to(torch::kCPU, torch::kFloat32).permute({0, 2, 3, 1}).contiguous();
    Image image(static_cast<int>(tensor.size(3)), static_cast<int>(tensor.size(2)),
                static_cast<int>(tensor.size(1)));
    std::copy_n(rows.data_ptr<float>(), image.data.size(), image.data.begin());
    return image;
}

torch::Tensor resize_square(const torch::Tensor& image, std::int64_t size) {
    const auto height = std::min(image.size(2), size), width = std::min(image.size(3), size);
    auto result = image;
    if (height != image.size(2) || width != image.size(3))
        result = torch::adaptive_avg_pool2d(result, {height, width});
    if (height != size || width != size) result = torch::upsample_bilinear2d(result, {size, size}, false);
    return result;
}

}  // namespace gse::neural
