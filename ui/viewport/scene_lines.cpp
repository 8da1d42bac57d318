// Axes, bounds and cameras as lines of the world and of a picture.
#include "ui/viewport/scene_lines.h"

#include <algorithm>
#include <cmath>

namespace gse::ui {

Vec3 axis_direction(int end) {
    Vec3 direction;
    direction[end % 3] = end < 3 ? 1 : -1;
    return direction;
}

double axis_depth(const Camera& camera, int end) { return (camera.rotation * axis_direction(end)).z; }

std::array<int, AxisEnds> axes_by_depth(const Camera& camera) {
    std::array<int, AxisEnds> order{0, 1, 2, 3, 4, 5};
    std::sort(order.begin(), order.end(),
              [&](int a, int b) { return axis_depth(camera, a) > axis_depth(camera, b); });
    return order;
}

ImU32 axis_colour(const Camera& camera, int end) {
    constexpr double Behind = 0.2;
    return with_alpha(AxisColours[static_cast<std::size_t>(end % 3)],
                      axis_depth(camera, end) > Behind ? 0.55f : 1);
}

std::vector<WorldLine> box_lines(const Vec3& low, const Vec3& high) {
    const auto corner = [&](int bits) {
        return Vec3{bits & 1 ? high.x : low.x, bits & 2 ? high.y : low.y, bits & 4 ? high.z : low.z};
    };
    std::vector<WorldLine> lines;
    for (int from = 0; from < 8; ++from)
        for (const int bit : {1, 2, 4})
            if ((from & bit) == 0) lines.push_back({corner(from), corner(from | bit)});
    return lines;
}

std::vector<WorldLine> frustum_lines(const Camera& of, double radius, const Camera& seen_by) {
    constexpr double LengthShare = 0.07;  // of the scene's radius
    const double reach = radius * LengthShare;
    const Mat3 to_world = of.rotation.transposed();
    const Vec3 eye = of.centre();
    if (length(eye - seen_by.centre()) < 1.5 * reach) return {};
    std::array<Vec3, 4> corners;
    for (std::size_t at = 0; at < 4; ++at) {
        const double x = at == 0 || at == 3 ? 0 : of.width, y = at < 2 ? 0 : of.height;
        corners[at] = eye + to_world * (Vec3{(x - of.cx) / of.fx, (y - of.cy) / of.fy, 1} * reach);
    }
    std::vector<WorldLine> lines;
    for (std::size_t at = 0; at < 4; ++at) lines.push_back({eye, corners[at]});
    for (std::size_t at = 0; at < 4; ++at) lines.push_back({corners[at], corners[(at + 1) % 4]});
    return lines;
}

std::optional<std::array<double, 4>> seen_line(const Camera& camera, const WorldLine& line, double radius) {
    const double near = std::max(1e-9, radius * 1e-3);
    Vec3 from = camera.to_camera(line.from), to = camera.to_camera(line.to);
    if (from.z < near && to.z < near) return std::nullopt;
    if (from.z < near) from = from + (to - from) * ((near - from.z) / (to.z - from.z));
    if (to.z < near) to = to + (from - to) * ((near - to.z) / (from.z - to.z));
    return std::array<double, 4>{camera.fx * from.x / from.z + camera.cx,
                                 camera.fy * from.y / from.z + camera.cy, camera.fx * to.x / to.z + camera.cx,
                                 camera.fy * to.y / to.z + camera.cy};
}

float frustum_width(float em) { return std::max(1.0f, em * 0.07f); }

namespace {

using pipeline::PictureMark;

std::array<float, 4> rgba(ImU32 colour) {
    std::array<float, 4> parts{};
    const std::array<int, 4> shifts{IM_COL32_R_SHIFT, IM_COL32_G_SHIFT, IM_COL32_B_SHIFT, IM_COL32_A_SHIFT};
    for (std::size_t c = 0; c < 4; ++c) parts[c] = static_cast<float>((colour >> shifts[c]) & 0xffu) / 255.0f;
    return parts;
}

void add_lines(const ShownLines& shown, const std::vector<WorldLine>& lines, ImU32 colour, double width,
               std::vector<PictureMark>& marks) {
    for (const auto& line : lines)
        if (const auto seen = seen_line(shown.camera, line, shown.radius))
            marks.push_back({{(*seen)[0], (*seen)[1]}, {(*seen)[2], (*seen)[3]}, width / 2, rgba(colour)});
}

/// Strokes of the letters x, y and z in a square from -1 to 1.
std::vector<std::array<double, 4>> strokes(int axis) {
    if (axis == 0) return {{-1, -1, 1, 1}, {1, -1, -1, 1}};
    if (axis == 1) return {{-1, -1, 0, 0}, {1, -1, -0.9, 1.3}};
    return {{-1, -1, 1, -1}, {1, -1, -1, 1}, {-1, 1, 1, 1}};
}

void add_axis_end(const ShownLines& shown, int end, std::vector<PictureMark>& marks) {
    const double away = shown.em * AxesEm * AxesAway, size = shown.em * AxesEm;
    const std::array<double, 2> centre{away, shown.camera.height - away};
    const Vec3 seen = shown.camera.rotation * axis_direction(end);
    const std::array<double, 2> at{centre[0] + seen.x * size, centre[1] + seen.y * size};
    const double line = std::max(1.5f, shown.em * 0.13f) / 2;
    const auto colour = rgba(axis_colour(shown.camera, end));
    if (end >= 3) {
        const double r = shown.em * AxisBallEm * FarEndShare;
        marks.push_back({at, at, r, rgba(with_alpha(palette::Window, 0.75f))});
        return marks.push_back({at, at, line, colour, r});
    }
    marks.push_back({centre, at, line, colour});
    marks.push_back({at, at, shown.em * AxisBallEm, colour});
    const double letter = shown.em * AxisBallEm * 0.4;
    for (const auto& [x0, y0, x1, y1] : strokes(end))
        marks.push_back({{at[0] + x0 * letter, at[1] + y0 * letter},
                         {at[0] + x1 * letter, at[1] + y1 * letter},
                         std::max(0.5, shown.em * 0.045),
                         rgba(IM_COL32(20, 20, 22, 255))});
}

}  // namespace

std::vector<PictureMark> marks_of(const ShownLines& shown) {
    std::vector<PictureMark> marks;
    if (shown.settings.show_bounds)
        add_lines(shown, box_lines(shown.low, shown.high), with_alpha(palette::Text, BoundsAlpha), 1, marks);
    if (shown.settings.show_views)
        for (const auto& view : shown.views) {
            const auto lines = frustum_lines(view.camera, shown.radius, shown.camera);
            const ImU32 colour = with_alpha(palette::Text, FrustumAlpha);
            add_lines(shown, lines, colour, frustum_width(shown.em), marks);
            if (lines.empty()) continue;
            const auto eye = seen_line(shown.camera, {lines[0].from, lines[0].from}, shown.radius);
            if (!eye) continue;
            marks.push_back({{(*eye)[0], (*eye)[1]}, {(*eye)[0], (*eye)[1]}, shown.em * EyeEm, rgba(colour)});
        }
    if (shown.settings.show_axes)
        for (const int end : axes_by_depth(shown.camera)) add_axis_end(shown, end, marks);
    return marks;
}

}  // namespace gse::ui
