// Bounding squares, and copies of them.
#include "engine/edit/interfaces/view_section.h"

#include <algorithm>
#include <cmath>

#include "engine/base/check.h"
#include "engine/localize/clusters.h"

namespace gse::edit {
namespace {

Image cut(const Image& image, const ViewSection& section) {
    if (image.data.empty()) return image;
    Image part(section.side, section.side, image.channels);
    const auto row = static_cast<std::size_t>(section.side) * static_cast<std::size_t>(image.channels);
    for (int y = 0; y < section.side; ++y) {
        const auto from = (static_cast<std::size_t>(section.top + y) * static_cast<std::size_t>(image.width) +
                           static_cast<std::size_t>(section.left)) *
                          static_cast<std::size_t>(image.channels);
        std::copy_n(image.data.begin() + static_cast<std::ptrdiff_t>(from), row,
                    part.data.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(y) * row));
    }
    return part;
}

}  // namespace

ViewSection section_around(const Mask& mask) {
    GSE_CHECK_EQ(mask.width, mask.height);
    const auto box = localize::bounds_of(mask);
    const ViewSection whole{0, 0, mask.width};
    if (box.width == 0) return whole;
    const int longer = std::max(box.width, box.height);
    const double wanted = std::max(longer / SectionShare, LeastSection * mask.width);
    if (wanted > LargestSection * mask.width) return whole;
    const int side = static_cast<int>(std::ceil(wanted));
    const auto begin = [&](int low, int size) {
        return std::clamp((2 * low + size - side) / 2, 0, mask.width - side);
    };
    return {begin(box.left, box.width), begin(box.top, box.height), side};
}

EditView cut_out_section(const EditView& view, const ViewSection& section) {
    EditView part = view;
    part.rendered = cut(view.rendered, section);
    part.original = cut(view.original, section);
    part.depth = cut(view.depth, section);
    part.clean_plate.picture = cut(view.clean_plate.picture, section);
    part.clean_plate.depth = cut(view.clean_plate.depth, section);
    part.mask = Mask(section.side, section.side);
    for (int y = 0; y < section.side; ++y)
        for (int x = 0; x < section.side; ++x)
            part.mask.at(x, y) = view.mask.at(section.left + x, section.top + y);
    auto& camera = part.view.camera;
    camera.width = camera.height = section.side;
    camera.cx -= section.left;
    camera.cy -= section.top;
    return part;
}

Image with_section(Image picture, const Image& part, const ViewSection& section) {
    GSE_CHECK(part.width == section.side && part.height == section.side && part.channels == picture.channels);
    for (int y = 0; y < section.side; ++y)
        for (int x = 0; x < section.side; ++x)
            for (int c = 0; c < picture.channels; ++c)
                picture.at(section.left + x, section.top + y, c) = part.at(x, y, c);
    return picture;
}

}  // namespace gse::edit
