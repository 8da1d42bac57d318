// Image files. PNG is written here; everything is read by the media library.
#include "engine/io/image/image_file.h"

#include <fmt/core.h>

#include <span>
#include <vector>

#include "engine/base/check.h"
#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/io/bytes/byte_reader.h"
#include "engine/io/bytes/claims.h"
#include "engine/io/bytes/encoding.h"
#include "engine/io/bytes/letter_case.h"
#include "engine/io/image/media.h"
#include "engine/io/image/png.h"

namespace gse {
namespace {

constexpr std::uint64_t BytesPerPixel = 4 + 4 * sizeof(float);  // as decoded and as an Image
constexpr std::size_t HeaderBytes = std::size_t{1} << 20;  // a JPEG's size may come after its preview picture

}  // namespace

Image decode_image(std::span<const std::byte> bytes) {
    if (bytes.empty()) throw Error(ErrorCode::Malformed, "the image file is empty");
    if (const auto size = io::parse_image_size(bytes)) {
        const std::uint64_t pixels =
            static_cast<std::uint64_t>(size->width) * static_cast<std::uint64_t>(size->height);
        io::check_claim(
            {io::saturating_product(pixels, BytesPerPixel), io::saturating_product(bytes.size(), 4)},
            fmt::format("the image of {} x {} pixels", size->width, size->height));
    }
    return io::media().decode(bytes);
}

Image read_image(const std::filesystem::path& path) {
    const FileBytes file(path);
    try {
        return decode_image(file.bytes());
    } catch (const Error& error) { throw Error(error.code(), error.message(), error.hint(), path); }
}

void write_png(const std::filesystem::path& path, const Image& image, const PngText& text) {
    GSE_CHECK(image.channels == 1 || image.channels == 3 || image.channels == 4);
    std::vector<std::uint8_t> bytes(image.data.size());
    for (std::size_t i = 0; i < bytes.size(); ++i)
        bytes[i] = io::to_byte(static_cast<double>(image.data[i]) * 255);
    write_file(path, io::encode_png({image.width, image.height, image.channels, bytes}, text));
}

void write_mask_png(const std::filesystem::path& path, const Mask& mask) {
    std::vector<std::uint8_t> bytes(mask.data.size());
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = mask.data[i] != 0 ? 255 : 0;
    write_file(path, io::encode_png({mask.width, mask.height, 1, bytes}, {}));
}

bool names_png(const std::filesystem::path& path) {
    return io::lower_case(path.extension().string()) == ".png";
}

Mask read_mask(const std::filesystem::path& path) {
    const Image image = read_image(path);
    Mask mask(image.width, image.height);
    const int colours = image.channels >= 3 ? 3 : 1;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            float sum = 0;
            for (int c = 0; c < colours; ++c) sum += image.at(x, y, c);
            mask.at(x, y) = sum > 0.5f * static_cast<float>(colours) ? 1 : 0;
        }
    return mask;
}

PngText read_png_text(const std::filesystem::path& path) {
    return io::parse_png_text(FileBytes(path).bytes());
}

std::optional<ImageSize> read_image_size(const std::filesystem::path& path) {
    const std::string start = read_start(path, HeaderBytes);
    return io::parse_image_size(std::as_bytes(std::span(start)));
}

std::optional<ImageSize> image_size(std::span<const std::byte> bytes) { return io::parse_image_size(bytes); }

}  // namespace gse
