// Decisions about asking again.
#include <doctest/doctest.h>

#include "engine/remote/http/retry.h"

namespace gse::remote {
namespace {

HttpResult failed(HttpFailure failure, bool connected) {
    HttpResult result;
    result.failure = failure;
    result.connected = connected;
    return result;
}

HttpResult answered(int status, const std::string& retry_after = {}) {
    HttpResult result;
    result.connected = result.answered = true;
    result.answer.status = status;
    if (!retry_after.empty()) result.answer.headers = {{"retry-after", retry_after}};
    return result;
}

std::optional<Milliseconds> wait(const HttpResult& result, Repeat repeat, RetryState state = {}) {
    return wait_before_retry(result, repeat, state, {}, 0);
}

DOCTEST_TEST_CASE("work that may have begun is not asked for twice") {
    for (const auto failure : {HttpFailure::Lost, HttpFailure::Silent}) {
        DOCTEST_CHECK(!wait(failed(failure, true), Repeat::UnlessStarted));
        DOCTEST_CHECK(wait(failed(failure, true), Repeat::Always));
        DOCTEST_CHECK(wait(failed(failure, false), Repeat::UnlessStarted));
    }
    DOCTEST_CHECK(wait(failed(HttpFailure::NoListener, false), Repeat::UnlessStarted));
}

DOCTEST_TEST_CASE("what cannot get better is not asked again") {
    for (const auto failure :
         {HttpFailure::NoHost, HttpFailure::Tls, HttpFailure::TooLarge, HttpFailure::Encoded,
          HttpFailure::NotHttp, HttpFailure::BadRequest, HttpFailure::Slow})
        DOCTEST_CHECK(!wait(failed(failure, false), Repeat::Always));
    for (const int status : {200, 302, 400, 401, 403, 404, 413, 422, 500, 502})
        DOCTEST_CHECK(!wait(answered(status), Repeat::Always));
}

DOCTEST_TEST_CASE("waiting times double up to a limit, and end") {
    const auto gone = failed(HttpFailure::NoListener, false);
    DOCTEST_CHECK(wait(gone, Repeat::Always, {1, {}}) == Milliseconds(1000));
    DOCTEST_CHECK(wait(gone, Repeat::Always, {3, {}}) == Milliseconds(4000));
    DOCTEST_CHECK(!wait(gone, Repeat::Always, {5, {}}));
    DOCTEST_CHECK(!wait(gone, Repeat::Always, {2, Milliseconds(59'000)}));
    const auto busy = answered(503);
    DOCTEST_CHECK(wait(busy, Repeat::UnlessStarted, {9, {}}) == Milliseconds(16'000));
    DOCTEST_CHECK(wait(busy, Repeat::UnlessStarted, {9, Milliseconds(280'000)}));
    DOCTEST_CHECK(!wait(busy, Repeat::UnlessStarted, {9, Milliseconds(290'000)}));
    DOCTEST_CHECK(wait_before_retry(busy, Repeat::Always, {1, {}}, {}, 1) == Milliseconds(1200));
}

DOCTEST_TEST_CASE("a server's own waiting time is kept, but not for ever") {
    DOCTEST_CHECK(wait(answered(429, "7"), Repeat::Always) == Milliseconds(7000));
    DOCTEST_CHECK(wait(answered(429, "0"), Repeat::Always) == Milliseconds(1000));
    DOCTEST_CHECK(wait(answered(429, "99999999"), Repeat::Always) == Milliseconds(60'000));
    DOCTEST_CHECK(wait(answered(429, "99999999999999999999999"), Repeat::Always) == Milliseconds(60'000));
    DOCTEST_CHECK(!retry_after(answered(429, "Wed, 21 Oct 2026 07:28:00 GMT").answer));
    DOCTEST_CHECK(!retry_after(answered(429, "-5").answer));
}

}  // namespace
}  // namespace gse::remote
