// From a snapshot to the edited set.
#include "engine/edit/interfaces/snapshot.h"

#include <algorithm>

#include "engine/scene/visit_attributes.h"

namespace gse::edit {
namespace {

/// Row of the edited set that each kept row is.
std::vector<std::size_t> places(const SnapshotRows& rows) {
    std::vector<std::size_t> result;
    result.reserve(rows.kept.size());
    std::size_t gone = 0;  // in front of it
    for (const auto row : rows.kept) {
        while (gone < rows.removed.size() && rows.removed[gone] < row) ++gone;
        result.push_back(row - gone);
    }
    return result;
}

/// One value per row of the edited set: `rest` outside the label, `of(i)` for row i of the label.
template <class T, class F> std::vector<T> per_row(const EditSnapshot& snapshot, T rest, F&& of) {
    const SnapshotRows& rows = *snapshot.rows;
    std::vector<T> result(snapshot.size(), rest);
    const auto place = places(rows);
    for (std::size_t i = 0; i < place.size(); ++i) result[place[i]] = of(i);
    const std::size_t first_born = result.size() - rows.ancestor.size();
    for (std::size_t i = 0; i < rows.ancestor.size(); ++i) result[first_born + i] = of(place.size() + i);
    return result;
}

}  // namespace

GaussianSet EditSnapshot::materialise() const {
    GaussianData data;
    data.sh_degree = base.sh_degree();
    const GaussianSpans before = base.spans();
    const auto place = places(*rows);
    visit_attributes(
        [&](std::size_t stride, const auto& labelled, const auto& all, auto& to) {
            const auto at = [stride](const auto& values, std::size_t row) {
                return values.begin() + static_cast<std::ptrdiff_t>(row * stride);
            };
            to.reserve(size() * stride);
            std::size_t begin = 0;
            for (const auto row : rows->removed) {
                to.insert(to.end(), at(all, begin), at(all, row));
                begin = row + std::size_t{1};
            }
            to.insert(to.end(), at(all, begin), all.end());
            for (std::size_t i = 0; i < place.size(); ++i)
                std::copy_n(at(labelled, i), stride,
                            to.begin() + static_cast<std::ptrdiff_t>(place[i] * stride));
            to.insert(to.end(), at(labelled, place.size()), labelled.end());
        },
        rows->rows, before, data);
    GaussianSet set(std::move(data));
    return finish ? finish(*this, set) : set;
}

std::vector<std::int64_t> EditSnapshot::base_to_new() const {
    std::vector<std::int64_t> result(base.size());
    std::size_t gone = 0;
    for (std::size_t row = 0; row < result.size(); ++row) {
        const bool removed = gone < rows->removed.size() && rows->removed[gone] == row;
        result[row] = removed ? -1 : static_cast<std::int64_t>(row - gone);
        gone += removed ? 1 : 0;
    }
    return result;
}

std::vector<std::uint8_t> EditSnapshot::label() const {
    return per_row(*this, std::uint8_t{0}, [](std::size_t) { return std::uint8_t{1}; });
}

std::vector<int> EditSnapshot::generation() const {
    return per_row(*this, 0, [this](std::size_t i) { return rows->generation[i]; });
}

std::vector<std::uint8_t> EditSnapshot::hole_fill() const {
    const std::size_t kept = rows->kept.size();
    return per_row<std::uint8_t>(*this, 0, [&](std::size_t i) -> std::uint8_t {
        return i >= kept && rows->ancestor[i - kept] == OfHoleFill ? 1 : 0;
    });
}

std::size_t EditSnapshot::byte_size() const {
    std::size_t bytes = sizeof(*this) + sizeof(SnapshotRows);
    const auto add = [&bytes](const auto& array) { bytes += array.capacity() * sizeof(array[0]); };
    visit_attributes([&](std::size_t, const auto& array) { add(array); }, rows->rows);
    add(rows->kept);
    add(rows->ancestor);
    add(rows->generation);
    add(rows->removed);
    return bytes;
}

void thin_out(std::deque<EditSnapshot>& snapshots, std::size_t most, std::size_t most_bytes) {
    constexpr std::size_t newest = 2;
    const auto bytes = [&] {
        std::size_t sum = 0;
        for (const auto& snapshot : snapshots) sum += snapshot.byte_size();
        return sum;
    };
    while (snapshots.size() > newest && (snapshots.size() > most || bytes() > most_bytes))
        for (std::size_t i = 0;
             i < std::max<std::size_t>(1, snapshots.size() / 2) && snapshots.size() > newest; ++i)
            snapshots.erase(snapshots.begin() + static_cast<std::ptrdiff_t>(i));
}

}  // namespace gse::edit
