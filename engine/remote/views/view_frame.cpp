// Boxes with margins, squares, resampling, feathered pasting.
#include "engine/remote/views/view_frame.h"

#include <algorithm>
#include <cmath>

#include "engine/base/check.h"
#include "engine/edit/request/scales.h"
#include "engine/edit/target_views/view_round.h"
#include "engine/localize/clusters.h"

namespace gse::remote {
namespace {

constexpr double LeastMargin = 1.0 / 16;  // of the box's longer side, on each side
constexpr double LargestCrop = 0.8;       // of the view's side: a larger part is sent whole
constexpr double SentGrowth = 4;          // px by which a sent mask is grown beside a latent cell
constexpr double FeatherPx = 3;           // of a picture of ReferenceSide

int side_around(const localize::PixelBox& box) {
    const int longer = std::max(box.width, box.height);
    const double half_mean = (box.width + box.height) / 4.0;
    return static_cast<int>(std::ceil(longer + 2 * std::max(longer * LeastMargin, half_mean)));
}

Image cut(const Image& image, const edit::ViewSection& section) {
    Image part(section.side, section.side, image.channels);
    for (int y = 0; y < section.side; ++y)
        for (int x = 0; x < section.side; ++x)
            for (int c = 0; c < image.channels; ++c)
                part.at(x, y, c) = image.at(section.left + x, section.top + y, c);
    return part;
}

Mask cut(const Mask& mask, const edit::ViewSection& section) {
    Mask part(section.side, section.side);
    for (int y = 0; y < section.side; ++y)
        for (int x = 0; x < section.side; ++x) part.at(x, y) = mask.at(section.left + x, section.top + y);
    return part;
}

}  // namespace

int crop_side(const std::vector<edit::EditView>& views) {
    if (views.empty()) return 0;
    const int whole = views.front().mask.width;
    int side = std::min(LeastCrop, whole);
    for (const auto& view : views) {
        const auto box = localize::bounds_of(view.mask);
        if (box.width > 0) side = std::max(side, side_around(box));
    }
    return side > LargestCrop * whole ? whole : side;
}

edit::ViewSection crop_around(const Mask& mask, int side) {
    GSE_CHECK_EQ(mask.width, mask.height);
    const auto box = localize::bounds_of(mask);
    const auto begin = [&](int low, int size) {
        return std::clamp((2 * low + size - side) / 2, 0, mask.width - side);
    };
    return {begin(box.left, box.width), begin(box.top, box.height), side};
}

int sent_side(int asked, int family_side, int step) {
    const int side = asked > 0 ? asked : family_side;
    return std::max(step, (side + step / 2) / step * step);
}

Image at_side(const Image& picture, int side) { return localize::resize_image(picture, side, side); }

Mask at_side(const Mask& mask, int side) {
    if (mask.width == side) return mask;
    const auto share = at_side(as_image(mask), side);
    Mask result(side, side);
    for (std::size_t i = 0; i < result.data.size(); ++i) result.data[i] = share.data[i] >= 0.5f ? 1 : 0;
    return result;
}

Image as_image(const Mask& mask) {
    Image image(mask.width, mask.height, 1);
    for (std::size_t i = 0; i < mask.data.size(); ++i) image.data[i] = mask.data[i] != 0 ? 1.0f : 0.0f;
    return image;
}

ViewFrame frame_of(const edit::EditView& view, const edit::ViewSection& section, int side, int latent_cell) {
    ViewFrame frame;
    frame.section = section;
    frame.view_side = view.mask.width;
    frame.picture = at_side(cut(view.rendered, frame.section), side);
    frame.original = at_side(cut(view.original, frame.section), side);
    frame.mask = at_side(cut(view.mask, frame.section), side);
    frame.sent_mask = localize::dilate(frame.mask, SentGrowth + latent_cell);
    return frame;
}

Image framed(const Image& whole, const ViewFrame& frame) {
    return at_side(cut(at_side(whole, frame.view_side), frame.section), frame.picture.width);
}

Image pasted(const edit::EditView& view, const ViewFrame& frame, const Image& drawn) {
    const auto whole = edit::with_section(view.rendered, at_side(drawn, frame.section.side), frame.section);
    const double feather = FeatherPx * view.rendered.width / edit::ReferenceSide;
    return edit::blend_inside(whole, view.rendered, view.mask, feather);
}

}  // namespace gse::remote
