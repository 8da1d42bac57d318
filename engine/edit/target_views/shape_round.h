// Shape of a replaced or new object from a round of redrawn views (METHOD.md, Visual hull): its outlines, the
// targets of the fit, and the rows it grows from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "engine/edit/interfaces/edit_plan.h"
#include "engine/edit/interfaces/interfaces.h"
#include "engine/edit/placement/visual_hull.h"
#include "engine/edit/request/checked_request.h"

namespace gse::edit {

/// Redrawn pictures with everything but the new thing taken out of them.
struct CutOut {
    std::vector<std::size_t> usable;        // indices of the views that show the thing
    std::vector<HullView> outlines;         // of those, with their pictures
    std::map<std::string, double> scalars;  // for the log
};

class ShapeFinder {
public:
    /// `word` is what is looked for in the redrawn pictures.
    ShapeFinder(const EditPlan& plan, const CheckedRequest& request, std::string word,
                AttentionSource& attention);

    /// Finds the thing in each picture and lays it over the view's clean plate: the pictures become what the
    /// scene is fitted to. Throws Error (Model) when fewer than three views show it, (Cancelled) on a stop
    /// request.
    CutOut cut_out(const std::vector<EditView>& views, EditedViews& drawn, int round, const JobControl& job);

    /// Takes the picture at `index`. Returns whether it shows the object.
    bool take_out(const EditView& view, EditedViews& drawn, std::size_t index, std::uint64_t seed,
                  Image* outline = nullptr) const;

    /// The word for the colour of the thing in a redrawn picture; empty where the picture does not show it.
    std::string colour_in(const EditView& view, const EditedViews& drawn, std::uint64_t seed,
                          const std::vector<std::string>& known) const;
    const std::string& word() const { return word_; }

    /// The rows that the new thing grows from, carved out of the box; empty when the outlines enclose nothing
    /// there.
    GaussianData seeds(const CutOut& found, const HullBox& box, int sh_degree) const;

private:
    AttentionQuery query_of(const EditView& view, const Image& picture, std::uint64_t seed) const;
    /// Mask of the object in a picture, [H,W,1] in [0,1], all zero if it does not show it. It follows the
    /// model's outlines, else the word's attention and the difference to the view's clean plate.
    Image outline_of(const EditView& view, const EditedViews& drawn, std::size_t index,
                     std::uint64_t seed) const;

    const EditPlan& plan_;
    const CheckedRequest& request_;
    std::string word_;
    AttentionSource& attention_;
};

}  // namespace gse::edit
