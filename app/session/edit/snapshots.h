// States of a running or finished edit that can be looked at, taken as the result, and gone on from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

#include "engine/edit/interfaces/snapshot.h"
#include "engine/scene/gaussian_set.h"
#include "ui/model/view_model.h"

namespace gse::app {

/// The edited set of one snapshot.
struct SnapshotSet {
    std::shared_ptr<const edit::SnapshotRows> of;  // that snapshot's rows; null = of none
    GaussianSet set;
};

class Snapshots {
public:
    static constexpr std::size_t Most = 24;                           // kept for the scrubber;
    static constexpr std::size_t MostBytes = std::size_t{512} << 20;  // thinned out beyond

    bool empty() const { return list_.empty(); }
    const edit::EditSnapshot& newest() const { return list_.back(); }
    const SnapshotSet& newest_set() const { return newest_set_; }
    /// The one that is looked at; null = the newest, or the result.
    const edit::EditSnapshot* shown() const;
    /// The snapshot of that iteration, else the last before it; null where there is none.
    const edit::EditSnapshot* at_or_before(int iteration) const;
    /// The edited set; those of the newest snapshot and of the one that was asked for last are at hand.
    GaussianSet set_of(const edit::EditSnapshot& snapshot);

    /// The set that they are states of; nothing is looked at. `rows`: row in it of each row of the document;
    /// empty = they are the document's.
    void begin(const GaussianSet& base, std::vector<std::int64_t> rows = {});
    /// Row in the snapshot's set of each row of the document.
    std::vector<std::int64_t> rows_of(const edit::EditSnapshot& snapshot) const;
    const GaussianSet& base() const { return base_; }
    /// Adds a new state and thins the old ones out; the one that is looked at stays, or the next later one.
    void add(edit::EditSnapshot snapshot, GaussianSet set);
    /// Looks at one by its index; -1, or beyond the last, is the newest. `result`: behind all of them there
    /// is a result.
    void look_at(int index, bool result);
    void look_at_newest() { shown_ = -1; }
    void drop_after(int iteration);
    void forget();
    void show(ui::EditPart& model) const;

private:
    std::deque<edit::EditSnapshot> list_;
    SnapshotSet newest_set_, looked_at_;
    GaussianSet base_;
    std::vector<std::int64_t> rows_;  // in base_; empty = as they are
    int shown_ = -1;
};

}  // namespace gse::app
