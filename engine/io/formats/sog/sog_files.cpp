// Archives of SOG scenes, and their WebP textures by libwebp.
#include "engine/io/formats/sog/sog_files.h"

#include <fmt/core.h>
#include <webp/decode.h>
#include <webp/encode.h>

#include "engine/base/check.h"
#include "engine/base/error.h"
#include "engine/io/bytes/claims.h"

namespace gse::io {
namespace {

constexpr int WebpLevel = 6;  // of 0 (fast) to 9 (small)

}  // namespace

std::unique_ptr<PartFiles> open_sog_archive(std::span<const std::byte> bytes) {
    return open_archive(bytes, "the SOG archive");
}

Texture decode_webp(std::span<const std::byte> bytes, const std::string& name, std::uint64_t stored_bytes) {
    const auto* data = reinterpret_cast<const std::uint8_t*>(bytes.data());
    int width = 0, height = 0;
    const auto fail = [&](const char* what) {
        throw Error(ErrorCode::Malformed, fmt::format("the texture \"{}\" {}", name, what),
                    "the file is cut off or damaged; get it again");
    };
    if (WebPGetInfo(data, bytes.size(), &width, &height) == 0) fail("is not a WebP picture");
    const std::uint64_t texels = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
    check_claim({texels * 4, stored_bytes},
                fmt::format("the texture \"{}\" of {} x {} texels", name, width, height));
    Texture texture;
    texture.width = static_cast<std::size_t>(width);
    texture.height = static_cast<std::size_t>(height);
    texture.rgba.resize(static_cast<std::size_t>(texels) * 4);
    if (WebPDecodeRGBAInto(data, bytes.size(), texture.rgba.data(), texture.rgba.size(), width * 4) ==
        nullptr)
        fail("cannot be decoded");
    return texture;
}

std::string encode_webp(const Texture& texture) {
    WebPConfig config;
    WebPPicture picture;
    GSE_CHECK(WebPConfigInit(&config) != 0 && WebPPictureInit(&picture) != 0);
    GSE_CHECK(WebPConfigLosslessPreset(&config, WebpLevel) != 0);
    config.exact = 1;  // else colours under alpha 0 are changed
    WebPMemoryWriter writer;
    WebPMemoryWriterInit(&writer);
    const std::unique_ptr<WebPPicture, void (*)(WebPPicture*)> free_picture(&picture, WebPPictureFree);
    const std::unique_ptr<WebPMemoryWriter, void (*)(WebPMemoryWriter*)> free_writer(&writer,
                                                                                     WebPMemoryWriterClear);
    picture.use_argb = 1;
    picture.width = static_cast<int>(texture.width);
    picture.height = static_cast<int>(texture.height);
    picture.writer = WebPMemoryWrite;
    picture.custom_ptr = &writer;
    if (WebPPictureImportRGBA(&picture, texture.rgba.data(), picture.width * 4) == 0 ||
        WebPEncode(&config, &picture) == 0)
        throw Error(ErrorCode::Foreign,
                    fmt::format("a texture of {} x {} texels cannot be made (WebP error {})", texture.width,
                                texture.height, static_cast<int>(picture.error_code)));
    return {reinterpret_cast<const char*>(writer.mem), writer.size};
}

}  // namespace gse::io
