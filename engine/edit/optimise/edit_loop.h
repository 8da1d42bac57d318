// One edit from labels to result: the loop of rendering, guidance, preservation, anchors and densification
// (GSEditPro 3.3, method S6).
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/memory.h"
#include "engine/base/progress.h"
#include "engine/edit/interfaces/interfaces.h"
#include "engine/edit/interfaces/snapshot.h"
#include "engine/edit/interfaces/view_targets.h"
#include "engine/edit/placement/voxel_region.h"
#include "engine/edit/request/request.h"
#include "engine/raster/rasterizer.h"

namespace gse::edit {

/// What the loop works on.
struct EditPlan {
    std::vector<View> views;              // cameras at the size of the pictures
    std::vector<std::string> view_words;  // per view, or empty
    std::vector<double> azimuths;         // per view, as in EditView, or empty
    std::vector<double> elevations;       // of as many views
    std::vector<Mask> masks;              // per view, dilated: 1 = the picture may change here
    std::vector<std::uint8_t> label;      // [N] 1 = the row may change
    GaussianData seeds;                   // new rows (add mode), may be empty
    raster::Settings settings;
    EditMode mode = EditMode::Modify;
    VoxelRegion room;  // replace mode: where the new thing may be
    std::string
        drawn_colour;  // add mode: that of what the search has drawn, where it did and the sentence says none
};

/// One line of the loss history.
struct IterationRecord {
    int iteration = 0;
    std::size_t view = 0;
    double preservation = 0, anchor = 0;
    double guidance_norm = 0, preservation_norm = 0;  // norms of the gradients on the picture
    std::map<std::string, double> guidance;           // what the guidance reports, where it is finite
    bool skipped = false;                             // the guidance was not finite: the step changed nothing
};

struct EditResult {
    GaussianSet set;
    std::vector<std::int64_t> base_to_new;  // [N] row in `set` of every base row, -1 = removed
    std::vector<std::uint8_t> label;        // [rows of set]
    std::vector<int> generation;            // [rows of set]
    std::vector<std::uint8_t> hidden;       // [rows of set] 1 = not the new thing, but what the old one hid
    std::vector<IterationRecord> history;
    int iterations = 0;
    bool stopped = false;                // by the stop token; the result is the last good state
    std::size_t label_changes = 0;       // labels taken over from `new_label`
    bool converged = false;              // by the early stop
    std::size_t masks_refreshed = 0;     // by the dynamic mask
    std::size_t skipped_steps = 0;       // left out because the guidance was not finite
    std::size_t skipped_rows = 0;        // rows whose gradient was not finite, summed over the steps
    std::size_t continued_pictures = 0;  // for which only the labelled rows were prepared
    std::size_t redrawn_views = 0;       // pictures that view guidance has asked for
    double kept_chroma = -1;  // of the colour that they have, see view_agreement.h; negative = not known
    std::size_t cloned = 0, split = 0, pruned = 0;
    std::size_t changed_outside_label =
        0;                      // rows outside the label that differ from the base in any bit; always 0
    std::size_t nonfinite = 0;  // labelled rows with a NaN or infinity in the result; always 0
    std::size_t unusable_before =
        0;                         // rows of the base that cannot be drawn (see usable_rows); never changed
    std::size_t unusable = 0;      // rows of the result that cannot be drawn
    std::optional<Error> failure;  // the guidance failed for good, or a later round of view guidance; the
                                   // result is the last good state
    std::optional<OutOfMemory> shortage;  // the memory ran out; the result is the last good state
    double guidance_scale = 0;            // factor the calibration gave the guidance's gradient
    std::map<std::string, double>
        seconds;  // per stage: "render", "preserve", "guidance", "backward", "optimise", ...
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
    /// Of view guidance: shows the redrawn views, as soon as a round is redrawn and whenever something about
    /// them changes.
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

/// One edit, in steps that a caller can take apart. Rows outside the label come back bit-identical (checked
/// at the end), and so do rows that cannot be drawn, labelled or not: they are in no picture and no loss. A
/// step whose guidance is not finite is left out. When that goes on, or the memory runs out in the middle,
/// the result is what was reached, with `failure` or `shortage`. The same plan, request and seed give the
/// same bytes for any number of threads of one instruction set (tests/agree/edit, tests/stress/edit).
class Optimiser {
public:
    /// Refers to base and plan, and to what the tools refer to. Throws Error (InvalidArgument) where nothing
    /// is labelled.
    Optimiser(const GaussianSet& base, const EditPlan& plan, const EditRequest& request,
              const EditTools& tools);
    ~Optimiser();
    /// Where views lead: has those of the first round redrawn, or takes them from EditTools::start, and
    /// returns them before anything is fitted. None where the edit was stopped; fit() then returns at once.
    /// Throws Error when no labelled row is visible in any view, and as the view editor does.
    std::optional<ViewTargets> draw_views();
    /// Runs the edit, from the drawn views on where they are; once. Throws Error as draw_views() does, and
    /// when the guidance was finite in no step.
    EditResult fit();

private:
    class Run;
    std::unique_ptr<Run> run_;
};

/// Runs a whole edit: Optimiser::fit().
EditResult run_edit(const GaussianSet& base, const EditPlan& plan, const EditRequest& request,
                    const EditTools& tools);

/// Extent of the views as 3DGS has it: 1.1 times the largest distance of a camera centre from their mean.
double camera_extent(const std::vector<View>& views);

}  // namespace gse::edit
