// Comparison of a picture with its baseline by the means of squares of pixels.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include "tests/image_baseline.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "engine/io/image/image_file.h"
#include "tests/test_paths.h"

namespace gse::test {

Image squares_of(const Image& picture, int square) {
    if (square == 1) return picture;
    const int width = (picture.width + square - 1) / square, height = (picture.height + square - 1) / square;
    Image result(width, height, picture.channels);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < picture.channels; ++c) {
                double sum = 0;
                const int bottom = std::min((y + 1) * square, picture.height);
                const int right = std::min((x + 1) * square, picture.width);
                for (int v = y * square; v < bottom; ++v)
                    for (int u = x * square; u < right; ++u) sum += picture.at(u, v, c);
                const int pixels = (bottom - y * square) * (right - x * square);
                result.at(x, y, c) = static_cast<float>(sum / pixels);
            }
    return result;
}

double changed_share(const Image& found, const Image& wanted, const BaselineTolerance& tolerance) {
    if (found.width != wanted.width || found.height != wanted.height || found.channels != wanted.channels)
        return 1;
    const Image left = squares_of(found, tolerance.square), right = squares_of(wanted, tolerance.square);
    std::size_t changed = 0;
    const std::size_t pixels = left.data.size() / static_cast<std::size_t>(left.channels);
    for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
        float most = 0;
        for (int c = 0; c < left.channels; ++c) {
            const std::size_t at =
                pixel * static_cast<std::size_t>(left.channels) + static_cast<std::size_t>(c);
            most = std::max(most, std::abs(left.data[at] - right.data[at]));
        }
        if (most > tolerance.level) ++changed;
    }
    return static_cast<double>(changed) / static_cast<double>(std::max<std::size_t>(pixels, 1));
}

void check_baseline(const std::string& name, const Image& picture, const BaselineTolerance& tolerance,
                    int kept) {
    const auto file = source_folder() / "tests/baselines" / (name + ".png");
    const Image found = squares_of(picture, kept);
    if (std::getenv("GSE_WRITE_BASELINES") != nullptr) {
        std::filesystem::create_directories(file.parent_path());
        write_png(file, found);
        return;
    }
    DOCTEST_REQUIRE_MESSAGE(std::filesystem::exists(file), file.string(), " is missing");
    const BaselineTolerance reduced{std::max(1, tolerance.square / kept), tolerance.level, tolerance.share};
    const double share = changed_share(found, read_image(file), reduced);
    DOCTEST_CAPTURE(name);
    DOCTEST_CHECK(share <= tolerance.share);
    if (share <= tolerance.share) return;
    const auto differing = binary_folder() / "baselines" / (name + ".png");
    std::filesystem::create_directories(differing.parent_path());
    write_png(differing, found);
    DOCTEST_MESSAGE(name, " looks otherwise than its baseline; the new picture is ", differing.string());
}

}  // namespace gse::test
