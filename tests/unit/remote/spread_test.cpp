// Views of a round that several servers in this process draw at once.
#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <latch>
#include <stop_token>
#include <string>
#include <thread>

#include "engine/base/log.h"
#include "engine/remote/views/difference_source.h"
#include "engine/remote/views/remote_view_editor.h"
#include "tests/unit/remote/fake_server.h"
#include "tests/unit/remote/wall_views.h"

namespace spread_test {
namespace {

using namespace gse;
using namespace gse::remote;
using namespace remote_walls;
using gse::test::FakeServer;

constexpr std::size_t Views = 8, Sheets = 3;  // of four cells, the first of which shows the key

/// Warnings while it lives; they do not reach stderr.
struct Warnings {
    std::vector<std::string> lines;
    Warnings() {
        log::set_sink([this](log::Level level, std::string_view text) {
            if (level == log::Level::Warning) lines.emplace_back(text);
        });
    }
    ~Warnings() { log::set_sink({}); }
};

/// Two servers. The first picture of each waits until the other server is asked, too: both draw some.
struct Pair {
    FakeServer first, second;
    std::latch both{2};
    MemoryAnswers answers;
    PictureSource source{first, first.facts, "", &answers};

    Pair() {
        for (auto* server : {&first, &second}) {
            server->facts.references = 4;
            server->draws = [this, server](const RedrawOrder& order, std::size_t call) {
                if (call == 0) both.arrive_and_wait();
                return drawn(*server, order);
            };
        }
        source.spread_over({{&second, "host2:7860"}});
    }
    static Image drawn(const FakeServer& server, const RedrawOrder& order) {
        return gse::test::where(order.mask, gse::test::in_colour(order.picture, server.colour),
                                order.picture);
    }
    /// The second server does not answer at its first picture, nor later.
    void second_fails() {
        second.draws = [this](const RedrawOrder&, std::size_t) -> Image {
            both.arrive_and_wait();
            throw Error(ErrorCode::Foreign, "nobody answers");
        };
    }
    edit::EditedViews edit(const RemoteDrawing& drawing, const JobControl& job = {}, int round = 0) {
        return RemoteViewEditor(source, drawing).edit(views_of_wall(Views), request_of(round), job);
    }
};

/// Pictures as one server draws them.
edit::EditedViews drawn_by_one(const RemoteDrawing& drawing) {
    FakeServer server;
    server.facts.references = 4;
    PictureSource source(server, server.facts, "", nullptr);
    return RemoteViewEditor(source, drawing).edit(views_of_wall(Views), request_of(), {});
}

void check_equal(const edit::EditedViews& one, const edit::EditedViews& other) {
    DOCTEST_REQUIRE(one.images.size() == other.images.size());
    for (std::size_t v = 0; v < one.images.size(); ++v)
        DOCTEST_CHECK(one.images[v].data == other.images[v].data);
    DOCTEST_CHECK(one.rejected == other.rejected);
}

DOCTEST_TEST_CASE("spread: two servers draw some each, and the result is that of one") {
    for (const auto& [agreement, family] : {std::pair{Agreement::None, "sd15"},
                                            {Agreement::Reference, "flux2-klein"},
                                            {Agreement::Sheet, "kontext"}}) {
        DOCTEST_CAPTURE(agreement_name(agreement));
        Pair pair;
        if (agreement != Agreement::None)  // the key is drawn before the others
            pair.first.draws = [&](const RedrawOrder& order, std::size_t call) {
                if (call == 1) pair.both.arrive_and_wait();
                return Pair::drawn(pair.first, order);
            };
        const auto drawing = drawing_of(agreement, family);
        const auto edited = pair.edit(drawing);
        check_equal(edited, drawn_by_one(drawing));
        DOCTEST_CHECK(!pair.first.orders.empty());
        DOCTEST_CHECK(!pair.second.orders.empty());
        const auto pictures = pair.first.orders.size() + pair.second.orders.size();
        DOCTEST_CHECK(pictures == (agreement == Agreement::Sheet ? Sheets : Views));
        DOCTEST_CHECK(pair.source.further()[0].drawn == pair.second.orders.size());
        DOCTEST_CHECK(edited.scalars.at("requests") == static_cast<double>(pictures));
        DOCTEST_CHECK(edited.scalars.at("cached_requests") == 0);
        const auto again = pair.edit(drawing);  // all of them were kept
        DOCTEST_CHECK(again.scalars.at("requests") == 0);
        DOCTEST_CHECK(again.scalars.at("cached_requests") == static_cast<double>(pictures));
    }
}

DOCTEST_TEST_CASE("spread: progress names both servers, and counts up") {
    Pair pair;
    auto drawing = drawing_of(Agreement::None);
    drawing.nickname = "host1:7860";
    std::vector<std::string> stages;
    std::vector<int> steps;
    const auto waits = std::this_thread::get_id();
    const JobControl job{[&](std::string_view stage, int step, int) {
                             stages.emplace_back(stage), steps.push_back(step);
                             DOCTEST_CHECK(std::this_thread::get_id() == waits);
                         },
                         {}};
    pair.edit(drawing, job);
    DOCTEST_REQUIRE(!stages.empty());
    DOCTEST_CHECK(stages[0] == "view 1 of 8 at host1:7860, host2:7860");
    DOCTEST_CHECK(std::is_sorted(steps.begin(), steps.end()));
    DOCTEST_CHECK(steps.back() == static_cast<int>(Views) - 1);
}

DOCTEST_TEST_CASE("spread: a further server that fails is named once, and the first draws all") {
    Pair pair;
    pair.second_fails();
    Warnings warnings;
    const auto drawing = drawing_of(Agreement::None);
    check_equal(pair.edit(drawing), drawn_by_one(drawing));
    DOCTEST_CHECK(pair.first.orders.size() == Views);
    pair.edit(drawing, {}, 1);
    DOCTEST_CHECK(pair.first.orders.size() == 2 * Views);  // the other one is not asked again
    DOCTEST_REQUIRE(warnings.lines.size() == 1);
    DOCTEST_CHECK(warnings.lines[0] == "host2:7860 is left out: nobody answers");
}

DOCTEST_TEST_CASE("spread: a failure of the first server ends the round, and what came is kept") {
    Pair pair;
    std::latch failed{1};
    pair.first.draws = [&](const RedrawOrder& order, std::size_t call) {
        if (call == 0) pair.both.arrive_and_wait();
        if (call == 0) return Pair::drawn(pair.first, order);
        failed.count_down();
        throw Error(ErrorCode::Foreign, "nobody answers");
    };
    pair.second.draws = [&](const RedrawOrder& order, std::size_t call) {
        call == 0 ? pair.both.arrive_and_wait() : failed.wait();
        return Pair::drawn(pair.second, order);
    };
    DOCTEST_CHECK_THROWS_WITH_AS(pair.edit(drawing_of(Agreement::None)), "nobody answers", Error);
    DOCTEST_CHECK(pair.first.orders.size() == 2);
    DOCTEST_CHECK(pair.source.use().requests == 1 + pair.second.orders.size());
    DOCTEST_CHECK(pair.answers.answers.size() == pair.source.use().requests);
}

/// Server that draws until it is told to stop.
class EndlessServer final : public ImageServer {
public:
    explicit EndlessServer(std::latch& begun) : begun_(begun) {}
    ServerFacts probe(const JobControl&) override { return {}; }
    RedrawnPicture redraw(const RedrawOrder&, const JobControl& job) override {
        begun_.count_down();
        while (!job.stop_requested()) std::this_thread::yield();
        stopped = true;
        throw Error(ErrorCode::Cancelled, "stopped");
    }
    std::atomic<bool> stopped = false;

private:
    std::latch& begun_;
};

DOCTEST_TEST_CASE("spread: a stop ends both servers, and neither is left out") {
    std::latch begun{2};
    EndlessServer first(begun), second(begun);
    PictureSource source(first, {}, "", nullptr);
    source.spread_over({{&second, "host2:7860"}});
    std::stop_source stop;
    const std::jthread artist([&] {
        begun.wait();
        stop.request_stop();
    });
    Warnings warnings;
    try {
        RemoteViewEditor(source, drawing_of(Agreement::None))
            .edit(views_of_wall(Views), request_of(), {{}, stop.get_token()});
        DOCTEST_FAIL("it was not stopped");
    } catch (const Error& error) { DOCTEST_CHECK(error.code() == ErrorCode::Cancelled); }
    DOCTEST_CHECK(first.stopped);
    DOCTEST_CHECK(second.stopped);
    DOCTEST_CHECK(source.is_spread());
    DOCTEST_CHECK(warnings.lines.empty());
}

DOCTEST_TEST_CASE("spread: an exception of who is told of the progress ends the servers") {
    std::latch begun{2};
    FakeServer first;
    EndlessServer second(begun);
    first.draws = [&](const RedrawOrder& order, std::size_t) {
        begun.arrive_and_wait();  // the other one is at work
        return order.picture;
    };
    const RedrawOrder order{.picture = waves(64), .prompt = "a golden wall"};
    const SpreadNews news{[](std::size_t) { throw Error(ErrorCode::Cancelled, "told enough"); }};
    DOCTEST_CHECK_THROWS_WITH_AS(draw_spread({&first, &second}, {order, order}, news, {}), "told enough",
                                 Error);
    DOCTEST_CHECK(second.stopped);
}

DOCTEST_TEST_CASE("spread: servers of two kinds or with two models do not draw together") {
    const std::string one = "host1:7860", two = "host2:8188";
    const ServerFacts first{.kind = ServerKind::Webui, .model = "sd-v1-5"};
    auto other = first;
    check_alike({one, first}, {two, other});
    other.model = "";  // not told
    check_alike({one, first}, {two, other});
    other.model = "sdxl";
    DOCTEST_CHECK_THROWS_WITH_AS(
        check_alike({one, first}, {two, other}),
        doctest::Contains("host2:8188 draws with another model (\"sdxl\") than host1:7860 (\"sd-v1-5\")"),
        Error);
    other.kind = ServerKind::Comfy;
    DOCTEST_CHECK_THROWS_WITH_AS(
        check_alike({one, first}, {two, other}),
        doctest::Contains("host2:8188 is a server of another kind (comfy) than host1:7860 (webui)"), Error);
}

DOCTEST_TEST_CASE("spread: a server that turns out to draw with another model is left out") {
    Pair pair;
    pair.first.model = "one", pair.second.model = "two";
    Warnings warnings;
    const auto drawing = drawing_of(Agreement::None);
    check_equal(pair.edit(drawing), drawn_by_one(drawing));
    DOCTEST_CHECK(pair.first.orders.size() == Views);
    DOCTEST_CHECK(pair.source.model_changes() == 0);
    DOCTEST_REQUIRE(warnings.lines.size() == 1);
    DOCTEST_CHECK(warnings.lines[0] == "host2:7860 draws with \"two\", not with \"one\", and is left out");
}

DOCTEST_TEST_CASE("spread: pictures too large for the first server are drawn at 3/4 of the side") {
    Pair pair;
    for (auto* server : {&pair.first, &pair.second})
        server->draws = [&, server](const RedrawOrder& order, std::size_t) {
            if (order.picture.width > 64)
                throw Error(ErrorCode::Foreign, "it ran out of memory", TooLargeHint);
            return Pair::drawn(*server, order);
        };
    const Warnings warnings;
    const auto edited = pair.edit(drawing_of(Agreement::None));
    DOCTEST_CHECK(pair.source.use().smaller_side == 64);
    DOCTEST_CHECK(std::count(edited.rejected.begin(), edited.rejected.end(), 1) == 0);
}

DOCTEST_TEST_CASE("spread: previews of the first server are seen, on the thread that waits") {
    Pair pair;
    pair.first.previews = pair.second.previews = 2;
    std::vector<DrawingNews> news;
    const auto waits = std::this_thread::get_id();
    pair.source.watch([&](const DrawingNews& one) {
        DOCTEST_CHECK(std::this_thread::get_id() == waits);
        news.push_back(one);
    });
    pair.edit(drawing_of(Agreement::None));
    DOCTEST_REQUIRE(!news.empty());
    const auto previews =
        std::count_if(news.begin(), news.end(), [](const auto& one) { return one.preview != nullptr; });
    DOCTEST_CHECK(previews == 2 * static_cast<std::ptrdiff_t>(pair.first.orders.size()));
    DOCTEST_CHECK(news.back().sent == nullptr);
    DOCTEST_CHECK(news.back().use.requests == Views);
}

DOCTEST_TEST_CASE("spread: both pictures of a view that is searched by differences") {
    const auto picture = waves(Side);
    const edit::AttentionQuery query{.image = picture, .prompt = "a wall", .words = {"wall"}, .seed = 17};
    const auto drawing = drawing_of(Agreement::None, "kontext");
    const auto found = [&](PictureSource& source) {
        return DifferenceSource(source, {drawing, "a wall", "wall"}, {}).locate(query);
    };
    const auto half_golden = [](const FakeServer& server, const RedrawOrder& order) {
        auto left = as_image(disc(Side, 30));
        return gse::test::where(left, gse::test::in_colour(order.picture, server.colour), order.picture);
    };
    FakeServer alone;
    alone.draws = [&](const RedrawOrder& order, std::size_t) { return half_golden(alone, order); };
    PictureSource one(alone, alone.facts, "", nullptr);
    Pair pair;
    for (auto* server : {&pair.first, &pair.second})
        server->draws = [&, server](const RedrawOrder& order, std::size_t) {
            pair.both.arrive_and_wait();
            return half_golden(*server, order);
        };
    const auto maps = found(pair.source), same = found(one);
    DOCTEST_CHECK(pair.first.orders.size() == 1);
    DOCTEST_CHECK(pair.second.orders.size() == 1);
    DOCTEST_REQUIRE(maps.size() == 1);
    DOCTEST_CHECK(maps[0].data == same[0].data);
    DOCTEST_CHECK(*std::max_element(maps[0].data.begin(), maps[0].data.end()) > 0.5f);
}

}  // namespace
}  // namespace spread_test
