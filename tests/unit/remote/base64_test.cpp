// Base64: there and back, and strictness.
#include <doctest/doctest.h>

#include <algorithm>
#include <span>
#include <string>

#include "engine/base/error.h"
#include "engine/base/random.h"
#include "engine/remote/picture/base64.h"

namespace gse::remote {
namespace {

std::string decoded_text(std::string_view text) {
    const auto bytes = base64_decoded(text);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

DOCTEST_TEST_CASE("any bytes come back from base64") {
    Random random(3);
    for (std::size_t size = 1; size < 200; ++size) {
        std::string bytes(size, '\0');
        for (char& byte : bytes) byte = static_cast<char>(random.below(256));
        DOCTEST_CHECK(decoded_text(base64_encoded(std::as_bytes(std::span(bytes)))) == bytes);
    }
}

DOCTEST_TEST_CASE("a data prefix is passed over") {
    DOCTEST_CHECK(decoded_text("data:image/png;base64,QUJD") == "ABC");
    DOCTEST_CHECK_THROWS_AS(base64_decoded("data:image/png,QUJD"), Error);
    DOCTEST_CHECK_THROWS_AS(base64_decoded("data:" + std::string(1000, 'x') + ";base64,QUJD"), Error);
}

DOCTEST_TEST_CASE("base64 that is not written strictly is refused") {
    for (const char* text : {"", "QUJ", "QUJDR", "QU\nJD", "QUJD\n", "QU-_", "====", "Q===", "QQ=Q",
                             "QR==", "QUF=", "QUJD=QUJ", " QUJD", "QUJD QUJD", "\xff\xff\xff\xff"}) {
        DOCTEST_CAPTURE(text);
        DOCTEST_CHECK_THROWS_AS(base64_decoded(text), Error);
    }
    DOCTEST_CHECK(decoded_text("QQ==") == "A");
    DOCTEST_CHECK(decoded_text("QUE=") == "AA");
}

}  // namespace
}  // namespace gse::remote
