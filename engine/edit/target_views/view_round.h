// A round of view guidance around the model's part: the redrawn views and the targets of the fit (METHOD.md,
// Redrawn views).
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "engine/edit/interfaces/edit_plan.h"
#include "engine/edit/interfaces/interfaces.h"
#include "engine/edit/interfaces/view_targets.h"
#include "engine/edit/masks/view_choice.h"
#include "engine/edit/request/checked_request.h"
#include "engine/edit/target_views/shape_round.h"
#include "engine/edit/target_views/view_agreement.h"

namespace gse::edit {

/// Settings of the loop, as they suit the kind of edit (METHOD.md, What the scene is fitted to).
/// With view guidance the steps are those of the fits, without a mask to follow. Growth comes once in the
/// middle of each round. Gaussians that get another shape move without anchors, each for itself, and grow
/// often. Settings that somebody set stay as they are. `supports_appearance_editing`: the editor of the
/// views does (MultiViewEditor::supports_appearance_editing()).
EditSettings loop_settings(EditSettings settings, EditMode mode, bool by_views,
                           bool supports_appearance_editing = false);
/// Part of those settings that follows from `supports_appearance_editing` alone. Shapes are shown, so that
/// views begin from noise alone, in steps of their own number.
EditSettings restyling(EditSettings settings, EditMode mode);

/// F edited + (1 - F) original, where F is the mask, feathered inwards by `feather_px`: outside the mask the
/// original stays bit by bit.
Image blend_inside(const Image& edited, const Image& original, const Mask& mask, double feather_px);

/// The rounds of an edit: which views are redrawn, and what the scene is fitted to meanwhile.
class ViewRounds {
public:
    /// `shapes` cuts out of the redrawn views what has a new shape; null where nothing has.
    /// `known`: words of the model; empty = it takes any.
    ViewRounds(const EditPlan& plan, const CheckedRequest& request, MultiViewEditor& guidance,
               ShapeFinder* shapes = nullptr, std::vector<std::string> known = {});

    /// Picks the views to redraw from those in which the edit is seen.
    void choose(const std::vector<std::size_t>& visible, const std::vector<Mask>& masks);
    const std::vector<std::size_t>& views() const { return views_; }
    /// Tells whether a round begins with this iteration.
    bool begins(int iteration) const;
    int round() const { return round_; }  // -1 = none has begun
    /// Has the views redrawn, in the order of views(); `originals` of all views of the plan. Returns what the
    /// model tells.
    std::map<std::string, double> redraw(int iteration, const std::vector<EditView>& views,
                                         const std::vector<Image>& originals, const JobControl& job);
    /// Has one of them redrawn once more, from a seed of its own for every `attempt` from 1 on.
    void redo(std::size_t view, const EditView& begun, int attempt, const Image& original,
              const JobControl& job);
    /// Another picture for a view of this round.
    void replace(std::size_t view, Image edited, const Image& original, const Mask& mask);
    /// Goes on in the middle of a round in which these views were redrawn; their pictures come by replace().
    void resume(const RoundState& start);
    /// By how much the views were redrawn further from the render than was asked, because they hardly
    /// changed.
    double raised() const { return raised_; }
    /// Word for the new object's colour if the artist's sentence leaves it open; else empty.
    const std::string& sentence() const { return sentence_; }
    /// Pictures that were asked for beside one of each of views() a round: for the colour, and where a first
    /// try hardly changed.
    std::size_t extra_pictures() const { return extra_pictures_; }
    /// Suspicious facts about the pictures of the last round.
    const std::vector<std::string>& warnings() const { return warnings_; }
    /// Per view of views(): 1 = the last round drew nothing of use there. Empty = all can be used.
    const std::vector<std::uint8_t>& rejected() const { return rejected_; }
    /// Per view of views(): 1 = the drawing of the last round ended before it. Empty = every view was drawn.
    const std::vector<std::uint8_t>& missing() const { return missing_; }
    /// Findings of the last round about the new shape.
    const CutOut& found() const { return found_; }
    /// Another mask: what was redrawn counts inside it.
    void blend(std::size_t view, const Image& original, const Mask& mask);
    /// Target picture of a fit: redrawn inside the mask, the original outside.
    const Image& target(std::size_t view) const { return targets_[view]; }
    /// As the model would have it.
    const Image& edited(std::size_t view) const { return edited_[view]; }

private:
    EditViewsRequest input(std::uint64_t stream) const;
    EditedViews draw(const std::vector<EditView>& views, const JobControl& job);
    void judge(const ViewAgreement& agreement, EditedViews& drawn);
    void name_colour(const std::vector<EditView>& views, const JobControl& job);
    std::string colour_of_key_view(const std::vector<EditView>& views, const JobControl& job);

    const EditPlan& plan_;
    const CheckedRequest& request_;
    MultiViewEditor& guidance_;
    ShapeFinder* shapes_;
    std::vector<std::string> known_;
    std::string sentence_;
    CutOut found_;
    std::vector<std::string> warnings_;
    std::vector<std::uint8_t> rejected_, missing_;
    std::vector<std::size_t> views_;
    std::vector<Image> targets_, edited_;  // of the plan's views; empty for those that are not redrawn
    double raised_ = 0;
    std::size_t extra_pictures_ = 0;
    int round_ = -1;
};

}  // namespace gse::edit
