// Views of a search that is under way, on their road from the threads that look to the window.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/base/shared_queue.h"
#include "engine/pipeline/report/evidence_pictures.h"

namespace gse::app {

class ArrivingViews {
public:
    /// Hands over view number `index` of `count`, from any thread. A view from another place than the one of
    /// that number before begins a new search.
    void add(const View& view, std::size_t index, std::size_t count, const edit::ViewEvidence& evidence);
    /// True when views came since the last call; `views` then holds all so far, with gaps. Main thread only.
    bool take(std::vector<pipeline::SeenView>& views);

private:
    struct Arrival {
        pipeline::SeenView view;
        std::size_t index = 0, count = 0;
    };
    SharedQueue<Arrival> arrivals_;
    std::vector<pipeline::SeenView> views_;  // of the main thread
};

}  // namespace gse::app
