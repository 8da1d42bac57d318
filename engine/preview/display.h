// Display modes of splats.
#pragma once

#include <array>
#include <cstdint>

namespace gse::preview {

/// Display mode; the order is that of ui::DisplayMode.
enum class Mode : std::uint32_t {
    Beauty,
    Centres,
    Rings,
    Ellipsoids,
    Depth,
    Opacity,
    Labels,       // beauty tinted by the value
    LabelWeight,  // the value in false colour over the dimmed picture
    Attention,
    Changed
};

struct Display {
    Mode mode = Mode::Beauty;
    int sh_degree = 3;
    bool antialiased = false;  // for scenes trained with the opacity compensation
    float near_plane = 0;      // 0 = follows scene and camera (scene/depth_range.h)
    std::array<float, 3> background{0, 0, 0};
    bool transparent = false;                      // alpha instead of the background, not premultiplied
    std::array<float, 3> tint{1.0f, 0.45f, 0.1f};  // its complement over what has its own hue
    float tint_strength = 0;  // beauty, centres, rings, ellipsoids, labels: how strongly the value tints
    // World units in the middle of the depth colours; 0 = distance to the scene's middle.
    float depth_scale = 0;
    float centre_radius_px = 1.5f;

    friend bool operator==(const Display&, const Display&) = default;
};

}  // namespace gse::preview
