// Requests to one server: its address, password, limits and retries in one place.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "engine/base/progress.h"
#include "engine/remote/api/remote_api.h"
#include "engine/remote/http/credentials.h"
#include "engine/remote/http/http_client.h"
#include "engine/remote/http/retry.h"

namespace gse::remote {

/// Demands of one request.
struct Ask {
    Repeat repeat = Repeat::Always;
    bool draws = false;                             // the answer comes when the picture is drawn
    bool looks = false;                             // it is not known yet what the server speaks
    std::size_t most_bytes = std::size_t{1} << 20;  // of the answer
    std::function<void()> meanwhile = {};           // called every second while waiting
    FollowUp after_stop = {};                       // see HttpClient::start()
};

/// Maker of requests to one server, with its address and password. A value.
class RequestMaker {
public:
    RequestMaker(ServerUrl url, std::optional<Credential> credential, const ServerTimes& times);

    HttpRequest get(const std::string& place) const;
    HttpRequest post(const std::string& place, const nlohmann::json& body) const;
    HttpRequest post_parts(const std::string& place, std::vector<HttpPart> parts) const;
    HttpRequest with_limits(HttpRequest request, const Ask& how) const;

    const ServerUrl& url() const { return url_; }
    const ServerTimes& times() const { return times_; }
    bool has_secret() const { return credential_.has_value(); }

private:
    ServerUrl url_;
    std::optional<Credential> credential_;
    ServerTimes times_;
};

/// One server. Answers are whole, and their status is 200 to 299: everything else is an Error.
class ServerLink {
public:
    ServerLink(ServerUrl url, std::optional<Credential> credential, const ServerAddress& address);

    const RequestMaker& requests() const { return requests_; }
    const ServerUrl& url() const { return requests_.url(); }
    const ServerTimes& times() const { return requests_.times(); }
    HttpRequest get(const std::string& place) const { return requests_.get(place); }

    /// True where somebody takes a connection. Throws Error (Cancelled) only.
    bool is_listening(const JobControl& job);
    /// Asks, again where wait_before_retry() says so. Throws Error.
    HttpAnswer ask(HttpRequest request, const Ask& how, const JobControl& job);
    nlohmann::json ask_json(HttpRequest request, const Ask& how, const JobControl& job);
    /// Asks, and gives the answer whatever its status is.
    HttpAnswer ask_any_status(HttpRequest request, const Ask& how, const JobControl& job);
    /// JSON of an answer 200; none for another status or another content. Asks once. Throws Error where
    /// nobody answers, for a redirect, and for a password that is wanted.
    std::optional<nlohmann::json> look(const std::string& place, const JobControl& job);
    /// JSON of an answer 200 of at most so many bytes; none for everything else. Asks once; throws Error
    /// (Cancelled) only.
    std::optional<nlohmann::json> try_json(HttpRequest request, const JobControl& job,
                                           std::size_t most_bytes = std::size_t{1} << 20);
    /// Sends without waiting.
    void send_later(HttpRequest request, FollowUp then = {});

    /// JSON of an answer. Throws Error (Foreign).
    nlohmann::json json_of(const HttpAnswer& answer) const;

private:
    HttpResult ask_once(const HttpRequest& request, const Ask& how, const JobControl& job);

    const RequestMaker requests_;
    HttpClient client_;
};

/// Text under a name of an object; empty for everything else.
std::string text_of(const nlohmann::json& json, const char* name);
/// Value under a name; null without one.
const nlohmann::json& value_of(const nlohmann::json& json, const char* name);
/// Finite number in [low, high] under a name; `otherwise` for everything else.
double number_of(const nlohmann::json& json, const char* name, double low, double high, double otherwise);
/// Texts under `name` in the objects of a list (`name` null: the list's own texts); at most 10,000.
std::vector<std::string> texts_of(const nlohmann::json& list, const char* name);

}  // namespace gse::remote
