// Folders of results: killed or failing at every rename, the old results or the new ones are there, never
// half of each under a report that says otherwise.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>
#include <fcntl.h>
#include <fmt/core.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <functional>
#include <string>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/log.h"
#include "engine/base/staged_folder.h"
#include "tests/test_paths.h"

namespace staged_folder_test {

using namespace gse;
namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

/// Fault of the calls below: the n-th rename kills the process or fails.
struct Fault {
    int at = 0;    // 0 = never
    int code = 0;  // errno, or 0 to kill
    bool no_exchange = false;
    int span = 1;  // so many calls in a row
    int calls = 0;
};
Fault fault;

/// True when this call is to fail; errno is set.
bool fails() {
    if (fault.at == 0 || ++fault.calls < fault.at || fault.calls >= fault.at + fault.span) return false;
    if (fault.code == 0) kill(getpid(), SIGKILL);
    errno = fault.code;
    return true;
}

}  // namespace

// These stand before the C library's.
extern "C" int rename(const char* from, const char* to) noexcept {
    if (fails()) return -1;
    return static_cast<int>(syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0));
}
extern "C" int renameat2(int from_folder, const char* from, int to_folder, const char* to,
                         unsigned flags) noexcept {
    if (fault.no_exchange && (flags & RENAME_EXCHANGE) != 0) {
        errno = EINVAL;
        return -1;
    }
    if (fails()) return -1;
    return static_cast<int>(syscall(SYS_renameat2, from_folder, from, to_folder, to, flags));
}

namespace {

const FolderContents contents{"report.json", {"report.json", "scene.ply", "film.mp4", "evidence"}};

/// Writes the results of run `name` into the folder's stage.
void fill(StagedFolder& folder, const std::string& name, int views) {
    for (const char* file : {"scene.ply", "film.mp4"}) write_file(folder.path() / file, name + file);
    for (int view = 0; view < views; ++view)
        write_file(folder.path() / fmt::format("evidence/{}.png", view), name);
    const Json report{{"run", name}, {"files", folder.listing()}};
    write_file(folder.path() / "report.json", report.dump());
}

void run(const fs::path& target, const std::string& name, int views) {
    StagedFolder folder(target, contents);
    fill(folder, name, views);
    folder.commit();
}

/// Name of the run whose results, all of them and nothing else of a run, are there; "" when the report says
/// that they do not belong together. Anything else fails the test.
std::string run_in(const fs::path& target, bool with_strangers = false) {
    const Json report = Json::parse(read_file(target / "report.json"));
    if (report.contains("unfinished")) return "";
    const auto name = report.at("run").get<std::string>();
    for (const auto& [file, entry] : report.at("files").items()) {
        const std::string expected = file.starts_with("evidence") ? name : name + file;
        DOCTEST_CHECK(read_file(target / file) == expected);
        DOCTEST_CHECK(entry.at("bytes") == expected.size());
    }
    if (!with_strangers)
        for (const auto& entry : fs::recursive_directory_iterator(target))
            if (entry.is_regular_file() && entry.path().filename() != "report.json" &&
                entry.path().string().find(".partial-") == std::string::npos)
                DOCTEST_CHECK(report["files"].contains(entry.path().lexically_relative(target).string()));
    return name;
}

int hidden_entries(const fs::path& folder) {
    int count = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        count += entry.path().filename().string().starts_with('.') ? 1 : 0;
    return count;
}

/// Runs it in another process; true when it was killed.
bool is_killed(const std::function<void()>& work) {
    const pid_t child = fork();
    if (child == 0) {
        work();
        _exit(0);
    }
    int status = 0;
    DOCTEST_REQUIRE(waitpid(child, &status, 0) == child);
    return WIFSIGNALED(status);
}

/// A failing or killed commit over an old run, with the n-th rename after the stage is filled.
void commit_with_fault(const fs::path& target, const Fault& wanted, int views) {
    StagedFolder folder(target, contents);
    fill(folder, "new ", views);
    fault = wanted;
    folder.commit();
}

constexpr int MostRenames = 40;

}  // namespace

