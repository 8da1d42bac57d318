// The state of an edit at one moment, kept as what differs from the scene it works on.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <vector>

#include "engine/scene/gaussian_set.h"

namespace gse::edit {

struct RoundState;

/// In place of the base row that a row descends from: it grew from a seed of what is new, or of what the old
/// thing hid.
constexpr std::int64_t OfSeed = -1, OfHidden = -2;

/// The rows of the label as they are at that moment.
struct SnapshotRows {
    GaussianData rows;                // those that are the base's, in its order, then those born in the run
    std::vector<std::uint32_t> kept;  // base row of each of the first ones, ascending
    std::vector<std::int64_t>
        ancestor;                 // [rows - kept] base row that a born one descends from, or OfSeed, OfHidden
    std::vector<int> generation;  // [rows]
    std::vector<std::uint32_t> removed;  // base rows that are gone, ascending
};

struct EditSnapshot;
/// What is laid over the edited set and is no part of what an edit goes on from, such as a pattern.
using SnapshotFinish = std::function<GaussianSet(const EditSnapshot& snapshot, const GaussianSet& edited)>;

/// May be kept: it is immutable, shares the arrays of the scene and holds the rows of the label beside them.
/// The edited set has the base's rows in their order, without those that are gone, and the born ones at its
/// end.
struct EditSnapshot {
    GaussianSet base;
    std::shared_ptr<const SnapshotRows> rows;
    int iteration = 0;
    std::shared_ptr<const RoundState> round =
        {};  // of view guidance: what the rows are fitted to; null = nothing yet
    SnapshotFinish finish = {};

    /// Rows of the edited set.
    std::size_t size() const { return base.size() - rows->removed.size() + rows->ancestor.size(); }
    /// The edited set, finished, with arrays of its own.
    GaussianSet materialise() const;
    std::vector<std::int64_t> base_to_new() const;  // [base rows] row of the edited set, -1 = removed
    std::vector<std::uint8_t> label() const;        // [size()] 1 = the row belongs to the label
    std::vector<int> generation() const;            // [size()] 0 = there before the edit
    std::vector<std::uint8_t> hidden() const;       // [size()] 1 = of what the old thing hid
    /// What it holds beside the base's arrays.
    std::size_t byte_size() const;
};

/// Drops every second snapshot of the older half until they are at most `most` and hold at most `most_bytes`;
/// the two newest stay.
void thin_out(std::deque<EditSnapshot>& snapshots, std::size_t most, std::size_t most_bytes);

/// Receives the state of a running edit every few iterations.
using SnapshotCallback = std::function<void(EditSnapshot snapshot)>;

}  // namespace gse::edit
