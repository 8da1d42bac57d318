// Temporary files that dead writers left are removed; those of living or recent ones are not.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>
#include <fmt/core.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>

#include "engine/base/file.h"
#include "tests/test_paths.h"

namespace temporaries_test {

using namespace gse;

DOCTEST_TEST_CASE("temporary files of dead writers are removed once they are old") {
    const test::ScratchFolder folder;
    const pid_t dead = fork();
    if (dead == 0) _exit(0);
    waitpid(dead, nullptr, 0);
    const auto make = [&](const std::string& name, std::chrono::minutes age) {
        const auto path = folder.path() / name;
        write_file(path, "x");
        std::filesystem::last_write_time(path, std::filesystem::file_time_type::clock::now() - age);
        return path;
    };
    using std::chrono::minutes;
    const auto stale = make(fmt::format(".work.tmp{}-3.gsep", dead), minutes(5));
    const auto stale_bare = make(fmt::format(".work.tmp{}-0", dead), minutes(5));
    const auto recent = make(fmt::format(".work.tmp{}-4.gsep", dead), minutes(0));
    const auto alive = make(fmt::format(".work.tmp{}-3.gsep", getpid()), minutes(5));
    const auto other = make(fmt::format("work.tmp{}-3.gsep", dead), minutes(5));
    const auto strange = make(".tmp-notes", minutes(5));
    const auto longer = make(fmt::format(".work.tmp{}-3x.gsep", dead), minutes(5));
    remove_stale_temporaries(folder.path());
    remove_stale_temporaries(folder.path() / "nowhere");
    DOCTEST_CHECK_FALSE(std::filesystem::exists(stale));
    DOCTEST_CHECK_FALSE(std::filesystem::exists(stale_bare));
    for (const auto& path : {recent, alive, other, strange, longer})
        DOCTEST_CHECK(std::filesystem::exists(path));
}

}  // namespace temporaries_test
