// Showing a folder: the desktop's program is asked, and one that is not there is told.
#include <doctest/doctest.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <string>
#include <thread>

#include "engine/base/desktop.h"
#include "engine/base/error.h"

namespace desktop_test {

using namespace gse;

DOCTEST_TEST_CASE(
    "the folder of a file is shown by xdg-open; without it, or without the folder, an error says so") {
    const auto folder = std::filesystem::temp_directory_path() / ("gse_desktop_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder / "bin");
    const std::string path = std::getenv("PATH") != nullptr ? std::getenv("PATH") : "";
    setenv("PATH", (folder / "bin").c_str(), 1);
    DOCTEST_CHECK_THROWS_WITH_AS(show_folder_of(folder / "a b.png"), doctest::Contains("xdg-open"), Error);
    {
        std::ofstream program(folder / "bin/xdg-open");
        program << "#!/bin/sh\nprintf '%s' \"$1\" >\"" << (folder / "asked.part").string() << "\"\n/bin/mv \""
                << (folder / "asked.part").string() << "\" \"" << (folder / "asked").string() << "\"\n";
    }
    std::filesystem::permissions(folder / "bin/xdg-open", std::filesystem::perms::owner_all);
    show_folder_of(folder / "a b.png");
    for (int i = 0; i < 1000 && !std::filesystem::exists(folder / "asked"); ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    std::ifstream asked(folder / "asked");
    std::string argument((std::istreambuf_iterator<char>(asked)), {});
    DOCTEST_CHECK(argument == folder.string());
    DOCTEST_CHECK_THROWS_WITH_AS(show_folder_of(folder / "none" / "c.png"),
                                 doctest::Contains("the folder is gone"), Error);
    std::filesystem::remove(folder / "asked");
    std::ofstream(folder / "page.html") << "<p>";
    open_document(folder / "page.html");
    for (int i = 0; i < 1000 && !std::filesystem::exists(folder / "asked"); ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    std::ifstream document(folder / "asked");
    argument.assign((std::istreambuf_iterator<char>(document)), {});
    DOCTEST_CHECK(argument == (folder / "page.html").string());
    DOCTEST_CHECK_THROWS_WITH_AS(open_document(folder / "none.html"), doctest::Contains("not there"), Error);
    setenv("PATH", path.c_str(), 1);
    std::filesystem::remove_all(folder);
}

}  // namespace desktop_test
