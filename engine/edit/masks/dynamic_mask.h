// Masks that follow an edit as it grows (GSEditPro 3.4; METHOD.md, Dynamic masks).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/edit/interfaces/edit_plan.h"
#include "engine/edit/interfaces/interfaces.h"
#include "engine/edit/request/checked_request.h"

namespace gse::edit {

/// One mask per view, static at first; later refreshed from the attention on the current render when its view
/// is drawn and its mask is old. A new mask is joined with what the label covers, averaged with the one
/// before and thresholded with hysteresis, so that it neither flickers nor runs away.
class DynamicMasks {
public:
    /// `word`, or the target where the prompt replaces it, is looked for in the current renders; `attention`
    /// null = the masks stay as they are.
    DynamicMasks(const EditPlan& plan, const CheckedRequest& request, std::string word,
                 AttentionSource* attention, Segmenter* segmenter);

    /// True when the view's mask is to be refreshed at this iteration.
    bool due(std::size_t view, int iteration) const;
    /// `shown` [H,W,3] in [0,1] and `label_seen` [H,W,1] (sum alpha T over labelled rows) are of the view
    /// now.
    void refresh(std::size_t view, int iteration, const Image& shown, const Image& label_seen);
    /// Replaces a view's static mask: the label was corrected.
    void set_static(std::size_t view, Mask mask);
    /// Mask of the word in a current render: attention, cleaned and refined by the segmenter. May be empty.
    Mask found_in(const Image& shown, std::size_t view, int iteration) const;
    bool can_look() const { return attention_ != nullptr && !word_.empty(); }
    const Mask& mask(std::size_t view) const { return masks_[view]; }
    std::size_t refreshed() const { return refreshed_; }
    std::size_t kept() const { return kept_; }  // refreshes that gave nothing sensible

private:
    const EditPlan& plan_;
    const CheckedRequest& request_;
    std::string word_;
    AttentionSource* attention_;
    Segmenter* segmenter_;
    std::vector<Mask> masks_;
    std::vector<std::size_t> static_area_;  // pixels
    std::vector<Image> soft_;               // [H,W,1] running mean of what was found
    std::vector<int> last_refresh_;         // iteration, -1 = never
    std::size_t refreshed_ = 0, kept_ = 0;
};

}  // namespace gse::edit
