// Answers on the disk: found again, whole or not at all, within their room.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <set>
#include <string>
#include <thread>

#include "engine/base/disk_cache.h"
#include "engine/base/file.h"
#include "tests/test_paths.h"

namespace disk_cache_test {

namespace {

using namespace gse;
namespace fs = std::filesystem;

constexpr std::uint64_t Room = 1 << 20;

std::vector<fs::path> entries_in(const fs::path& folder) {
    std::vector<fs::path> paths;
    for (const auto& entry : fs::directory_iterator(folder)) paths.push_back(entry.path());
    return paths;
}

/// Bytes of any value, other ones for another seed.
std::string answer_of(std::size_t bytes, int seed) {
    std::string answer(bytes, '\0');
    for (std::size_t i = 0; i < bytes; ++i)
        answer[i] = static_cast<char>((i * 31 + static_cast<std::size_t>(seed)) % 251);
    return answer;
}

/// Makes an entry look as if it was used that long ago.
void age(const fs::path& path, std::chrono::seconds seconds) {
    fs::last_write_time(path, fs::file_time_type::clock::now() - seconds);
}

}  // namespace

DOCTEST_TEST_CASE("disk cache: what was kept is found by the next object, and nothing else is") {
    const test::ScratchFolder folder;
    const std::string question = std::string("where is the bear\0?", 19), answer = answer_of(5000, 1);
    {
        DiskCache cache(folder.path() / "new" / "cache", Room);
        DOCTEST_CHECK(!cache.find(question));
        cache.keep(question, answer);
        cache.keep("nothing", "");
    }
    DiskCache cache(folder.path() / "new" / "cache", Room);
    DOCTEST_CHECK(cache.find(question) == answer);
    DOCTEST_CHECK(cache.find("nothing") == "");
    DOCTEST_CHECK(!cache.find("where is the bear"));
    cache.keep(question, "here");
    DOCTEST_CHECK(cache.find(question) == "here");
    DOCTEST_CHECK(entries_in(cache.folder()).size() == 2);  // nothing half written is left
    DOCTEST_CHECK(cached_bytes(cache.folder()) > 0);
    clear_cache_folder(cache.folder());
    DOCTEST_CHECK(!cache.find(question));
    DOCTEST_CHECK(cached_bytes(cache.folder()) == 0);
}

DOCTEST_TEST_CASE(
    "disk cache: an entry that is not whole, or was changed anywhere, is removed and counts as not there") {
    const test::ScratchFolder folder;
    DiskCache cache(folder.path(), Room);
    const std::string question = "a question", answer = answer_of(300, 2);
    const auto keep = [&] {
        cache.keep(question, answer);
        return entries_in(folder.path()).at(0);
    };
    const auto whole = read_file(keep());
    for (std::size_t bytes = 0; bytes < whole.size(); bytes += 7) {
        write_file(keep(), whole.substr(0, bytes));
        DOCTEST_CHECK(!cache.find(question));
        DOCTEST_CHECK(entries_in(folder.path()).empty());
    }
    for (std::size_t at = 0; at < whole.size(); at += 3) {
        auto changed = whole;
        changed[at] = static_cast<char>(changed[at] ^ 0x10);
        write_file(keep(), changed);
        DOCTEST_CHECK(!cache.find(question));
        DOCTEST_CHECK(entries_in(folder.path()).empty());
    }
    write_file(keep(), whole + "x");
    DOCTEST_CHECK(!cache.find(question));
    const auto path = keep();
    cache.keep("another", "answer");
    for (const auto& other : entries_in(folder.path()))
        if (other != path)
            fs::copy_file(other, path,
                          fs::copy_options::overwrite_existing);  // a whole entry, of another question
    DOCTEST_CHECK(!cache.find(question));
}

DOCTEST_TEST_CASE(
    "disk cache: what was used least recently goes when the room is full, and too large an answer is not "
    "kept") {
    const test::ScratchFolder folder;
    DiskCache cache(folder.path(), 100000);
    const auto question = [](int i) { return fmt::format("question {}", i); };
    for (int i = 0; i < 9; ++i) {
        cache.keep(question(i), answer_of(10000, i));
        for (const auto& path : entries_in(folder.path())) age(path, std::chrono::seconds(100 - i));
    }
    DOCTEST_CHECK(cache.find(question(0)));  // used again: the youngest now
    cache.keep(question(9), answer_of(10000, 9));
    cache.keep(question(10), answer_of(10000, 10));
    DOCTEST_CHECK(cached_bytes(folder.path()) <= 100000);
    DOCTEST_CHECK(cache.find(question(0)) == answer_of(10000, 0));
    DOCTEST_CHECK(cache.find(question(10)) == answer_of(10000, 10));
    int left = 0;
    for (int i = 1; i < 9; ++i) left += cache.find(question(i)) ? 1 : 0;
    DOCTEST_CHECK(left == 6);
    cache.keep("large", answer_of(30000, 0));
    DOCTEST_CHECK(!cache.find("large"));
    cache.resize(40000);
    DOCTEST_CHECK(cached_bytes(folder.path()) <= 40000);
    DOCTEST_CHECK(cached_bytes(folder.path()) > 0);
    cache.resize(0);
    cache.keep("small", "answer");
    DOCTEST_CHECK(!cache.find("small"));
    DOCTEST_CHECK(entries_in(folder.path()).empty());
}

DOCTEST_TEST_CASE("disk cache: files of others stay, and so does what another process is writing") {
    const test::ScratchFolder folder;
    write_file(folder.path() / "mine.txt", "text");
    write_file(folder.path() / "young.pending", "being written");
    write_file(folder.path() / "old.pending", "left behind");
    age(folder.path() / "old.pending", std::chrono::hours(2));
    DiskCache cache(folder.path(), Room);
    cache.keep("question", "answer");
    clear_cache_folder(folder.path());
    DOCTEST_CHECK(fs::exists(folder.path() / "mine.txt"));
    DOCTEST_CHECK(fs::exists(folder.path() / "young.pending"));
    DOCTEST_CHECK(!fs::exists(folder.path() / "old.pending"));
}

DOCTEST_TEST_CASE("disk cache: a folder that cannot be made, read or written is no error") {
    const test::ScratchFolder folder;
    write_file(folder.path() / "file", "no folder");
    for (const fs::path& place : {fs::path("/dev/null"), folder.path() / "file",
                                  folder.path() / "file" / "below", fs::path("/proc/self/cache")}) {
        DiskCache cache(place, Room);
        cache.keep("question", "answer");
        DOCTEST_CHECK(!cache.find("question"));
        DOCTEST_CHECK(cached_bytes(place) == 0);
        DOCTEST_CHECK(clear_cache_folder(place) == 0);
        cache.resize(10);
    }
    const auto closed = folder.path() / "closed";
    DiskCache(closed, Room).keep("question", "answer");
    fs::permissions(closed, fs::perms::owner_read | fs::perms::owner_exec);
    DiskCache cache(closed, Room);
    cache.keep("another", "answer");  // kept where the user may do everything
    DOCTEST_CHECK(cache.find("question") == "answer");
    fs::permissions(closed, fs::perms::owner_all);
}

DOCTEST_TEST_CASE(
    "disk cache: processes and threads that share a folder see whole answers only, and stay within the "
    "room") {
    const test::ScratchFolder folder;
    constexpr int questions = 12, rounds = 150;
    const auto work = [&](int seed) {
        DiskCache cache(folder.path(), 120000);
        bool right = true;
        for (int i = 0; i < rounds; ++i) {
            const int number = (i * 7 + seed) % questions;
            const auto question = fmt::format("question {}", number);
            if (const auto answer = cache.find(question))
                right = right && *answer == answer_of(20000, number);
            else cache.keep(question, answer_of(20000, number));
        }
        return right;
    };
    std::vector<pid_t> children;
    for (int child = 0; child < 2; ++child) {
        const pid_t process = fork();
        if (process == 0) _exit(work(child + 3) ? 0 : 1);
        children.push_back(process);
    }
    bool first = false, second = false;
    std::thread thread([&] { first = work(0); });
    second = work(5);
    thread.join();
    DOCTEST_CHECK(first);
    DOCTEST_CHECK(second);
    for (const pid_t child : children) {
        int status = 1;
        waitpid(child, &status, 0);
        DOCTEST_CHECK((WIFEXITED(status) && WEXITSTATUS(status) == 0));
    }
    // Each process knows its own writes at once, those of others later.
    DOCTEST_CHECK(cached_bytes(folder.path()) <= 4 * 120000);
    DiskCache cache(folder.path(), 120000);
    for (int i = 0; i < 7; ++i) cache.keep(fmt::format("last {}", i), answer_of(20000, i));
    DOCTEST_CHECK(cached_bytes(folder.path()) <= 120000);
}

}  // namespace disk_cache_test
