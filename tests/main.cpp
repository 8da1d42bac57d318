// The one doctest main of every test program: what was skipped is said once more at the end and in the exit
// code.
#define DOCTEST_CONFIG_IMPLEMENT
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <cstdlib>

#include "tests/test_paths.h"

int main(int argc, char** argv) {
    setenv("GSE_CACHE_DIR", "/dev/null",
           0);  // what is tested is computed; a test of the cache names a folder
    doctest::Context context(argc, argv);
    const int result = context.run();
    const auto& missing = gse::test::skipped();
    if (context.shouldExit() || result != 0 || missing.empty()) return result;
    std::printf("[skip] %zu checks were left out; the first: %s\n", missing.size(), missing.front().c_str());
    return gse::test::SkipCode;
}
