// Arrays by the line: where they begin, and that they keep what is in them.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <cstdint>
#include <numeric>

#include "engine/base/aligned.h"

using namespace gse;

DOCTEST_TEST_CASE("arrays of lines begin at a line, small and large, and keep what is in them when they grow") {
    LineFloats values;
    for (const std::size_t count : {1u, 15u, 4096u, 3000000u, 3000001u}) {
        const std::size_t before = values.size();
        values.resize(count);
        std::iota(values.begin() + static_cast<std::ptrdiff_t>(before), values.end(), static_cast<float>(before));
        DOCTEST_CHECK(reinterpret_cast<std::uintptr_t>(values.data()) % CacheLine == 0);
        bool kept = true;
        for (std::size_t i = 0; i < count; ++i) kept = kept && values[i] == static_cast<float>(i);
        DOCTEST_CHECK(kept);
    }
    const LineFloats copy = values;
    DOCTEST_CHECK(copy == values);
}

DOCTEST_TEST_CASE("a vector that grows in large pages keeps what is in it") {
    std::vector<float> values{1, 2, 3};
    resize_large(values, 5000000);   // 20 MB: new memory that does not begin at a large page
    DOCTEST_CHECK(values[2] == 3);
    DOCTEST_CHECK(values[3] == 0);
    DOCTEST_CHECK(values.back() == 0);
    const float* at = values.data();
    resize_large(values, 10);
    reserve_large(values, 100);
    DOCTEST_CHECK(values.size() == 10);
    DOCTEST_CHECK(values.data() == at);
}
