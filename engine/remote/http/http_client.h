// HTTP/1.1 client on libcurl: one thread drives all exchanges of a client; callers wait and can be stopped.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <stop_token>

#include "engine/remote/http/http_types.h"

namespace gse::remote {

struct NextRequest;

/// Request that follows from a result nobody waits for any more; null = nothing follows.
using FollowUp = std::function<std::unique_ptr<NextRequest>(const HttpResult&)>;

struct NextRequest {
    HttpRequest request;
    FollowUp then = {};
};

class HttpTransfer;

/// One exchange under way. Destroying it gives the exchange up.
class HttpExchange {
public:
    explicit HttpExchange(std::shared_ptr<HttpTransfer> transfer);
    ~HttpExchange();
    HttpExchange(HttpExchange&&) noexcept;
    HttpExchange& operator=(HttpExchange&&) = delete;

    /// Waits until the exchange has ended, but not longer than `most`. Returns true when it has ended.
    /// Throws Error (Cancelled) within 100 ms of a stop request, and gives the exchange up then.
    bool wait(const std::stop_token& stop, Milliseconds most);
    /// The result of an exchange that has ended.
    HttpResult take();

private:
    std::shared_ptr<HttpTransfer> transfer_;
};

/// Client that follows no redirects, asks for no compression and keeps no cookies. Safe to call from several
/// threads. Exchanges that nobody waits for get 1 s to end when the client is destroyed.
class HttpClient {
public:
    /// `ca_file` holds certificates to trust; empty = the system's.
    explicit HttpClient(std::filesystem::path ca_file = {});
    ~HttpClient();
    HttpClient(const HttpClient&) = delete;
    HttpClient& operator=(const HttpClient&) = delete;

    /// Begins an exchange. One that is given up after its request was sent goes on for at most 10 s if
    /// `after_stop` is set, which then says what to send next.
    HttpExchange start(HttpRequest request, FollowUp after_stop = {});
    /// Sends and waits. Throws Error (Cancelled) as HttpExchange::wait().
    HttpResult send(HttpRequest request, const std::stop_token& stop, FollowUp after_stop = {});
    /// Sends without waiting; `then` says what to send next.
    void send_later(HttpRequest request, FollowUp then = {});

private:
    class Driver;
    std::shared_ptr<Driver> driver_;
};

/// Waits. Throws Error (Cancelled) within 100 ms of a stop request.
void wait_stoppable(const std::stop_token& stop, Milliseconds time);

}  // namespace gse::remote
