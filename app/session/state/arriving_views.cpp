// Views of a search that is under way, on their road from the threads that look to the window.
#include "app/session/state/arriving_views.h"

#include <utility>

namespace gse::app {

void ArrivingViews::add(const View& view, std::size_t index, std::size_t count,
                        const edit::ViewEvidence& evidence) {
    arrivals_.push({pipeline::seen_view(view, evidence), index, count});
}

bool ArrivingViews::take(std::vector<pipeline::SeenView>& views) {
    auto arrivals = arrivals_.take();
    if (arrivals.empty()) return false;
    for (auto& [seen, index, count] : arrivals) {
        const bool same_place =
            index < views_.size() &&
            (views_[index].render == nullptr || views_[index].camera.translation == seen.camera.translation);
        if (views_.size() != count || !same_place) {
            views_.clear();
            views_.resize(count);
        }
        views_[index] = std::move(seen);
    }
    views = views_;
    return true;
}

}  // namespace gse::app
