// Decisions about asking again: pure functions of what happened.
#pragma once

#include <optional>

#include "engine/remote/api/remote_api.h"
#include "engine/remote/http/http_types.h"

namespace gse::remote {

/// Kind of a request: one that starts drawing must not be sent twice.
enum class Repeat {
    Always,         // a question; answers do not depend on how often it is asked
    UnlessStarted,  // starts work: only where the server has surely not begun
};

/// Attempts so far, and the time since the first of a row of failures.
struct RetryState {
    int attempts = 1;
    Milliseconds waited{0};
};

/// Time to wait before asking again; none = it is of no use, or it could double the work. `chance` in [0,1)
/// spreads the waiting times. A question is given up after 5 failures in a row or ServerTimes::away; one that
/// is refused for being busy (429, 503) after ServerTimes::busy.
std::optional<Milliseconds> wait_before_retry(const HttpResult& result, Repeat repeat,
                                              const RetryState& state, const ServerTimes& times,
                                              double chance);

/// Seconds in a header Retry-After, at most 60; none for a date or for what is no number.
std::optional<Milliseconds> retry_after(const HttpAnswer& answer);

/// True for a network that failed without an answer: nobody there, or gone in the middle.
bool is_gone(const HttpResult& result);

}  // namespace gse::remote
