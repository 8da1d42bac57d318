// PNG by the encoder of engine/io; decoding by its image reader, after our own look at the header.
#include "engine/remote/picture/picture_codec.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "engine/base/check.h"
#include "engine/base/error.h"
#include "engine/io/image/image_file.h"
#include "engine/io/image/png.h"
#include "engine/remote/picture/base64.h"
#include "engine/remote/picture/picture_header.h"

namespace gse::remote {
namespace {

constexpr std::uint64_t MostTimesThePixels = 4;

std::uint8_t byte_of(float value) {
    return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0f, 1.0f) * 255));
}

std::uint8_t mask_byte(const Image& mask, std::size_t pixel) { return mask.data[pixel] > 0.5f ? 255 : 0; }

std::string png_of(const Image& size, int channels, const std::vector<std::uint8_t>& bytes) {
    return io::encode_png({size.width, size.height, channels, bytes}, {});
}

Error damaged_picture() {
    return {ErrorCode::Malformed, "the picture in the server's answer is damaged",
            "ask again; if it stays so, the server or the network is at fault"};
}

/// Decoded picture of 1, 3 or 4 channels. Libraries know no server: their words are replaced.
Image decoded_picture(std::span<const std::byte> bytes, const PictureHeader& header) {
    Image decoded;
    try {
        decoded = decode_image(bytes);
    } catch (const Error& error) {
        if (error.code() != ErrorCode::Malformed) throw;
        throw damaged_picture();
    }
    if (decoded.width != static_cast<int>(header.width) || decoded.height != static_cast<int>(header.height))
        throw damaged_picture();
    return decoded;
}

/// Colours of a decoded picture of 1, 3 or 4 channels, in steps of 8 bits.
Image as_colours(const Image& decoded, const Image& sent) {
    Image picture(decoded.width, decoded.height, 3);
    const bool same_size = sent.width == decoded.width && sent.height == decoded.height && sent.channels == 3;
    const auto step = static_cast<std::size_t>(decoded.channels);
    for (std::size_t i = 0; i < picture.pixel_count(); ++i) {
        const float* from = decoded.data.data() + i * step;
        const float alpha = step == 4 ? std::clamp(from[3], 0.0f, 1.0f) : 1;
        for (std::size_t c = 0; c < 3; ++c) {
            const float under = same_size ? sent.data[i * 3 + c] : 0;
            const float value = from[step == 1 ? 0 : c] * alpha + under * (1 - alpha);
            picture.data[i * 3 + c] = static_cast<float>(byte_of(value)) / 255;
        }
    }
    return picture;
}

}  // namespace

std::string picture_png(const Image& picture) {
    GSE_CHECK_EQ(picture.channels, 3);
    std::vector<std::uint8_t> bytes(picture.data.size());
    std::transform(picture.data.begin(), picture.data.end(), bytes.begin(), byte_of);
    return png_of(picture, 3, bytes);
}

std::string mask_png(const Image& mask) {
    GSE_CHECK_EQ(mask.channels, 1);
    std::vector<std::uint8_t> bytes(mask.pixel_count());
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = mask_byte(mask, i);
    return png_of(mask, 1, bytes);
}

std::string two_way_mask_png(const Image& mask) {
    GSE_CHECK_EQ(mask.channels, 1);
    std::vector<std::uint8_t> bytes;
    bytes.reserve(mask.pixel_count() * 4);
    for (std::size_t i = 0; i < mask.pixel_count(); ++i) {
        const std::uint8_t inside = mask_byte(mask, i);
        bytes.insert(bytes.end(), {inside, inside, inside, static_cast<std::uint8_t>(255 - inside)});
    }
    return png_of(mask, 4, bytes);
}

std::string picture_with_mask_png(const Image& picture, const Image& mask) {
    GSE_CHECK(picture.channels == 3 && picture.pixel_count() == mask.pixel_count());
    std::vector<std::uint8_t> bytes;
    bytes.reserve(mask.pixel_count() * 4);
    for (std::size_t i = 0; i < mask.pixel_count(); ++i) {
        for (std::size_t c = 0; c < 3; ++c) bytes.push_back(byte_of(picture.data[i * 3 + c]));
        bytes.push_back(static_cast<std::uint8_t>(255 - mask_byte(mask, i)));
    }
    return png_of(picture, 4, bytes);
}

Image received_picture(std::span<const std::byte> bytes, const Image& sent) {
    const PictureLimits limits;
    const auto header = read_picture_header(bytes, limits);
    if (std::uint64_t{header.width} * header.height > MostTimesThePixels * sent.pixel_count())
        throw Error(ErrorCode::Malformed,
                    "the server's picture is many times larger than the one it was sent",
                    "look whether the server enlarges pictures");
    return as_colours(decoded_picture(bytes, header), sent);
}

Image received_picture(const std::string& base64, const Image& sent) {
    return received_picture(base64_decoded(base64), sent);
}

}  // namespace gse::remote
