// State of one exchange, shared between the caller that waits and the thread that drives it.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>

#include "engine/remote/http/http_client.h"

namespace gse::remote {

/// One exchange. The driving thread alone touches what the callbacks fill; `result` is handed over under
/// the lock.
class HttpTransfer {
public:
    using Clock = std::chrono::steady_clock;

    /// Nobody waits for one in the `background`.
    HttpTransfer(HttpRequest asked, FollowUp next, bool in_background, std::function<void()> wake_driver);

    const HttpRequest request;
    const FollowUp follow_up;
    const bool background;

    // Called by those who wait.
    bool wait(const std::stop_token& stop, Milliseconds most);
    HttpResult take();
    void give_up();

    // Called by the driving thread.
    void finish(HttpResult result);
    /// True when nobody waits for the result, but something may follow from it.
    bool followed() const { return follow_up && (background || given_up_); }
    /// True when the exchange shall end now: nobody waits, and nothing follows from its result.
    bool unwanted(Clock::time_point now) const;

    /// Takes one header line. False ends the transfer.
    bool take_header(std::string_view line);
    bool take_body(std::string_view bytes);
    void take_upload(std::int64_t bytes, std::int64_t total);
    /// The limit of time that was passed, if any. `connected` = a connection stands.
    HttpFailure overdue(Clock::time_point now, bool connected);

    HttpAnswer answer = {};
    HttpFailure failure = HttpFailure::None;  // found by a callback
    std::string detail = {};
    bool answered = false;

private:
    bool fail(HttpFailure why, std::string words);
    void touch() { last_byte_ = Clock::now(); }

    const std::function<void()> wake_driver_;
    std::mutex mutex_;
    std::condition_variable_any changed_;
    std::optional<HttpResult> result_;
    std::atomic<bool> given_up_ = false;
    std::atomic<Clock::rep> given_up_at_ = 0;  // or begun, in the background

    std::size_t header_bytes_ = 0, header_lines_ = 0;
    std::int64_t uploaded_ = 0;
    bool sent_ = false, body_begun_ = false;
    Clock::time_point last_byte_ = Clock::now(), body_began_ = {};
};

}  // namespace gse::remote
