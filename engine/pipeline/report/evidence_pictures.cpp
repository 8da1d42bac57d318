// Attention and masks over renders; views as they come.
#include "engine/pipeline/report/evidence_pictures.h"

#include <algorithm>

namespace gse::pipeline {

std::shared_ptr<const Image> coloured_map(const Image& render, const Image& map) {
    auto picture = std::make_shared<Image>(render.width, render.height, 3);
    for (std::size_t i = 0; i < picture->pixel_count(); ++i) {
        const float m = std::clamp(map.data[i], 0.0f, 1.0f);
        const float colour[3] = {std::min(1.0f, 1.7f * m), m * m, 0.35f + 0.4f * m * (1 - m) - 0.35f * m};
        for (std::size_t c = 0; c < 3; ++c)
            picture->data[i * 3 + c] =
                0.35f * (1 - m) * render.data[i * 3 + c] + (0.25f + 0.75f * m) * colour[c];
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

SeenView refreshed(SeenView shown, const edit::ViewEvidence& evidence) {
    // Else the view is only attended so far.
    const bool made = !evidence.mask.data.empty() || evidence.failed;
    shown.mask = made ? std::make_shared<const Mask>(evidence.mask) : nullptr;
    shown.mask_picture = made ? masked_picture(evidence.render, evidence.mask) : nullptr;
    shown.points = evidence.points;
    shown.branch = evidence.branch;
    shown.captured = evidence.captured;
    shown.failed = evidence.failed;
    shown.step = evidence.step;
    return shown;
}

SeenView seen_view(const View& view, const edit::ViewEvidence& evidence) {
    SeenView shown;
    shown.name = view.name;
    const Image& picture = evidence.drawn.data.empty() ? evidence.render : evidence.drawn;
    shown.drawn = !evidence.drawn.data.empty();
    shown.render = std::make_shared<const Image>(picture);
    shown.map = std::make_shared<const Image>(evidence.map);
    shown.map_coloured = coloured_map(picture, evidence.map);
    shown.camera = view.camera;
    return refreshed(std::move(shown), evidence);
}

}  // namespace gse::pipeline
