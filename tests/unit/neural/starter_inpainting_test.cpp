// Regions that the training of new shapes hides.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <numeric>
#include <set>

#include "engine/neural/starter/starter_inpainting.h"

namespace {

using namespace gse::neural;

constexpr int Side = 16;

std::vector<std::uint8_t> square(int left, int top, int size) {
    std::vector<std::uint8_t> covered(Side * Side);
    for (int y = top; y < top + size; ++y)
        for (int x = left; x < left + size; ++x) covered[static_cast<std::size_t>(y * Side + x)] = 200;
    return covered;
}

float sum(const std::vector<float>& values) { return std::accumulate(values.begin(), values.end(), 0.0f); }

}  // namespace

DOCTEST_TEST_CASE("what is hidden holds what is new and a cell around it, and differs from time to time") {
    gse::Random random(1);
    const auto covered = square(5, 6, 4), grown = square(4, 5, 6);
    std::set<std::vector<float>> masks;
    for (const auto task : {InpaintTask::Around, InpaintTask::Background, InpaintTask::Scene})
        for (int k = 0; k < 40; ++k) {
            const auto cells = draw_inpaint_cells(task, covered, square(0, 0, 0), Side, random);
            for (std::size_t i = 0; i < grown.size(); ++i) {
                DOCTEST_CHECK((cells.mask[i] == 0 || cells.mask[i] == 1));
                DOCTEST_CHECK((cells.mask[i] == 1 || grown[i] == 0));
                DOCTEST_CHECK((cells.mask[i] == 1 || cells.shown[i] == 1));  // what stays is shown
                if (task == InpaintTask::Around) DOCTEST_CHECK(cells.shown[i] == 1 - cells.mask[i]);
                if (task == InpaintTask::Scene) DOCTEST_CHECK(cells.shown[i] == 1);
            }
            DOCTEST_CHECK(sum(cells.mask) < Side * Side);
            masks.insert(cells.mask);
        }
    DOCTEST_CHECK(masks.size() > 60);
}

DOCTEST_TEST_CASE("at times nothing is shown, or there is nothing new to see") {
    gse::Random random(2);
    const auto nothing =
        draw_inpaint_cells(InpaintTask::Nothing, square(0, 0, 3), square(2, 2, 2), Side, random);
    DOCTEST_CHECK(sum(nothing.mask) == Side * Side);
    DOCTEST_CHECK(sum(nothing.shown) == 0);
    std::size_t empty = 0;
    for (int k = 0; k < 40; ++k)
        empty += sum(draw_inpaint_cells(InpaintTask::Scene, square(0, 0, 0), square(2, 2, 2), Side, random)
                         .mask) == 0;
    DOCTEST_CHECK(empty > 5);
    DOCTEST_CHECK(empty < 35);
    std::set<InpaintTask> with, without;
    for (int k = 0; k < 60; ++k) {
        with.insert(draw_inpaint_task(true, random));
        without.insert(draw_inpaint_task(false, random));
    }
    DOCTEST_CHECK((with == std::set{InpaintTask::Nothing, InpaintTask::Scene, InpaintTask::Place}));
    DOCTEST_CHECK((without == std::set{InpaintTask::Nothing, InpaintTask::Around, InpaintTask::Background}));
}

DOCTEST_TEST_CASE("where another thing takes a place, what is hidden mostly is the room of the old one") {
    gse::Random random(3);
    const auto room = square(2, 3, 9);
    std::size_t rooms = 0;
    for (int k = 0; k < 100; ++k) {
        const auto cells = draw_inpaint_cells(InpaintTask::Around, square(5, 6, 4), room, Side, random);
        rooms += std::equal(room.begin(), room.end(), cells.mask.begin(),
                            [](auto in_room, float hidden) { return (in_room > 0) == (hidden > 0); });
    }
    DOCTEST_CHECK(rooms > 60);
    DOCTEST_CHECK(rooms < 100);
}

DOCTEST_TEST_CASE(
    "what is added somewhere on a thing may change all around it, and all of the scene is shown") {
    gse::Random random(4);
    const auto room = square(2, 3, 9);
    for (int k = 0; k < 20; ++k) {
        const auto cells = draw_inpaint_cells(InpaintTask::Place, square(5, 6, 4), room, Side, random);
        DOCTEST_CHECK(std::equal(room.begin(), room.end(), cells.mask.begin(),
                                 [](auto in_room, float hidden) { return (in_room > 0) == (hidden > 0); }));
        DOCTEST_CHECK(sum(cells.shown) == Side * Side);
    }
}
