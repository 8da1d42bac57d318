// Parts of pictures that a server changed, told by differences among noise, drift and leaks.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <array>
#include <vector>

#include "engine/base/error.h"
#include "engine/localize/clusters.h"
#include "engine/remote/views/difference_source.h"
#include "engine/remote/views/painted_part.h"
#include "tests/unit/remote/fake_server.h"
#include "tests/unit/remote/test_pictures.h"

namespace change_map_test {
namespace {

using namespace gse;
using namespace gse::remote;
using namespace remote_pictures;

constexpr int Side = 128;
constexpr double Noise = 0.02;

/// The picture with the mask in one colour, and noise everywhere.
Image edited(const Image& picture, const Mask& mask, std::uint64_t seed, double noise = Noise) {
    Image result = picture;
    paint(result, mask, {0.95f, 0.15f, 0.85f});
    add_noise(result, noise, seed);
    return result;
}

double iou_of(const ChangedPart& part, const Mask& truth) { return localize::mask_iou(part.mask, truth); }

}  // namespace

DOCTEST_TEST_CASE("changed part: a thing is found at every size, among noise") {
    const Image before = waves(Side);
    for (const double radius : {6.0, 14.0, 28.0, 45.0}) {
        const Mask thing = disc(Side, radius, 60, 66);
        const std::array after{edited(before, thing, 1), edited(before, thing, 2)};
        const auto part = changed_part(before, after);
        DOCTEST_CHECK((part.found == ChangeFound::Part));
        DOCTEST_CHECK_MESSAGE(iou_of(part, thing) >= (radius < 10 ? 0.75 : 0.9), radius);
        for (std::size_t i = 0; i < part.map.data.size(); ++i)
            DOCTEST_REQUIRE((part.map.data[i] > 0.5f) == (part.mask.data[i] != 0));
    }
}

DOCTEST_TEST_CASE("changed part: a leak of one picture is left out, and a small one of both") {
    const Image before = waves(Side);
    const Mask thing = disc(Side, 20, 50, 60), leak = disc(Side, 14, 105, 25), small = disc(Side, 5, 20, 110);
    Image first = edited(before, thing, 1), second = edited(before, thing, 2);
    paint(first, leak, {0.1f, 0.9f, 0.9f});
    const std::array after{first, second};
    DOCTEST_CHECK(iou_of(changed_part(before, after), thing) >= 0.9);
    const auto alone = changed_part(before, std::span(after).first(1));
    DOCTEST_CHECK(iou_of(alone, thing) < 0.8);  // chance is not told from the edit by one picture
    paint(second, small, {0.1f, 0.9f, 0.9f});
    paint(first, small, {0.1f, 0.9f, 0.9f});
    const std::array leaking{first, second};
    DOCTEST_CHECK(iou_of(changed_part(before, leaking), thing) >= 0.9);
}

DOCTEST_TEST_CASE("changed part: what was not edited, and what was restyled as a whole, is no part") {
    const Image before = waves(Side);
    const std::array same{edited(before, Mask(Side, Side), 1), edited(before, Mask(Side, Side), 2)};
    DOCTEST_CHECK((changed_part(before, same).found == ChangeFound::Nothing));
    Image tinted = before;
    for (std::size_t i = 0; i < tinted.data.size(); i += 3) tinted.data[i] += 0.15f;
    DOCTEST_CHECK((changed_part(before, std::span(&tinted, 1)).found == ChangeFound::Nothing));
    const Image other = waves(Side, 31, 17, 1.7);
    const auto restyled = changed_part(before, std::span(&other, 1));
    DOCTEST_CHECK(restyled.mask.count() == 0);
    DOCTEST_CHECK((restyled.found == ChangeFound::Everywhere));
    DOCTEST_CHECK((changed_part(before, {}).found == ChangeFound::Nothing));
}

DOCTEST_TEST_CASE("changed part: a picture that the server moved is moved back first") {
    const Image before = waves(Side);
    const Mask thing = disc(Side, 22, 64, 60);
    Image drawn = edited(waves(Side, 2, -1), Mask(Side, Side), 3);
    const Mask moved = disc(Side, 22, 66, 59);
    paint(drawn, moved, {0.95f, 0.15f, 0.85f});
    const Image back = aligned(before, drawn);
    DOCTEST_CHECK(iou_of(changed_part(before, std::span(&back, 1)), thing) >= 0.9);
    const Image still = edited(before, thing, 4);
    DOCTEST_CHECK(iou_of(changed_part(before, std::array{aligned(before, still)}), thing) >= 0.9);
}

namespace {

struct Asked {
    test::FakeServer server;
    PictureSource source{server, server.facts, "", nullptr};
    Image picture = waves(Side);

