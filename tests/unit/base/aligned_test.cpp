// Arrays by the line: where they begin, and that they keep what is in them.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <cstdint>
#include <numeric>

#include "engine/base/aligned.h"

namespace aligned_test {

using namespace gse;

DOCTEST_TEST_CASE(
    "arrays of lines begin at a line, small and large, and keep what is in them when they grow") {
    LineFloats values;
    for (const std::size_t count : {1u, 15u, 4096u, 3000000u, 3000001u}) {
        const std::size_t before = values.size();
        values.resize(count);
        std::iota(values.begin() + static_cast<std::ptrdiff_t>(before), values.end(),
                  static_cast<float>(before));
        DOCTEST_CHECK(reinterpret_cast<std::uintptr_t>(values.data()) % CacheLine == 0);
        bool kept = true;
        for (std::size_t i = 0; i < count; ++i) kept = kept && values[i] == static_cast<float>(i);
        DOCTEST_CHECK(kept);
    }
    const LineFloats copy = values;
    DOCTEST_CHECK(copy == values);
}

}  // namespace aligned_test
