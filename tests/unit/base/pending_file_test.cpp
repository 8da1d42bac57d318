// New versions of files appear whole or not at all, whatever fails; links, modes and read-only files are
// respected.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>
#include <fmt/core.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/path_text.h"
#include "engine/base/pending_file.h"
#include "tests/test_paths.h"

namespace pending_file_test {

using namespace gse;
namespace fs = std::filesystem;

namespace {

std::size_t entries_of(const fs::path& folder) {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

mode_t mode_of(const fs::path& path) {
    struct stat status {};
    DOCTEST_REQUIRE(stat(path.c_str(), &status) == 0);
    return status.st_mode & 07777;
}

/// Files may not grow beyond this while the object lives: a disk that is full at that point.
class FullDisk {
public:
    explicit FullDisk(rlim_t bytes) {
        signal(SIGXFSZ, SIG_IGN);
        getrlimit(RLIMIT_FSIZE, &before_);
        const rlimit limit{bytes, before_.rlim_max};
        setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FullDisk() { setrlimit(RLIMIT_FSIZE, &before_); }

private:
    rlimit before_{};
};

/// A process that holds a half-written file until it is killed.
pid_t start_writer(const fs::path& path) {
    int ends[2] = {-1, -1};
    DOCTEST_REQUIRE(pipe(ends) == 0);
    const pid_t writer = fork();
    if (writer == 0) {
        PendingFile file(path);
        file.write("half");
        static_cast<void>(!write(ends[1], "x", 1));
        for (;;) pause();
    }
    char ready = 0;
    DOCTEST_REQUIRE(read(ends[0], &ready, 1) == 1);
    close(ends[0]);
    close(ends[1]);
    return writer;
}

}  // namespace

DOCTEST_TEST_CASE("a write that fails half-way leaves the old file and nothing else, and says why") {
    const test::ScratchFolder folder;
    const auto path = folder.path() / "a.bin";
    write_file(path, "old");
    const std::string large(100000, 'x');
    {
        const FullDisk full(50000);
        DOCTEST_CHECK_THROWS_WITH_AS(write_file(path, large), doctest::Contains("File too large"), Error);
    }
    DOCTEST_CHECK(read_file(path) == "old");
    DOCTEST_CHECK(entries_of(folder.path()) == 1);
    write_file(path, large);
    DOCTEST_CHECK(read_file(path) == large);
}

DOCTEST_TEST_CASE("the mode of a file that is replaced stays") {
    const test::ScratchFolder folder;
    const auto path = folder.path() / "a.bin";
    for (const mode_t mode : {0600, 0640, 0755}) {
        write_file(path, "old");
        DOCTEST_REQUIRE(chmod(path.c_str(), mode) == 0);
        write_file(path, "new");
        DOCTEST_CHECK(mode_of(path) == mode);
        DOCTEST_CHECK(read_file(path) == "new");
    }
}

DOCTEST_TEST_CASE("a link is followed and stays a link") {
    const test::ScratchFolder folder;
    const auto real = folder.path() / "elsewhere" / "real.bin", link = folder.path() / "link.bin";
    write_file(real, "old");
    fs::create_symlink("elsewhere/real.bin", link);
    write_file(link, "new");
    DOCTEST_CHECK(fs::is_symlink(link));
    DOCTEST_CHECK(read_file(real) == "new");
    const auto dangling = folder.path() / "dangling.bin";
    fs::create_symlink(folder.path() / "elsewhere" / "later.bin", dangling);
    write_file(dangling, "made");
    DOCTEST_CHECK(read_file(folder.path() / "elsewhere" / "later.bin") == "made");
    DOCTEST_CHECK(entries_of(folder.path() / "elsewhere") == 2);
    fs::create_symlink("round.bin", folder.path() / "round.bin");
    DOCTEST_CHECK_THROWS_AS(write_file(folder.path() / "round.bin", "x"), Error);
}

DOCTEST_TEST_CASE("read-only files, folders and pipes are refused") {
    const test::ScratchFolder folder;
    const auto read_only = folder.path() / "a.bin", pipe_path = folder.path() / "pipe";
    write_file(read_only, "old");
    DOCTEST_REQUIRE(chmod(read_only.c_str(), 0444) == 0);
    DOCTEST_CHECK_THROWS_WITH_AS(write_file(read_only, "new"), doctest::Contains("read-only"), Error);
    DOCTEST_CHECK(read_file(read_only) == "old");
    DOCTEST_REQUIRE(mkfifo(pipe_path.c_str(), 0600) == 0);
    DOCTEST_CHECK_THROWS_WITH_AS(write_file(pipe_path, "x"), doctest::Contains("pipe"), Error);
    DOCTEST_CHECK_THROWS_WITH_AS(read_file(pipe_path), doctest::Contains("pipe"),
                                 Error);  // and does not wait
    DOCTEST_CHECK_THROWS_WITH_AS(read_file("/dev/zero"), doctest::Contains("device"), Error);
    DOCTEST_CHECK_THROWS_WITH_AS(write_file("/dev/full", "x"), doctest::Contains("device"), Error);
    DOCTEST_CHECK_THROWS_WITH_AS(write_file(folder.path(), "x"), doctest::Contains("folder"), Error);
    DOCTEST_CHECK(fs::is_character_file("/dev/full"));
}

DOCTEST_TEST_CASE("names of 255 bytes and names that are not UTF-8 work") {
    const test::ScratchFolder folder;
    const std::vector<std::string> names{fmt::format("{:n>255}", ".bin"), "b\xe4r\xff.bin"};
    for (const auto& name : names) {
        write_file(folder.path() / name, name);
        DOCTEST_CHECK(read_file(folder.path() / name) == name);
    }
    DOCTEST_CHECK(entries_of(folder.path()) == 2);
}

DOCTEST_TEST_CASE("what a killed writer left is removed at once, what a living one writes is not") {
    const test::ScratchFolder folder;
    const pid_t writer = start_writer(folder.path() / "a.bin");
    DOCTEST_CHECK(entries_of(folder.path()) == 1);
    remove_stale_temporaries(folder.path());
    DOCTEST_CHECK(entries_of(folder.path()) == 1);
    kill(writer, SIGKILL);
    waitpid(writer, nullptr, 0);
    remove_stale_temporaries(folder.path());
    DOCTEST_CHECK(entries_of(folder.path()) == 0);
}

DOCTEST_TEST_CASE("names that are not UTF-8 go through JSON and back") {
    for (const std::string name :
         {"/a/b.ply", "", "/tmp/b\xe4r 100%.ply", "/b\xc3\xa4r.ply", "file:strange", "rel\xff"}) {
        const std::string text = text_of_path(name);
        DOCTEST_CHECK(is_utf8(text));
        DOCTEST_CHECK(path_of_text(text) == name);
    }
    DOCTEST_CHECK(text_of_path("/b\xc3\xa4r.ply") == "/b\xc3\xa4r.ply");
    DOCTEST_CHECK(path_of_text("file:///tmp/b%E4r.ply") == "/tmp/b\xe4r.ply");
    DOCTEST_CHECK(path_of_text("file:/a%zz%4") == "/a%zz%4");
    DOCTEST_CHECK(is_utf8(json_text(nlohmann::ordered_json{{"a", "b\xff"}}, -1)));
}

}  // namespace pending_file_test
