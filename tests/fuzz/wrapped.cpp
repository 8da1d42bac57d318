// Fuzz target: scenes inside of zip archives, gzip streams and projects of other programs.
#include "tests/fuzz/fuzz_helpers.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace gse;
    return fuzz::exercise([&] { fuzz::exercise_scene(parse_scene(fuzz::as_bytes(data, size), "x.zip")); });
}
