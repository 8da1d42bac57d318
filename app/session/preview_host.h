// Interface between the application and any painter of the viewport.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "engine/scene/gaussian_set.h"
#include "ui/model/view_model.h"

namespace gse::app {

/// The picture that is wanted now; the newest request wins.
struct PictureRequest {
    GaussianSet set;
    GaussianSet original;                              // the other side of comparisons
    std::shared_ptr<const std::vector<float>> values;  // [set.size()] in [0,1] for tints and maps, or null
    bool antialiased = false;
    bool transparent = false;  // without the background; painted by shown_picture() alone
    Camera camera;             // at the viewport's size
    ui::ViewSettings settings;
    ui::Comparison comparison = ui::Comparison::None;
    bool moving = false;        // resolution may drop
    std::uint64_t content = 0;  // another number = set, original or values are others
};

/// The picture that is there.
struct PictureState {
    ui::TextureId texture = 0;
    ui::TextureId original = 0;  // the other side of a wipe, where it is a picture of its own
    int width = 0, height = 0;
    Camera camera;
    std::shared_ptr<const Image> depth;  // [H,W,1] alpha-normalised, 0 = nothing; may be null
    double render_ms = 0;
    std::string renderer;
    bool busy = false;  // a newer picture is on its way
};

class PreviewHost {
public:
    virtual ~PreviewHost() = default;
    virtual void want(const PictureRequest& request) = 0;
    virtual PictureState state() = 0;
};

}  // namespace gse::app
