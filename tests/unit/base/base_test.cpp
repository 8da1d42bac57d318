// Errors, files, fields, random numbers, the log and the thread pool.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <atomic>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <thread>

#include "engine/base/error.h"
#include "engine/base/fields.h"
#include "engine/base/file.h"
#include "engine/base/image.h"
#include "engine/base/log.h"
#include "engine/base/log_quiet.h"
#include "engine/base/random.h"
#include "engine/base/thread_pool.h"
#include "tests/test_paths.h"

namespace base_test {

using namespace gse;
using namespace gse::test;

namespace {

struct Settings {
    int steps = 4;
    double rate = 0.5;
    bool on = false;
    std::string word = "hat";

    template <class Self, class F> static void visit_fields(Self& self, F&& f) {
        f("steps", self.steps, "Steps.", Range{1, 10});
        f("rate", self.rate, "Rate.");
        f("on", self.on, "On or off.");
        f("word", self.word, "Word.");
    }
};

template <class F> bool throws_error(F&& body, ErrorCode code) {
    try {
        body();
    } catch (const Error& error) { return error.code() == code; }
    return false;
}

}  // namespace

DOCTEST_TEST_CASE("an error says what, what to do and where, on one line") {
    const Error error(ErrorCode::Malformed, "the file is broken", "get it again", "/a/b.ply");
    DOCTEST_CHECK(std::string(error.what()) == "the file is broken; get it again: /a/b.ply");
    DOCTEST_CHECK(std::string(Error(ErrorCode::Malformed, "short").what()) == "short");
}

DOCTEST_TEST_CASE("a zero byte that a message quotes does not end it") {
    const Error error(ErrorCode::Malformed, std::string("it holds \"a\0b\"", 14), "get it again",
                      "scene.ply");
    DOCTEST_CHECK(std::string(error.what()) == "it holds \"a\\x00b\"; get it again: scene.ply");
}

DOCTEST_TEST_CASE("files are mapped, written whole, and kept when writing fails") {
    ScratchFolder scratch;
    const auto path = scratch.path() / "new/folder/a.txt";
    write_file(path, "first");
    DOCTEST_CHECK(read_file(path) == "first");
    DOCTEST_CHECK(FileBytes(path).bytes().size() == 5);
    DOCTEST_CHECK_THROWS_AS(write_atomically(path,
                                             [](const std::filesystem::path& temporary) {
                                                 write_file(temporary, "half");
                                                 throw std::runtime_error("stop");
                                             }),
                            std::runtime_error);
    DOCTEST_CHECK(read_file(path) == "first");
    write_file(path, "");
    DOCTEST_CHECK(FileBytes(path).bytes().empty());
    std::size_t entries = 0;
    for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(path.parent_path()))
        ++entries;
    DOCTEST_CHECK(entries == 1);
    FileBytes moved_from(path);
    const FileBytes moved(std::move(moved_from));
    DOCTEST_CHECK(moved.text().empty());
}

DOCTEST_TEST_CASE("missing files, folders and unwritable places are told apart") {
    ScratchFolder scratch;
    DOCTEST_CHECK(throws_error([&] { FileBytes file(scratch.path() / "gone"); }, ErrorCode::NotFound));
    DOCTEST_CHECK(throws_error([&] { FileBytes file(scratch.path()); }, ErrorCode::Unreadable));
    DOCTEST_CHECK(throws_error([&] { write_file(scratch.path(), "x"); }, ErrorCode::Unwritable));
    DOCTEST_CHECK(throws_error([&] { write_file("/proc/none/x", "x"); }, ErrorCode::Unwritable));
    write_file(scratch.path() / "file", "x");
    DOCTEST_CHECK(
        throws_error([&] { write_file(scratch.path() / "file/below", "x"); }, ErrorCode::Unwritable));
}

DOCTEST_TEST_CASE("fields travel through JSON and refuse what is not theirs") {
    Settings settings;
    settings.steps = 7;
    settings.word = "crown";
    const auto json = fields_to_json(settings);
    DOCTEST_CHECK(json.dump() == R"({"steps":7,"rate":0.5,"on":false,"word":"crown"})");
    Settings again;
    fields_from_json(again, json);
    DOCTEST_CHECK(again.steps == 7);
    DOCTEST_CHECK(again.word == "crown");
    using Json = nlohmann::ordered_json;
    DOCTEST_CHECK(throws_error(
        [&] {
            fields_from_json(again, Json{{"steps", 11}});
        },
        ErrorCode::InvalidArgument));
    DOCTEST_CHECK(throws_error(
        [&] {
            fields_from_json(again, Json{{"steps", "many"}});
        },
        ErrorCode::InvalidArgument));
    DOCTEST_CHECK(throws_error(
        [&] {
            fields_from_json(again, Json{{"stepz", 3}});
        },
        ErrorCode::InvalidArgument));
}