DOCTEST_TEST_CASE(
    "a folder killed at any rename holds one run, whole, and the next run removes the remains") {
    for (int at = 1;; ++at) {
        DOCTEST_REQUIRE(at < MostRenames);
        DOCTEST_CAPTURE(at);
        const test::ScratchFolder scratch;
        const auto target = scratch.path() / "out";
        run(target, "old ", 5);
        const bool killed = is_killed([&] { commit_with_fault(target, {at, 0, false}, 3); });
        const std::string name = run_in(target);
        const bool whole = name == "old " || name == "new ";
        DOCTEST_CHECK(whole);
        run(target, "next ", 2);
        DOCTEST_CHECK(run_in(target) == "next ");
        DOCTEST_CHECK(hidden_entries(scratch.path()) == 0);
        DOCTEST_CHECK(std::distance(fs::directory_iterator(scratch.path()), fs::directory_iterator()) == 1);
        if (killed) continue;
        DOCTEST_CHECK(name == "new ");
        DOCTEST_CHECK(at > 2);  // it did rename something
        break;
    }
}

DOCTEST_TEST_CASE("where folders cannot be swapped, the report tells whether the files belong together") {
    int unfinished = 0;
    for (const bool no_exchange : {false, true})
        for (int at = 1;; ++at) {
            DOCTEST_REQUIRE(at < MostRenames);
            DOCTEST_CAPTURE(at);
            const test::ScratchFolder scratch;
            const auto target = scratch.path() / "out";
            run(target, "old ", 5);
            write_file(target / "notes.txt", "mine");  // a stranger's file: the folder is not swapped
            const bool killed = is_killed([&] { commit_with_fault(target, {at, 0, no_exchange}, 3); });
            const std::string name = run_in(target, true);
            unfinished += name.empty() ? 1 : 0;
            if (name == "new ") DOCTEST_CHECK_FALSE(fs::exists(target / "evidence/4.png"));
            run(target, "next ", 2);
            DOCTEST_CHECK(run_in(target, true) == "next ");
            DOCTEST_CHECK(read_file(target / "notes.txt") == "mine");
            DOCTEST_CHECK(hidden_entries(scratch.path()) == 0);
            if (killed) continue;
            DOCTEST_CHECK(name == "new ");
            break;
        }
    DOCTEST_CHECK(unfinished > 4);
}

DOCTEST_TEST_CASE("a commit that fails keeps the new results and the old ones") {
    for (const bool stranger : {false, true})
        for (const int code : {EXDEV, EIO, ENOSPC}) {
            int failed = 0, mixed = 0;
            for (int at = 1;; ++at) {
                DOCTEST_REQUIRE(at < MostRenames);
                DOCTEST_CAPTURE(at);
                DOCTEST_CAPTURE(code);
                const test::ScratchFolder scratch;
                const auto target = scratch.path() / "out";
                run(target, "old ", 5);
                if (stranger) write_file(target / "notes.txt", "mine");
                std::string said;
                try {
                    commit_with_fault(target, {at, code, false, 2}, 3);
                } catch (const Error& error) { said = error.what(); }
                const bool reached = fault.calls >= at || !said.empty();
                fault = {};
                if (said.empty()) {  // another way was found
                    DOCTEST_CHECK(run_in(target, stranger) == "new ");
                } else {
                    ++failed;
                    const std::string name = run_in(target, stranger);
                    if (name.empty()) {  // moving back failed, too: the report says so, and nothing is
                                         // deleted
                        ++mixed;
                        continue;
                    }
                    DOCTEST_CHECK(name == "old ");
                    const bool beside = fs::exists(scratch.path() / "out.kept"),
                               inside = fs::exists(target / "out.kept");
                    DOCTEST_REQUIRE((beside || inside));
                    const auto kept = beside ? scratch.path() / "out.kept" : target / "out.kept";
                    DOCTEST_CHECK(run_in(kept) == "new ");
                    DOCTEST_CHECK(said.find(kept.string()) != std::string::npos);
                }
                if (!reached) break;
            }
            if (stranger) DOCTEST_CHECK(failed > 3);
            DOCTEST_CHECK(mixed <= 1);
        }
}

