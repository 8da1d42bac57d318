// What redrawn views look like before the scene is fitted to them: whether they show a change at all, whether they agree on it,
// and whether the mask cuts it off (views.md 8.7 and 12).
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "engine/edit/interfaces.h"

namespace gse::edit {

struct ViewAgreement {
    /// Mean absolute distance of a point's colour in a view from its median over the views, over the points in the masks that
    /// at least three of them show; 0 = no such point.
    double disagreement = 0;
    double unchanged = 0;    // share of the views that differ from their render by hardly anything inside the mask
    double at_rim = 0;       // share of the change that lies within two cells of a latent of the mask's rim
    std::map<std::string, double> scalars() const;
};

/// `pictures` as the model would have them, of the views' size and in their order; depths say which pixels show the same point.
ViewAgreement view_agreement(const std::vector<RoundView>& views, const std::vector<Image>& pictures);

/// Sentences for the artist, with what would help; none where nothing is suspicious. `anew`: a thing of a new shape, whose points
/// the depths do not know.
std::vector<std::string> warnings_of(const ViewAgreement& agreement, bool anew);

}  // namespace gse::edit
