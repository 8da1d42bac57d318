// What a round of redrawn views says of a thing that becomes another, or is new: its outlines, what the scene
// is fitted to, and the rows it grows from (views.md 17).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "engine/edit/interfaces/edit_plan.h"
#include "engine/edit/interfaces/interfaces.h"
#include "engine/edit/placement/visual_hull.h"

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
    ShapeFinder(const EditPlan& plan, const EditRequest& request, std::string word,
                AttentionSource& attention);

    /// Finds the thing in each picture and lays it over the view's backdrop: the pictures become what the
    /// scene is fitted to. Throws Error (Model) when fewer than three views show it, (Cancelled) on a stop
    /// request.
    CutOut cut_out(const std::vector<EditView>& views, EditedViews& drawn, int round, const JobControl& job);

    /// The same for the picture at `index`. Whether it shows the thing.
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
    /// Where a picture shows the thing, by what the model tells of it, else by the word's attention and by
    /// what differs from the view's backdrop; [H,W,1] in [0,1], all zero where it does not.
    Image outline_of(const EditView& view, const EditedViews& drawn, std::size_t index,
                     std::uint64_t seed) const;

    const EditPlan& plan_;
    const EditRequest& request_;
    std::string word_;
    AttentionSource& attention_;
};

}  // namespace gse::edit
