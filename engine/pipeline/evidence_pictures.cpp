// Attention and masks over renders.
#include "engine/pipeline/evidence_pictures.h"

#include <algorithm>

namespace gse::pipeline {

std::shared_ptr<const Image> coloured_map(const Image& render, const Image& map) {
    auto picture = std::make_shared<Image>(render.width, render.height, 3);
    for (std::size_t i = 0; i < picture->pixel_count(); ++i) {
        const float m = std::clamp(map.data[i], 0.0f, 1.0f);
        const float colour[3] = {std::min(1.0f, 1.7f * m), m * m, 0.35f + 0.4f * m * (1 - m) - 0.35f * m};
        for (std::size_t c = 0; c < 3; ++c)
            picture->data[i * 3 + c] = 0.35f * (1 - m) * render.data[i * 3 + c] + (0.25f + 0.75f * m) * colour[c];
    }
    return picture;
}

std::shared_ptr<const Image> masked_picture(const Image& render, const Mask& mask) {
    auto picture = std::make_shared<Image>(render);
    constexpr float tint[3] = {1.0f, 0.55f, 0.1f};
    const bool any = mask.data.size() == picture->pixel_count();
    for (std::size_t i = 0; i < picture->pixel_count(); ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            float& value = picture->data[i * 3 + c];
            value = any && mask.data[i] != 0 ? 0.45f * value + 0.55f * tint[c] : 0.6f * value;
        }
    return picture;
}

}  // namespace gse::pipeline
