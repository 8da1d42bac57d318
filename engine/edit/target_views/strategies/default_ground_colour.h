// Grounds that look much alike everywhere: snow is white, whoever draws it (METHOD.md, Usual colours of
// grounds).
#pragma once

#include <array>
#include <optional>
#include <string>

#include "engine/edit/interfaces/interfaces.h"
#include "engine/edit/interfaces/model_traits.h"
#include "engine/edit/interfaces/view_targets.h"
#include "engine/edit/request/request.h"
#include "engine/language/sentence.h"

namespace gse::edit {

/// Colour, display values in [0,1], of the ground that an edit makes of another ("snow" for the
/// grass). None if it makes something else, if that ground has no usual colour, or if the sentence says its
/// colour ("red sand").
std::optional<std::array<float, 3>> default_ground_colour(const language::EditSentence& sentence,
                                                          language::EditMode mode, const ModelTraits& traits);

/// Share of the way to the colour that redrawn views have gone, in their changed pixels. 1 = all of it; below
/// 0 = away from it. 1 if they began near it.
double gone_towards(const std::array<float, 3>& colour, const ViewTargets& round);

/// Draws without a model: what the masks hold gets the colour, in the light and shade in which the unedited
/// scene shows it.
class DefaultGroundColour final : public MultiViewEditor {
public:
    explicit DefaultGroundColour(std::array<float, 3> colour) : colour_(colour) {}
    EditedViews edit(const std::vector<EditView>& views, const EditViewsRequest& input,
                     const JobControl& job) override;
    bool supports_appearance_editing() const override { return true; }

private:
    std::array<float, 3> colour_;
};

}  // namespace gse::edit
