// State of an edit at one moment, kept as its difference from the scene.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <vector>

#include "engine/scene/gaussian_set.h"

namespace gse::edit {

struct RoundState;

/// Marks in place of the base row that a row descends from. Such a row grew from a seed of a new object, or
/// of the surface that the old one hid.
constexpr std::int64_t OfSeed = -1, OfHoleFill = -2;

/// Rows of the label at that moment.
struct SnapshotRows {
    GaussianData rows;                // those that are the base's, in its order, then those born in the run
    std::vector<std::uint32_t> kept;  // base row of each of the first ones, ascending
    std::vector<std::int64_t>
        ancestor;  // [rows - kept] base row that a born one descends from, or OfSeed, OfHoleFill
    std::vector<int> generation;         // [rows]
    std::vector<std::uint32_t> removed;  // base rows that are gone, ascending
};

struct EditSnapshot;
/// Layer over the edited set, such as a pattern. The edit does not go on from it.
using SnapshotFinish = std::function<GaussianSet(const EditSnapshot& snapshot, const GaussianSet& edited)>;

/// Immutable state that may be kept. It shares the arrays of the scene and holds the rows of the label beside
/// them. The edited set has the base's rows in their order, without removed ones, and added ones at its end.
struct EditSnapshot {
    GaussianSet base;
    std::shared_ptr<const SnapshotRows> rows;
    int iteration = 0;
    // State of view guidance: what the rows are fitted to; null = nothing yet.
    std::shared_ptr<const RoundState> round = {};
    SnapshotFinish finish = {};

    /// Rows of the edited set.
    std::size_t size() const { return base.size() - rows->removed.size() + rows->ancestor.size(); }
    /// Edited set, finished, with arrays of its own.
    GaussianSet materialise() const;
    std::vector<std::int64_t> base_to_new() const;  // [base rows] row of the edited set, -1 = removed
    std::vector<std::uint8_t> label() const;        // [size()] 1 = the row belongs to the label
    std::vector<int> generation() const;            // [size()] 0 = there before the edit
    std::vector<std::uint8_t> hole_fill() const;    // [size()] 1 = of what the old thing hid
    /// Bytes beside the base's arrays.
    std::size_t byte_size() const;
};

/// Drops every second snapshot of the older half until at most `most` are left with at most `most_bytes`. The
/// two newest stay.
void thin_out(std::deque<EditSnapshot>& snapshots, std::size_t most, std::size_t most_bytes);

/// Receives the state of a running edit every few iterations.
using SnapshotCallback = std::function<void(EditSnapshot snapshot)>;

}  // namespace gse::edit
