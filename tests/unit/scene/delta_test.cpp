// Deltas: the difference of two sets gives the second one back, bit for bit, and touches nothing else.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <numeric>

#include "tests/unit/scene/random_sets.h"

namespace delta_test {

using namespace gse;
using namespace gse::test;

namespace {

std::vector<RowId> first_ids(std::size_t count) {
    std::vector<RowId> ids(count);
    std::iota(ids.begin(), ids.end(), RowId{0});
    return ids;
}

}  // namespace

DOCTEST_TEST_CASE("applying the difference of two sets gives the second one bit for bit") {
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        const GaussianSet before = random_set(1 + seed * 7, static_cast<int>(seed % 4), seed);
        const auto ids = first_ids(before.size());
        const RandomEdit edit = random_edit(before, seed + 1000);
        const SceneDelta delta = make_delta(before, ids, edit.after, edit.base_to_new, 5);
        const auto [set, new_ids] = apply_delta(before, ids, delta);
        DOCTEST_CHECK(bits_equal(set, edit.after));
        DOCTEST_REQUIRE(new_ids.size() == set.size());
        for (std::size_t row = 0; row < before.size(); ++row) {
            if (edit.base_to_new[row] >= 0)
                DOCTEST_CHECK(new_ids[static_cast<std::size_t>(edit.base_to_new[row])] == row);
            if (edit.untouched[row] != 0)
                DOCTEST_CHECK_FALSE(std::binary_search(delta.changed.begin(), delta.changed.end(), row));
        }
        for (std::size_t i = 0; i < delta.added.size(); ++i)
            DOCTEST_CHECK(delta.added[i] == ((5ull << 32) | i));
    }
}

DOCTEST_TEST_CASE("a delta that only moves splats shares every other array") {
    const GaussianSet before = random_set(100, 3, 1);
    GaussianData data = before.to_data();
    data.position[30] = 42;
    const GaussianSet after(std::move(data));
    const auto ids = first_ids(100);
    std::vector<std::int64_t> map(100);
    std::iota(map.begin(), map.end(), std::int64_t{0});
    const SceneDelta delta = make_delta(before, ids, after, map, 1);
    DOCTEST_CHECK(delta.changed == std::vector<RowId>{10});
    const auto [set, unused] = apply_delta(before, ids, delta);
    DOCTEST_CHECK(bits_equal(set, after));
    DOCTEST_CHECK(set.buffers().sh == before.buffers().sh);
    DOCTEST_CHECK(set.buffers().opacity_logit == before.buffers().opacity_logit);
    DOCTEST_CHECK(set.buffers().position != before.buffers().position);
    DOCTEST_CHECK(make_delta(before, ids, before, map, 1).byte_size() == 0);
    DOCTEST_CHECK(apply_delta(before, ids, SceneDelta{}).first.shares_all_with(before));
}

DOCTEST_TEST_CASE("rows that are not there are passed over") {
    const GaussianSet before = random_set(50, 1, 3);
    const auto ids = first_ids(50);
    const RandomEdit first = random_edit(before, 4);
    const SceneDelta one = make_delta(before, ids, first.after, first.base_to_new, 1);
    const auto [middle, middle_ids] = apply_delta(before, ids, one);
    const RandomEdit second = random_edit(middle, 5);
    const SceneDelta two = make_delta(middle, middle_ids, second.after, second.base_to_new, 2);
    // Without edit 1: what edit 2 says of base rows holds, what it says of edit 1's rows does not matter.
    const auto [alone, alone_ids] = apply_delta(before, ids, two);
    DOCTEST_CHECK(std::none_of(alone_ids.begin(), alone_ids.end(), [](RowId id) { return id >> 32 == 1; }));
    for (std::size_t row = 0; row < alone_ids.size(); ++row) {
        if (alone_ids[row] >> 32 != 0) continue;
        const auto at = std::lower_bound(two.changed.begin(), two.changed.end(), alone_ids[row]);
        if (at != two.changed.end() && *at == alone_ids[row])
            DOCTEST_CHECK(same_row(alone.spans(), row, spans(two.changed_rows),
                                   static_cast<std::size_t>(at - two.changed.begin())));
        else
            DOCTEST_CHECK(
                same_row(alone.spans(), row, before.spans(), static_cast<std::size_t>(alone_ids[row])));
    }
    for (const RowId id : two.removed)
        DOCTEST_CHECK(std::find(alone_ids.begin(), alone_ids.end(), id) == alone_ids.end());
    // Together is the same as one after the other.
    const SceneDelta* both[] = {&one, &two};
    const auto [together, together_ids] = apply_deltas(before, ids, both);
    const auto [after, after_ids] = apply_delta(middle, middle_ids, two);
    DOCTEST_CHECK(bits_equal(together, after));
    DOCTEST_CHECK(together_ids == after_ids);
}

DOCTEST_TEST_CASE("identities in any order are found") {
    Random random(8);
    for (int round = 0; round < 50; ++round) {
        std::vector<RowId> ids = first_ids(1 + random.below(60));
        for (std::size_t i = ids.size(); i-- > 1;)
            if (random.below(3) == 0) std::swap(ids[i], ids[random.below(i + 1)]);
        std::vector<RowId> wanted;
        for (RowId id = 0; id < 70; ++id)
            if (random.below(2) == 0) wanted.push_back(id);
        std::vector<std::pair<std::size_t, std::size_t>> found, expected;
        locate_rows(ids, wanted, [&](std::size_t row, std::size_t k) { found.emplace_back(row, k); });
        for (std::size_t row = 0; row < ids.size(); ++row) {
            const auto at = std::find(wanted.begin(), wanted.end(), ids[row]);
            if (at != wanted.end()) expected.emplace_back(row, static_cast<std::size_t>(at - wanted.begin()));
        }
        DOCTEST_CHECK(found == expected);
    }
}

DOCTEST_TEST_CASE("SH degrees are widened with zeros, in the set and in the delta") {
    const auto ids = first_ids(20);
    std::vector<std::int64_t> map(20);
    std::iota(map.begin(), map.end(), std::int64_t{0});
    const GaussianSet flat = random_set(20, 0, 1);
    const GaussianSet rich = random_set(20, 2, 2);
    const auto up = apply_delta(flat, ids, make_delta(flat, ids, rich, map, 1)).first;
    DOCTEST_CHECK(bits_equal(up, rich));
    const auto down = apply_delta(rich, ids, make_delta(rich, ids, flat, map, 1)).first;
    DOCTEST_REQUIRE(down.sh_degree() == 2);
    for (std::size_t row = 0; row < 20; ++row) DOCTEST_CHECK(same_row(down.spans(), row, flat.spans(), row));
}

}  // namespace delta_test
