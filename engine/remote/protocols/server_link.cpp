// Requests to one server.
#include "engine/remote/protocols/server_link.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "engine/base/json.h"
#include "engine/remote/protocols/server_error.h"

namespace gse::remote {
namespace {

constexpr Milliseconds BetweenReports{1'000};
constexpr std::size_t MostTexts = 10'000;

double chance() {
    static thread_local std::minstd_rand random{std::random_device{}()};
    return std::uniform_real_distribution<double>(0, 1)(random);
}

bool is_success(int status) { return status >= 200 && status < 300; }

}  // namespace

RequestMaker::RequestMaker(ServerUrl url, std::optional<Credential> credential, const ServerTimes& times)
    : url_(std::move(url)), credential_(std::move(credential)), times_(times) {}

HttpRequest RequestMaker::get(const std::string& place) const {
    HttpRequest request;
    request.url = url_.at(place);
    request.direct = is_private(url_.host);
    request.headers = {{"Accept", "application/json, */*;q=0.5"}, {"User-Agent", "gseditpro"}};
    if (credential_) request.headers.emplace_back("Authorization", credential_->header());
    return with_limits(std::move(request), {});
}

HttpRequest RequestMaker::post(const std::string& place, const nlohmann::json& body) const {
    HttpRequest request = get(place);
    request.method = "POST";
    request.headers.emplace_back("Content-Type", "application/json");
    request.body = json_text(body);
    return request;
}

HttpRequest RequestMaker::post_parts(const std::string& place, std::vector<HttpPart> parts) const {
    HttpRequest request = get(place);
    request.method = "POST";
    request.parts = std::move(parts);
    return request;
}

HttpRequest RequestMaker::with_limits(HttpRequest request, const Ask& how) const {
    request.repeatable = how.repeat == Repeat::Always;
    request.limits.body_bytes = how.most_bytes;
    request.limits.connect = times_.connect;
    request.limits.first_byte = how.draws ? times_.drawing : how.looks ? times_.look : times_.answer;
    request.limits.silence = times_.silence;
    request.limits.body = times_.body;
    return request;
}

ServerLink::ServerLink(ServerUrl url, std::optional<Credential> credential, const ServerAddress& address)
    : requests_(std::move(url), std::move(credential), address.times), client_(address.ca_file) {}

HttpResult ServerLink::ask_once(const HttpRequest& request, const Ask& how, const JobControl& job) {
    auto exchange = client_.start(requests_.with_limits(request, how), how.after_stop);
    while (!exchange.wait(job.stop, BetweenReports))
        if (how.meanwhile) how.meanwhile();
    return exchange.take();
}

bool ServerLink::is_listening(const JobControl& job) {
    Ask how;
    how.looks = true;
    return ask_once(get("/"), how, job).connected;
}

HttpAnswer ServerLink::ask_any_status(HttpRequest request, const Ask& how, const JobControl& job) {
    const auto begin = std::chrono::steady_clock::now();
    RetryState state;
    while (true) {
        auto result = ask_once(request, how, job);
        state.waited = std::chrono::duration_cast<Milliseconds>(std::chrono::steady_clock::now() - begin);
        const auto wait = wait_before_retry(result, how.repeat, state, times(), chance());
        if (!wait) {
            if (!result.ok()) throw network_error(result, url());
            return std::move(result.answer);
        }
        job.report(result.ok() ? "the server is busy" : "waiting for the server", 0, 0);
        wait_stoppable(job.stop, *wait);
        ++state.attempts;
    }
}

HttpAnswer ServerLink::ask(HttpRequest request, const Ask& how, const JobControl& job) {
    auto answer = ask_any_status(std::move(request), how, job);
    if (!is_success(answer.status)) throw status_error(answer, url(), requests_.has_secret());
    return answer;
}

nlohmann::json ServerLink::json_of(const HttpAnswer& answer) const {
    auto json = try_parse_json(answer.body);
    if (!json.is_discarded()) return json;
    const auto words = server_words(answer);
    const auto start = shown(answer.body.substr(0, 64));
    if (answer.body.find("<html") != std::string::npos || answer.body.find("<!DOCTYPE") != std::string::npos)
        throw answer_error(url(), "with a web page" + (words.empty() ? "" : " (\"" + words + "\")"));
    throw answer_error(url(), "with something that is not JSON" +
                                  (start.empty() ? std::string(" (nothing)") : std::string()));
}

nlohmann::json ServerLink::ask_json(HttpRequest request, const Ask& how, const JobControl& job) {
    return json_of(ask(std::move(request), how, job));
}

std::optional<nlohmann::json> ServerLink::look(const std::string& place, const JobControl& job) {
    Ask how;
    how.looks = true;
    const auto result = ask_once(get(place), how, job);
    if (!result.ok()) throw network_error(result, url());
    const int status = result.answer.status;
    if ((status >= 300 && status < 400) || status == 401 || status == 403)
        throw status_error(result.answer, url(), requests_.has_secret());
    auto json = try_parse_json(result.answer.body);
    if (status != 200 || json.is_discarded()) return std::nullopt;
    return json;
}

std::optional<nlohmann::json> ServerLink::try_json(HttpRequest request, const JobControl& job,
                                                   std::size_t most_bytes) {
    Ask how;
    how.most_bytes = most_bytes;
    const auto result = ask_once(request, how, job);
    if (!result.ok() || result.answer.status != 200) return std::nullopt;
    auto json = try_parse_json(result.answer.body);
    if (json.is_discarded()) return std::nullopt;
    return json;
}

void ServerLink::send_later(HttpRequest request, FollowUp then) {
    client_.send_later(std::move(request), std::move(then));
}

const nlohmann::json& value_of(const nlohmann::json& json, const char* name) {
    static const nlohmann::json nothing;
    if (!json.is_object()) return nothing;
    const auto found = json.find(name);
    return found == json.end() ? nothing : *found;
}

std::string text_of(const nlohmann::json& json, const char* name) {
    const auto& value = value_of(json, name);
    return value.is_string() ? value.get<std::string>() : std::string();
}

double number_of(const nlohmann::json& json, const char* name, double low, double high, double otherwise) {
    const auto& value = value_of(json, name);
    if (!value.is_number()) return otherwise;
    const double number = value.get<double>();
    return std::isfinite(number) ? std::clamp(number, low, high) : otherwise;
}

std::vector<std::string> texts_of(const nlohmann::json& list, const char* name) {
    std::vector<std::string> texts;
    if (!list.is_array()) return texts;
    for (const auto& item : list) {
        const auto text = name != nullptr    ? text_of(item, name)
                          : item.is_string() ? item.get<std::string>()
                                             : std::string();
        if (!text.empty() && texts.size() < MostTexts) texts.push_back(text);
    }
    return texts;
}

}  // namespace gse::remote
