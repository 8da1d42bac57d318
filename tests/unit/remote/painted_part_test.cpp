// A thing that a server was told to paint in one colour.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <string>

#include "engine/localize/clusters.h"
#include "engine/remote/views/painted_part.h"
#include "tests/unit/remote/test_pictures.h"

namespace painted_part_test {
namespace {

using namespace gse;
using namespace gse::remote;
using namespace remote_pictures;

constexpr int Side = 128;

/// The thing in the colour, half of it in shade, and noise everywhere.
Image painted(const Image& picture, const Mask& thing, const PaintColour& colour, double noise = 0.02) {
    Image result = picture;
    for (int y = 0; y < Side; ++y)
        for (int x = 0; x < Side; ++x)
            for (int c = 0; c < 3 && thing.at(x, y) != 0; ++c)
                result.at(x, y, c) = (y > Side / 2 ? 0.55f : 0.95f) * colour.rgb[static_cast<std::size_t>(c)];
    add_noise(result, noise, 5);
    return result;
}

}  // namespace

DOCTEST_TEST_CASE("painted part: the colour is one that the picture has least of") {
    Image picture(Side, Side, 3, 0.5f);
    paint(picture, disc(Side, 30, 40, 40), {1, 0, 1});
    paint(picture, disc(Side, 30, 90, 90), {0, 1, 1});
    const std::string words(rarest_colour(picture).words);
    DOCTEST_CHECK(words.find("magenta") == std::string::npos);
    DOCTEST_CHECK(words.find("cyan") == std::string::npos);
}

DOCTEST_TEST_CASE("painted part: the thing is found with its shaded side, whatever else has changed") {
    const Image before = waves(Side);
    const auto& colour = rarest_colour(before);
    const Mask thing = disc(Side, 26, 60, 64), leak = disc(Side, 20, 105, 30);
    Image after = painted(before, thing, colour);
    paint(after, leak, {0.9f, 0.9f, 0.9f});
    const auto part = painted_part(before, after, colour);
    DOCTEST_REQUIRE((part.found == ChangeFound::Part));
    DOCTEST_CHECK(localize::mask_iou(part.mask, thing) >= 0.95);
}

DOCTEST_TEST_CASE(
    "painted part: specks, nothing, all of the picture, and what had the hue before are no part") {
    const Image before = waves(Side);
    const auto& colour = rarest_colour(before);
    DOCTEST_CHECK((painted_part(before, before, colour).found == ChangeFound::Nothing));
    Mask specks(Side, Side), all(Side, Side);
    for (int y = 0; y < Side; ++y)
        for (int x = 0; x < Side; ++x) specks.at(x, y) = x % 5 == 0 && y % 5 == 0 ? 1 : 0, all.at(x, y) = 1;
    DOCTEST_CHECK(
        (painted_part(before, painted(before, specks, colour), colour).found == ChangeFound::Nothing));
    DOCTEST_CHECK(
        (painted_part(before, painted(before, all, colour), colour).found == ChangeFound::Everywhere));
    const Image had = painted(before, disc(Side, 30), colour, 0);
    DOCTEST_CHECK((painted_part(had, had, colour).found == ChangeFound::Nothing));
}

}  // namespace painted_part_test