    std::vector<Image> locate(const char* family, const std::vector<std::string>& words,
                              bool paints = false) {
        RemoteDrawing drawing;
        drawing.text = {"a golden bear", "turn the bear into a golden bear", ""};
        drawing.family = family_named(family);
        drawing.side = Side;
        DifferenceSource differences(source, {drawing, "a bear", "bear", paints}, {});
        return differences.locate({picture, "a golden bear", words, "", false, 1, 77});
    }
};

}  // namespace

DOCTEST_TEST_CASE("difference source: a model that is told what to do is asked twice, and once per word") {
    Asked asked;
    const Mask thing = disc(Side, 24, 60, 60);
    asked.server.draws = [&](const RedrawOrder& order, std::size_t call) {
        return edited(order.picture, thing, call);
    };
    const auto maps = asked.locate("kontext", {"bear", "grass"});
    DOCTEST_REQUIRE(asked.server.orders.size() == 2);
    DOCTEST_CHECK(asked.server.orders[0].seed != asked.server.orders[1].seed);
    DOCTEST_CHECK(asked.server.orders[0].prompt.starts_with("Turn the bear into a golden bear."));
    DOCTEST_CHECK(asked.server.orders[0].mask.data.empty());
    DOCTEST_CHECK(localize::mask_iou(localize::threshold_map(maps[0], 0.5), thing) >= 0.9);
    DOCTEST_CHECK(*std::max_element(maps[1].data.begin(), maps[1].data.end()) == 0);
}

DOCTEST_TEST_CASE(
    "difference source: a thing that is to be painted takes one picture, and its colour tells") {
    Asked asked;
    const Mask thing = disc(Side, 24, 60, 60), leak = disc(Side, 24, 100, 30);
    const auto& colour = rarest_colour(asked.picture);
    asked.server.draws = [&](const RedrawOrder& order, std::size_t) {
        Image drawn = order.picture;
        paint(drawn, leak, {0.9f, 0.9f, 0.9f});
        paint(drawn, thing, colour.rgb);
        return drawn;
    };
    const auto maps = asked.locate("kontext", {"bear"}, true);
    DOCTEST_REQUIRE(asked.server.orders.size() == 1);
    DOCTEST_CHECK(asked.server.orders[0].prompt.find(colour.words) != std::string::npos);
    DOCTEST_CHECK(asked.server.orders[0].prompt.starts_with("Paint the bear completely in flat"));
    DOCTEST_CHECK(localize::mask_iou(localize::threshold_map(maps[0], 0.5), thing) >= 0.9);
    DOCTEST_CHECK_THROWS_AS(asked.locate("sdxl", {"bear"}, true), Error);
}

DOCTEST_TEST_CASE(
    "difference source: other models draw both sentences with one seed, and errors of both cancel") {
    Asked asked;
    const Mask thing = disc(Side, 24, 60, 60), error = disc(Side, 30, 100, 100);
    asked.server.draws = [&](const RedrawOrder& order, std::size_t call) {
        Image drawn = order.picture;
        paint(drawn, error, {0.5f, 0.5f, 0.1f});  // of the seed
        if (order.prompt.starts_with("a golden")) paint(drawn, thing, {0.95f, 0.15f, 0.85f});
        add_noise(drawn, Noise, call);
        return drawn;
    };
    const auto maps = asked.locate("sdxl", {"bear"});
    DOCTEST_REQUIRE(asked.server.orders.size() == 2);
    DOCTEST_CHECK(asked.server.orders[0].prompt == "a bear");
    DOCTEST_CHECK(asked.server.orders[0].seed == asked.server.orders[1].seed);
    DOCTEST_CHECK(localize::mask_iou(localize::threshold_map(maps[0], 0.5), thing) >= 0.9);
}

DOCTEST_TEST_CASE(
    "difference source: an answer of another shape says nothing, and fillers of masks are refused") {
    Asked asked;
    asked.server.draws = [](const RedrawOrder&, std::size_t) { return Image(96, 64, 3, 0.5f); };
    const auto maps = asked.locate("kontext", {"bear"});
    DOCTEST_CHECK(*std::max_element(maps[0].data.begin(), maps[0].data.end()) == 0);
    DOCTEST_CHECK_THROWS_AS(asked.locate("flux1-fill", {"bear"}), Error);
}

}  // namespace change_map_test
