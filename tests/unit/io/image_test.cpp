// Image and video files: values survive, text travels, films are real files and appear whole or not at all.
#include <cmath>
#include <limits>

#include "engine/io/image/image_file.h"
#include "engine/io/image/video.h"
#include "tests/test_paths.h"
#include "tests/unit/io/io_helpers.h"

namespace image_test {

using namespace gse;
using namespace gse::test;

namespace {

constexpr double ByteStep = 0.5 / 255 + 1e-6;

Image random_image(int width, int height, int channels, std::uint64_t seed) {
    Random random(seed);
    Image image(width, height, channels);
    for (float& value : image.data) value = static_cast<float>(random.uniform());
    return image;
}

bool reads_images() {
#ifdef GSE_HAVE_OPENCV
    return true;
#else
    test::skip("built without OpenCV");
    return false;
#endif
}

}  // namespace

DOCTEST_TEST_CASE("PNG round trip in grey, colour and with alpha") {
    if (!reads_images()) return;
    ScratchFolder scratch;
    for (const int channels : {1, 3, 4})
        for (const int width : {1, 7, 64}) {
            const Image image =
                random_image(width, 9, channels, static_cast<std::uint64_t>(width * channels));
            write_png(scratch.path() / "a.png", image);
            const Image again = read_image(scratch.path() / "a.png");
            DOCTEST_CHECK(again.width == width);
            DOCTEST_CHECK(again.height == 9);
            DOCTEST_REQUIRE(again.channels == channels);
            DOCTEST_CHECK(largest_difference(image.data, again.data) <= ByteStep);
            write_png(scratch.path() / "b.png", again);
            DOCTEST_CHECK(read_file(scratch.path() / "a.png") == read_file(scratch.path() / "b.png"));
        }
}

DOCTEST_TEST_CASE("values outside of [0,1] are clamped, NaN is black") {
    if (!reads_images()) return;
    ScratchFolder scratch;
    Image image(4, 1, 1);
    image.data = {-1, 2, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()};
    write_png(scratch.path() / "a.png", image);
    DOCTEST_CHECK(read_image(scratch.path() / "a.png").data == std::vector<float>{0, 1, 0, 1});
}

DOCTEST_TEST_CASE("text chunks travel, ASCII and not") {
    ScratchFolder scratch;
    const PngText text = {{"prompt", "a golden statue"},
                          {"title", "Früh — 貝殻"},
                          {"long", std::string(5000, 'x')},
                          {"empty", ""}};
    write_png(scratch.path() / "a.png", random_image(5, 5, 3, 1), text);
    DOCTEST_CHECK(read_png_text(scratch.path() / "a.png") == text);
    const auto size = read_image_size(scratch.path() / "a.png");
    DOCTEST_REQUIRE(size.has_value());
    DOCTEST_CHECK(size->width == 5);
    if (!reads_images()) return;
    DOCTEST_CHECK(read_image(scratch.path() / "a.png").channels == 3);
}

DOCTEST_TEST_CASE("masks round trip") {
    if (!reads_images()) return;
    ScratchFolder scratch;
    Mask mask(9, 5);
    for (std::size_t i = 0; i < mask.data.size(); i += 3) mask.data[i] = 1;
    write_mask_png(scratch.path() / "m.png", mask);
    DOCTEST_CHECK(read_mask(scratch.path() / "m.png").data == mask.data);
}

DOCTEST_TEST_CASE("photographs are read; their size without decoding") {
    const auto photo = data_folder() / "photos/sam_dog.jpg";
    if (!available(photo) || !reads_images()) return;
    const Image image = read_image(photo);
    const auto size = read_image_size(photo);
    DOCTEST_REQUIRE(size.has_value());
    DOCTEST_CHECK(size->width == image.width);
    DOCTEST_CHECK(size->height == image.height);
    DOCTEST_CHECK(image.channels == 3);
}

DOCTEST_TEST_CASE("files that are no images give Error") {
    ScratchFolder scratch;
    write_file(scratch.path() / "a.png", "hello");
    write_file(scratch.path() / "b.png", "");
    DOCTEST_CHECK(error_of([&] { read_image(scratch.path() / "a.png"); }));
    DOCTEST_CHECK(error_of([&] { read_image(scratch.path() / "b.png"); }));
    DOCTEST_CHECK(error_of([&] { read_image(scratch.path() / "c.png"); }));
    DOCTEST_CHECK(error_of([&] { write_png("/proc/none/a.png", Image(1, 1, 1)); }));
    DOCTEST_CHECK(!read_image_size(scratch.path() / "a.png").has_value());
}

DOCTEST_TEST_CASE("a film is written whole or not at all") {
    if (!reads_images()) return;
    ScratchFolder scratch;
    const auto path = scratch.path() / "sub/film.mp4";
    {
        VideoWriter abandoned(path, 64, 48, 25);
        abandoned.add(random_image(64, 48, 3, 1));
    }
    DOCTEST_CHECK(std::filesystem::is_empty(scratch.path() / "sub"));
    VideoWriter writer(path, 65, 47, 25);
    for (std::uint64_t i = 0; i < 10; ++i) writer.add(random_image(65, 47, 3, i));
    DOCTEST_CHECK(!std::filesystem::exists(path));
    writer.finish();
    DOCTEST_REQUIRE(std::filesystem::exists(path));
    const std::string bytes = read_file(path);
    DOCTEST_CHECK(bytes.size() > 1000);
    DOCTEST_CHECK(bytes.find("ftyp") == 4);
    DOCTEST_CHECK(writer.codec().size() == 4);
    DOCTEST_CHECK(error_of([] { VideoWriter nowhere("/proc/none/a.mp4", 64, 64, 25); }));
    DOCTEST_CHECK(error_of([&] { VideoWriter tiny(scratch.path() / "a.mp4", 1, 64, 25); }));
}

DOCTEST_TEST_CASE("the same frames give the same film") {
    if (!reads_images()) return;
    ScratchFolder scratch;
    for (const char* name : {"a.mp4", "b.mp4"}) {
        VideoWriter writer(scratch.path() / name, 64, 64, 25);
        for (std::uint64_t i = 0; i < 5; ++i) writer.add(random_image(64, 64, 3, i));
        writer.finish();
    }
    DOCTEST_CHECK(read_file(scratch.path() / "a.mp4") == read_file(scratch.path() / "b.mp4"));
}

}  // namespace image_test
