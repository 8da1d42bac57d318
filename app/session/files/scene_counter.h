// Statistics of the splats for the Scene panel, counted beside the frames: large scenes take a while.
#pragma once

#include "app/session/state/workspace.h"
#include "engine/scene/gaussian_set.h"
#include "engine/scene/scene.h"

namespace gse::app {

class SceneCounter {
public:
    explicit SceneCounter(Workspace& workspace) : workspace_(workspace) {}
    /// Counts the document's splats where they are others than those counted last. Once per frame.
    void refresh();
    /// True while the document's splats are others than those counted last.
    bool behind() const { return !counted_.shares_all_with(workspace_.document.state().current); }
    /// They were counted when the document was read.
    void take(const GaussianSet& counted, const SceneStatistics& statistics);
    const SceneStatistics& statistics() const { return statistics_; }

private:
    Workspace& workspace_;
    GaussianSet counted_;
    SceneStatistics statistics_;
};

}  // namespace gse::app
