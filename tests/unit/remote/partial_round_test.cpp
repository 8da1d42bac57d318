// Rounds that end before all of their views are drawn, slow pictures, and views that disagree.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "engine/base/error.h"
#include "engine/remote/drawing/partial_round.h"
#include "engine/remote/views/remote_view_editor.h"
#include "tests/unit/remote/fake_server.h"
#include "tests/unit/remote/wall_views.h"

namespace partial_round_test {
namespace {

using namespace gse;
using namespace gse::remote;

using namespace remote_pictures;
using namespace remote_walls;
using gse::test::FakeServer;

/// A server that ends early, and what was asked about its round.
struct Ending {
    FakeServer server;
    MemoryAnswers answers;
    RemoteDrawing drawing = drawing_of(Agreement::None);
    std::vector<PartialRound> asked = {};
    std::stop_source stop = {};

    /// Answers every question so.
    void answer(bool fits) {
        drawing.partial.fits = [this, fits](const PartialRound& round) {
            asked.push_back(round);
            return fits;
        };
    }
    edit::EditedViews edit(std::size_t views) {
        PictureSource source(server, server.facts, "", &answers);
        return RemoteViewEditor(source, drawing)
            .edit(views_of_wall(views), request_of(), {{}, stop.get_token()});
    }
    std::optional<Error> error_of(std::size_t views) {
        try {
            edit(views);
        } catch (const Error& error) { return error; }
        return std::nullopt;
    }
};

DOCTEST_TEST_CASE("partial: at least 60 % of the views and four of them are enough") {
    DOCTEST_CHECK(is_enough(5, 8));
    DOCTEST_CHECK_FALSE(is_enough(4, 8));
    DOCTEST_CHECK(is_enough(4, 6));
    DOCTEST_CHECK_FALSE(is_enough(3, 4));
    DOCTEST_CHECK(is_enough(8, 12));
    DOCTEST_CHECK_FALSE(is_enough(7, 12));
}

DOCTEST_TEST_CASE("partial: after a failure the scene may be fitted to what is there, after a question") {
    Ending run;
    run.server.fails_from = 5;
    run.answer(true);
    const auto edited = run.edit(8);
    DOCTEST_REQUIRE(run.asked.size() == 1);
    DOCTEST_CHECK(run.asked[0].drawn == 5);
    DOCTEST_CHECK(run.asked[0].wanted == 8);
    DOCTEST_CHECK(run.asked[0].missing == std::vector<std::string>{"view 5", "view 6", "view 7"});
    DOCTEST_CHECK(run.asked[0].reason.find("nobody answers") != std::string::npos);
    DOCTEST_CHECK(partial_text(run.asked[0]) == "5 of 8 views are drawn; missing: view 5, view 6, view 7");
    const std::vector<std::uint8_t> missing{0, 0, 0, 0, 0, 1, 1, 1};
    DOCTEST_CHECK(edited.missing == missing);
    DOCTEST_CHECK(edited.rejected == missing);
    DOCTEST_CHECK(edited.unfinished);
    DOCTEST_REQUIRE(edited.warnings.size() == 1);
    DOCTEST_CHECK(edited.warnings[0].starts_with("3 of 8 views were not drawn"));
    DOCTEST_CHECK(edited.images[6].data == views_of_wall(8)[6].rendered.data);
}

DOCTEST_TEST_CASE("partial: without an answer, with a No, or with too few views the failure ends the edit") {
    Ending nobody;
    nobody.server.fails_from = 5;
    const auto told = nobody.error_of(8);
    DOCTEST_REQUIRE(told);
    DOCTEST_CHECK(told->message() == "nobody answers");
    DOCTEST_CHECK(told->hint().find("5 of 8 views are drawn") != std::string::npos);
    DOCTEST_CHECK(told->hint().find("--server-fit-partial") != std::string::npos);
    Ending refused;
    refused.server.fails_from = 5;
    refused.answer(false);
    const auto error = refused.error_of(8);
    DOCTEST_REQUIRE(error);
    DOCTEST_CHECK(error->code() == ErrorCode::Foreign);
    DOCTEST_CHECK(refused.asked.size() == 1);
    Ending few;
    few.server.fails_from = 4;
    few.answer(true);
    const auto early = few.error_of(8);
    DOCTEST_REQUIRE(early);
    DOCTEST_CHECK(early->hint().empty());
    DOCTEST_CHECK(few.asked.empty());
}

DOCTEST_TEST_CASE("partial: views kept from an earlier run count, and a later run asks for the rest") {
    Ending run;
    run.server.fails_from = 5;
    run.answer(true);
    run.edit(8);
    run.edit(8);
    DOCTEST_CHECK(run.asked.size() == 2);
    DOCTEST_CHECK(run.server.orders.size() == 5);
    run.server.fails_from = ~std::size_t{0};
    const auto whole = run.edit(8);
    DOCTEST_CHECK(run.server.orders.size() == 8);
    DOCTEST_CHECK(whole.missing.empty());
    DOCTEST_CHECK_FALSE(whole.unfinished);
}

DOCTEST_TEST_CASE("partial: a drawing with enough views is ended alone, one with fewer with its job") {
    for (const std::size_t ends_at : {3, 6}) {
        DOCTEST_CAPTURE(ends_at);
        Ending run;
        run.answer(true);
        run.drawing.partial.stop = std::make_shared<DrawingStop>();
        bool taken = false;
        run.server.while_drawn = [&](std::size_t call) {
            if (call == ends_at) taken = run.drawing.partial.stop->request();
        };
        const auto edited = run.edit(8);
        DOCTEST_CHECK(taken == (ends_at == 6));
        DOCTEST_CHECK(std::count(edited.missing.begin(), edited.missing.end(), 1) == (taken ? 2 : 0));
        DOCTEST_CHECK(run.asked.size() == (taken ? 1 : 0));
        if (taken) DOCTEST_CHECK(run.asked[0].reason.empty());
        DOCTEST_CHECK_FALSE(run.drawing.partial.stop->request());  // nothing is under way any more
    }
}

DOCTEST_TEST_CASE("partial: a stop of the job is no question") {
    Ending run;
    run.answer(true);
    run.server.while_drawn = [&](std::size_t call) {
        if (call == 6) run.stop.request_stop();
    };
    const auto error = run.error_of(8);
    DOCTEST_REQUIRE(error);
    DOCTEST_CHECK(error->code() == ErrorCode::Cancelled);
    DOCTEST_CHECK(run.asked.empty());
}

DOCTEST_TEST_CASE("partial: what further servers have drawn before the first failed is there") {
    Ending run;
    FakeServer second;
    second.facts = run.server.facts;
    std::atomic<int> drawn = 0;
    second.draws = [&](const RedrawOrder& order, std::size_t) {
        ++drawn;
        return gse::test::where(order.mask, gse::test::in_colour(order.picture, second.colour),
                                order.picture);
    };
    run.server.while_drawn = [&](std::size_t) {
        while (drawn < 5) std::this_thread::yield();  // the second one draws first
        throw Error(ErrorCode::Foreign, "nobody answers");
    };
    run.answer(true);
    PictureSource source(run.server, run.server.facts, "", nullptr);
    source.spread_over({{&second, "second"}});
    second.while_drawn = [&](std::size_t call) {
        if (call >= 5) throw Error(ErrorCode::Foreign, "gone");
    };
    const auto edited = RemoteViewEditor(source, run.drawing).edit(views_of_wall(8), request_of(), {});
    DOCTEST_REQUIRE(run.asked.size() == 1);
    DOCTEST_CHECK(run.asked[0].drawn == 5);
    DOCTEST_CHECK(std::count(edited.missing.begin(), edited.missing.end(), 1) == 3);
}

DOCTEST_TEST_CASE("slow: a picture of more than three times the usual time is told once per view") {
    FakeServer server;
    double now = 0;
    std::vector<std::string> stages;
    PictureSource source(server, server.facts, "", nullptr, PictureTimes([&] { return now; }));
    server.while_drawn = [&](std::size_t call) { now += call == 4 ? 31 : 10; };
    const JobControl job{[&](std::string_view stage, int, int) { stages.emplace_back(stage); }, {}};
    RemoteViewEditor(source, drawing_of(Agreement::None)).edit(views_of_wall(6), request_of(), job);
    const auto slow = [](const std::string& stage) { return stage.find(SlowStage) != std::string::npos; };
    DOCTEST_CHECK(std::count_if(stages.begin(), stages.end(), slow) == 1);
    const auto told = std::find_if(stages.begin(), stages.end(), slow);
    DOCTEST_REQUIRE(told != stages.end());
    DOCTEST_CHECK(*told == "view 5 of 6 at the server: it takes longer than the views before (10 s)");
}

DOCTEST_TEST_CASE("slow: nothing is said of the first pictures, of short waits, and of what is no longer") {
    double now = 0;
    PictureTimes times([&] { return now; });
    const auto drawn_in = [&](double seconds) {
        times.begin();
        now += seconds;
        times.end();
    };
    times.begin();
    now += 1000;
    DOCTEST_CHECK_FALSE(times.usual_of_slow());
    drawn_in(60);  // it loads the model
    times.begin();
    now += 1000;
    DOCTEST_CHECK_FALSE(times.usual_of_slow());
    drawn_in(0.125);
    drawn_in(0.125);
    times.begin();
    now += 1;  // eight times as long, and not worth a word
    DOCTEST_CHECK_FALSE(times.usual_of_slow());
    now += 1.5;
    DOCTEST_CHECK(times.usual_of_slow() == 0.125);
}

/// Draws golden, but for the views of two calls, which come in blue unless a golden key is shown.
void draw_two_in_blue(FakeServer& server, std::vector<std::size_t> calls) {
    server.draws = [&server, calls](const RedrawOrder& order, std::size_t call) {
        const bool blue = std::find(calls.begin(), calls.end(), call) != calls.end();
        const auto colour = blue ? std::array<float, 3>{0.1f, 0.3f, 1.0f} : server.colour;
        return gse::test::where(order.mask, gse::test::in_colour(order.picture, colour), order.picture);
    };
}

DOCTEST_TEST_CASE("outliers: the two views that disagree most are drawn once more, like the key view") {
    FakeServer server;
    server.facts.references = 4;
    draw_two_in_blue(server, {3, 6});
    PictureSource source(server, server.facts, "", nullptr);
    const auto views = views_of_wall(8);
    const auto edited =
        RemoteViewEditor(source, drawing_of(Agreement::None, "flux2-klein")).edit(views, request_of(), {});
    DOCTEST_REQUIRE(server.orders.size() == 10);
    DOCTEST_CHECK(edited.scalars.at("redrawn_outliers") == 2);
    for (std::size_t i = 8; i < 10; ++i) {
        DOCTEST_CHECK(server.orders[i].prompt.find("image 2") != std::string::npos);
        DOCTEST_CHECK(server.orders[i].seed != server.orders[0].seed);
    }
    for (const std::size_t v : {3, 6}) {
        const auto golden = gse::test::in_colour(views[v].original, server.colour);
        DOCTEST_CHECK(change_inside(golden, edited.images[v], views[v].mask) < 0.03);
    }
}

DOCTEST_TEST_CASE("outliers: none is looked for where the model takes no references, or views agree") {
    for (const auto& [family, references] : {std::pair{"sd15", 4}, {"flux2-klein", 1}}) {
        DOCTEST_CAPTURE(family);
        FakeServer server;
        server.facts.references = static_cast<std::size_t>(references);
        draw_two_in_blue(server, {3});
        PictureSource source(server, server.facts, "", nullptr);
        RemoteViewEditor(source, drawing_of(Agreement::None, family))
            .edit(views_of_wall(8), request_of(), {});
        DOCTEST_CHECK(server.orders.size() == 8);
    }
    FakeServer alike;
    alike.facts.references = 4;
    PictureSource source(alike, alike.facts, "", nullptr);
    RemoteViewEditor(source, drawing_of(Agreement::None, "flux2-klein"))
        .edit(views_of_wall(8), request_of(), {});
    DOCTEST_CHECK(alike.orders.size() == 8);
}

DOCTEST_TEST_CASE("outliers: a second picture that disagrees no less leaves the first one") {
    FakeServer server;
    server.facts.references = 4;
    draw_two_in_blue(server, {3, 8});
    PictureSource source(server, server.facts, "", nullptr);
    const auto edited = RemoteViewEditor(source, drawing_of(Agreement::None, "flux2-klein"))
                            .edit(views_of_wall(8), request_of(), {});
    DOCTEST_CHECK(server.orders.size() == 9);
    DOCTEST_CHECK_FALSE(edited.scalars.contains("redrawn_outliers"));
}

}  // namespace
}  // namespace partial_round_test
