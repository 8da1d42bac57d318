// Rows of the working set: they come and go in all columns at once, and keep what they were born with.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <set>

#include "engine/edit/optimise/working_set.h"
#include "tests/unit/edit/edit_scenes.h"
#include "tests/unit/edit/row_gradients.h"

namespace working_set_test {

namespace {

using namespace gse;

constexpr double Extent = 3;

/// A request under which a densification clones, splits and prunes.
edit::EditRequest restless_request() {
    edit::EditRequest request;
    request.densify_percent = 0.3;
    request.min_opacity = 0.5;
    request.percent_dense = 0.02;
    request.geometry_share = 1;
    return request;
}

/// Gradients of every labelled row, random.
raster::Gradients random_gradients(const edit::WorkingSet& set, Random& random) {
    return test::row_gradients(set, [&] { return random.normal(); });
}

void step(edit::WorkingSet& set, const edit::EditRequest& request, Random& random, int times) {
    for (int i = 0; i < times; ++i) {
        const auto gradients = random_gradients(set, random);
        set.collect(gradients);
        set.step(gradients, i, request);
    }
}

/// The label with every seventh row taken away and every eleventh given.
std::vector<std::uint8_t> corrected(std::vector<std::uint8_t> label) {
    for (std::size_t row = 0; row < label.size(); ++row)
        if (row % 7 == 0) label[row] = 0;
        else if (row % 11 == 0) label[row] = 1;
    return label;
}

}  // namespace

DOCTEST_TEST_CASE("every array of the table is declared a column, once") {
    edit::RowTable table(3);
    std::set<const void*> arrays;
    std::size_t count = 0;
    edit::RowTable::visit(
        [&](const edit::Column&, const auto& array) {
            arrays.insert(&array);
            ++count;
        },
        table);
    DOCTEST_CHECK(arrays.size() == count);
    // Contents of the table besides arrays: the count of unlabelled rows and two SH degrees. All arrays are
    // equally large.
    constexpr std::size_t degree = sizeof(GaussianData) - 5 * sizeof(std::vector<float>);
    DOCTEST_CHECK(sizeof(table) == sizeof(std::size_t) + 2 * degree + count * sizeof(std::vector<float>));
}

DOCTEST_TEST_CASE("a row dropped, carried over or new has one entry in every column") {
    edit::RowTable table(1);
    table.rows.resize(2);
    table.first_row = 2;
    for (int i = 0; i < 4; ++i) {
        table.append_zero();
        table.origin[static_cast<std::size_t>(i)] = 10 + i;
        table.rows.opacity_logit.back() = static_cast<float>(i);
        DOCTEST_CHECK(table.complete());
    }
    DOCTEST_CHECK(table.position.first.empty());
    table.position.first.resize(12, 1.0f);  // the first step
    table.gradient_sum[3] = 5;
    table.append_carried(table, 3);
    DOCTEST_CHECK(table.complete());
    DOCTEST_CHECK(table.position.first == std::vector<float>{1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 0, 0, 0});
    DOCTEST_CHECK(table.gradient_sum == std::vector<double>{0, 0, 0, 5, 0});
    table.keep({1, 0, 1, 0, 1});
    DOCTEST_CHECK(table.complete());
    DOCTEST_CHECK(table.origin == std::vector<std::int64_t>{10, 12, 13});
    DOCTEST_CHECK(table.rows.opacity_logit == std::vector<float>{0, 0, 0, 2, 3});
    table.birth_scale.pop_back();
    DOCTEST_CHECK_FALSE(table.complete());
}

DOCTEST_TEST_CASE(
    "steps, densifications, corrected labels and dropped seeds leave every column as long as the label") {
    for (const int degree : {0, 3})
        for (const std::size_t seeds : {0u, 20u}) {
            const auto scene = test::ball_scene(100, degree);
            GaussianData added;
            added.sh_degree = degree;
            for (std::size_t row = 0; row < seeds; ++row) added.append_row(scene.set.to_data(), row);
            const auto request = restless_request();
            edit::WorkingSet set(scene.set, scene.first, added, request, Extent);
            Random random(3);
            DOCTEST_CHECK(set.table().complete());
            for (int round = 0; round < 3; ++round) {
                step(set, request, random, 3);
                DOCTEST_CHECK(set.table().complete());
                const auto count = set.densify(request, random, true);
                DOCTEST_CHECK(count.cloned + count.split > 0);
                DOCTEST_CHECK(set.table().complete());
                set.relabel(scene.set, round % 2 == 0 ? corrected(scene.first) : scene.first, request);
                DOCTEST_CHECK(set.table().complete());
            }
            DOCTEST_CHECK(set.labelled() > 0);
            std::vector<float> weight(set.rows().size(), 1.0f);
            for (std::size_t row = 0; row < weight.size(); row += 5) weight[row] = 0;
            const auto dropped = set.keep_added(weight, std::vector<double>(weight.size(), 1.0), 0.5, 0);
            DOCTEST_CHECK((dropped > 0) == (seeds > 0));
            DOCTEST_CHECK(set.table().complete());
        }
}

DOCTEST_TEST_CASE(
    "rows of what the old thing hid are told from those of the new one, and so are their descendants") {
    const auto scene = test::ball_scene(100, 0);
    GaussianData seeds, hole_fill;
    for (std::size_t row = 0; row < 30; ++row) seeds.append_row(scene.set.to_data(), row);
    for (std::size_t row = 30; row < 50; ++row) hole_fill.append_row(scene.set.to_data(), row);
    const auto request = restless_request();
    edit::WorkingSet set(scene.set, scene.first, {}, request, Extent);
    const auto marked = [&] {
        const auto snapshot = set.snapshot(scene.set, 0);
        const auto bits = snapshot.hole_fill(), label = snapshot.label();
        DOCTEST_CHECK(bits.size() == snapshot.size());
        for (std::size_t row = 0; row < bits.size(); ++row) DOCTEST_CHECK(bits[row] <= label[row]);
        return std::count(bits.begin(), bits.end(), 1);
    };
    DOCTEST_CHECK(marked() == 0);
    set.plant(seeds, hole_fill, -3);
    DOCTEST_CHECK(set.table().complete());
    DOCTEST_CHECK(marked() == 20);
    const auto before = static_cast<std::size_t>(
        std::count(set.table().ancestor.begin(), set.table().ancestor.end(), edit::OfSeed));
    DOCTEST_CHECK(before == 30);
    set.plant({}, hole_fill, -3);  // all that is born from here on descends from them, or from the base
    Random random(3);
    step(set, request, random, 3);
    const auto count = set.densify(request, random, true);
    DOCTEST_CHECK(count.cloned + count.split > 0);
    const auto& ancestors = set.table().ancestor;
    DOCTEST_CHECK(std::count(ancestors.begin(), ancestors.end(), edit::OfSeed) == 0);
    DOCTEST_CHECK(marked() != 20);
    set.plant(seeds, {}, -3);  // the next round has no hole any more
    DOCTEST_CHECK(marked() == 0);
}

DOCTEST_TEST_CASE(
    "after a corrected label, rows born in the run follow the shared colour like the rows they descend "
    "from") {
    const auto scene = test::ball_scene(60);
    auto request = restless_request();
    request.colour_coupling = 1;  // colours change together or not at all
    request.percent_dense = 1;    // clones only: a clone has its parent's colour
    request.min_opacity = 0;
    edit::WorkingSet set(scene.set, scene.first, {}, request, Extent);
    Random random(5);
    step(set, request, random, 20);
    DOCTEST_REQUIRE(set.densify(request, random, true).cloned > 0);
    auto label = scene.first;
    label[0] = 0;
    set.relabel(scene.set, label, request);
    step(set, request, random, 20);
    const auto& table = set.table();
    std::size_t clones = 0;
    for (std::size_t i = 0; i < set.labelled(); ++i) {
        if (table.origin[i] >= 0) continue;
        const auto parent =
            std::find(table.origin.begin(), table.origin.end(), table.ancestor[i]) - table.origin.begin();
        DOCTEST_REQUIRE(parent < static_cast<std::ptrdiff_t>(set.labelled()));
        ++clones;
        const float* own = &set.rows().sh[(set.first_row() + i) * 3];
        const float* of_parent = &set.rows().sh[(set.first_row() + static_cast<std::size_t>(parent)) * 3];
        for (int c = 0; c < 3; ++c) DOCTEST_CHECK(own[c] == of_parent[c]);
    }
    DOCTEST_CHECK(clones > 0);
}

DOCTEST_TEST_CASE("a corrected label changes nothing of what is remembered of rows that stay") {
    const auto scene = test::ball_scene(60, 1);
    const auto request = restless_request();
    edit::WorkingSet set(scene.set, scene.first, {}, request, Extent);
    Random random(7);
    step(set, request, random, 5);
    set.densify(request, random, true);
    step(set, request, random, 5);
    auto label = scene.first;
    label[60] = 1;  // one row of the other ball joins, none leaves
    edit::RowTable before = set.table();
    set.relabel(scene.set, label, request);
    const auto& after = set.table();
    DOCTEST_REQUIRE(after.labelled() == before.labelled() + 1);
    const auto joined = static_cast<std::size_t>(std::find(after.origin.begin(), after.origin.end(), 60) -
                                                 after.origin.begin());
    std::vector<std::uint8_t> stayed(after.labelled(), 1);
    stayed[joined] = 0;
    edit::RowTable rest = after;
    rest.keep(stayed);
    before.anchor = rest.anchor;  // anchors begin anew
    edit::RowTable::visit(
        [](const edit::Column& column, const auto& was, const auto& is) {
            if (column.kind == edit::ColumnKind::Fact) DOCTEST_CHECK(was == is);
        },
        before, rest);
}

}  // namespace working_set_test
