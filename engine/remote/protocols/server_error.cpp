// Sentences about servers. Their own words are foreign text.
#include "engine/remote/protocols/server_error.h"

#include <algorithm>
#include <cctype>

#include <fmt/format.h>

#include "engine/base/json.h"
#include "engine/base/printable.h"
#include "engine/remote/api/image_server.h"

namespace gse::remote {
namespace {

constexpr std::size_t MostWordBytes = 300;
constexpr int DeepestWords = 4;
constexpr std::size_t MostNamed = 8;

std::string lower_case(std::string_view text) {
    std::string lower(text);
    for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return lower;
}

std::string page_title(const std::string& html) {
    const auto lower = lower_case(html);
    const auto begin = lower.find("<title");
    if (begin == std::string::npos) return {};
    const auto open = lower.find('>', begin), end = lower.find("</title", begin);
    if (open == std::string::npos || end == std::string::npos || end < open) return {};
    return html.substr(open + 1, end - open - 1);
}

bool is_page(const std::string& body) {
    const auto start = lower_case(std::string_view(body).substr(0, 256));
    return start.find("<html") != std::string::npos || start.find("<!doctype html") != std::string::npos;
}

void add_words(std::string& all, const std::string& more) {
    if (more.empty() || all.find(more) != std::string::npos) return;
    if (!all.empty()) all += ": ";
    all += more;
}

/// Place of a wrong field in FastAPI's lists: ["body", "width"] is "body.width".
std::string place_of(const nlohmann::json& item) {
    const auto loc = item.find("loc");
    std::string place;
    if (loc == item.end() || !loc->is_array()) return place;
    for (const auto& part : *loc)
        if (part.is_string()) place += (place.empty() ? "" : ".") + part.get<std::string>();
    return place;
}

std::string words_in(const nlohmann::json& json, int depth) {
    if (json.is_string()) return json.get<std::string>();
    std::string all;
    if (depth == 0) return all;
    if (json.is_array()) {
        for (const auto& item : json) {
            if (item.is_object()) add_words(all, place_of(item));
            add_words(all, words_in(item, depth - 1));
            if (all.size() > MostWordBytes) break;
        }
        return all;
    }
    if (!json.is_object()) return all;
    for (const char* name : {"error", "detail", "message", "msg", "errors", "details", "exception_message"}) {
        const auto found = json.find(name);
        if (found != json.end()) add_words(all, words_in(*found, depth - 1));
    }
    return all;
}

std::string raw_words(const HttpAnswer& answer) {
    if (is_page(answer.body)) return page_title(answer.body);
    const auto json = try_parse_json(answer.body);
    if (!json.is_discarded()) return words_in(json, DeepestWords);
    return answer.body;
}

std::string said(const std::string& words) { return words.empty() ? "" : fmt::format(": \"{}\"", words); }

/// The address without its query, which may hold secrets.
std::string place_to_show(const std::string& address) {
    std::string place = address.substr(0, address.find_first_of("?#"));
    const auto scheme = place.find("://");
    const auto user = place.find('@');
    if (scheme != std::string::npos && user != std::string::npos) place.erase(scheme + 3, user - scheme - 2);
    return shown(place);
}

Error redirect_error(const HttpAnswer& answer, const ServerUrl& url) {
    const auto target = place_to_show(answer.header("location"));
    if (target.empty())
        return {ErrorCode::Foreign, fmt::format("{} sends us on to nowhere", url.nickname()),
                "look at the server's address"};
    return {ErrorCode::Foreign, fmt::format("{} sends us on to {}", url.nickname(), target),
            "enter that address if you trust it"};
}

Error password_error(const HttpAnswer& answer, const ServerUrl& url, bool with_secret) {
    const auto realm = answer.header("www-authenticate");
    const auto asks = realm.empty() ? std::string() : fmt::format(" ({})", shown(realm));
    if (with_secret)
        return {ErrorCode::InvalidArgument, fmt::format("{} refuses the password{}", url.nickname(), asks),
                "correct it in servers.json or in GSEDITPRO_SERVER_TOKEN"};
    return {ErrorCode::InvalidArgument, fmt::format("{} wants a password{}", url.nickname(), asks),
            "write it into the address once (http://name:password@host), or set GSEDITPRO_SERVER_TOKEN"};
}

}  // namespace

std::string shown(std::string_view text) {
    std::string plain;
    for (const char c : text.substr(0, 4 * MostWordBytes))  // blanks and line ends become one space
        if (!std::isspace(static_cast<unsigned char>(c))) plain += c;
        else if (!plain.empty() && plain.back() != ' ') plain += ' ';
    plain = printable(plain);
    if (plain.size() <= MostWordBytes) return plain;
    std::size_t end = MostWordBytes - 3;
    while (end > 0 && (static_cast<unsigned char>(plain[end]) & 0xc0) == 0x80) --end;
    return plain.substr(0, end) + "...";
}

std::string listed(const std::vector<std::string>& names) {
    std::string list;
    for (std::size_t i = 0; i < std::min(names.size(), MostNamed); ++i)
        list += (i > 0 ? ", " : "") + names[i];
    return shown(list + (names.size() > MostNamed ? ", ..." : ""));
}

std::string server_words(const HttpAnswer& answer) { return shown(raw_words(answer)); }

bool ran_out_of_memory(const HttpAnswer& answer) {
    const auto words = lower_case(raw_words(answer));
    return words.find("out of memory") != std::string::npos || words.find("outofmemory") != std::string::npos;
}

Error status_error(const HttpAnswer& answer, const ServerUrl& url, bool with_secret) {
    const auto name = url.nickname();
    const auto words = said(server_words(answer));
    const int status = answer.status;
    if (status >= 300 && status < 400) return redirect_error(answer, url);
    if (status == 401 || status == 403) return password_error(answer, url, with_secret);
    if (status == 404)
        return {ErrorCode::Foreign, fmt::format("{} does not know this request (404){}", name, words),
                "is this its address? A1111 and Forge must be started with --api"};
    if (status == 413)
        return {ErrorCode::Foreign, fmt::format("{} finds the picture too large", name), TooLargeHint};
    if (status == 429 || status == 503)
        return {ErrorCode::Foreign, fmt::format("{} stays busy ({}){}", name, status, words),
                "try again later"};
    if (status >= 500 && ran_out_of_memory(answer))
        return {ErrorCode::Foreign, fmt::format("{} ran out of memory", name), TooLargeHint};
    if (status >= 500)
        return {ErrorCode::Foreign, fmt::format("{} failed ({}){}", name, status, words),
                "the server's own messages say more"};
    return {ErrorCode::InvalidArgument, fmt::format("{} refuses the request ({}){}", name, status, words),
            "change what it complains about"};
}

Error network_error(const HttpResult& result, const ServerUrl& url) {
    const auto name = url.nickname();
    const auto detail = shown(result.detail);
    switch (result.failure) {
        case HttpFailure::NoHost:
            return {ErrorCode::Foreign, fmt::format("there is no host named {}", url.host),
                    "look at the address"};
        case HttpFailure::NoListener:
            return {ErrorCode::Foreign, fmt::format("nobody answers at {}", name),
                    "is the server running? A1111 and Forge must be started with --api"};
        case HttpFailure::Tls:
            return {ErrorCode::Foreign, fmt::format("no safe connection to {} ({})", name, detail),
                    "check https or http, or name the server's certificate (--server-ca)"};
        case HttpFailure::Lost:
            return {ErrorCode::Foreign,
                    fmt::format("{} closed the connection before its answer was whole", name),
                    "look whether the server still runs, then ask again"};
        case HttpFailure::Silent:
            return {ErrorCode::Foreign, fmt::format("{} says nothing any more", name),
                    "look whether the server still runs, then ask again"};
        case HttpFailure::Slow:
            return {ErrorCode::Foreign, fmt::format("{} answers too slowly", name), "look at the network"};
        case HttpFailure::TooLarge:
            return {ErrorCode::Foreign, fmt::format("{} answers with more than a picture can need", name),
                    "is this the address of an image server?"};
        case HttpFailure::Encoded:
            return {ErrorCode::Foreign,
                    fmt::format("{} compresses its answer though nobody asked for it", name),
                    "switch compression off at the server or proxy"};
        case HttpFailure::BadRequest:
            return {ErrorCode::InvalidArgument, fmt::format("nothing can be sent to {}", name),
                    "look at the address, and at the password for characters that no header holds"};
        default:
            return {ErrorCode::Foreign, fmt::format("{} does not speak HTTP ({})", name, detail),
                    "look at the address and its port"};
    }
}

Error answer_error(const ServerUrl& url, const std::string& what) {
    return {ErrorCode::Foreign, fmt::format("{} answers {}", url.nickname(), what),
            "is this its address, and its protocol?"};
}

void check_only_model(const ServerUrl& url, const std::string& wanted, const std::string& only) {
    if (wanted.empty() || wanted == only) return;
    throw Error(ErrorCode::InvalidArgument,
                fmt::format("{} draws with {} alone, not with {}", url.nickname(),
                            only.empty() ? "one model" : only, shown(wanted)),
                "start it with that model, or name none");
}

Error work_error(const ServerUrl& url, std::string_view words) {
    const auto lower = lower_case(words);
    if (lower.find("out of memory") != std::string::npos)
        return {ErrorCode::Foreign, fmt::format("{} ran out of memory", url.nickname()), TooLargeHint};
    return {ErrorCode::Foreign, fmt::format("{} failed to draw{}", url.nickname(), said(shown(words))),
            "the server's own messages say more"};
}

}  // namespace gse::remote
