// EWA projection (Zwicker et al. 2001, Kerbl et al. 2023) of one Gaussian in double precision, and its
// derivative.
#include "engine/raster/plain_projection.h"

#include <algorithm>
#include <cmath>

#include "engine/math/spherical_harmonics.h"
#include "engine/raster/conventions.h"

namespace gse::raster::plain {
namespace {

/// 2x3 matrix, row-major.
using Mat23 = std::array<Vec3, 2>;

/// Everything between the raw parameters and the projected covariance.
struct Geometry {
    Vec3 camera_point;                          // camera frame
    double ratio_x = 0, ratio_y = 0;            // x/z and y/z after the frustum clamp
    bool inside_x = true, inside_y = true;      // false where the clamp holds
    Mat3 rotation;                              // of the Gaussian
    double quaternion_norm = 1;                 // 0: identity was used
    Vec3 scale;                                 // standard deviations
    Mat3 axes;                                  // rotation * diag(scale), columns are the scaled axes
    Mat23 to_pixels;                            // J W: world offset -> pixels
    Mat23 footprint;                            // J W axes
    double raw_xx = 0, raw_xy = 0, raw_yy = 0;  // covariance before the blur, px^2
    double xx = 0, yy = 0;                      // after the blur
    double raw_determinant = 0, determinant = 0;
};

bool usable(const Inputs& in, std::size_t row) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (!(std::abs(in.position[row * 3 + axis]) <= PositionLimit)) return false;
        const double log_scale = in.log_scale[row * 3 + axis];
        if (std::isnan(log_scale) || log_scale == INFINITY) return false;
    }
    for (std::size_t k = 0; k < 4; ++k)
        if (!std::isfinite(in.rotation[row * 4 + k])) return false;
    return !std::isnan(in.opacity_logit[row]);
}

double sigmoid(double logit) { return 1.0 / (1.0 + std::exp(-logit)); }

/// Clamp of x/z to the frustum widened by the margin, as in gsplat. It follows the principal point.
double clamp_ratio(double ratio, double size, double focal, double centre) {
    const double margin = FrustumMargin * 0.5 * size / focal;
    return std::clamp(ratio, -(centre / focal + margin), (size - centre) / focal + margin);
}

void shape(const Inputs& in, std::size_t row, Geometry& g) {
    const double* q = &in.rotation[row * 4];
    const double squared = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    g.quaternion_norm = squared < QuaternionCut ? 0.0 : std::sqrt(squared);
    g.rotation = g.quaternion_norm > 0 ? rotation_matrix(Quat{q[0], q[1], q[2], q[3]}) : Mat3::identity();
    for (int axis = 0; axis < 3; ++axis)
        g.scale[axis] =
            std::exp(std::min(in.log_scale[row * 3 + static_cast<std::size_t>(axis)], LogScaleLimit));
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) g.axes(r, c) = g.rotation(r, c) * g.scale[c];
}

Vec3 position_of(const Inputs& in, std::size_t row) {
    return {in.position[row * 3], in.position[row * 3 + 1], in.position[row * 3 + 2]};
}

void footprint(const View& view, Geometry& g) {
    const Camera& camera = view.camera;
    const double z = g.camera_point.z;
    const double x = g.camera_point.x / z, y = g.camera_point.y / z;
    g.ratio_x = clamp_ratio(x, camera.width, camera.fx, camera.cx);
    g.ratio_y = clamp_ratio(y, camera.height, camera.fy, camera.cy);
    g.inside_x = g.ratio_x == x;
    g.inside_y = g.ratio_y == y;
    g.to_pixels[0] = Vec3{camera.fx / z, 0, -camera.fx * g.ratio_x / z} * camera.rotation;
    g.to_pixels[1] = Vec3{0, camera.fy / z, -camera.fy * g.ratio_y / z} * camera.rotation;
    g.footprint = {g.to_pixels[0] * g.axes, g.to_pixels[1] * g.axes};
    g.raw_xx = dot(g.footprint[0], g.footprint[0]);
    g.raw_xy = dot(g.footprint[0], g.footprint[1]);
    g.raw_yy = dot(g.footprint[1], g.footprint[1]);
    const double blur = view.blur_px2;
    g.xx = g.raw_xx + blur;
    g.yy = g.raw_yy + blur;
    // |u x v|^2 = |u|^2 |v|^2 - (u.v)^2 without its cancellation for needles.
    const Vec3 area = cross(g.footprint[0], g.footprint[1]);
    g.raw_determinant = dot(area, area);
    g.determinant = g.raw_determinant + blur * (g.raw_xx + g.raw_yy) + blur * blur;
}

