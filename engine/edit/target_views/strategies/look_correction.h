// Redrawn views brought to the look that their sentence asks for, where the model falls short of it
// (METHOD.md, Looks).
#pragma once

#include <optional>

#include "engine/edit/interfaces/interfaces.h"
#include "engine/edit/words/look_words.h"

namespace gse::edit {

/// Corrects what a model of few pictures draws on things unlike those. In parts of one colour of which less
/// than LookEnough has the look, pixels without it go towards the look's tones. The thing keeps its own light
/// and shade: a tone follows from the luminance in the unedited scene, compared with that of parts of one
/// colour.
class LookCorrection final : public MultiViewEditor {
public:
    /// `guidance` stays alive.
    LookCorrection(MultiViewEditor& guidance, const Look& look) : guidance_(guidance), look_(look) {}
    EditedViews edit(const std::vector<EditView>& views, const EditViewsRequest& input,
                     const JobControl& job) override;
    bool supports_appearance_editing() const override { return guidance_.supports_appearance_editing(); }

    /// Share of the masks' pixels that has the look in the pictures of the last round; none before one.
    std::optional<double> share() const { return share_; }

private:
    MultiViewEditor& guidance_;
    Look look_;
    std::optional<double> share_;
};

inline constexpr double LookEnough = 0.7;  // share of a part from which on nothing is corrected
inline constexpr double LookPoor = 0.5;    // share from which down it is corrected in full

}  // namespace gse::edit
