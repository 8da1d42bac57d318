// Sentences about servers: their words are found in every known form, and made harmless.
#include <doctest/doctest.h>

#include "engine/remote/protocols/server_error.h"

namespace gse::remote {
namespace {

HttpAnswer answer(int status, const std::string& body, const HttpHeaders& headers = {}) {
    return {status, headers, body};
}

const ServerUrl Studio = parse_server_url("http://studio.local:7860").url;

DOCTEST_TEST_CASE("a server's words are found in every known form") {
    const auto words = [](const std::string& body) { return server_words(answer(500, body)); };
    DOCTEST_CHECK(words(R"({"error":"prompt required"})") == "prompt required");
    DOCTEST_CHECK(words(R"({"error":"server_error","message":"bad type"})") == "server_error: bad type");
    DOCTEST_CHECK(words(R"({"error":{"message":"no key","code":"x"}})") == "no key");
    DOCTEST_CHECK(words(R"({"detail":[{"loc":["body","width"],"msg":"no number"}]})") ==
                  "body.width: no number");
    DOCTEST_CHECK(words(R"({"detail":{"msg":"busy","type":"x"}})") == "busy");
    DOCTEST_CHECK(words(R"({"error":"OutOfMemoryError","detail":"","errors":"CUDA out of memory"})") ==
                  "OutOfMemoryError: CUDA out of memory");
    DOCTEST_CHECK(words("<html><HEAD><Title>502 Bad\n Gateway</title></html>") == "502 Bad Gateway");
    DOCTEST_CHECK(words("Internal Server Error") == "Internal Server Error");
    DOCTEST_CHECK(words("") == "");
    DOCTEST_CHECK(words("{}") == "");
    DOCTEST_CHECK(words("[1,2]") == "");
}

DOCTEST_TEST_CASE("a server's words are short and hold no control characters") {
    const auto long_words = server_words(answer(500, "{\"error\":\"" + std::string(5000, 'x') + "\"}"));
    DOCTEST_CHECK(long_words.size() == 300);
    DOCTEST_CHECK(long_words.ends_with("..."));
    std::string accents(297, 'x');
    for (int i = 0; i < 3; ++i) accents += "\xc3\xa4";
    const auto letters = shown(accents);
    DOCTEST_CHECK(letters.size() <= 300);
    DOCTEST_CHECK(shown("a\x1b[31m\n\n b\xff") == "a\\x1b[31m b\\xff");
    DOCTEST_CHECK(shown("\xe2\x80\xae") == "\\u202e");
}

DOCTEST_TEST_CASE("a redirect is told without what may be secret") {
    const auto told = [](const std::string& target) {
        return status_error(answer(302, "", {{"location", target}}), Studio, true).message();
    };
    DOCTEST_CHECK(told("https://b.example/x?token=1#y") ==
                  "studio.local:7860 sends us on to https://b.example/x");
    DOCTEST_CHECK(told("https://me:pw@b.example/") == "studio.local:7860 sends us on to https://b.example/");
    DOCTEST_CHECK(told("") == "studio.local:7860 sends us on to nowhere");
}

DOCTEST_TEST_CASE("memory that did not do is told apart from other failures") {
    DOCTEST_CHECK(ran_out_of_memory(answer(500, R"({"error":"OutOfMemoryError"})")));
    DOCTEST_CHECK(ran_out_of_memory(answer(500, "CUDA error: out of memory")));
    DOCTEST_CHECK(!ran_out_of_memory(answer(500, "no such model")));
    DOCTEST_CHECK(work_error(Studio, "HIP out of memory").message() == "studio.local:7860 ran out of memory");
    DOCTEST_CHECK(work_error(Studio, "bad \x1b").message() ==
                  "studio.local:7860 failed to draw: \"bad \\x1b\"");
}

}  // namespace
}  // namespace gse::remote
