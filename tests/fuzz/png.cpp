// Fuzz target: the readers of PNG text chunks and of image sizes.
#include "engine/io/image/png.h"
#include "tests/fuzz/fuzz_helpers.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace gse;
    return fuzz::exercise([&] {
        io::parse_png_text(fuzz::as_bytes(data, size));
        if (const auto found = io::parse_image_size(fuzz::as_bytes(data, size)))
            GSE_CHECK(found->width >= 0 && found->height >= 0);
    });
}