struct Colour {
    Vec3 direction;  // unit, eye -> Gaussian
    double distance = 0;
    int degree = 0;
    std::array<double, MaxShCoefficients> basis{};
    std::array<double, 3> raw{};  // before the clamp at 0
};

Colour colour_of(const Inputs& in, std::size_t row, const View& view) {
    Colour result;
    const Vec3 offset = position_of(in, row) - view.eye;
    result.distance = length(offset);
    result.direction = normalized(offset);
    result.degree = std::clamp(view.settings.sh_degree, 0, in.sh_degree);
    sh_basis(result.direction, result.degree, result.basis.data());
    const std::size_t stride = static_cast<std::size_t>(sh_coefficient_count(in.sh_degree)) * 3;
    const std::size_t used = static_cast<std::size_t>(sh_coefficient_count(result.degree));
    for (std::size_t channel = 0; channel < 3; ++channel) {
        double sum = 0.5;
        for (std::size_t k = 0; k < used; ++k) sum += result.basis[k] * in.sh[row * stride + k * 3 + channel];
        result.raw[channel] = sum;
    }
    return result;
}

/// Gradient of the spherical harmonics part: the coefficients, and the position through the direction.
void colour_backward(const Inputs& in, std::size_t row, const View& view,
                     const std::array<double, 3>& d_colour, RowGradient& result) {
    const Colour colour = colour_of(in, row, view);
    const std::size_t stride = static_cast<std::size_t>(sh_coefficient_count(in.sh_degree)) * 3;
    const std::size_t used = static_cast<std::size_t>(sh_coefficient_count(colour.degree));
    std::array<Vec3, MaxShCoefficients> slopes;
    sh_basis_gradient(colour.direction, colour.degree, slopes.data());
    Vec3 d_direction;
    for (std::size_t channel = 0; channel < 3; ++channel) {
        const double slope = colour.raw[channel] > 0 ? 1.0 : view.settings.negative_colour_slope;
        const double d = d_colour[channel] * slope;
        for (std::size_t k = 0; k < used; ++k) {
            result.sh[k * 3 + channel] = colour.basis[k] * d;
            d_direction = d_direction + slopes[k] * (in.sh[row * stride + k * 3 + channel] * d);
        }
    }
    if (!(colour.distance > 0)) return;
    const Vec3 tangent = d_direction - colour.direction * dot(colour.direction, d_direction);
    for (int axis = 0; axis < 3; ++axis)
        result.position[static_cast<std::size_t>(axis)] += tangent[axis] / colour.distance;
}

/// Symmetric 2x2 gradient of the blurred covariance. xy is half the derivative with respect to the entry.
struct CovarianceGradient {
    double xx = 0, xy = 0, yy = 0;
};

