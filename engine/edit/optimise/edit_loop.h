// One edit from labels to result: the loop of rendering, guidance, preservation, anchors and densification
// (METHOD.md, Optimiser).
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/memory.h"
#include "engine/edit/interfaces/edit_plan.h"
#include "engine/edit/interfaces/edit_tools.h"
#include "engine/edit/request/checked_request.h"

namespace gse::edit {

struct EditResult {
    GaussianSet set;
    std::vector<std::int64_t> base_to_new;  // [N] row in `set` of every base row, -1 = removed
    std::vector<std::uint8_t> label;        // [rows of set]
    std::vector<int> generation;            // [rows of set]
    std::vector<std::uint8_t> hole_fill;    // [rows of set] 1 = not the new thing, but what the old one hid
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
    // Rows outside the label that differ from the base in any bit; always 0.
    std::size_t changed_outside_label = 0;
    std::size_t nonfinite = 0;  // labelled rows with a NaN or infinity in the result; always 0
    // Rows of the base that cannot be drawn (see usable_rows); never changed.
    std::size_t unusable_before = 0;
    std::size_t unusable = 0;      // rows of the result that cannot be drawn
    std::optional<Error> failure;  // the guidance failed for good, or a later round of view guidance; the
                                   // result is the last good state
    std::optional<OutOfMemory> shortage;  // the memory ran out; the result is the last good state
    double guidance_scale = 0;            // factor the calibration gave the guidance's gradient
    std::map<std::string, double>
        seconds;  // per stage: "render", "preserve", "guidance", "backward", "optimise", ...
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
    Optimiser(const GaussianSet& base, const EditPlan& plan, const CheckedRequest& request,
              const EditTools& tools);
    ~Optimiser();
    /// Has the views of the first round redrawn, or takes them from EditTools::start. Returns them before
    /// anything is fitted. None if views do not lead, or if the edit was stopped; fit() then returns at once.
    /// Throws Error when no labelled row is visible in any view, and the errors of the view editor.
    std::optional<ViewTargets> draw_views();
    /// Runs the edit, from the drawn views on where they are; once. Throws Error as draw_views() does, and
    /// when the guidance was finite in no step.
    EditResult fit();

private:
    class Run;
    std::unique_ptr<Run> run_;
};

/// Runs a whole edit: Optimiser::fit().
EditResult run_edit(const GaussianSet& base, const EditPlan& plan, const CheckedRequest& request,
                    const EditTools& tools);

/// Extent of the views as 3DGS has it: 1.1 times the largest distance of a camera centre from their mean.
double camera_extent(const std::vector<View>& views);

}  // namespace gse::edit
