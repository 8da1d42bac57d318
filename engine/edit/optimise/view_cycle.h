// The order in which an edit draws its views.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "engine/base/random.h"

namespace gse::edit {

/// Draws views without replacement, cycle after cycle.
class ViewCycle {
public:
    explicit ViewCycle(std::uint64_t seed) : random_(seed) {}
    /// From here on these views, none of them drawn yet.
    void begin(std::vector<std::size_t> views) {
        views_ = std::move(views);
        position_ = 0;
    }
    std::size_t next() {
        if (position_ == 0)
            for (std::size_t i = views_.size(); i > 1; --i)
                std::swap(views_[i - 1], views_[random_.below(i)]);
        const std::size_t view = views_[position_];
        position_ = (position_ + 1) % views_.size();
        return view;
    }

private:
    std::vector<std::size_t> views_;
    Random random_;
    std::size_t position_ = 0;
};

}  // namespace gse::edit
