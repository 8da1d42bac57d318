// Crops, sizes, pasting, sheets, outlines of changes.
#include <doctest/doctest.h>

#include "engine/remote/views/change_map.h"
#include "engine/remote/views/view_frame.h"
#include "engine/remote/views/view_sheet.h"
#include "tests/unit/remote/test_pictures.h"

namespace view_frame_test {
namespace {

using namespace gse;
using namespace gse::remote;

using namespace remote_pictures;

edit::EditView view_with(int side, const Mask& mask) {
    edit::EditView view;
    view.rendered = view.original = waves(side);
    view.mask = mask;
    return view;
}

DOCTEST_TEST_CASE("frame: one crop holds the largest mask of all views with a margin, and stays inside") {
    const std::vector<edit::EditView> views{view_with(1024, disc(1024, 60, 100, 100)),
                                            view_with(1024, disc(1024, 180, 700, 800))};
    const int side = crop_side(views);
    DOCTEST_CHECK(side == 720);  // 360 px and half of that on each side
    const auto corner = crop_around(views[0].mask, side), other = crop_around(views[1].mask, side);
    DOCTEST_CHECK(corner.left == 0);
    DOCTEST_CHECK(corner.top == 0);
    DOCTEST_CHECK(other.left == 1024 - 720);
    DOCTEST_CHECK(other.top + other.side <= 1024);
    DOCTEST_CHECK(crop_side({view_with(1024, disc(1024, 20))}) == LeastCrop);
    DOCTEST_CHECK(crop_side({view_with(1024, disc(1024, 400))}) == 1024);
    DOCTEST_CHECK(crop_side({view_with(256, disc(256, 10))}) == 256);
}

DOCTEST_TEST_CASE("frame: sides that are sent are multiples of the family's step") {
    DOCTEST_CHECK(sent_side(0, 1008, 112) == 1008);
    DOCTEST_CHECK(sent_side(1024, 1008, 112) == 1008);
    DOCTEST_CHECK(sent_side(768, 1008, 112) == 784);
    DOCTEST_CHECK(sent_side(16, 1008, 112) == 112);
    DOCTEST_CHECK(sent_side(0, 1024, 64) == 1024);
    DOCTEST_CHECK(sent_side(100, 1024, 64) == 128);
    DOCTEST_CHECK(sent_side(16, 512, 64) == 64);
}

DOCTEST_TEST_CASE("frame: what is pasted back changes nothing outside the mask, bit by bit") {
    const auto view = view_with(256, disc(256, 40, 90, 140));
    const auto frame = frame_of(view, crop_around(view.mask, 160), 320, 8);
    DOCTEST_CHECK(frame.picture.width == 320);
    DOCTEST_CHECK(frame.sent_mask.count() > frame.mask.count());
    Image drawn(320, 320, 3, 0.9f);
    const auto whole = pasted(view, frame, drawn);
    std::size_t changed_outside = 0;
    for (std::size_t i = 0; i < view.mask.data.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c)
            if (view.mask.data[i] == 0 && whole.data[i * 3 + c] != view.rendered.data[i * 3 + c])
                ++changed_outside;
    DOCTEST_CHECK(changed_outside == 0);
    DOCTEST_CHECK(whole.at(90, 140, 0) == doctest::Approx(0.9));
}

DOCTEST_TEST_CASE("sheet: cells come back as they went in, and nothing changes between them") {
    const int side = 256, cell = cell_side(side);
    std::vector<Image> pictures;
    std::vector<Mask> masks;
    for (int i = 0; i < 3; ++i) {
        pictures.push_back(waves(cell, 5 * i));
        masks.push_back(Mask(cell, cell, 1));
    }
    const auto sheet = sheet_of(pictures, side);
    for (std::size_t i = 0; i < pictures.size(); ++i)
        DOCTEST_CHECK(cut_cell(sheet, i).data == pictures[i].data);
    const auto mask = sheet_mask(masks, side);
    DOCTEST_CHECK(mask.count() == 3 * static_cast<std::size_t>(cell) * static_cast<std::size_t>(cell));
    DOCTEST_CHECK(mask.at(cell + 2, 3) == 0);
    DOCTEST_CHECK(mask.at(side - 1, side - 1) == 0);
}

DOCTEST_TEST_CASE("outline: follows a new thing through a server's error, and is empty without one") {
    const auto before = waves(256);
    auto after = before;
    const auto thing = disc(256, 30, 120, 120), allowed = disc(256, 90);
    paint(after, thing, {0.9f, 0.1f, 0.9f});
    add_noise(after, 0.01, 2);
    const auto outline = outline_of_change(change_map(before, after, 1), allowed);
    std::size_t both = 0, either = 0;
    for (std::size_t i = 0; i < thing.data.size(); ++i) {
        const bool found = outline.data[i] > 0.5f, there = thing.data[i] != 0;
        both += found && there ? 1u : 0u, either += found || there ? 1u : 0u;
    }
    DOCTEST_CHECK(static_cast<double>(both) > 0.85 * static_cast<double>(either));
    auto same = before;
    add_noise(same, 0.008, 4);
    const auto nothing = outline_of_change(change_map(before, same, 1), allowed);
    DOCTEST_CHECK(std::count_if(nothing.data.begin(), nothing.data.end(),
                                [](float share) { return share > 0.5f; }) == 0);
}

}  // namespace
}  // namespace view_frame_test
