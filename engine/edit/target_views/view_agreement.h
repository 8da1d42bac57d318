// Check of redrawn views before the scene is fitted to them (METHOD.md, Agreement of views). They should show
// a change, agree on it, and fit into the mask.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "engine/edit/interfaces/interfaces.h"

namespace gse::edit {

struct ViewAgreement {
    /// Mean absolute distance of a point's colour in a view from its median over the views. Points lie in the
    /// masks and are shown by at least three views; 0 = no such point.
    double disagreement = 0;
    // Share of the views that differ from the unedited scene by hardly anything inside the mask.
    double unchanged = 0;
    double at_rim = 0;     // share of the change that lies within two cells of a latent of the mask's rim
    double rim_share = 0;  // share of the masks' pixels that lie there: of thin things most
    std::map<std::string, double> scalars() const;
};

/// Checks `pictures` as the model would have them, of the views' size and in their order. Depths say which
/// pixels show one point.
ViewAgreement view_agreement(const std::vector<EditView>& views, const std::vector<Image>& pictures);

/// Disagreement of each view alone: its pixels' mean distance from the medians. 0 where too few views show
/// its points.
std::vector<double> view_disagreements(const std::vector<EditView>& views,
                                       const std::vector<Image>& pictures);

/// Weight of each pixel in the fit, per view [H,W,1]: max(0.1, exp(-d / 0.15)). d is the distance of its
/// colour from the median over the views that show its point. 1 if fewer than three do, and outside the masks
/// (METHOD.md, Agreement of views).
std::vector<Image> trust_weights(const std::vector<EditView>& views, const std::vector<Image>& pictures);

/// True when most views hardly show a change. The model should begin further from the render.
bool hardly_edited(const ViewAgreement& agreement);

/// Mean difference of a pixel's largest and smallest channel inside the mask. 0 if nothing is masked.
double mean_chroma(const Image& picture, const Mask& mask);
/// Share of the redrawn views' colour that the fitted scene keeps: its mean chroma over the views' median.
/// Less than 1 when views of different colours cancel each other to grey. Negative if the views have hardly
/// any.
double kept_chroma(std::vector<double> of_views, const std::vector<double>& of_scene);
/// A sentence for the artist, or none.
std::string warning_of_chroma(double kept);

/// Sentences for the artist, with remedies. None if nothing is suspicious. `anew`: an object of a new shape,
/// whose points the depths do not know.
std::vector<std::string> warnings_of(const ViewAgreement& agreement, bool anew);

}  // namespace gse::edit
