// Decisions about asking again.
#include "engine/remote/http/retry.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace gse::remote {
namespace {

constexpr int MostFailures = 5;
constexpr double Spread = 0.2;
constexpr long LongestRetryAfter = 60;

Milliseconds doubled(const RetryState& state, const ServerTimes& times, double chance) {
    const double steps = std::min(state.attempts - 1, 20);
    const double wait = std::min(static_cast<double>(times.first_retry.count()) * std::exp2(steps),
                                 static_cast<double>(times.longest_retry.count()));
    return Milliseconds(static_cast<long>(wait * (1 + Spread * chance)));
}

bool says_busy(const HttpResult& result) {
    return result.ok() && (result.answer.status == 429 || result.answer.status == 503);
}

}  // namespace

bool is_gone(const HttpResult& result) {
    switch (result.failure) {
        case HttpFailure::NoListener:
        case HttpFailure::Lost:
        case HttpFailure::Silent: return true;
        default: return false;
    }
}

std::optional<Milliseconds> retry_after(const HttpAnswer& answer) {
    const std::string text = answer.header("retry-after");
    if (text.empty() || text.find_first_not_of("0123456789") != std::string::npos) return std::nullopt;
    long seconds = LongestRetryAfter;
    const auto read = std::from_chars(text.data(), text.data() + text.size(), seconds);
    if (read.ec != std::errc{}) seconds = LongestRetryAfter;  // more than a long holds
    return std::chrono::seconds(std::min(seconds, LongestRetryAfter));
}

std::optional<Milliseconds> wait_before_retry(const HttpResult& result, Repeat repeat,
                                              const RetryState& state, const ServerTimes& times,
                                              double chance) {
    const auto wait = doubled(state, times, chance);
    if (says_busy(result)) {
        const auto asked = std::max(retry_after(result.answer).value_or(wait), times.first_retry);
        return state.waited + asked <= times.busy ? std::optional(asked) : std::nullopt;
    }
    if (!is_gone(result) || state.attempts >= MostFailures || state.waited + wait > times.away)
        return std::nullopt;
    if (repeat == Repeat::UnlessStarted && result.connected) return std::nullopt;
    return wait;
}

}  // namespace gse::remote
