// Pictures of a server as they are drawn: previews, ends, and what is asked for.
#include <doctest/doctest.h>

#include "engine/base/error.h"
#include "engine/remote/views/picture_source.h"
#include "tests/unit/remote/fake_server.h"

namespace picture_source_test {
namespace {

using namespace gse;
using namespace gse::remote;
using gse::test::FakeServer;

RedrawOrder plain_order(std::uint32_t seed = 5) {
    RedrawOrder order;
    order.picture = Image(64, 64, 3, 0.5f);
    order.prompt = "a golden bear";
    order.seed = seed;
    return order;
}

/// Server with two previews per picture, and all that is told of it.
struct Watched {
    FakeServer server;
    PictureSource source{server, server.facts, "", nullptr};
    std::vector<DrawingNews> news;
    Watched() {
        server.previews = 2;
        source.watch([this](const DrawingNews& one) { news.push_back(one); });
    }
};

DOCTEST_TEST_CASE("source: previews are handed on beside what was sent, and end with the picture") {
    Watched watched;
    const auto order = plain_order();
    watched.source.ask(order, {});
    DOCTEST_REQUIRE(watched.news.size() == 3);
    DOCTEST_CHECK(watched.news[0].sent->data == order.picture.data);
    DOCTEST_CHECK(watched.news[0].preview->width == 8);
    DOCTEST_CHECK(watched.news[1].preview->data[0] == 0.1f);
    DOCTEST_CHECK(watched.news[1].use.requests == 0);
    DOCTEST_CHECK(watched.news[2].sent == nullptr);
    DOCTEST_CHECK(watched.news[2].preview == nullptr);
    DOCTEST_CHECK(watched.news[2].use.requests == 1);
}

DOCTEST_TEST_CASE("source: a drawing that fails takes its preview along") {
    Watched watched;
    watched.server.lost_at = 0;
    DOCTEST_CHECK_THROWS_AS(watched.source.ask(plain_order(), {}), Error);
    DOCTEST_REQUIRE(watched.news.size() == 3);
    DOCTEST_CHECK(watched.news[1].preview != nullptr);
    DOCTEST_CHECK(watched.news[2].preview == nullptr);
    DOCTEST_CHECK(watched.news[2].use.requests == 0);
}

DOCTEST_TEST_CASE("source: nobody who watches, no preview that is asked for") {
    Watched watched;
    watched.source.watch({});
    watched.source.ask(plain_order(), {});
    DOCTEST_CHECK(watched.news.empty());
    DOCTEST_REQUIRE(watched.server.orders.size() == 1);
    DOCTEST_CHECK_FALSE(static_cast<bool>(watched.server.orders[0].preview));
}

}  // namespace
}  // namespace picture_source_test
