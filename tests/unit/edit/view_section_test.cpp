// Parts of views that are redrawn by themselves: where they lie, and that cutting and putting back loses
// nothing.
#include <doctest/doctest.h>

#include "engine/base/random.h"
#include "engine/edit/interfaces/view_section.h"

namespace view_section_test {

using namespace gse;
using namespace gse::edit;

namespace {

constexpr int Side = 96;

Mask box_mask(int left, int top, int width, int height) {
    Mask mask(Side, Side);
    for (int y = top; y < top + height; ++y)
        for (int x = left; x < left + width; ++x) mask.at(x, y) = 1;
    return mask;
}

Image noise_image(int channels, std::uint64_t seed) {
    Image image(Side, Side, channels);
    Random random(seed);
    for (auto& value : image.data) value = static_cast<float>(random.uniform());
    return image;
}

}  // namespace

DOCTEST_TEST_CASE(
    "a section holds all of its mask, lies in the picture, and is as large as the mask asks for") {
    Random random(3);
    for (int i = 0; i < 200; ++i) {
        const int width = 1 + static_cast<int>(random.below(Side)),
                  height = 1 + static_cast<int>(random.below(Side));
        const int left = static_cast<int>(random.below(static_cast<std::uint64_t>(Side - width + 1)));
        const int top = static_cast<int>(random.below(static_cast<std::uint64_t>(Side - height + 1)));
        const auto section = section_around(box_mask(left, top, width, height));
        DOCTEST_CHECK(section.left >= 0);
        DOCTEST_CHECK(section.top >= 0);
        DOCTEST_CHECK(section.left + section.side <= Side);
        DOCTEST_CHECK(section.top + section.side <= Side);
        DOCTEST_CHECK(section.left <= left);
        DOCTEST_CHECK(section.top <= top);
        DOCTEST_CHECK(section.left + section.side >= left + width);
        DOCTEST_CHECK(section.top + section.side >= top + height);
        DOCTEST_CHECK(section.side >= LeastSection * Side);
        const double longer = std::max(width, height);
        if (longer > SectionShare * LargestSection * Side) DOCTEST_CHECK(section.side == Side);
        else DOCTEST_CHECK(section.side <= std::max(longer / SectionShare, LeastSection * Side) + 1);
    }
    DOCTEST_CHECK(section_around(Mask(Side, Side)).side == Side);
}

DOCTEST_TEST_CASE("a section shows what the view shows there, and goes back to where it was") {
    EditView view;
    view.rendered = noise_image(3, 1);
    view.original = noise_image(3, 2);
    view.depth = noise_image(1, 3);
    view.mask = box_mask(50, 10, 20, 12);
    view.view.camera = {Side, Side, 80, 80, 48, 48, {}, {}};
    const auto section = section_around(view.mask);
    DOCTEST_REQUIRE(section.side < Side);
    const auto part = cut_out_section(view, section);
    DOCTEST_CHECK(part.mask.count() == view.mask.count());
    DOCTEST_CHECK(part.clean_plate.picture.data.empty());
    DOCTEST_CHECK(part.rendered.at(3, 5, 1) == view.rendered.at(section.left + 3, section.top + 5, 1));
    DOCTEST_CHECK(part.depth.at(3, 5, 0) == view.depth.at(section.left + 3, section.top + 5, 0));
    DOCTEST_CHECK(with_section(view.rendered, part.rendered, section).data == view.rendered.data);
    // A pixel of the part looks where the view's pixel does.
    const auto& camera = part.view.camera;
    DOCTEST_CHECK((3.5 - camera.cx) / camera.fx == doctest::Approx((section.left + 3.5 - 48) / 80));
    DOCTEST_CHECK((5.5 - camera.cy) / camera.fy == doctest::Approx((section.top + 5.5 - 48) / 80));
    DOCTEST_CHECK(camera.width == section.side);
    Image other(section.side, section.side, 3);
    const auto replaced = with_section(view.rendered, other, section);
    for (int y = 0; y < Side; ++y)
        for (int x = 0; x < Side; ++x) {
            const bool inside = x >= section.left && y >= section.top && x < section.left + section.side &&
                                y < section.top + section.side;
            DOCTEST_CHECK(replaced.at(x, y, 0) == (inside ? 0.0f : view.rendered.at(x, y, 0)));
        }
}

}  // namespace view_section_test
