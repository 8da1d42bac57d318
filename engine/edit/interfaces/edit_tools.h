// The parts that an edit calls, and what it tells while it runs.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/progress.h"
#include "engine/edit/interfaces/interfaces.h"
#include "engine/edit/interfaces/snapshot.h"
#include "engine/edit/interfaces/view_targets.h"
#include "engine/raster/rasterizer.h"

namespace gse::edit {

/// One line of the loss history.
struct IterationRecord {
    int iteration = 0;
    std::size_t view = 0;
    double preservation = 0, anchor = 0;
    double guidance_norm = 0, preservation_norm = 0;  // norms of the gradients on the picture
    std::map<std::string, double> guidance;           // what the guidance reports, where it is finite
    bool skipped = false;                             // the guidance was not finite: the step changed nothing
};

/// Receives every line of the loss history as it is written.
using IterationCallback = std::function<void(const IterationRecord& record)>;

/// The parts the loop calls.
struct EditTools {
    raster::Rasterizer& rasterizer;
    Guidance* guidance;         // pulls at every step; may be null where `views` leads
    SnapshotCallback snapshot;  // may be empty
    JobControl job;
    IterationCallback iteration = {};      // may be empty
    AttentionSource* attention = nullptr;  // for the dynamic mask; null = the masks stay as they are
    Segmenter* segmenter = nullptr;
    std::string word = {};  // what the dynamic mask looks for, and what has a new shape
    /// Asked before every iteration: another label ([N] 0 or 1) that the artist has drawn meanwhile, or
    /// nothing.
    std::function<std::optional<std::vector<std::uint8_t>>()> new_label = {};
    /// Goes on from this state of an earlier run over the same base, at its iteration; what it says of rows
    /// outside the label does not count. Null = from the base.
    const EditSnapshot* start = nullptr;
    MultiViewEditor* views = nullptr;  // leads the edit in place of `guidance`: redraws views to fit to
    double snapshot_seconds = 0;  // above 0: a snapshot whenever this much time has passed (more where they
                                  // take long), instead of by iterations
    /// Shows the redrawn views of view guidance. Called as soon as a round is redrawn, and on every change of
    /// them.
    std::function<void(const ViewTargets&)> targets = {};
    /// Asked when a round was redrawn, before every iteration, and again after orders: what the artist says
    /// meanwhile, or nothing. May wait for an answer; a stop request has to end that.
    std::function<std::vector<TargetOrder>()> target_orders = {};
    std::vector<std::string> known = {};  // words of the model; empty = it takes any
    std::size_t view_bytes =
        std::size_t{512}
        << 20;  // memory that saves time where few rows are labelled; no result depends on it
    std::string redraw_key = {};  // of what `views` is made from: a round begun with another key is redrawn
};

}  // namespace gse::edit