CovarianceGradient covariance_backward(const Geometry& g, const View& view, const SplatGradient& d) {
    const double a = g.yy / g.determinant, b = -g.raw_xy / g.determinant, c = g.xx / g.determinant;
    // dL/dCov = -Q G Q with Q the inverse covariance and G its symmetric gradient.
    const double ga = d.a, gb = 0.5 * d.b, gc = d.c;
    const double h00 = a * ga + b * gb, h01 = a * gb + b * gc, h10 = b * ga + c * gb, h11 = b * gb + c * gc;
    CovarianceGradient result{-(h00 * a + h01 * b), -(h00 * b + h01 * c), -(h10 * b + h11 * c)};
    if (view.settings.antialiased && g.raw_determinant > 0) {
        // opacity factor sqrt(det / det_blurred): d ln(factor) = (d det / det - d det_b / det_b) / 2
        const double raw = 0.5 * d.log_opacity / g.raw_determinant,
                     blurred = 0.5 * d.log_opacity / g.determinant;
        result.xx += raw * g.raw_yy - blurred * g.yy;
        result.xy -= raw * g.raw_xy - blurred * g.raw_xy;
        result.yy += raw * g.raw_xx - blurred * g.xx;
    }
    return result;
}

void rotation_backward(const Inputs& in, std::size_t row, const Geometry& g, const Mat3& d,
                       RowGradient& result) {
    if (!(g.quaternion_norm > 0)) return;
    const double n = g.quaternion_norm;
    const double w = in.rotation[row * 4] / n, x = in.rotation[row * 4 + 1] / n,
                 y = in.rotation[row * 4 + 2] / n, z = in.rotation[row * 4 + 3] / n;
    const double dw = 2 * (x * (d(2, 1) - d(1, 2)) + y * (d(0, 2) - d(2, 0)) + z * (d(1, 0) - d(0, 1)));
    const double dx = 2 * (y * (d(0, 1) + d(1, 0)) + z * (d(0, 2) + d(2, 0)) - 2 * x * (d(1, 1) + d(2, 2)) +
                           w * (d(2, 1) - d(1, 2)));
    const double dy = 2 * (x * (d(0, 1) + d(1, 0)) + z * (d(1, 2) + d(2, 1)) - 2 * y * (d(0, 0) + d(2, 2)) +
                           w * (d(0, 2) - d(2, 0)));
    const double dz = 2 * (x * (d(0, 2) + d(2, 0)) + y * (d(1, 2) + d(2, 1)) - 2 * z * (d(0, 0) + d(1, 1)) +
                           w * (d(1, 0) - d(0, 1)));
    const double radial = w * dw + x * dx + y * dy + z * dz;
    result.rotation = {(dw - w * radial) / n, (dx - x * radial) / n, (dy - y * radial) / n,
                       (dz - z * radial) / n};
}

/// Camera-frame gradient through the centre of the splat and through the Jacobian, which is clamped as in
/// forward.
Vec3 point_backward(const Geometry& g, const Camera& camera, const SplatGradient& d,
                    const Mat23& d_to_pixels) {
    const double x = g.camera_point.x, y = g.camera_point.y, z = g.camera_point.z;
    const Mat3 transposed = camera.rotation.transposed();
    const Vec3 jx = d_to_pixels[0] * transposed, jy = d_to_pixels[1] * transposed;
    const double d_ratio_x = g.inside_x ? -camera.fx / z * jx.z : 0.0;
    const double d_ratio_y = g.inside_y ? -camera.fy / z * jy.z : 0.0;
    Vec3 point;
    point.x = d.x * camera.fx / z + d_ratio_x / z;
    point.y = d.y * camera.fy / z + d_ratio_y / z;
    point.z = -(d.x * camera.fx * x + d.y * camera.fy * y) / (z * z) -
              (d_ratio_x * x + d_ratio_y * y) / (z * z) - (camera.fx * jx.x + camera.fy * jy.y) / (z * z) +
              (camera.fx * g.ratio_x * jx.z + camera.fy * g.ratio_y * jy.z) / (z * z);
    return point;
}

}  // namespace

