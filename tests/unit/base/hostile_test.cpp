// Hostile files and users against the basics: files cut off while they are read, deep JSON, control
// characters, numbers that are none, and more memory than there is.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <string>

#include "engine/base/fields.h"
#include "engine/base/file.h"
#include "engine/base/json.h"
#include "engine/base/memory.h"
#include "engine/base/printable.h"
#include "tests/test_paths.h"

namespace hostile_test {

using namespace gse;
using namespace gse::test;

namespace {

struct Numbers {
    int steps = 4;
    double rate = 0.5;
    float share = 0.1f;
    double free = 1;
    bool on = false;
    std::uint64_t seed = 1;
    std::string word = "hat";

    template <class Self, class F> static void visit_fields(Self& self, F&& f) {
        f("steps", self.steps, "Steps.", Range{1, 10});
        f("rate", self.rate, "Rate.", Range{0, 1});
        f("share", self.share, "Share.", Range{0, 0.1});
        f("free", self.free, "Any.");
        f("on", self.on, "On or off.");
        f("seed", self.seed, "Seed.");
        f("word", self.word, "Word.");
    }
};

/// The message of the Error that `body` throws; empty when it throws none.
template <class F> std::string message_of(F&& body) {
    try {
        body();
    } catch (const Error& error) { return error.what(); }
    return "";
}

bool says(const std::string& message, std::initializer_list<const char*> words) {
    return std::all_of(words.begin(), words.end(),
                       [&](const char* word) { return message.find(word) != std::string::npos; });
}

}  // namespace

DOCTEST_TEST_CASE("a file that is cut off while it is read is an error, and what was read stays") {
    const ScratchFolder scratch;
    const auto path = scratch.path() / "a.bin";
    write_file(path, std::string(100000, 'x'));
    const InputFile open(path);
    const FileBytes whole(path);
    std::filesystem::resize_file(path, 10);
    std::array<std::byte, 1000> piece{};
    DOCTEST_CHECK(says(message_of([&] { open.read(90000, piece); }), {"shorter", "a.bin"}));
    DOCTEST_CHECK(says(message_of([&] { open.read(5, piece); }), {"shorter", "a.bin"}));
    DOCTEST_CHECK(whole.text() == std::string(100000, 'x'));
    DOCTEST_CHECK(read_start(path, 4) == "xxxx");
    DOCTEST_CHECK(read_start(path, 400) == std::string(10, 'x'));
}

DOCTEST_TEST_CASE("pipes and devices are refused without waiting") {
    const ScratchFolder scratch;
    const auto pipe = scratch.path() / "pipe";
    DOCTEST_REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
    DOCTEST_CHECK(says(message_of([&] { const InputFile file(pipe); }), {"pipe or device"}));
    DOCTEST_CHECK(says(message_of([&] { const InputFile file("/dev/zero"); }), {"pipe or device"}));
}

DOCTEST_TEST_CASE("JSON nested too deep is refused before it is parsed, brackets in text do not count") {
    const std::string deep = std::string(200000, '[') + std::string(200000, ']');
    DOCTEST_CHECK(says(message_of([&] { parse_json(deep, "the list"); }), {"the list", "128 levels"}));
    DOCTEST_CHECK(try_parse_json(deep).is_discarded());
    const std::string fits = std::string(DeepestJson, '[') + std::string(DeepestJson, ']');
    DOCTEST_CHECK(try_parse_json(fits).is_array());
    DOCTEST_CHECK(try_parse_json("[" + fits + "]").is_discarded());
    const std::string text = "{\"a\\\"\": \"" + std::string(500, '{') + "\"}";
    DOCTEST_CHECK(parse_json(text, "it").size() == 1);
    DOCTEST_CHECK(says(message_of([] { parse_json("{\"a\": 1,\n  b}", "it"); }),
                       {"it is not valid JSON", "line 2, column 3"}));
    DOCTEST_CHECK(says(message_of([] { parse_json("[1e999]", "it"); }), {"too large"}));
    DOCTEST_CHECK(says(message_of([] { parse_json("", "it"); }), {"not valid JSON"}));
    DOCTEST_CHECK(json_text(nlohmann::json("a\xff")) == "\"a\xef\xbf\xbd\"");
}

DOCTEST_TEST_CASE("control characters and broken UTF-8 become escapes, other scripts stay") {
    DOCTEST_CHECK(printable("a\x1b[2J\x07") == "a\\x1b[2J\\x07");
    DOCTEST_CHECK(printable(std::string_view("a\0b", 3)) == "a\\x00b");
    DOCTEST_CHECK(printable("a\nb\tc\x7f") == "a\\x0ab\\x09c\\x7f");
    DOCTEST_CHECK(printable("a\nb\tc", true) == "a\nb\tc");
    DOCTEST_CHECK(printable("h\xc3\xbct \xe5\xb8\xbd \xf0\x9f\x8e\xa9") ==
                  "h\xc3\xbct \xe5\xb8\xbd \xf0\x9f\x8e\xa9");
    DOCTEST_CHECK(printable("\xc2\x9b"
                            "1m") == "\\x9b1m");            // C1 as UTF-8
    DOCTEST_CHECK(printable("\xe2\x80\xae") == "\\u202e");  // right-to-left override
    DOCTEST_CHECK(printable("\xff\xc0\x80\xed\xa0\x80") == "\\xff\\xc0\\x80\\xed\\xa0\\x80");
    DOCTEST_CHECK(printable("\xe5\xb8") == "\\xe5\\xb8");  // cut off
}

DOCTEST_TEST_CASE("settings from JSON: what is no number of the setting's range is refused by name") {
    using Json = nlohmann::ordered_json;
    const auto refused = [](const Json& json) {
        Numbers numbers;
        const std::string message = message_of([&] { fields_from_json(numbers, json); });
        DOCTEST_CHECK(numbers.steps == 4);  // nothing was set
        return message;
    };
    const double nan = std::numeric_limits<double>::quiet_NaN(),
                 infinity = std::numeric_limits<double>::infinity();
    DOCTEST_CHECK(says(refused({{"steps", 2}, {"rate", nan}}), {"rate", "0 to 1", "nan"}));
    DOCTEST_CHECK(says(refused({{"rate", infinity}}), {"rate", "inf"}));
    DOCTEST_CHECK(says(refused({{"free", infinity}}), {"free", "finite"}));
    DOCTEST_CHECK(says(refused({{"free", nullptr}}), {"free", "null"}));
    DOCTEST_CHECK(says(refused({{"share", 0.2}}), {"share"}));
    DOCTEST_CHECK(says(refused({{"share", "\x1b"}}), {"share", "\\u001b"}));
    DOCTEST_CHECK(says(refused({{"steps", 2.5}}), {"steps", "whole", "2.5"}));
    DOCTEST_CHECK(says(refused({{"steps", 4294967298}}), {"steps"}));  // 2 when cut to 32 bits
    DOCTEST_CHECK(says(refused({{"steps", true}}), {"steps", "true"}));
    DOCTEST_CHECK(says(refused({{"on", 1}}), {"on", "true or false", "1"}));
    DOCTEST_CHECK(says(refused({{"seed", -1}}), {"seed", "-1"}));
    DOCTEST_CHECK(says(refused({{"seed", 1e300}}), {"seed"}));
    DOCTEST_CHECK(says(refused({{"word", Json::array({1})}}), {"word", "text", "a list"}));
    DOCTEST_CHECK(says(refused(Json::array()), {"not an object"}));
    Numbers taken;
    fields_from_json(taken, {{"steps", 3.0}, {"seed", ~std::uint64_t{0}}, {"share", 0.1}, {"rate", 1}});
    DOCTEST_CHECK(taken.steps == 3);
    DOCTEST_CHECK(taken.seed == ~std::uint64_t{0});
    DOCTEST_CHECK(taken.rate == 1);
    fields_from_json(taken, fields_to_json(taken));  // a float at its limit comes back
}

DOCTEST_TEST_CASE("settings in memory are checked the same way") {
    Numbers numbers;
    DOCTEST_CHECK(message_of([&] { check_fields(numbers); }).empty());
    numbers.rate = std::numeric_limits<double>::quiet_NaN();
    DOCTEST_CHECK(says(message_of([&] { check_fields(numbers); }), {"rate", "nan"}));
    numbers.rate = 0;
    numbers.free = -std::numeric_limits<double>::infinity();
    DOCTEST_CHECK(says(message_of([&] { check_fields(numbers); }), {"free", "-inf"}));
}

DOCTEST_TEST_CASE("more memory than there is: the sentence says what is needed and what is free") {
    DOCTEST_CHECK(free_memory() > 0);
    DOCTEST_CHECK(message_of([] { require_memory(1 << 20, "a small thing"); }).empty());
    const std::string message =
        message_of([] { require_memory(std::uint64_t{1} << 60, "the scene of 5 splats"); });
    DOCTEST_CHECK(says(message, {"the scene of 5 splats needs", "GB", "are free"}));
    DOCTEST_CHECK(memory_text(1500000) == "2 MB");
    DOCTEST_CHECK(memory_text(60123456789) == "60.1 GB");
    note_refused(3'000'000'000);
    DOCTEST_CHECK(says(out_of_memory().what(), {"3 GB more were needed", "are free"}));
    DOCTEST_CHECK(says(out_of_memory().what(), {"there is not enough memory; ", "are free"}));  // told once
}

}  // namespace hostile_test
