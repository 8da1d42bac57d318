// Views for what redraws them.
#pragma once

#include <vector>

#include "engine/edit/interfaces/interfaces.h"

namespace gse::test {

/// Two views of one wall with something to see on it.
inline std::vector<edit::EditView> wall_views() {
    std::vector<edit::EditView> views;
    for (const double x : {0.0, 0.3}) {
        edit::EditView view;
        view.view.camera = Camera::look_at({x, 0, 3}, {x, 0, 0}, {0, -1, 0}, 0.9, 40, 40);
        view.rendered = Image(40, 40, 3);
        for (std::size_t i = 0; i < view.rendered.data.size(); ++i)
            view.rendered.data[i] = static_cast<float>(i % 37) / 37.0f;
        view.original = view.rendered;
        view.depth = Image(40, 40, 1, 3.0f);
        view.mask = Mask(40, 40);
        for (int y = 8; y < 24; ++y)
            for (int at = 8; at < 24; ++at) view.mask.at(at, y) = 1;
        view.view_words = x == 0 ? "front view" : "side view";
        views.push_back(std::move(view));
    }
    return views;
}

}  // namespace gse::test
