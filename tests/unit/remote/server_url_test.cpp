// Addresses of servers: what is taken, what is refused, and what counts as private.
#include <doctest/doctest.h>

#include "engine/base/error.h"
#include "engine/remote/api/server_url.h"

namespace gse::remote {
namespace {

std::string kept(const char* text) { return parse_server_url(text).url.at(""); }

DOCTEST_TEST_CASE("addresses are kept in one form") {
    DOCTEST_CHECK(kept("192.168.1.20:7860") == "http://192.168.1.20:7860");
    DOCTEST_CHECK(kept(" HTTP://Studio.Local:8188/ ") == "http://studio.local:8188");
    DOCTEST_CHECK(kept("https://example.com") == "https://example.com:443");
    DOCTEST_CHECK(kept("http://example.com/sd//") == "http://example.com:80/sd");
    DOCTEST_CHECK(kept("[::1]:1234") == "http://[::1]:1234");
    DOCTEST_CHECK(kept("https://[FD00::7]/a/b/") == "https://[fd00::7]:443/a/b");
    DOCTEST_CHECK(parse_server_url("http://h:1/x").url.at("/v1/models") == "http://h:1/x/v1/models");
    DOCTEST_CHECK(parse_server_url("http://h:1/x").url.origin() == "http://h:1");
}

DOCTEST_TEST_CASE("user and password are taken out of an address") {
    const auto typed = parse_server_url("https://anna:a%40b:c@host.example:8443/x");
    DOCTEST_CHECK(typed.user.name == "anna");
    DOCTEST_CHECK(typed.user.password == "a@b:c");
    DOCTEST_CHECK(typed.url.at("") == "https://host.example:8443/x");
    DOCTEST_CHECK(parse_server_url("http://token@h").user.name == "token");
    // The last "@" ends the user: the host is what the library would take, too.
    DOCTEST_CHECK(parse_server_url("http://a:b@c@host").url.host == "host");
}

DOCTEST_TEST_CASE("addresses that are no plain server are refused") {
    for (const char* text : {"",
                             "http://",
                             "ftp://host",
                             "file:///etc/passwd",
                             "http://host:0",
                             "http://host:65536",
                             "http://host:99999999999999999999",
                             "http://host:",
                             "http://host:8x",
                             "http://ho st",
                             "http://h\tx",
                             "http://host/?a=b",
                             "http://host/#x",
                             "http://host/../x",
                             "http://host/a\\b",
                             "http://::1:80",
                             "http://[::1",
                             "http://[::1]x",
                             "http://[zz]",
                             "http://2130706433",
                             "http://0x7f.1",
                             "http://127.1",
                             "http://0177.0.0.1",
                             "http://1.2.3.4.5",
                             "http://m\xc3\xbcller.de",
                             "http://a/b/c//d"}) {
        DOCTEST_CAPTURE(text);
        DOCTEST_CHECK_THROWS_AS(parse_server_url(text), Error);
    }
    DOCTEST_CHECK_THROWS_AS(parse_server_url("http://" + std::string(3000, 'a')), Error);
}

DOCTEST_TEST_CASE("loopback and local networks are private, everything else is public") {
    for (const char* host :
         {"localhost", "a.localhost", "127.0.0.1", "127.9.9.9", "::1", "::ffff:127.0.0.1"}) {
        DOCTEST_CAPTURE(host);
        DOCTEST_CHECK(is_loopback(host));
        DOCTEST_CHECK(is_private(host));
    }
    for (const char* host : {"10.0.0.1", "172.16.0.1", "172.31.255.255", "192.168.1.2", "169.254.1.1",
                             "fd00::1", "fe80::1", "::ffff:10.0.0.1", "studio.local"}) {
        DOCTEST_CAPTURE(host);
        DOCTEST_CHECK(!is_loopback(host));
        DOCTEST_CHECK(is_private(host));
    }
    for (const char* host :
         {"example.com", "8.8.8.8", "172.32.0.1", "172.15.0.1", "192.169.0.1", "11.0.0.1", "2001:db8::1",
          "localhost.example.com", "10.0.0.1.example.com", "studio", "::ffff:8.8.8.8", "0.0.0.0", "::"}) {
        DOCTEST_CAPTURE(host);
        DOCTEST_CHECK(!is_private(host));
    }
}

DOCTEST_TEST_CASE("names in addresses are encoded byte by byte") {
    DOCTEST_CHECK(percent_encoded("../a b\"\xc3\xa4~") == "..%2Fa%20b%22%C3%A4~");
    DOCTEST_CHECK(percent_encoded(std::string_view("\0", 1)) == "%00");
}

}  // namespace
}  // namespace gse::remote
