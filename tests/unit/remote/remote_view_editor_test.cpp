// Rounds of views through a server in this process.
#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <stop_token>
#include <string>

#include "engine/base/content_hash.h"
#include "engine/remote/views/depth_warp.h"
#include "engine/remote/views/remote_view_editor.h"
#include "engine/remote/views/view_sheet.h"
#include "tests/unit/remote/fake_server.h"
#include "tests/unit/remote/test_pictures.h"
#include "tests/unit/remote/wall_views.h"

namespace remote_view_editor_test {
namespace {

using namespace gse;
using namespace gse::remote;

using namespace remote_pictures;
using namespace remote_walls;
using gse::test::FakeServer;

struct Setup {
    FakeServer server;
    MemoryAnswers answers;
    edit::EditedViews edit(const RemoteDrawing& drawing, const std::vector<edit::EditView>& views,
                           const edit::EditViewsRequest& request = request_of()) {
        PictureSource source(server, server.facts, "", &answers);
        return RemoteViewEditor(source, drawing).edit(views, request, {});
    }
};

/// Mean error inside the mask against what the server's rule makes of the original.
double error_inside(const edit::EditView& view, const Image& picture, const FakeServer& server) {
    return change_inside(gse::test::in_colour(view.original, server.colour), picture, view.mask);
}

DOCTEST_TEST_CASE("editor: every way draws what the server's rule makes, inside the masks alone") {
    const auto views = views_of_wall(6);
    for (const auto& [agreement, family, most] : {std::tuple{Agreement::None, "sd15", 0.03},
                                                  {Agreement::Sheet, "kontext", 0.06},
                                                  {Agreement::Reference, "flux2-klein", 0.03},
                                                  {Agreement::Warp, "sd15-inpainting", 0.06}}) {
        DOCTEST_CAPTURE(agreement_name(agreement));
        Setup setup;
        setup.server.facts.references = 4;
        if (agreement == Agreement::Warp)  // what is carried over is in its colour already
            setup.server.draws = [&](const RedrawOrder& order, std::size_t) {
                if (order.strength < 0.5) return order.picture;
                return gse::test::where(order.mask, gse::test::in_colour(order.picture, setup.server.colour),
                                        order.picture);
            };
        const auto edited = setup.edit(drawing_of(agreement, family), views);
        DOCTEST_REQUIRE(edited.images.size() == views.size());
        for (std::size_t v = 0; v < views.size(); ++v) {
            DOCTEST_CAPTURE(v);
            DOCTEST_CHECK(edited.rejected[v] == 0);
            DOCTEST_CHECK(error_inside(views[v], edited.images[v], setup.server) < most);
            DOCTEST_CHECK(psnr_outside(views[v].rendered, edited.images[v], views[v].mask) == 99);
        }
        DOCTEST_CHECK(edited.scalars.at("rejected") == 0);
        DOCTEST_CHECK(edited.scalars.at("requests") == static_cast<double>(setup.server.orders.size()));
    }
}

DOCTEST_TEST_CASE("editor: one seed for all views, which another round does not share") {
    Setup setup;
    setup.edit(drawing_of(Agreement::None), views_of_wall(4));
    for (const auto& order : setup.server.orders) DOCTEST_CHECK(order.seed == setup.server.orders[0].seed);
    DOCTEST_CHECK(setup.server.orders[0].prompt == "a golden wall");
    DOCTEST_CHECK(setup.server.orders[0].strength == family_named("sd15").strength);
    const auto first = setup.server.orders.size();
    auto later = request_of(1);
    later.seed = 18;
    setup.edit(drawing_of(Agreement::None), views_of_wall(4), later);
    DOCTEST_CHECK(setup.server.orders[first].seed != setup.server.orders[0].seed);
    DOCTEST_CHECK(setup.server.orders[first].strength == family_named("sd15").again_strength);
}

DOCTEST_TEST_CASE("editor: progress names the server, and its queue while a view waits there") {
    Setup setup;
    setup.server.place = 3;
    auto drawing = drawing_of(Agreement::None);
    drawing.nickname = "10.0.0.5:7860";
    std::vector<std::string> stages;
    const JobControl job{[&](std::string_view stage, int, int) { stages.emplace_back(stage); }, {}};
    PictureSource source(setup.server, setup.server.facts, "", nullptr);
    RemoteViewEditor(source, drawing).edit(views_of_wall(2), request_of(), job);
    const std::string first = "view 1 of 2 at 10.0.0.5:7860", second = "view 2 of 2 at 10.0.0.5:7860",
                      waits = ": waiting in the server's queue, place 3";
    DOCTEST_CHECK(stages ==
                  std::vector<std::string>{first, first + waits, first, second, second + waits, second});
}

DOCTEST_TEST_CASE("editor: an edit that failed asks only for what is missing when it is run again") {
    Setup setup;
    setup.server.fails_from = 3;
    DOCTEST_CHECK_THROWS_AS(setup.edit(drawing_of(Agreement::None), views_of_wall(5)), Error);
    DOCTEST_CHECK(setup.server.orders.size() == 3);
    setup.server.fails_from = ~std::size_t{0};
    const auto edited = setup.edit(drawing_of(Agreement::None), views_of_wall(5));
    DOCTEST_CHECK(setup.server.orders.size() == 5);
    DOCTEST_CHECK(edited.scalars.at("requests") == 2);
    DOCTEST_CHECK(edited.scalars.at("cached_requests") == 3);
    Setup fresh;
    const auto whole = fresh.edit(drawing_of(Agreement::None), views_of_wall(5));
    for (std::size_t v = 0; v < 5; ++v) DOCTEST_CHECK(whole.images[v].data == edited.images[v].data);
    auto other = request_of();
    other.seed = 99;  // another edit has nothing in the cache
    setup.edit(drawing_of(Agreement::None), views_of_wall(5), other);
    DOCTEST_CHECK(setup.server.orders.size() == 10);
}

DOCTEST_TEST_CASE("editor: what is of no use is asked for once more with another seed, then rejected") {
    const auto views = views_of_wall(4);
    Setup setup;
    const auto rule = [&](const RedrawOrder& order) {
        return gse::test::where(order.mask, gse::test::in_colour(order.picture, setup.server.colour),
                                order.picture);
    };
    setup.server.draws = [&](const RedrawOrder& order, std::size_t call) {
        return call == 1 ? Image(Side, Side, 3, 0.9f) : rule(order);  // once something unrelated
    };
    const auto mended = setup.edit(drawing_of(Agreement::None), views);
    DOCTEST_CHECK(setup.server.orders.size() == 5);
    DOCTEST_CHECK(setup.server.orders[2].seed != setup.server.orders[1].seed);
    DOCTEST_CHECK(mended.scalars.at("rejected") == 0);
    Setup stubborn;
    stubborn.server.draws = [&](const RedrawOrder& order, std::size_t call) {
        return call == 1 || call == 2 ? Image(Side, Side, 3, 0.9f) : rule(order);
    };
    const auto edited = stubborn.edit(drawing_of(Agreement::None), views);
    DOCTEST_CHECK(edited.rejected == std::vector<std::uint8_t>{0, 1, 0, 0});
    DOCTEST_CHECK(edited.images[1].data == views[1].rendered.data);
    Setup blind;
    blind.server.draws = [&](const RedrawOrder&, std::size_t) { return Image(Side, Side, 3, 0.9f); };
    std::string said;
    try {
        blind.edit(drawing_of(Agreement::None), views);
    } catch (const Error& error) { said = error.message(); }
    DOCTEST_CHECK(said.find("has not looked at our picture") != std::string::npos);
}

DOCTEST_TEST_CASE("editor: an unedited copy is asked for at a higher strength") {
    Setup setup;
    setup.server.draws = [&](const RedrawOrder& order, std::size_t call) {
        if (call == 0) return order.picture;
        return gse::test::where(order.mask, gse::test::in_colour(order.picture, setup.server.colour),
                                order.picture);
    };
    const auto edited = setup.edit(drawing_of(Agreement::None), views_of_wall(2));
    DOCTEST_CHECK(edited.scalars.at("rejected") == 0);
    DOCTEST_CHECK(setup.server.orders[1].strength > setup.server.orders[0].strength);
}

DOCTEST_TEST_CASE("editor: a stop request ends a round between views, and what came is kept") {
    Setup setup;
    std::stop_source stop;
    PictureSource source(setup.server, setup.server.facts, "", &setup.answers);
    RemoteViewEditor editor(source, drawing_of(Agreement::None));
    std::vector<std::string> stages;
    const JobControl job{[&](std::string_view stage, int, int) {
                             if (stages.empty() || stages.back() != stage) stages.emplace_back(stage);
                             if (stages.size() == 3) stop.request_stop();
                         },
                         stop.get_token()};
    DOCTEST_CHECK_THROWS_AS(editor.edit(views_of_wall(5), request_of(), job), Error);
    DOCTEST_CHECK(stages.front() == "view 1 of 5 at the server");
    DOCTEST_CHECK(setup.server.orders.size() == 2);
    DOCTEST_CHECK(setup.answers.answers.size() == 2);
}

DOCTEST_TEST_CASE("sheet: four views a request; later sheets hold the edited first view, which stays") {
    Setup setup;
    setup.edit(drawing_of(Agreement::Sheet, "kontext"), views_of_wall(7));
    DOCTEST_REQUIRE(setup.server.orders.size() == 2);
    const auto& second = setup.server.orders[1];
    const auto anchor = cut_cell(second.picture, 0);
    const auto first = cut_cell(setup.server.orders[0].picture, 0);
    DOCTEST_CHECK(change_inside(anchor, first, disc(cell_side(Side), 10)) > 0.1);
    for (int y = 0; y < cell_side(Side); ++y)
        for (int x = 0; x < cell_side(Side); ++x) DOCTEST_REQUIRE(second.mask.at(x, y, 0) == 0);
}

DOCTEST_TEST_CASE("reference: others are shown the first view as it was drawn, and a copy of it is refused") {
    Setup setup;
    setup.server.facts.references = 2;
    setup.server.facts.kind = ServerKind::Comfy;
    setup.server.draws = [&](const RedrawOrder& order, std::size_t) {
        if (!order.references.empty() && order.references[0].data != order.picture.data &&
            setup.server.orders.size() == 3)
            return order.references[0];
        return gse::test::where(order.mask, gse::test::in_colour(order.picture, setup.server.colour),
                                order.picture);
    };
    auto views = views_of_wall(4);
    for (std::size_t v = 0; v < views.size(); ++v) {  // one ground, and another side of the object in each
        views[v].mask = disc(Side, 40);
        views[v].rendered = views[v].original = gse::test::where(
            as_image(views[v].mask), waves(Side, 31.0 * static_cast<double>(v)), waves(Side));
    }
    const auto edited = setup.edit(drawing_of(Agreement::Reference, "flux2"), views);
    DOCTEST_CHECK(setup.server.orders[0].references.empty());
    DOCTEST_CHECK(setup.server.orders[1].references.size() == 1);
    DOCTEST_CHECK(setup.server.orders[1].prompt.find("image 2") != std::string::npos);
    DOCTEST_CHECK(edited.scalars.at("rejected") == 0);
    DOCTEST_CHECK(std::any_of(setup.server.orders.begin() + 1, setup.server.orders.end(),
                              [](const auto& order) { return order.references.empty(); }));
}

DOCTEST_TEST_CASE("warp: what another view shows is carried over along the surface, without its rim") {
    const auto views = views_of_wall(3);
    std::vector<Image> pictures;
    for (const auto& view : views)
        pictures.push_back(gse::test::in_colour(view.original, {0.2f, 0.4f, 1.0f}));
    const auto warped = warp_by_depth({&views[0], &views[1]}, {&pictures[0], &pictures[1]}, views[2]);
    DOCTEST_CHECK(warped.known.count() > views[2].mask.count() * 8 / 10);
    DOCTEST_CHECK(change_inside(warped.picture, pictures[2], warped.known) < 0.01);
    DOCTEST_CHECK(psnr_outside(views[2].rendered, warped.picture, warped.known) == 99);
    auto hidden = views;
    hidden[2].depth = Image(Side, Side, 1, 3.0f);  // another surface
    const auto nothing = warp_by_depth({&views[0]}, {&pictures[0]}, hidden[2]);
    DOCTEST_CHECK(nothing.known.count() == 0);
    DOCTEST_CHECK(nothing.picture.data == hidden[2].rendered.data);
}

DOCTEST_TEST_CASE("warp: parts of a mask that lie beside the object may stay as they are") {
    auto views = views_of_wall(3);
    for (auto& view : views) {
        const auto object =
            disc(Side, 22, Side / 2.0 - 4.0 * static_cast<double>(&view - &views[0]), Side / 2.0);
        for (std::size_t i = 0; i < object.data.size(); ++i) {
            if (object.data[i] != 0) continue;
            view.depth.data[i] = 0;
            if (view.mask.data[i] == 0) continue;
            for (std::size_t c = 0; c < 3; ++c)
                view.rendered.data[i * 3 + c] = view.original.data[i * 3 + c] = 0;
        }
    }
    Setup setup;
    const auto edited = setup.edit(drawing_of(Agreement::Warp, "sd15-inpainting"), views);
    DOCTEST_CHECK(edited.scalars.at("rejected") == 0);
    DOCTEST_CHECK(setup.server.orders.size() == 1 + 2 * 2);
}

DOCTEST_TEST_CASE(
    "own pictures: a view that has one is not asked for, and leads the others, whatever their way") {
    const auto views = views_of_wall(5);
    const auto blue = gse::test::in_colour(views[3].original, {0.2f, 0.4f, 1.0f});
    for (const auto& [agreement, family] : {std::pair{Agreement::None, "sd15"},
                                            {Agreement::Sheet, "kontext"},
                                            {Agreement::Reference, "flux2-klein"},
                                            {Agreement::Warp, "sd15-inpainting"}}) {
        DOCTEST_CAPTURE(agreement_name(agreement));
        Setup setup;
        setup.server.facts.references = 4;
        auto drawing = drawing_of(agreement, family);
        drawing.own = {{"view_3", at_side(blue, 2 * Side)}};  // the name as files have it
        const auto edited = setup.edit(drawing, views);
        DOCTEST_CHECK(change_inside(edited.images[3], blue, views[3].mask) < 0.02);
        DOCTEST_CHECK(psnr_outside(views[3].rendered, edited.images[3], views[3].mask) == 99);
        DOCTEST_CHECK(edited.rejected[3] == 0);
        for (const auto& order : setup.server.orders) {
            DOCTEST_CHECK(order.picture.data != views[3].rendered.data);
            if (agreement == Agreement::Reference)
                DOCTEST_CHECK(
                    change_inside(order.references.back(), at_side(blue, Side), Mask(Side, Side, 1)) < 0.02);
        }
        if (agreement == Agreement::Warp)  // view 0 is blue, carried over, before the server is asked
            DOCTEST_CHECK(change_inside(setup.server.orders[0].picture,
                                        gse::test::in_colour(views[0].original, {0.2f, 0.4f, 1.0f}),
                                        disc(Side, 20)) < 0.05);
        if (agreement == Agreement::Sheet)
            DOCTEST_CHECK(change_inside(cut_cell(setup.server.orders[0].picture, 0),
                                        at_side(blue, cell_side(Side)), disc(cell_side(Side), 10)) < 0.05);
    }
}

DOCTEST_TEST_CASE(
    "own pictures: what is painted beside the mask is left out, and that is said with its share") {
    const auto views = views_of_wall(4);
    auto inside =
        gse::test::where(as_image(views[2].mask), gse::test::in_colour(views[2].rendered, {0.2f, 0.4f, 1.0f}),
                         views[2].rendered);
    auto beyond = inside;
    for (int y = 0; y < 24; ++y)  // 576 pixels of about 2800 + 576
        for (int x = 0; x < 24; ++x) beyond.at(x, y, 0) = 1, beyond.at(x, y, 1) = beyond.at(x, y, 2) = 0;
    add_noise(inside, 0.01, 3);  // as files that are compressed have it
    const auto warnings = [&](const Image& own, int round = 0) {
        Setup setup;
        auto drawing = drawing_of(Agreement::None);
        drawing.own = {{"view 2", own}};
        const auto edited = setup.edit(drawing, views, request_of(round));
        DOCTEST_CHECK(psnr_outside(views[2].rendered, edited.images[2], views[2].mask) == 99);
        return edited.warnings;
    };
    DOCTEST_CHECK(warnings(inside).empty());
    DOCTEST_CHECK(warnings(at_side(inside, 4 * Side)).empty());
    DOCTEST_CHECK(warnings(at_side(views[2].rendered, 3 * Side)).empty());
    for (const int side : {Side, 4 * Side}) {
        const auto said = warnings(at_side(beyond, side));
        DOCTEST_REQUIRE(said.size() == 1);
        DOCTEST_CHECK(said[0].find("view 2") != std::string::npos);
        DOCTEST_CHECK(said[0].find("widen the label") != std::string::npos);
        const double share = share_outside(views[2], at_side(beyond, side));
        DOCTEST_CHECK(share > 0.15);
        DOCTEST_CHECK(share < 0.21);
        DOCTEST_CHECK(said[0].starts_with(std::to_string(static_cast<int>(std::lround(100 * share))) + " %"));
    }
    DOCTEST_CHECK(warnings(beyond, 1).empty());  // it was said in the first round
}

DOCTEST_TEST_CASE("own pictures: a name that no view of the round has is refused with the names they have") {
    Setup setup;
    auto drawing = drawing_of(Agreement::None);
    drawing.own = {{"view 9", waves(Side)}};
    DOCTEST_CHECK_THROWS_WITH_AS(setup.edit(drawing, views_of_wall(3)),
                                 doctest::Contains("\"view 9\" is none of the views"), Error);
    drawing.own = {};
    drawing.key_view = "view 4";
    DOCTEST_CHECK_THROWS_AS(setup.edit(drawing, views_of_wall(3)), Error);
    DOCTEST_CHECK(setup.server.orders.empty());
}

DOCTEST_TEST_CASE("own pictures: the view that is named as key is drawn first") {
    Setup setup;
    setup.server.facts.references = 4;
    auto drawing = drawing_of(Agreement::Reference, "flux2-klein");
    drawing.key_view = "view 2";
    const auto views = views_of_wall(4);
    setup.edit(drawing, views);
    DOCTEST_CHECK(setup.server.orders[0].picture.data == views[2].rendered.data);
    DOCTEST_CHECK(suited_agreement(Agreement::Auto, family_named("sd15"), setup.server.facts) ==
                  Agreement::None);
    DOCTEST_CHECK(suited_agreement(Agreement::Auto, family_named("sd15"), setup.server.facts, true) ==
                  Agreement::Warp);
}

DOCTEST_TEST_CASE("editor: something new comes with its outline") {
    Setup setup;
    const auto hat = disc(Side, 9);
    setup.server.draws = [&](const RedrawOrder& order, std::size_t) {
        auto picture = order.picture;
        paint(picture, hat, {0.9f, 0.1f, 0.8f});
        return picture;
    };
    auto views = views_of_wall(3);
    for (auto& view : views) view.mask = disc(Side, 30), view.clean_plate.picture = view.rendered;
    auto request = request_of();
    request.anew = true;
    const auto edited = setup.edit(drawing_of(Agreement::None), views, request);
    DOCTEST_CHECK(setup.server.orders[0].strength >= 0.95);
    DOCTEST_REQUIRE(edited.outlines.size() == 3);
    const auto found = std::count_if(edited.outlines[0].data.begin(), edited.outlines[0].data.end(),
                                     [](float share) { return share > 0.5f; });
    DOCTEST_CHECK(static_cast<double>(found) ==
                  doctest::Approx(static_cast<double>(hat.count())).epsilon(0.3));
}

DOCTEST_TEST_CASE("source: answers are kept by all that they follow from, and not by the address") {
    Setup setup;
    RedrawOrder order;
    order.picture = waves(64);
    order.prompt = "a golden wall";
    const auto asked = [&](const std::string& identity, const RedrawOrder& what) {
        PictureSource source(setup.server, setup.server.facts, identity, &setup.answers);
        source.ask(what, {});
        return source.use().requests == 1;
    };
    DOCTEST_CHECK(asked("", order));
    DOCTEST_CHECK(!asked("", order));
    DOCTEST_CHECK(asked("workflow", order));
    for (const auto change : {0, 1, 2, 3}) {
        auto other = order;
        if (change == 0) other.seed = 1;
        if (change == 1) other.prompt = "a red wall";
        if (change == 2) other.mask = as_image(disc(64, 10));
        if (change == 3) other.references.push_back(waves(64));
        DOCTEST_CHECK(asked("", other));
    }
    setup.server.facts.model = "another";
    DOCTEST_CHECK(asked("", order));
}

DOCTEST_TEST_CASE(
    "source: a picture that is too large is asked for at 3/4 of its side, and the rest as well") {
    Setup setup;
    setup.server.draws = [&](const RedrawOrder& asked, std::size_t) {
        if (asked.picture.width > 192) throw Error(ErrorCode::Foreign, "it ran out of memory", TooLargeHint);
        return gse::test::in_colour(asked.picture, setup.server.colour);
    };
    RedrawOrder order;
    order.picture = waves(256);
    order.mask = as_image(disc(256, 40));
    order.references = {waves(256), waves(64)};
    PictureSource source(setup.server, setup.server.facts, "", &setup.answers);
    const auto picture = source.ask(order, {});
    DOCTEST_CHECK(picture.width == 256);
    DOCTEST_CHECK(change_inside(picture, gse::test::in_colour(order.picture, setup.server.colour),
                                disc(256, 100)) < 0.02);
    DOCTEST_CHECK(source.use().smaller_side == 192);
    DOCTEST_REQUIRE(setup.server.orders.size() == 2);
    DOCTEST_CHECK(setup.server.orders[1].mask.width == 192);
    DOCTEST_CHECK(setup.server.orders[1].references[0].width == 192);
    DOCTEST_CHECK(setup.server.orders[1].references[1].width == 64);
    DOCTEST_CHECK(source.ask(order, {}).data == picture.data);  // kept, and not asked for at the full size
    DOCTEST_CHECK(setup.server.orders.size() == 2);
    order.picture = Image(64, 64, 3);  // no smaller side is left
    order.mask = {};
    setup.server.draws = [](const RedrawOrder&, std::size_t) -> Image {
        throw Error(ErrorCode::Foreign, "it ran out of memory", TooLargeHint);
    };
    DOCTEST_CHECK_THROWS_WITH_AS(source.ask(order, {}), doctest::Contains("ran out of memory"), Error);
    DOCTEST_CHECK(setup.server.orders.size() == 3);
}

DOCTEST_TEST_CASE("editor: a round whose views are of two models is drawn once more") {
    Setup setup;
    setup.server.model = "one";
    setup.server.draws = [&](const RedrawOrder& order, std::size_t call) {
        if (call == 2) setup.server.model = "two";
        return gse::test::where(order.mask, gse::test::in_colour(order.picture, setup.server.colour),
                                order.picture);
    };
    setup.edit(drawing_of(Agreement::None), views_of_wall(4));
    DOCTEST_CHECK(setup.server.orders.size() == 4 + 2);  // the last two of the first pass are of "two"
}

}  // namespace
}  // namespace remote_view_editor_test
