// Headers of PNG (chunks up to the pixels), JPEG (segments up to the frame) and WebP (VP8, VP8L, VP8X).
#include "engine/remote/picture/picture_header.h"

#include <array>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "engine/base/error.h"

namespace gse::remote {
namespace {

Error bad_picture(const std::string& why) {
    return {ErrorCode::Malformed, "the picture in the server's answer " + why,
            "ask again; if it stays so, look at the server's output format"};
}

/// Bytes with bounds: everything beyond the end throws.
class Cursor {
public:
    explicit Cursor(std::span<const std::byte> bytes) : bytes_(bytes) {}
    std::size_t left() const { return bytes_.size() - at_; }
    std::string_view take(std::size_t count) {
        if (count > left()) throw bad_picture("is cut off");
        const std::string_view taken(reinterpret_cast<const char*>(bytes_.data()) + at_, count);
        at_ += count;
        return taken;
    }
    std::uint32_t big_endian(std::size_t count) {
        std::uint32_t value = 0;
        for (const char c : take(count)) value = value << 8 | static_cast<unsigned char>(c);
        return value;
    }
    std::uint32_t little_endian(std::size_t count) {
        std::uint32_t value = 0;
        int shift = 0;
        for (const char c : take(count)) {
            value |= static_cast<std::uint32_t>(static_cast<unsigned char>(c)) << shift;
            shift += 8;
        }
        return value;
    }

private:
    std::span<const std::byte> bytes_;
    std::size_t at_ = 0;
};

bool is_png_kind(std::uint32_t depth, std::uint32_t colour) {
    const auto depths = colour == 0   ? std::string_view("\1\2\4\10\20", 5)
                        : colour == 3 ? std::string_view("\1\2\4\10", 4)
                                      : std::string_view("\10\20", 2);
    return (colour == 0 || colour == 2 || colour == 3 || colour == 4 || colour == 6) &&
           depths.find(static_cast<char>(depth)) != std::string_view::npos;
}

PictureHeader png_header(Cursor bytes) {
    bytes.take(8);
    if (bytes.big_endian(4) != 13 || bytes.take(4) != "IHDR") throw bad_picture("is a damaged PNG");
    PictureHeader header{PictureFormat::Png, bytes.big_endian(4), bytes.big_endian(4)};
    const auto depth = bytes.big_endian(1), colour = bytes.big_endian(1);
    if (!is_png_kind(depth, colour) || bytes.big_endian(2) != 0 || bytes.big_endian(1) > 1)
        throw bad_picture("is a PNG of an unknown kind");
    bytes.take(4);
    while (bytes.left() >= 12) {
        const auto size = bytes.big_endian(4);
        const auto type = bytes.take(4);
        if (type == "acTL") throw bad_picture("is an animation");
        if (type == "IDAT") return header;
        bytes.take(size);
        bytes.take(4);
    }
    throw bad_picture("is a PNG without pixels");
}

PictureHeader jpeg_header(Cursor bytes) {
    bytes.take(2);
    while (true) {
        if (bytes.big_endian(1) != 0xff) throw bad_picture("is a damaged JPEG");
        auto marker = bytes.big_endian(1);
        while (marker == 0xff) marker = bytes.big_endian(1);
        if (marker == 0xd9 || marker == 0xda || marker == 0) throw bad_picture("is a JPEG without a frame");
        const auto size = bytes.big_endian(2);
        if (size < 2) throw bad_picture("is a damaged JPEG");
        const bool frame =
            marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
        if (!frame) {
            bytes.take(size - 2);
            continue;
        }
        if (bytes.big_endian(1) != 8) throw bad_picture("is a JPEG of another depth than 8 bits");
        const auto height = bytes.big_endian(2), width = bytes.big_endian(2);
        return {PictureFormat::Jpeg, width, height};
    }
}

PictureHeader webp_header(Cursor bytes) {
    bytes.take(12);
    const auto type = bytes.take(4);
    bytes.take(4);
    if (type == "VP8X") {
        const auto flags = bytes.little_endian(1);
        bytes.take(3);
        if ((flags & 2) != 0) throw bad_picture("is an animation");
        const auto width = bytes.little_endian(3) + 1, height = bytes.little_endian(3) + 1;
        return {PictureFormat::Webp, width, height};
    }
    if (type == "VP8L") {
        if (bytes.big_endian(1) != 0x2f) throw bad_picture("is a damaged WebP");
        const auto bits = bytes.little_endian(4);
        return {PictureFormat::Webp, (bits & 0x3fff) + 1, (bits >> 14 & 0x3fff) + 1};
    }
    if (type != "VP8 ") throw bad_picture("is a WebP of an unknown kind");
    bytes.take(3);
    if (bytes.take(3) != "\x9d\x01\x2a") throw bad_picture("is a damaged WebP");
    const auto width = bytes.little_endian(2) & 0x3fff, height = bytes.little_endian(2) & 0x3fff;
    return {PictureFormat::Webp, width, height};
}

std::optional<PictureFormat> format_of(std::string_view start) {
    if (start.starts_with(std::string_view("\x89PNG\r\n\x1a\n", 8))) return PictureFormat::Png;
    if (start.starts_with("\xff\xd8\xff")) return PictureFormat::Jpeg;
    if (start.size() >= 12 && start.starts_with("RIFF") && start.substr(8, 4) == "WEBP")
        return PictureFormat::Webp;
    return std::nullopt;
}

PictureHeader header_of(std::span<const std::byte> bytes) {
    const std::string_view start(reinterpret_cast<const char*>(bytes.data()),
                                 std::min<std::size_t>(bytes.size(), 16));
    const auto format = format_of(start);
    if (!format) throw bad_picture("is no PNG, JPEG or WebP");
    switch (*format) {
        case PictureFormat::Png: return png_header(Cursor(bytes));
        case PictureFormat::Jpeg: return jpeg_header(Cursor(bytes));
        case PictureFormat::Webp: return webp_header(Cursor(bytes));
    }
    return {};
}

}  // namespace

PictureHeader read_picture_header(std::span<const std::byte> bytes, const PictureLimits& limits) {
    const auto header = header_of(bytes);
    if (header.width == 0 || header.height == 0) throw bad_picture("has no pixels");
    const std::uint64_t pixels = std::uint64_t{header.width} * header.height;
    if (header.width > limits.side || header.height > limits.side || pixels > limits.pixels)
        throw bad_picture(fmt::format("is too large ({} x {})", header.width, header.height));
    return header;
}

}  // namespace gse::remote
