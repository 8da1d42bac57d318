// Statistics of the splats for the Scene panel, counted beside the frames: large scenes take a while.
#include "app/session/files/scene_counter.h"

#include <memory>

namespace gse::app {

void SceneCounter::refresh() {
    if (!behind()) return;
    const auto& current = workspace_.document.state().current;
    auto statistics = std::make_shared<SceneStatistics>();
    auto done = [this, statistics, opened = workspace_.opened](const Error*) {
        if (opened == workspace_.opened) statistics_ = *statistics;
    };
    const auto work = [statistics, set = current](const JobControl&) {
        *statistics = compute_statistics(set);
    };
    if (workspace_.jobs->counter.start({"Count", work, done}))
        counted_ = current;  // else once the last count has ended, whose news wake the window
}

void SceneCounter::take(const GaussianSet& counted, const SceneStatistics& statistics) {
    counted_ = counted;
    statistics_ = statistics;
}

}  // namespace gse::app
