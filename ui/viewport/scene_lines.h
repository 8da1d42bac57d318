// Axes, bounds and cameras as lines: for the viewport, and for a saved picture of it.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "engine/pipeline/report/picture_marks.h"
#include "ui/model/theme.h"
#include "ui/model/view_model.h"

namespace gse::ui {

inline constexpr std::array<ImU32, 3> AxisColours{IM_COL32(226, 104, 98, 255), IM_COL32(124, 196, 104, 255),
                                                  IM_COL32(98, 150, 232, 255)};
inline constexpr float AxesEm = 2.05f;      // from the middle of the axes to a ball
inline constexpr float AxesAway = 1.5f;     // of that, from the picture's corner to the middle
inline constexpr float AxisBallEm = 0.47f;  // radius of a ball
inline constexpr float FarEndShare = 0.8f;  // of that radius, where an axis ends
/// Ends of the world's axes in the corner: x, y, z, -x, -y, -z.
inline constexpr int AxisEnds = 6;

/// Unit vector of an end.
Vec3 axis_direction(int end);
/// Ends from the farthest from the eye to the nearest.
std::array<int, AxisEnds> axes_by_depth(const Camera& camera);
/// How far an end points away from the eye, -1 to 1.
double axis_depth(const Camera& camera, int end);
/// Colour of an end: weaker where it points away.
ImU32 axis_colour(const Camera& camera, int end);

struct WorldLine {
    Vec3 from, to;
};

/// Edges of a box along the axes.
std::vector<WorldLine> box_lines(const Vec3& low, const Vec3& high);
/// Edges of the frustum of a view's camera, its eye first in the first four. `radius`: of the scene. Empty
/// where it is seen from inside: only stray lines would be seen.
std::vector<WorldLine> frustum_lines(const Camera& of, double radius, const Camera& seen_by);
/// Both ends in pixels of the camera, x y x y, cut at a near plane of a scene of that radius. Nothing when
/// it is behind.
std::optional<std::array<double, 4>> seen_line(const Camera& camera, const WorldLine& line, double radius);

constexpr float BoundsAlpha = 0.45f, FrustumAlpha = 0.55f;
constexpr float EyeEm = 0.18f;  // radius of the dot at a frustum's eye
/// Width of a frustum's lines, pixels.
float frustum_width(float em);

/// Scene as the viewport shows it, without its splats.
struct ShownLines {
    Camera camera;
    ViewSettings settings;  // that switch axes, bounds and cameras on
    Vec3 low, high;         // of the bounds
    std::span<const View> views;
    double radius = 1;  // of the scene
    float em = 15;      // size of the window's letters in pixels of the camera
};

/// Marks over a picture by that camera, in the order in which the viewport draws them.
std::vector<pipeline::PictureMark> marks_of(const ShownLines& shown);

}  // namespace gse::ui
