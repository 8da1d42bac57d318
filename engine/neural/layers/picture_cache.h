// What an encoder said of the pictures asked about last.
#pragma once

#include <torch/torch.h>

#include <algorithm>
#include <list>
#include <mutex>
#include <string>
#include <utility>

#include "engine/base/digest.h"
#include "engine/base/image.h"

namespace gse::neural {

/// Keyed by the picture's digest. Threads may ask at the same time; two that ask for the same new picture
/// both work it out.
template <class Said> class PictureCache {
public:
    explicit PictureCache(std::size_t most) : most_(most) {}

    /// What was said of the picture, or else work_out() says now.
    template <class WorkOut> Said get(const Image& image, const WorkOut& work_out) {
        Digest digest;
        digest.image(image);
        const auto key = digest.hex();
        {
            const std::lock_guard lock(mutex_);
            const auto known = std::find_if(kept_.begin(), kept_.end(),
                                            [&](const auto& entry) { return entry.first == key; });
            if (known != kept_.end()) {
                kept_.splice(kept_.begin(), kept_, known);
                return known->second;
            }
        }
        Said said = work_out();
        const std::lock_guard lock(mutex_);
        kept_.emplace_front(key, said);
        if (kept_.size() > most_) kept_.pop_back();
        return said;
    }

private:
    const std::size_t most_;
    std::mutex mutex_;
    std::list<std::pair<std::string, Said>> kept_;  // the last first
};

}  // namespace gse::neural