DOCTEST_TEST_CASE("a stage that dies takes with it what was made for it, unless its work was dear") {
    const test::ScratchFolder scratch;
    const auto target = scratch.path() / "a" / "b" / "out";
    { const StagedFolder folder(target, contents); }
    DOCTEST_CHECK_FALSE(fs::exists(scratch.path() / "a"));
    log::set_level(log::Level::Off);
    {
        StagedFolder folder(target, contents);
        folder.keep_on_failure();
        fill(folder, "dear ", 1);
    }
    log::set_level(log::Level::Info);
    DOCTEST_CHECK_FALSE(fs::exists(target));
    DOCTEST_CHECK(run_in(scratch.path() / "a" / "b" / "out.kept") == "dear ");
}

DOCTEST_TEST_CASE("links, read-only files and files of others are refused before the work") {
    const test::ScratchFolder scratch;
    int folders = 0;
    const auto refused = [&](const std::function<void(const fs::path&)>& prepare, const char* word) {
        const auto target = scratch.path() / fmt::format("out{}", ++folders);
        run(target, "old ", 1);
        prepare(target);
        DOCTEST_CHECK_THROWS_WITH_AS(StagedFolder(target, contents), doctest::Contains(word), Error);
        DOCTEST_CHECK(hidden_entries(target) == 0);
    };
    refused(
        [](const fs::path& target) {
            fs::remove(target / "scene.ply"), fs::create_symlink("/x", target / "scene.ply");
        },
        "link");
    refused([](const fs::path& target) { chmod((target / "scene.ply").c_str(), 0444); }, "read-only");
    refused([](const fs::path& target) { chmod((target / "evidence/0.png").c_str(), 0400); }, "read-only");
    refused([](const fs::path& target) { fs::remove(target / "report.json"); }, "no earlier run");
}

DOCTEST_TEST_CASE("a linked folder is written where the link leads, and modes stay") {
    const test::ScratchFolder scratch;
    const auto real = scratch.path() / "disk" / "real", link = scratch.path() / "out";
    fs::create_directories(real);
    chmod(real.c_str(), 0750);
    fs::create_directory_symlink(real, link);
    run(link, "old ", 1);
    chmod((real / "scene.ply").c_str(), 0640);
    run(link, "new ", 1);
    DOCTEST_CHECK(fs::is_symlink(link));
    DOCTEST_CHECK(run_in(real) == "new ");
    struct stat status {};
    stat(real.c_str(), &status);
    DOCTEST_CHECK((status.st_mode & 0777) == 0750);
    stat((real / "scene.ply").c_str(), &status);
    DOCTEST_CHECK((status.st_mode & 0777) == 0640);
    DOCTEST_CHECK_THROWS_AS(StagedFolder(real / "scene.ply", contents), Error);
}

DOCTEST_TEST_CASE(
    "the folder somebody stands in stays the same folder; a hostile report removes nothing outside") {
    const test::ScratchFolder scratch;
    const auto target = scratch.path() / "out";
    run(target, "old ", 3);
    Json report = Json::parse(read_file(target / "report.json"));
    write_file(scratch.path() / "precious", "x");
    for (const char* name : {"../precious", "evidence/../../precious", "/etc/hostname"})
        report["files"][name] = Json::object();
    write_file(target / "report.json", report.dump());
    write_file(target / "notes.txt", "mine");
    struct stat before {
    }, after{};
    stat(target.c_str(), &before);
    const auto here = fs::current_path();
    fs::current_path(target);
    run(".", "new ", 1);
    fs::current_path(here);
    stat(target.c_str(), &after);
    DOCTEST_CHECK(before.st_ino == after.st_ino);
    DOCTEST_CHECK(fs::exists(scratch.path() / "precious"));
    DOCTEST_CHECK(run_in(target, true) == "new ");
}

DOCTEST_TEST_CASE("too little room is said before the work") {
    const test::ScratchFolder scratch;
    const StagedFolder folder(scratch.path() / "out", contents);
    DOCTEST_CHECK_NOTHROW(folder.require_space(1));
    DOCTEST_CHECK_THROWS_WITH_AS(folder.require_space(~std::uint64_t{0}), doctest::Contains("free"), Error);
}

}  // namespace staged_folder_test
