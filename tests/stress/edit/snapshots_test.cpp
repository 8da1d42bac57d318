// Snapshots of a large scene: how much they hold, and that each is still the edited set of its moment.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <fstream>

#include "engine/base/random.h"
#include "engine/edit/optimise/working_set.h"
#include "tests/unit/edit/edit_scenes.h"

namespace snapshots_test {

namespace {

using namespace gse;

constexpr std::size_t Splats = 1'000'000;
constexpr std::size_t LabelEvery = 20;          // 5 % of the rows are labelled
constexpr std::size_t Snapshots = 24;           // as many as the window keeps
constexpr std::size_t MostBytes = 400'000'000;  // of them all together; whole sets would be 5.7 GB
constexpr double Extent = 3;

GaussianSet large_scene() {
    GaussianData data;
    data.sh_degree = 3;
    data.resize(Splats);
    Random random(21);
    for (auto& value : data.position) value = static_cast<float>(random.uniform(-1, 1));
    for (auto& value : data.log_scale) value = static_cast<float>(random.uniform(-6, -3));
    for (auto& value : data.rotation) value = static_cast<float>(random.uniform(-1, 1));
    for (auto& value : data.opacity_logit) value = static_cast<float>(random.uniform(-2, 4));
    for (auto& value : data.sh) value = static_cast<float>(random.uniform(-1, 1));
    return GaussianSet(std::move(data));
}

raster::Gradients gradients_of(const edit::WorkingSet& set, Random& random) {
    raster::Gradients gradients;
    const std::size_t rows = set.labelled();
    for (auto [values, stride] : {std::pair{&gradients.position, std::size_t{3}},
                                  {&gradients.log_scale, 3},
                                  {&gradients.rotation, 4},
                                  {&gradients.opacity_logit, 1},
                                  {&gradients.sh, set.rows().sh_stride()},
                                  {&gradients.mean2d_norm, 1}}) {
        values->resize(rows * stride);
        for (auto& value : *values) value = static_cast<float>(random.uniform(-1, 1));
    }
    for (auto& value : gradients.mean2d_norm) value = std::abs(value);
    gradients.visible.assign(rows, 1);
    return gradients;
}

/// The edited set row by row from the working set: the base's rows in their order, then the born ones.
struct Expected {
    GaussianData data;
    std::vector<std::int64_t> base_to_new;
    std::vector<std::uint8_t> label;
    std::vector<int> generation;
};

Expected expected_of(const edit::WorkingSet& set, const GaussianData& base,
                     const std::vector<std::uint8_t>& label) {
    Expected result;
    const auto& table = set.table();
    result.data.sh_degree = base.sh_degree;
    std::vector<std::int64_t> now(base.size(), -1);
    for (std::size_t i = 0; i < table.origin.size(); ++i)
        if (table.origin[i] >= 0)
            now[static_cast<std::size_t>(table.origin[i])] = static_cast<std::int64_t>(i);
    const auto add_labelled = [&](std::size_t i) {
        result.data.append_row(table.rows, table.first_row + i);
        result.label.push_back(1);
        result.generation.push_back(table.generation[i]);
    };
    for (std::size_t row = 0; row < base.size(); ++row) {
        const bool gone = label[row] != 0 && now[row] < 0;
        result.base_to_new.push_back(gone ? -1 : static_cast<std::int64_t>(result.data.size()));
        if (gone) continue;
        if (label[row] != 0) {
            add_labelled(static_cast<std::size_t>(now[row]));
            continue;
        }
        result.data.append_row(base, row);
        result.label.push_back(0);
        result.generation.push_back(0);
    }
    for (std::size_t i = 0; i < table.origin.size(); ++i)
        if (table.origin[i] < 0) add_labelled(i);
    return result;
}

void check_is(const edit::EditSnapshot& snapshot, const Expected& expected) {
    DOCTEST_CHECK(snapshot.size() == expected.data.size());
    DOCTEST_CHECK(test::same_bytes(snapshot.materialise(), GaussianSet(expected.data)));
    DOCTEST_CHECK(snapshot.base_to_new() == expected.base_to_new);
    DOCTEST_CHECK(snapshot.label() == expected.label);
    DOCTEST_CHECK(snapshot.generation() == expected.generation);
}

/// Memory this program holds, 0 where the system does not say.
std::size_t resident_bytes() {
    std::ifstream file("/proc/self/statm");
    std::size_t all = 0, resident = 0;
    constexpr std::size_t page = 4096;
    return file >> all >> resident ? resident * page : 0;
}

}  // namespace

DOCTEST_TEST_CASE(
    "24 snapshots of a million splats, one in twenty labelled, stay small and are what they were") {
    const GaussianSet base = large_scene();
    std::vector<std::uint8_t> label(base.size(), 0);
    for (std::size_t row = 0; row < label.size(); row += LabelEvery) label[row] = 1;
    edit::EditRequest request;
    request.geometry_share = 1;
    request.densify_percent = 0.02;
    request.min_opacity = 0.2;
    edit::WorkingSet set(base, label, {}, request, Extent);
    Random random(22);
    std::vector<edit::EditSnapshot> snapshots;
    edit::DensifyCount changed;
    std::size_t bytes = 0;
    const std::size_t before = resident_bytes();
    for (std::size_t k = 0; k < Snapshots; ++k) {
        const auto gradients = gradients_of(set, random);
        set.collect(gradients);
        set.step(gradients, static_cast<int>(k), request);
        if (k == 3) changed = set.densify(request, random, true);
        snapshots.push_back(set.snapshot(base, static_cast<int>(k)));
        bytes += snapshots.back().byte_size();
    }
    const std::size_t grown = resident_bytes() - before;
    DOCTEST_CHECK(changed.cloned + changed.split > 0);
    DOCTEST_CHECK(changed.pruned > 0);
    DOCTEST_MESSAGE(Snapshots, " snapshots: ", static_cast<double>(bytes) / 1e6,
                    " MB, resident memory grew by ", static_cast<double>(grown) / 1e6, " MB");
    DOCTEST_CHECK(bytes < MostBytes);
    for (const auto& snapshot : snapshots) DOCTEST_CHECK(snapshot.base.shares_all_with(base));
    const GaussianData data = base.to_data();
    check_is(snapshots.back(), expected_of(set, data, label));
    // Rows are removed and born in the fourth; the first still has all of them.
    DOCTEST_CHECK(snapshots.front().size() == base.size());
    DOCTEST_CHECK_FALSE(test::same_bytes(snapshots.front().materialise(), snapshots[1].materialise()));
}

DOCTEST_TEST_CASE("snapshots are thinned out by their number and by what they hold") {
    const auto snapshots = [](int count, std::size_t rows) {
        std::deque<edit::EditSnapshot> result;
        for (int i = 0; i < count; ++i) {
            edit::SnapshotRows now;
            now.rows.resize(rows);
            result.push_back({GaussianSet(), std::make_shared<const edit::SnapshotRows>(std::move(now)), i});
        }
        return result;
    };
    auto few = snapshots(5, 100);
    edit::thin_out(few, 24, std::size_t{1} << 30);
    DOCTEST_CHECK(few.size() == 5);
    edit::thin_out(few, 4, std::size_t{1} << 30);
    DOCTEST_CHECK(few.size() <= 4);
    auto heavy = snapshots(20, 10000);
    const std::size_t one = heavy.front().byte_size();
    edit::thin_out(heavy, 24, 6 * one);
    DOCTEST_CHECK(heavy.size() <= 6);
    DOCTEST_CHECK(heavy.size() >= 3);
    DOCTEST_CHECK(heavy.back().iteration == 19);
    DOCTEST_CHECK(heavy[heavy.size() - 2].iteration == 18);
    edit::thin_out(heavy, 24, one / 2);  // the newest stay, whatever they hold
    DOCTEST_CHECK(heavy.size() == 2);
    DOCTEST_CHECK(heavy.back().iteration == 19);
}

}  // namespace snapshots_test
