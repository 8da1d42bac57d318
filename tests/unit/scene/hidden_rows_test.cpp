// Hiding rows: by identity, for the display alone.
#include <doctest/doctest.h>

#include <cmath>

#include "engine/scene/hidden_rows.h"

namespace hidden_rows_test {

using namespace gse;

namespace {

GaussianSet rows_at(std::vector<float> x) {
    GaussianData data;
    data.resize(x.size());
    for (std::size_t row = 0; row < x.size(); ++row) {
        data.position[row * 3] = x[row];
        data.rotation[row * 4] = 1;
        data.opacity_logit[row] = 0.5f;
    }
    return GaussianSet(std::move(data));
}

using Bits = std::vector<std::uint8_t>;

}  // namespace

DOCTEST_TEST_CASE("hidden rows are known by identity: others that come and go do not matter") {
    HiddenRows hidden;
    const std::vector<RowId> ids{0, 1, 2, 3};
    DOCTEST_CHECK(hidden.rows(ids) == Bits{0, 0, 0, 0});
    hidden.hide(ids, Bits{0, 1, 0, 1});
    hidden.hide(ids, Bits{0, 1, 1, 0});
    DOCTEST_CHECK(hidden.rows(ids) == Bits{0, 1, 1, 1});
    const std::vector<RowId> later{0, 2, RowId{7} << EditIdShift, 3};  // 1 was deleted, an edit has added one
    DOCTEST_CHECK(hidden.rows(later) == Bits{0, 1, 0, 1});
    DOCTEST_CHECK(hidden.rows(ids) == Bits{0, 1, 1, 1});  // the deletion undone: 1 is still hidden
    hidden.show_all();
    DOCTEST_CHECK(hidden.empty());
    DOCTEST_CHECK(hidden.rows(ids) == Bits{0, 0, 0, 0});
}

DOCTEST_TEST_CASE("isolating shows what was hidden of the label, and hides all else that is there") {
    HiddenRows hidden;
    const std::vector<RowId> ids{4, 5, 6, 9};
    hidden.hide(ids, Bits{1, 1, 0, 0});
    hidden.isolate(ids, Bits{0, 1, 1, 0});
    DOCTEST_CHECK(hidden.rows(ids) == Bits{1, 0, 0, 1});
    hidden.isolate(std::vector<RowId>{5, 6}, Bits{0, 1});  // 4 and 9 are off at present
    DOCTEST_CHECK(hidden.rows(ids) == Bits{1, 1, 0, 1});
}

DOCTEST_TEST_CASE("what is hidden is invisible and nothing else of the set changes") {
    const GaussianSet set = rows_at({1, 2, 3});
    const GaussianSet shown = with_hidden(set, Bits{0, 1, 0});
    DOCTEST_CHECK(std::isinf(shown.opacity_logit()[1]));
    DOCTEST_CHECK(shown.opacity_logit()[1] < 0);
    DOCTEST_CHECK(shown.opacity_logit()[0] == 0.5f);
    DOCTEST_CHECK(shown.buffers().position == set.buffers().position);
    DOCTEST_CHECK(shown.buffers().sh == set.buffers().sh);
    DOCTEST_CHECK(set.opacity_logit()[1] == 0.5f);
    DOCTEST_CHECK(with_hidden(set, Bits{0, 0, 0}).shares_all_with(set));
    DOCTEST_CHECK(without_hidden(set, Bits{0, 0, 0}).shares_all_with(set));
    const GaussianSet rest = without_hidden(set, Bits{0, 1, 0});
    DOCTEST_REQUIRE(rest.size() == 2);
    DOCTEST_CHECK(rest.position()[3] == 3);
    DOCTEST_CHECK(rest.opacity_logit()[1] == 0.5f);
    DOCTEST_CHECK(seen_values(std::vector<float>{7, 8, 9}, Bits{0, 1, 0}) == std::vector<float>{7, 9});
}

}  // namespace hidden_rows_test
