// Pictures of servers: headers, depths, transparency, and what is refused before it is decoded.
#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#ifdef GSE_HAVE_OPENCV
#include <opencv2/imgcodecs.hpp>
#endif

#include "engine/base/error.h"
#include "engine/io/image/png.h"
#include "engine/remote/picture/picture_codec.h"
#include "engine/remote/picture/picture_header.h"

namespace gse::remote {
namespace {

std::span<const std::byte> bytes_of(const std::string& text) { return std::as_bytes(std::span(text)); }

PictureHeader header_of(const std::string& file) { return read_picture_header(bytes_of(file), {}); }

Image ramp(int width, int height) {
    Image picture(width, height, 3);
    for (std::size_t i = 0; i < picture.data.size(); ++i) picture.data[i] = static_cast<float>(i % 256) / 255;
    return picture;
}

std::string png_chunk(const std::string& type, const std::string& content) {
    std::string size(4, '\0');
    for (std::size_t i = 0; i < 4; ++i) size[i] = static_cast<char>(content.size() >> (24 - 8 * i));
    return size + type + content + std::string(4, '\0');
}

std::string png_start(const std::string& size_depth_kind) {
    return std::string("\x89PNG\r\n\x1a\n", 8) + png_chunk("IHDR", size_depth_kind);
}

DOCTEST_TEST_CASE("a picture comes back from its PNG in steps of 8 bits") {
    const auto picture = ramp(64, 128);
    const auto file = picture_png(picture);
    DOCTEST_CHECK(header_of(file).width == 64);
    DOCTEST_CHECK(header_of(file).height == 128);
    DOCTEST_CHECK(received_picture(bytes_of(file), picture).data == picture.data);
}

DOCTEST_TEST_CASE("masks are 0 or 255, and the two-way mask is transparent where it is white") {
    Image mask(2, 1, 1), black(2, 1, 3);
    mask.data = {0.4f, 0.6f};
    const auto grey = received_picture(bytes_of(mask_png(mask)), black);
    DOCTEST_CHECK(grey.at(0, 0, 0) == 0);
    DOCTEST_CHECK(grey.at(1, 0, 0) == 1);
    Image white(2, 1, 3, 1);
    const auto both = received_picture(bytes_of(two_way_mask_png(mask)), ramp(2, 1));
    DOCTEST_CHECK(both.at(0, 0, 0) == 0);                       // opaque black
    DOCTEST_CHECK(both.at(1, 0, 0) == ramp(2, 1).at(1, 0, 0));  // shows what is below
    const auto holes = received_picture(bytes_of(picture_with_mask_png(white, mask)), black);
    DOCTEST_CHECK(holes.at(0, 0, 1) == 1);
    DOCTEST_CHECK(holes.at(1, 0, 1) == 0);
}

DOCTEST_TEST_CASE("headers of PNG that lie are refused") {
    const std::string good("\0\0\0\x40\0\0\0\x40\x08\x02\0\0\0", 13);
    DOCTEST_CHECK(header_of(png_start(good) + png_chunk("IDAT", "")).width == 64);
    for (const auto& header : {std::string("\0\0\0\0\0\0\0\x40\x08\x02\0\0\0", 13),
                               std::string("\0\0\xff\xff\0\0\xff\xff\x08\x02\0\0\0", 13),
                               std::string("\xff\xff\xff\xff\0\0\0\1\x08\x02\0\0\0", 13),
                               std::string("\0\0\0\x40\0\0\0\x40\x07\x02\0\0\0", 13),
                               std::string("\0\0\0\x40\0\0\0\x40\x08\x05\0\0\0", 13),
                               std::string("\0\0\0\x40\0\0\0\x40\x08\x02\1\0\0", 13),
                               std::string("\0\0\0\x40\0\0\0\x40\x08\x02\0\0\2", 13),
                               std::string("\0\0\x10\1\0\0\0\1\x08\x02\0\0\0", 13)})
        DOCTEST_CHECK_THROWS_AS(header_of(png_start(header) + png_chunk("IDAT", "")), Error);
    DOCTEST_CHECK_THROWS_AS(header_of(png_start(good)), Error);
    DOCTEST_CHECK_THROWS_AS(header_of(png_start(good) + png_chunk("acTL", "x") + png_chunk("IDAT", "")),
                            Error);
    DOCTEST_CHECK_THROWS_AS(header_of(png_start(good) + std::string("\xff\xff\xff\xffIDAx", 8)), Error);
}

DOCTEST_TEST_CASE("every beginning of a file is refused or read, and none is read beyond its end") {
    const auto file = picture_png(ramp(16, 16));
    for (std::size_t size = 0; size < 58; ++size) {
        const std::vector<std::byte> part(bytes_of(file).begin(),
                                          bytes_of(file).begin() + static_cast<long>(size));
        DOCTEST_CHECK_THROWS_AS(read_picture_header(part, {}), Error);
    }
}

DOCTEST_TEST_CASE("other formats are refused by their signature") {
    for (const auto& file : {std::string("GIF89a\x10\0\x10\0", 10), std::string("BM\0\0\0\0", 6),
                             std::string("<svg/>"), std::string("II*\0", 4), std::string("\x76\x2f\x31\x01"),
                             std::string(), std::string("RIFF\0\0\0\0WAVEfmt ", 16)})
        DOCTEST_CHECK_THROWS_AS(header_of(file), Error);
}

DOCTEST_TEST_CASE("headers of JPEG and WebP tell size and animation") {
    const std::string jpeg("\xff\xd8\xff\xe0\0\4ab\xff\xc2\0\x0b\x08\0\x20\0\x30\1\1\x11\0", 21);
    DOCTEST_CHECK(header_of(jpeg).width == 48);
    DOCTEST_CHECK(header_of(jpeg).height == 32);
    DOCTEST_CHECK_THROWS_AS(header_of(std::string("\xff\xd8\xff\xda\0\4ab", 8)), Error);
    DOCTEST_CHECK_THROWS_AS(header_of(std::string("\xff\xd8\xff\xe0\0\1", 6)), Error);
    const std::string riff("RIFF\0\0\0\0WEBP", 12);
    const std::string extended("VP8X\x0a\0\0\0\0\0\0\0\x3f\0\0\x1f\0\0", 18);
    DOCTEST_CHECK(header_of(riff + extended).width == 64);
    DOCTEST_CHECK(header_of(riff + extended).height == 32);
    auto moving = extended;
    moving[8] = 2;
    DOCTEST_CHECK_THROWS_AS(header_of(riff + moving), Error);
    DOCTEST_CHECK(header_of(riff + std::string("VP8L\0\0\0\0\x2f\x3f\xc0\x07\0", 13)).width == 64);
    DOCTEST_CHECK_THROWS_AS(header_of(riff + "VP8Q1234567890"), Error);
}

DOCTEST_TEST_CASE("pictures many times larger than the one sent are refused before they are decoded") {
    const auto file = picture_png(ramp(128, 128));
    DOCTEST_CHECK(received_picture(bytes_of(file), ramp(64, 64)).width == 128);
    DOCTEST_CHECK_THROWS_AS(received_picture(bytes_of(file), ramp(32, 64)), Error);
}

#ifdef GSE_HAVE_OPENCV
std::string encoded(const char* extension, const cv::Mat& picture, const std::vector<int>& settings = {}) {
    std::vector<unsigned char> file;
    cv::imencode(extension, picture, file, settings);
    return {file.begin(), file.end()};
}

DOCTEST_TEST_CASE("JPEG and WebP as libraries write them are taken") {
    cv::Mat orange(64, 64, CV_8UC3, cv::Scalar(30, 120, 240));
    const auto sent = ramp(64, 64);
    for (const auto& file :
         {encoded(".jpg", orange), encoded(".jpg", orange, {cv::IMWRITE_JPEG_PROGRESSIVE, 1}),
          encoded(".webp", orange), encoded(".webp", orange, {cv::IMWRITE_WEBP_QUALITY, 101})}) {
        const auto picture = received_picture(bytes_of(file), sent);
        DOCTEST_CHECK(picture.width == 64);
        DOCTEST_CHECK(std::abs(picture.at(9, 9, 0) * 255 - 240) < 6);
        DOCTEST_CHECK(std::abs(picture.at(9, 9, 2) * 255 - 30) < 6);
        DOCTEST_CHECK_THROWS_AS(received_picture(bytes_of(file.substr(0, 30)), sent), Error);
    }
    for (const char* extension : {".bmp", ".tiff"})
        DOCTEST_CHECK_THROWS_AS(received_picture(bytes_of(encoded(extension, orange)), sent), Error);
}

DOCTEST_TEST_CASE("a turn that EXIF asks for is not made") {
    cv::Mat wide(32, 64, CV_8UC3, cv::Scalar(30, 120, 240));
    auto file = encoded(".jpg", wide);
    const std::string exif(
        "\xff\xe1\0\x22"
        "Exif\0\0MM\0*\0\0\0\x08\0\1\x01\x12\0\3\0\0\0\1\0\6\0\0\0\0\0\0",
        36);
    file.insert(2, exif);
    const auto picture = received_picture(bytes_of(file), ramp(64, 64));
    DOCTEST_CHECK(picture.width == 64);
    DOCTEST_CHECK(picture.height == 32);
}

/// JPEG of one block of 8 x 8 in four inks, all at half.
std::string cmyk_jpeg() {
    const auto marker = [](char kind, const std::string& content) {
        const auto size = content.size() + 2;
        return std::string{'\xff', kind, static_cast<char>(size >> 8), static_cast<char>(size)} + content;
    };
    const std::string one_code("\1\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0", 17);  // of length 1, for 0
    std::string frame("\x08\0\x08\0\x08\x04", 6), scan("\x04");
    for (char ink = 1; ink <= 4; ++ink) {
        frame += std::string{ink, '\x11', '\0'};
        scan += std::string{ink, '\0'};
    }
    return "\xff\xd8" + marker('\xdb', std::string(1, '\0') + std::string(64, '\1')) + marker('\xc0', frame) +
           marker('\xc4', std::string(1, '\0') + one_code) + marker('\xc4', "\x10" + one_code) +
           marker('\xda', scan + std::string("\0\x3f\0", 3)) + std::string("\0\xff\xd9", 3);
}

DOCTEST_TEST_CASE("a JPEG in four inks becomes colours") {
    const auto picture = received_picture(bytes_of(cmyk_jpeg()), ramp(64, 64));
    DOCTEST_REQUIRE(picture.width == 8);
    DOCTEST_CHECK(picture.channels == 3);
    DOCTEST_CHECK(std::abs(picture.at(3, 3, 0) - picture.at(3, 3, 2)) < 0.02);
    DOCTEST_CHECK(picture.at(3, 3, 0) > 0.1);
    DOCTEST_CHECK(picture.at(3, 3, 0) < 0.6);
}

DOCTEST_TEST_CASE("16 bits become 8") {
    cv::Mat deep(8, 8, CV_16UC3, cv::Scalar(257 * 10, 257 * 20, 257 * 30));
    const auto picture = received_picture(bytes_of(encoded(".png", deep)), ramp(64, 64));
    DOCTEST_CHECK(picture.at(0, 0, 0) == 30.0f / 255);
    DOCTEST_CHECK(picture.at(0, 0, 2) == 10.0f / 255);
}
#endif

}  // namespace
}  // namespace gse::remote
