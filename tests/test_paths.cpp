// The paths that the build knows, in one file, so that no other depends on where the checkout is.
#include "tests/test_paths.h"

namespace gse::test {

std::filesystem::path shared_folder() { return from_environment("GSE_SHARED", GSE_SHARED_DEFAULT); }
std::filesystem::path source_folder() { return GSE_SOURCE_DIR; }
std::filesystem::path binary_folder() { return GSE_BINARY_DIR; }

}  // namespace gse::test
