// Quantisers of the writers: few values are kept exactly, many are near their code; nothing depends on
// threads.
#include "engine/io/formats/sog/codebook.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "tests/unit/io/io_helpers.h"

namespace codebook_test {

using namespace gse;
using namespace gse::test;

namespace {

std::vector<float> normal_values(std::size_t count, std::uint64_t seed) {
    Random random(seed);
    std::vector<float> values(count);
    for (float& value : values) value = static_cast<float>(random.normal());
    return values;
}

double mean_squared_error(const std::vector<float>& values, const io::Codebook& codebook) {
    double sum = 0;
    for (const float value : values) {
        const double error = static_cast<double>(value) - codebook.values[codebook.nearest(value)];
        sum += error * error;
    }
    return sum / static_cast<double>(values.size());
}

io::VectorRows rows_of(const std::vector<float>& values, std::size_t dimension) {
    return {values, dimension, 0, dimension, values.size() / dimension};
}

double palette_error(const io::VectorRows& rows, const io::Palette& palette) {
    double sum = 0;
    for (std::size_t row = 0; row < rows.count; ++row)
        for (std::size_t axis = 0; axis < rows.dimension; ++axis) {
            const double error = static_cast<double>(rows.row(row)[axis]) -
                                 palette.entries[palette.labels[row] * rows.dimension + axis];
            sum += error * error;
        }
    return sum / static_cast<double>(rows.count);
}

}  // namespace

DOCTEST_TEST_CASE("a codebook keeps up to 256 different values exactly") {
    for (const std::size_t different : {1u, 2u, 255u, 256u}) {
        std::vector<float> values;
        for (std::size_t i = 0; i < 1000; ++i)
            values.push_back(static_cast<float>((i * 7919) % different) * 0.37f - 9.0f);
        const io::Codebook codebook = io::fit_codebook(values);
        DOCTEST_CHECK(std::is_sorted(codebook.values.begin(), codebook.values.end()));
        for (const float value : values) DOCTEST_REQUIRE(codebook.values[codebook.nearest(value)] == value);
    }
}

DOCTEST_TEST_CASE(
    "a codebook of many values is ascending, nearest finds the nearest, and the error is that of the best "
    "quantiser") {
    const std::vector<float> values = normal_values(20000, 3);
    const io::Codebook codebook = io::fit_codebook(values);
    DOCTEST_CHECK(std::is_sorted(codebook.values.begin(), codebook.values.end()));
    for (std::size_t i = 0; i < 500; ++i) {
        float best = HUGE_VALF;
        for (const float code : codebook.values) best = std::min(best, std::abs(code - values[i]));
        DOCTEST_REQUIRE(std::abs(codebook.values[codebook.nearest(values[i])] - values[i]) == best);
    }
    // Panter and Dite: the best 256 codes of a normal density leave sqrt(3) pi / 2 / 256^2; fitted to a
    // sample, a little less.
    const double best_error = std::sqrt(3.0) * 3.14159265358979 / 2 / 65536;
    DOCTEST_CHECK(mean_squared_error(values, codebook) < 1.05 * best_error);
    DOCTEST_CHECK(mean_squared_error(values, codebook) > 0.5 * best_error);
}

DOCTEST_TEST_CASE("a codebook takes huge and uneven values") {
    std::vector<float> values = normal_values(5000, 4);
    for (std::size_t i = 0; i < 300; ++i) values.push_back(-3e38f + static_cast<float>(i) * 1e36f);
    values.push_back(3e38f);
    const io::Codebook codebook = io::fit_codebook(values);
    DOCTEST_CHECK(std::is_sorted(codebook.values.begin(), codebook.values.end()));
    for (const float code : codebook.values) DOCTEST_CHECK(std::isfinite(code));
    DOCTEST_CHECK(codebook.nearest(HUGE_VALF) == 255);
    DOCTEST_CHECK(codebook.nearest(-HUGE_VALF) == 0);
}

DOCTEST_TEST_CASE(
    "a palette keeps rows exactly where there are no more of them, or of different ones, than entries") {
    ThreadPool pool(2);
    const std::vector<float> few = normal_values(9 * 100, 5);
    const io::Palette own = io::fit_palette(rows_of(few, 9), 128, pool);
    DOCTEST_CHECK(own.size() == 100);
    DOCTEST_CHECK(palette_error(rows_of(few, 9), own) == 0);
    std::vector<float> repeated;
    for (std::size_t i = 0; i < 3000; ++i)
        repeated.insert(repeated.end(), few.begin() + static_cast<std::ptrdiff_t>(i * i % 40 * 9),
                        few.begin() + static_cast<std::ptrdiff_t>(i * i % 40 * 9 + 9));
    for (const std::size_t most : {64u, 1024u}) {
        const io::Palette palette = io::fit_palette(rows_of(repeated, 9), most, pool);
        DOCTEST_CHECK(palette.size() <= most);
        DOCTEST_CHECK(palette_error(rows_of(repeated, 9), palette) <
                      1e-12);  // means of equal rows are rounded
    }
}

DOCTEST_TEST_CASE(
    "a palette of clustered rows finds the clusters, with the same result for one thread and three") {
    constexpr std::size_t Dimension = 24, Clusters = 600, Rows = 12000;
    constexpr double Spread = 0.01;  // of a cluster whose centres are about 1 apart
    Random random(6);
    const std::vector<float> centres = normal_values(Clusters * Dimension, 7);
    std::vector<float> values;
    for (std::size_t row = 0; row < Rows; ++row) {
        const std::size_t cluster = random.below(Clusters);
        for (std::size_t axis = 0; axis < Dimension; ++axis)
            values.push_back(centres[cluster * Dimension + axis] +
                             static_cast<float>(Spread * random.normal()));
    }
    ThreadPool one(1), three(3);
    const io::Palette palette = io::fit_palette(rows_of(values, Dimension), 1024, one);
    const io::Palette again = io::fit_palette(rows_of(values, Dimension), 1024, three);
    DOCTEST_CHECK(palette.entries == again.entries);
    DOCTEST_CHECK(palette.labels == again.labels);
    DOCTEST_CHECK(palette.size() > Clusters);
    DOCTEST_CHECK(palette.size() <= 1024);
    DOCTEST_CHECK(*std::max_element(palette.labels.begin(), palette.labels.end()) < palette.size());
    // Within a cluster the rows differ by Spread per axis; twice that squared is far below the distance of
    // two clusters (48).
    DOCTEST_CHECK(palette_error(rows_of(values, Dimension), palette) < 4 * Dimension * Spread * Spread);
}

DOCTEST_TEST_CASE("a palette reads its vectors out of larger rows") {
    std::vector<float> values;
    for (std::size_t row = 0; row < 50; ++row)
        for (std::size_t i = 0; i < 5; ++i)
            values.push_back(i < 3 ? 1000.0f : static_cast<float>(row * 2 + i));
    ThreadPool pool(1);
    const io::VectorRows rows{values, 5, 3, 2, 50};
    const io::Palette palette = io::fit_palette(rows, 50, pool);
    DOCTEST_CHECK(palette_error(rows, palette) == 0);
    DOCTEST_CHECK(*std::max_element(palette.entries.begin(), palette.entries.end()) < 1000);
}

}  // namespace codebook_test
