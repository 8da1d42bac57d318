// The radix sort: order, stability, and the same result for any number of threads.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>

#include "engine/base/random.h"
#include "engine/raster/depth_sort.h"

namespace depth_sort_test {

using namespace gse;
using namespace gse::raster;

DOCTEST_TEST_CASE("depth sort is stable and right") {
    for (const unsigned threads : {1u, 3u}) {
        ThreadPool pool(threads);
        DepthSort sort(pool);
        for (const std::size_t count : {0u, 1u, 2u, 1000u, 150000u}) {
            for (const std::uint64_t spread : {1ull, 50ull, 0xffffffffull}) {
                Random random(count + spread);
                auto& items = sort.items(count);
                std::vector<DepthSort::Item> expected(count);
                for (std::size_t i = 0; i < count; ++i) {
                    const std::uint32_t key =
                        static_cast<std::uint32_t>(random.below(spread) * (0xffffffffull / spread));
                    expected[i] = items[i] = {key, static_cast<std::uint32_t>(i)};
                }
                std::stable_sort(
                    expected.begin(), expected.end(),
                    [](const DepthSort::Item& a, const DepthSort::Item& b) { return a.key < b.key; });
                const auto& order = sort.sort(count);
                bool same = true;
                for (std::size_t i = 0; i < count; ++i) same = same && order[i] == expected[i].index;
                DOCTEST_CHECK(same);
            }
        }
    }
}

}  // namespace depth_sort_test
