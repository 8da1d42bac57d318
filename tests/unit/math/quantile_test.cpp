// Order statistics.
#include "engine/math/quantile.h"

#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

#include "engine/base/random.h"

using namespace gse;

namespace {

std::vector<double> samples(std::size_t count, std::uint64_t seed) {
    Random random(seed);
    std::vector<double> values(count);
    for (double& value : values) value = random.uniform();
    return values;
}

}  // namespace

DOCTEST_TEST_CASE("an element of each rank is that of the sorted order") {
    for (std::size_t count = 1; count < 20; ++count) {
        auto sorted = samples(count, count);
        std::sort(sorted.begin(), sorted.end());
        for (std::size_t rank = 0; rank < count; ++rank) {
            auto values = samples(count, count);
            DOCTEST_CHECK(element_of_rank(values, rank) == sorted[rank]);
            DOCTEST_CHECK(std::is_permutation(values.begin(), values.end(), sorted.begin()));
        }
    }
}

DOCTEST_TEST_CASE("quantiles reach from the smallest to the largest, and rise with the share") {
    auto values = samples(101, 7);
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    const double smallest = *least, largest = *most;
    DOCTEST_CHECK(nearest_quantile(values, 0) == smallest);
    DOCTEST_CHECK(nearest_quantile(values, 1) == largest);
    double before = -1;
    for (int percent = 0; percent <= 100; ++percent) {
        const double now = nearest_quantile(values, percent / 100.0);
        DOCTEST_CHECK(now >= before);
        DOCTEST_CHECK(lower_quantile(values, percent / 100.0) <= now);
        before = now;
    }
}

DOCTEST_TEST_CASE("quantiles between two ranks: the nearest one, the lower one") {
    std::vector<int> values{40, 10, 30, 20};
    DOCTEST_CHECK(nearest_quantile(values, 0.6) == 30);
    DOCTEST_CHECK(lower_quantile(values, 0.6) == 20);
    DOCTEST_CHECK(upper_median(values) == 30);
    std::vector<float> odd{3, 1, 2};
    DOCTEST_CHECK(upper_median(odd) == 2);
}