Fate project(const Inputs& in, std::size_t row, const View& view, Splat& splat) {
    if (!usable(in, row)) return Fate::Unusable;
    const Camera& camera = view.camera;
    const Settings& settings = view.settings;
    Geometry g;
    g.camera_point = camera.to_camera(position_of(in, row));
    const double z = g.camera_point.z;
    if (!(z > (settings.near_plane > 0 ? static_cast<double>(settings.near_plane) : SmallestNear)) ||
        (settings.far_plane > 0 && !(z < settings.far_plane)))
        return Fate::Culled;
    shape(in, row, g);
    footprint(view, g);
    if (!(g.determinant > DeterminantCut)) return Fate::Culled;
    splat.opacity = sigmoid(in.opacity_logit[row]);
    if (settings.antialiased) splat.opacity *= std::sqrt(g.raw_determinant / g.determinant);
    if (!(splat.opacity >= AlphaCut)) return Fate::Culled;
    splat.row = row;
    splat.depth = z;
    splat.x = camera.fx * g.camera_point.x / z + camera.cx;
    splat.y = camera.fy * g.camera_point.y / z + camera.cy;
    splat.a = g.yy / g.determinant;
    splat.b = -g.raw_xy / g.determinant;
    splat.c = g.xx / g.determinant;
    // alpha >= 1/255 <=> d^T Q d <= k, an ellipse whose box has half-extents sqrt(k cov) (StopThePop,
    // appendix B.2).
    const double k = 2 * std::log(splat.opacity / AlphaCut);
    splat.half_width = std::sqrt(k * g.xx);
    splat.half_height = std::sqrt(k * g.yy);
    if (splat.x + splat.half_width < 0 || splat.x - splat.half_width > camera.width ||
        splat.y + splat.half_height < 0 || splat.y - splat.half_height > camera.height)
        return Fate::Culled;
    const Colour colour = colour_of(in, row, view);
    for (std::size_t channel = 0; channel < 3; ++channel) {
        if (!std::isfinite(colour.raw[channel])) return Fate::Unusable;
        splat.colour[channel] = std::max(0.0, colour.raw[channel]);
    }
    return Fate::Drawn;
}

void project_backward(const Inputs& in, const View& view, std::size_t row, const SplatGradient& d,
                      RowGradient& result) {
    result = {};
    Geometry g;
    g.camera_point = view.camera.to_camera(position_of(in, row));
    shape(in, row, g);
    footprint(view, g);
    result.opacity_logit = d.log_opacity * (1 - sigmoid(in.opacity_logit[row]));
    const CovarianceGradient cov = covariance_backward(g, view, d);
    const Mat23 d_footprint = {g.footprint[0] * (2 * cov.xx) + g.footprint[1] * (2 * cov.xy),
                               g.footprint[0] * (2 * cov.xy) + g.footprint[1] * (2 * cov.yy)};
    Mat3 d_rotation;
    Vec3 d_scale;
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) {
            const double d_axis =
                g.to_pixels[0][r] * d_footprint[0][c] + g.to_pixels[1][r] * d_footprint[1][c];
            d_rotation(r, c) = d_axis * g.scale[c];
            d_scale[c] += d_axis * g.rotation(r, c);
        }
    for (int axis = 0; axis < 3; ++axis) {
        const std::size_t k = static_cast<std::size_t>(axis);
        const bool clamped = in.log_scale[row * 3 + k] > LogScaleLimit;
        result.log_scale[k] = clamped ? 0.0 : d_scale[axis] * g.scale[axis];
    }
    rotation_backward(in, row, g, d_rotation, result);
    const Mat3 axes_transposed = g.axes.transposed();
    const Mat23 d_to_pixels = {d_footprint[0] * axes_transposed, d_footprint[1] * axes_transposed};
    const Vec3 d_world = view.camera.rotation.transposed() * point_backward(g, view.camera, d, d_to_pixels);
    result.position = {d_world.x, d_world.y, d_world.z};
    colour_backward(in, row, view, d.colour, result);
}

}  // namespace gse::raster::plain
