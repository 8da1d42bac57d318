// Addresses of image servers. Hosts that are numbers in unusual writing are refused, since libraries read
// them differently.
#include "engine/remote/api/server_url.h"

#include <arpa/inet.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <optional>

#include <fmt/format.h>

#include "engine/base/error.h"
#include "engine/base/printable.h"

namespace gse::remote {
namespace {

constexpr std::size_t LongestUrl = 2048;
constexpr const char* UrlExample = "write it as http://192.168.1.20:7860";

Error bad_url(const std::string& why) { return Error(ErrorCode::InvalidArgument, why, UrlExample); }

std::string in_small_letters(std::string_view text) {
    std::string small(text);
    for (char& c : small) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return small;
}

std::optional<std::array<std::uint8_t, 4>> ipv4_of(std::string_view host) {
    std::array<std::uint8_t, 4> bytes{};
    if (inet_pton(AF_INET, std::string(host).c_str(), bytes.data()) != 1) return std::nullopt;
    return bytes;
}

std::optional<std::array<std::uint8_t, 16>> ipv6_of(std::string_view host) {
    std::array<std::uint8_t, 16> bytes{};
    if (inet_pton(AF_INET6, std::string(host).c_str(), bytes.data()) != 1) return std::nullopt;
    return bytes;
}

/// An IPv4 address inside an IPv6 one (::ffff:a.b.c.d).
std::optional<std::array<std::uint8_t, 4>> mapped_ipv4(const std::array<std::uint8_t, 16>& bytes) {
    static constexpr std::array<std::uint8_t, 12> prefix{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff};
    if (!std::equal(prefix.begin(), prefix.end(), bytes.begin())) return std::nullopt;
    return std::array<std::uint8_t, 4>{bytes[12], bytes[13], bytes[14], bytes[15]};
}

int hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

std::string percent_decoded(std::string_view text) {
    std::string plain;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const bool escape = text[i] == '%' && i + 2 < text.size() && hex_digit(text[i + 1]) >= 0 &&
                            hex_digit(text[i + 2]) >= 0;
        if (escape) {
            plain += static_cast<char>(hex_digit(text[i + 1]) * 16 + hex_digit(text[i + 2]));
            i += 2;
        } else plain += text[i];
    }
    return plain;
}

std::string take_scheme(std::string_view& rest) {
    const auto mark = rest.find("://");
    if (mark == std::string_view::npos) return "http";
    const std::string scheme = in_small_letters(rest.substr(0, mark));
    if (scheme != "http" && scheme != "https")
        throw bad_url(fmt::format("servers are asked over http or https, not \"{}\"", printable(scheme)));
    rest.remove_prefix(mark + 3);
    return scheme;
}

UrlUser take_user(std::string_view& authority) {
    const auto mark = authority.rfind('@');
    if (mark == std::string_view::npos) return {};
    const auto user = authority.substr(0, mark);
    authority.remove_prefix(mark + 1);
    const auto colon = user.find(':');
    if (colon == std::string_view::npos) return {percent_decoded(user), {}};
    return {percent_decoded(user.substr(0, colon)), percent_decoded(user.substr(colon + 1))};
}

int port_of(std::string_view text) {
    int port = 0;
    const auto end = text.data() + text.size();
    const auto [stop, failure] = std::from_chars(text.data(), end, port);
    if (failure != std::errc{} || stop != end || port < 1 || port > 65535)
        throw bad_url(fmt::format("\"{}\" is no port (1 to 65535)", printable(text)));
    return port;
}

void check_name(std::string_view host) {
    if (host.empty()) throw bad_url("the address names no host");
    if (std::any_of(host.begin(), host.end(), [](char c) { return static_cast<unsigned char>(c) > 127; }))
        throw Error(ErrorCode::InvalidArgument, "the host's name has letters outside of ASCII",
                    "write it in its ASCII form (xn--...) or as a number");
    for (const char c : host)
        if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-' && c != '.' && c != '_')
            throw bad_url(fmt::format("\"{}\" is no name of a host", printable(host)));
    const auto last = host.substr(host.rfind('.') + 1);
    const bool number = last.empty() || std::isdigit(static_cast<unsigned char>(last[0]));
    if (number && !ipv4_of(host))
        throw bad_url(fmt::format("\"{}\" is neither a name nor four numbers", printable(host)));
}

/// Host and port of "host:port" or "[::1]:port".
void read_authority(std::string_view authority, ServerUrl& url) {
    std::string_view port;
    if (authority.starts_with('[')) {
        const auto end = authority.find(']');
        if (end == std::string_view::npos || !ipv6_of(authority.substr(1, end - 1)))
            throw bad_url(fmt::format("\"{}\" is no IPv6 address", printable(authority)));
        url.host = in_small_letters(authority.substr(1, end - 1));
        port = authority.substr(end + 1);
        if (!port.empty() && port[0] != ':') throw bad_url("after the host comes a colon and the port");
    } else {
        const auto colon = authority.find(':');
        if (colon != authority.rfind(':')) throw bad_url("an IPv6 address stands in brackets");
        url.host = in_small_letters(authority.substr(0, colon));
        check_name(url.host);
        if (colon != std::string_view::npos) port = authority.substr(colon);
    }
    url.port = port.empty() ? (url.encrypted() ? 443 : 80) : port_of(port.substr(1));
}

std::string checked_path(std::string_view path) {
    while (path.ends_with('/')) path.remove_suffix(1);
    if (path.find("//") != std::string_view::npos || path.find("/.") != std::string_view::npos ||
        path.find('\\') != std::string_view::npos)
        throw bad_url("the path of the address is not plain");
    return std::string(path);
}

}  // namespace