DOCTEST_TEST_CASE("random numbers are repeatable, in range and spread") {
    Random a(5), b(5), other(6);
    DOCTEST_CHECK(a.next() == b.next());
    DOCTEST_CHECK(a.next() != other.next());
    DOCTEST_CHECK(Random::stream(1, 0).next() != Random::stream(1, 1).next());
    Random random(9);
    double sum = 0, squares = 0;
    constexpr int Draws = 20000;
    for (int i = 0; i < Draws; ++i) {
        const double u = random.uniform(2, 3);
        DOCTEST_REQUIRE(u >= 2);
        DOCTEST_REQUIRE(u < 3);
        DOCTEST_REQUIRE(random.below(7) < 7);
        const double n = random.normal();
        sum += n;
        squares += n * n;
    }
    DOCTEST_CHECK(std::abs(sum / Draws) < 0.03);  // four standard errors
    DOCTEST_CHECK(squares / Draws == doctest::Approx(1).epsilon(0.05));
}

DOCTEST_TEST_CASE("the log reaches its sink from the level on") {
    std::vector<std::string> lines;
    log::set_sink([&](log::Level, std::string_view text) { lines.emplace_back(text); });
    log::set_level(log::Level::Warning);
    log::info("unseen {}", 1);
    log::warning("seen {}", 2);
    log::set_level(log::Level::Info);
    log::set_sink({});
    DOCTEST_REQUIRE(lines.size() == 1);
    DOCTEST_CHECK(lines[0] == "seen 2");
}

DOCTEST_TEST_CASE("what is measured says nothing but errors, in its own thread") {
    std::vector<std::string> lines;
    log::set_sink([&](log::Level, std::string_view text) { lines.emplace_back(text); });
    {
        const log::Quiet outer;
        { const log::Quiet inner; }
        log::warning("of the measured");
        log::error("an error");
        std::thread([] { log::warning("of another thread"); }).join();
    }
    log::warning("afterwards");
    log::set_sink({});
    DOCTEST_CHECK(lines == std::vector<std::string>{"an error", "of another thread", "afterwards"});
}

DOCTEST_TEST_CASE("a loop visits every item once, for any number of threads and any chunk") {
    for (const unsigned threads : {1u, 2u, 5u}) {
        ThreadPool pool(threads);
        DOCTEST_CHECK(pool.thread_count() == threads);
        for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{17}, std::size_t{1000}}) {
            std::vector<std::atomic<int>> visits(count);
            pool.parallel_for(count, 16, [&](std::size_t begin, std::size_t end, unsigned worker) {
                if (worker >= threads || end - begin > 16) throw std::logic_error("bad chunk");
                for (std::size_t i = begin; i < end; ++i) visits[i].fetch_add(1);
            });
            for (const auto& visit : visits) DOCTEST_REQUIRE(visit.load() == 1);
        }
    }
}

DOCTEST_TEST_CASE("an exception in a loop comes out of it, and the pool lives on") {
    ThreadPool pool(3);
    DOCTEST_CHECK_THROWS_AS(pool.parallel_for(100, 1,
                                              [](std::size_t begin, std::size_t, unsigned) {
                                                  if (begin == 50) throw std::runtime_error("stop");
                                              }),
                            std::runtime_error);
    std::atomic<int> done{0};
    pool.parallel_for(10, 1, [&](std::size_t, std::size_t, unsigned) { done.fetch_add(1); });
    DOCTEST_CHECK(done.load() == 10);
}

DOCTEST_TEST_CASE("images and masks index by row, then column") {
    Image image(3, 2, 2, 0.5f);
    image.at(2, 1, 1) = 7;
    DOCTEST_CHECK(image.data.back() == 7.0f);
    image.resize(1, 1, 1);
    DOCTEST_CHECK(image.data.size() == 1);
    Mask mask(4, 4);
    mask.at(1, 2) = 1;
    DOCTEST_CHECK(mask.data[9] == 1);
    DOCTEST_CHECK(mask.count() == 1);
}

}  // namespace base_test
