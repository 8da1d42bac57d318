// What redrawn views look like before the scene is fitted to them: whether they show a change at all, whether
// they agree on it, and whether the mask cuts it off (views.md 8.7 and 12).
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "engine/edit/interfaces/interfaces.h"

namespace gse::edit {

struct ViewAgreement {
    /// Mean absolute distance of a point's colour in a view from its median over the views, over the points
    /// in the masks that at least three of them show; 0 = no such point.
    double disagreement = 0;
    double unchanged =
        0;  // share of the views that differ from the unedited scene by hardly anything inside the mask
    double at_rim = 0;     // share of the change that lies within two cells of a latent of the mask's rim
    double rim_share = 0;  // share of the masks' pixels that lie there: of thin things most
    std::map<std::string, double> scalars() const;
};

/// `pictures` as the model would have them, of the views' size and in their order; depths say which pixels
/// show the same point.
ViewAgreement view_agreement(const std::vector<EditView>& views, const std::vector<Image>& pictures);

/// Per view [H,W,1]: how much a pixel counts in the fit (views.md 8.7): max(0.1, exp(-d / 0.15)) for the
/// distance d of its colour from the median over the views that show its point; 1 where fewer than three do,
/// and outside the masks. With it grounds come nearer to the truth (error removed 0.595 0.632 0.558 -> 0.623
/// 0.642 0.564 on suites of seeds 55 56 57, 12 edits each; recolours and materials 0.658 0.534 0.581 -> 0.655
/// 0.535 0.591). Colours that are common to the label by less where views agree (coupling 0.5 to 0.9 there)
/// lose: 0.619 and 0.529 on seeds 55 and 56.
std::vector<Image> trust_weights(const std::vector<EditView>& views, const std::vector<Image>& pictures);

/// Whether most views hardly show a change: the model should begin further from the render (views.md 12).
bool hardly_edited(const ViewAgreement& agreement);

/// Mean difference of a pixel's largest and smallest channel inside the mask; 0 where nothing is masked.
double mean_chroma(const Image& picture, const Mask& mask);
/// What is left in the fitted scene of the colour that the redrawn views have: its mean chroma as a share of
/// the views' median; less than 1 where views of different colours cancel each other to grey (views.md 12).
/// Negative where the views have hardly any.
double kept_chroma(std::vector<double> of_views, const std::vector<double>& of_scene);
/// A sentence for the artist, or none.
std::string warning_of_chroma(double kept);

/// Sentences for the artist, with what would help; none where nothing is suspicious. `anew`: a thing of a new
/// shape, whose points the depths do not know.
std::vector<std::string> warnings_of(const ViewAgreement& agreement, bool anew);

}  // namespace gse::edit
