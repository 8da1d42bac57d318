// Optimisation by view guidance alone (METHOD.md, Redrawn views). Views are redrawn, an artist may drop some
// and have others redrawn, and the rows are fitted to the rest.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "engine/edit/interfaces/edit_plan.h"
#include "engine/edit/interfaces/edit_tools.h"
#include "engine/edit/interfaces/view_targets.h"
#include "engine/edit/masks/dynamic_mask.h"
#include "engine/edit/target_views/view_round.h"

namespace gse::edit {

/// The rounds of one edit. Refers to all it is given; `originals` and `masks` are of all views of the plan.
class DatasetUpdate {
public:
    /// `shapes` cuts out of the redrawn views what has a new shape; null where nothing has.
    DatasetUpdate(const EditPlan& plan, const CheckedRequest& request, const EditTools& tools,
                  const std::vector<Image>& originals, const DynamicMasks& masks,
                  ShapeFinder* shapes = nullptr);

    /// Picks the views to redraw from those in which the edit is seen. An edit that starts in the middle of a
    /// round goes on with what was redrawn in it, where nothing has changed that the pictures follow from.
    void choose(const std::vector<std::size_t>& visible);
    /// Views of the plan that the fit uses, ascending; at least one.
    std::vector<std::size_t> fitted() const;
    /// Tells whether a round begins with this iteration.
    bool begins(int iteration) const { return rounds_.begins(iteration); }
    /// Has the views redrawn as the rows show them now; a new thing is laid over what the rows of
    /// `unlabelled` show. Returns what the model tells. Throws Error (Cancelled, Model).
    std::map<std::string, double> redraw(int iteration, const GaussianSpans& rows,
                                         const GaussianSpans& unlabelled, const raster::Settings& settings);
    /// Does what the artist says, as long as there are orders. The last view that is used is not dropped, and
    /// one that cannot be redrawn once more stays as it is. Throws Error (Cancelled).
    void take_orders();
    /// Tells whether a round was redrawn, or taken over from an earlier run.
    bool has_views() const { return state_ != nullptr; }
    /// The round's views before and after.
    const ViewTargets& sheet() const { return sheet_; }
    /// Hands the sheet of a round out, once.
    void show_new_sheet();
    int round() const { return rounds_.round(); }  // -1 = none has begun
    /// Rows for the holes that a thing leaves when another takes its place, as the round's views show them
    /// (ground_hole_fill()).
    GaussianData hole_fill(int sh_degree) const;
    const CutOut& found() const { return rounds_.found(); }  // of the new shape, in the last round
    /// The masks have changed: what was redrawn counts inside them.
    void take_masks();
    /// Target picture of a fit: redrawn inside the mask, the original outside.
    const Image& target(std::size_t view) const { return rounds_.target(view); }

    /// How much a pixel of it counts, [H,W,1]; null = all fully.
    const Image* trust(std::size_t view) const {
        return trust_.empty() || trust_[view].data.empty() ? nullptr : &trust_[view];
    }
    /// After the fit: see kept_chroma(); says so where the colours were lost.
    double check_colour(const GaussianSpans& rows, const raster::Settings& settings);

    /// For snapshots; null before the first round.
    const std::shared_ptr<const RoundState>& state() const { return state_; }
    std::size_t redrawn() const { return redrawn_ + rounds_.extra_pictures(); }  // pictures so far
    double seconds() const { return seconds_; }                                  // that redrawing took

private:
    EditView begin_view(std::size_t view, const GaussianSpans& rows, const GaussianSpans& unlabelled,
                        const raster::Settings& settings);
    /// Renders of rows from a camera. Colour [H,W,3] in [0,1]; depth of the surface [H,W,1], 0 where hardly
    /// anything is; and covered share of each pixel [H,W,1].
    struct Surface {
        Image colour, depth, alpha;
    };
    Surface draw(const GaussianSpans& rows, const Camera& camera, const raster::Settings& settings);
    bool resumes(const RoundState& start, const std::vector<std::size_t>& visible) const;
    bool follow(const TargetOrder& order, RoundState& next);
    void redo(std::size_t index, RoundState& next);
    void weigh();
    void begin_sheet();
    void refresh_sheet(std::size_t index);
    void show_sheet() const;

    const EditPlan& plan_;
    const CheckedRequest& request_;
    const EditTools& tools_;
    const std::vector<Image>& originals_;
    const DynamicMasks& masks_;
    const bool anew_;  // a thing of a new shape
    ViewRounds rounds_;
    const std::string key_;
    std::shared_ptr<const RoundState> state_;
    std::vector<Image> trust_;  // of the plan's views; empty for what is not fitted
    ViewTargets sheet_;
    bool new_sheet_ = false;  // it was not handed out yet
    raster::ForwardOutput output_;
    std::size_t redrawn_ = 0;
    double seconds_ = 0;
};

}  // namespace gse::edit
