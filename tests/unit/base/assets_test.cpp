// Places where the program finds its own files.
#include "engine/base/assets.h"

#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "tests/test_paths.h"

namespace assets_test {

using namespace gse;

DOCTEST_TEST_CASE(
    "an installed program takes the files installed with it, another one those of its checkout") {
    test::ScratchFolder scratch;
    const auto program = scratch.path() / "usr/bin";
    std::filesystem::create_directories(program);
    DOCTEST_CHECK(assets_beside(program, "/checkout/assets") == "/checkout/assets");
    std::filesystem::create_directories(scratch.path() / "usr/share/gseditpro");
    DOCTEST_CHECK(assets_beside(program, "/checkout/assets") == scratch.path() / "usr/share/gseditpro");
    DOCTEST_CHECK(assets_folder(test::source_folder() / "assets") == test::source_folder() / "assets");
}

}  // namespace assets_test
