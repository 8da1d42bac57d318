// Farthest-point samples of cameras.
#include "engine/edit/masks/view_choice.h"

#include <algorithm>
#include <limits>

#include "engine/base/check.h"

namespace gse::edit {
namespace {

// Share of the picture: smaller things are not worth a redrawn view (METHOD.md, Redrawn views)
constexpr double LeastCover = 0.01;

}  // namespace

std::vector<std::size_t> views_to_redraw(const std::vector<View>& views, const std::vector<double>& covered,
                                         std::size_t count) {
    GSE_CHECK_EQ(views.size(), covered.size());
    const double most = covered.empty() ? 0 : *std::max_element(covered.begin(), covered.end());
    if (!(most > 0)) return {};
    const double least = std::min(LeastCover, most);
    std::vector<std::size_t> chosen{
        static_cast<std::size_t>(std::max_element(covered.begin(), covered.end()) - covered.begin())};
    std::vector<double> distance(views.size(), std::numeric_limits<double>::infinity());
    while (chosen.size() < count) {
        const Vec3 last = views[chosen.back()].camera.centre();
        distance[chosen.back()] = -1;
        std::size_t farthest = views.size();
        for (std::size_t v = 0; v < views.size(); ++v) {
            distance[v] = std::min(distance[v], length(views[v].camera.centre() - last));
            const bool counts = covered[v] >= least && distance[v] >= 0;
            if (counts && (farthest == views.size() || distance[v] > distance[farthest])) farthest = v;
        }
        if (farthest == views.size()) break;
        chosen.push_back(farthest);
    }
    std::sort(chosen.begin(), chosen.end());
    return chosen;
}

}  // namespace gse::edit
