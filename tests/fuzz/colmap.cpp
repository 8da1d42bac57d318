// Fuzz target: COLMAP models. The first byte says text or binary, the next two where cameras end and images
// begin.
#include "engine/io/cameras/cameras.h"
#include "tests/fuzz/fuzz_helpers.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace gse;
    if (size < 3) return 0;
    const std::span<const std::byte> bytes = fuzz::as_bytes(data + 3, size - 3);
    const std::size_t split = std::min<std::size_t>(data[1] | (data[2] << 8), bytes.size());
    const auto text = [](std::span<const std::byte> part) {
        return std::string_view(reinterpret_cast<const char*>(part.data()), part.size());
    };
    return fuzz::exercise([&] {
        const CameraList list = data[0] % 2 == 0
                                    ? parse_colmap_binary(bytes.first(split), bytes.subspan(split))
                                    : parse_colmap_text(text(bytes.first(split)), text(bytes.subspan(split)));
        for (const View& view : list.views) GSE_CHECK(view.camera.fx > 0 && view.camera.width > 0);
    });
}