std::string ServerUrl::origin() const { return scheme + "://" + nickname(); }

std::string ServerUrl::at(std::string_view place) const { return origin() + path + std::string(place); }

std::string ServerUrl::nickname() const {
    const bool ipv6 = host.find(':') != std::string::npos;
    return fmt::format("{}{}{}:{}", ipv6 ? "[" : "", host, ipv6 ? "]" : "", port);
}

TypedUrl parse_server_url(std::string_view text) {
    while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
    while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
    if (text.size() > LongestUrl) throw bad_url("the address is longer than 2048 characters");
    for (const char c : text)
        if (static_cast<unsigned char>(c) <= 32 || c == 127)
            throw bad_url("the address holds a space or a control character");
    TypedUrl typed;
    typed.url.scheme = take_scheme(text);
    const auto slash = text.find_first_of("/?#");
    auto authority = text.substr(0, slash);
    const auto path = slash == std::string_view::npos ? std::string_view{} : text.substr(slash);
    typed.user = take_user(authority);
    if (path.find_first_of("?#") != std::string_view::npos)
        throw bad_url("a server's address has no \"?\" and no \"#\"");
    read_authority(authority, typed.url);
    typed.url.path = checked_path(path);
    return typed;
}

bool is_loopback(std::string_view host) {
    if (host == "localhost" || host.ends_with(".localhost")) return true;
    if (const auto v4 = ipv4_of(host)) return (*v4)[0] == 127;
    const auto v6 = ipv6_of(host);
    if (!v6) return false;
    if (const auto v4 = mapped_ipv4(*v6)) return (*v4)[0] == 127;
    static constexpr std::array<std::uint8_t, 16> one{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1};
    return *v6 == one;
}

bool is_private(std::string_view host) {
    if (is_loopback(host) || host.ends_with(".local")) return true;
    auto v4 = ipv4_of(host);
    if (const auto v6 = ipv6_of(host)) {
        if (((*v6)[0] & 0xfe) == 0xfc || ((*v6)[0] == 0xfe && ((*v6)[1] & 0xc0) == 0x80)) return true;
        v4 = mapped_ipv4(*v6);
    }
    if (!v4) return false;
    const auto& b = *v4;
    return b[0] == 10 || (b[0] == 172 && (b[1] & 0xf0) == 16) || (b[0] == 192 && b[1] == 168) ||
           (b[0] == 169 && b[1] == 254);
}

std::string percent_encoded(std::string_view text) {
    std::string encoded;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte < 128 && (std::isalnum(byte) || std::string_view("-_.~").find(c) != std::string_view::npos))
            encoded += c;
        else encoded += fmt::format("%{:02X}", byte);
    }
    return encoded;
}

}  // namespace gse::remote
