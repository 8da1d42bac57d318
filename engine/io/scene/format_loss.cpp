// Largest errors per field, in the units an artist sees.
#include "engine/io/scene/format_loss.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "engine/base/check.h"
#include "engine/io/bytes/encoding.h"
#include "engine/scene/scene.h"

namespace gse::io {
namespace {

// From here on a difference shows.
constexpr double VisibleSizeFactor = 1.1;
constexpr double VisibleMove = 0.5;  // of the splat's own largest standard deviation
constexpr double VisibleTurn = 2;    // degrees
constexpr double VisibleOpacity = 0.02;
constexpr double VisibleColour = 0.02;  // of the range from black to white

// The nearest view that is usual: a quarter of the distance at which a picture of this width shows the scene.
constexpr double ViewWidth = 1920;  // pixels
constexpr double Nearness = 4;
constexpr double DrawnPixels2 = 0.3;  // the picture's own blur, which is added to the drawn size

// Below this it is float rounding.
constexpr double RoundingOfSizes = 1e-5, RoundingOfPositions = 1e-6, RoundingOfTurns = 1e-3,
                 RoundingOfColours = 1e-6;

/// The worst error of one field and the splats where it is visible.
struct Worst {
    double error = 0;
    std::size_t visible = 0;

    void add(double value, bool shows) {
        if (std::isnan(value)) return;
        error = std::max(error, value);
        visible += shows ? 1 : 0;
    }
};

struct Losses {
    double blur = 0;        // blur_of_views()
    Worst larger, smaller;  // of the drawn sizes, as logs
    Worst move, turn, opacity, colour, view_colour;
    double extent = 0;  // largest coordinate
};

/// Standard deviation that a view adds to what it draws: far smaller sizes look alike.
double blur_of_views(const GaussianSet& set) {
    const OrbitParameters orbit = fit_orbit(compute_statistics(set), {0, -1, 0});
    const double pixel = 2 * orbit.radius * std::tan(0.5 * orbit.fov_x) / ViewWidth;
    return std::sqrt(DrawnPixels2) * pixel / Nearness;
}

/// Log of the size of an axis as a view draws it.
double drawn_log_size(double log_scale, double blur) {
    constexpr double Sharp = 20;  // from here on, as a log, the blur is below the last digit
    const double log_blur = std::log(blur), above = log_scale - log_blur;
    return above > Sharp ? log_scale : log_blur + 0.5 * std::log1p(std::exp(2 * above));
}

/// Degrees between two orientations. Exact for small ones.
double turn_between(const float* a, const float* b) {
    const auto p = unit_quaternion(a), q = unit_quaternion(b);
    double same = 0, opposite = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        same += (p[i] - q[i]) * (p[i] - q[i]);
        opposite += (p[i] + q[i]) * (p[i] + q[i]);
    }
    return 4 * std::asin(std::min(1.0, 0.5 * std::sqrt(std::min(same, opposite)))) * 180 / std::numbers::pi;
}

void add_geometry(Losses& losses, const GaussianSpans& a, std::size_t i, const GaussianSpans& b,
                  std::size_t j) {
    double largest = FlattestLogScale, up = 0, down = 0, distance = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double before = a.log_scale[i * 3 + axis], after = b.log_scale[j * 3 + axis];
        const double change = drawn_log_size(after, losses.blur) - drawn_log_size(before, losses.blur);
        largest = std::max(largest, before);
        up = std::max(up, change);
        down = std::max(down, -change);
        const double moved = static_cast<double>(b.position[j * 3 + axis]) - a.position[i * 3 + axis];
        distance += moved * moved;
        losses.extent = std::max(losses.extent, std::abs(static_cast<double>(a.position[i * 3 + axis])));
    }
    losses.larger.add(up, up > std::log(VisibleSizeFactor));
    losses.smaller.add(down, down > std::log(VisibleSizeFactor));
    losses.move.add(std::sqrt(distance), std::sqrt(distance) > VisibleMove * std::exp(largest));
    const double turned = turn_between(a.rotation.data() + i * 4, b.rotation.data() + j * 4);
    losses.turn.add(turned, turned > VisibleTurn);
}

void add_look(Losses& losses, const GaussianSpans& a, std::size_t i, const GaussianSpans& b, std::size_t j) {
    const double faded = std::abs(opacity_from_logit(static_cast<double>(a.opacity_logit[i])) -
                                  opacity_from_logit(static_cast<double>(b.opacity_logit[j])));
    losses.opacity.add(faded, faded > VisibleOpacity);
    const std::size_t a_stride = (rest_of_degree(a.sh_degree) + 1) * 3,
                      b_stride = (rest_of_degree(b.sh_degree) + 1) * 3;
    double colour = 0, view_colour = 0;
    for (std::size_t k = 0; k < a_stride; ++k) {
        const double back = k < b_stride ? static_cast<double>(b.sh[j * b_stride + k]) : 0.0;
        double& worst = k < 3 ? colour : view_colour;
        worst = std::max(worst, ShC0 * std::abs(static_cast<double>(a.sh[i * a_stride + k]) - back));
    }
    losses.colour.add(colour, colour > VisibleColour);
    losses.view_colour.add(view_colour, view_colour > VisibleColour);
}

std::string with_count(std::string text, const Worst& worst) {
    return worst.visible == 0 ? text
                              : text + fmt::format(" (visibly for {} splat{})", worst.visible,
                                                   worst.visible == 1 ? "" : "s");
}

std::string size_text(double change, const char* direction) {
    const double factor = std::exp(change);
    return factor < 2 ? fmt::format("sizes up to {:.2g} % too {}", (factor - 1) * 100, direction)
                      : fmt::format("sizes up to {:.3g} times too {}", factor, direction);
}

}  // namespace

std::string describe_loss(const GaussianSet& written, const GaussianSet& back,
                          std::span<const std::uint32_t> order) {
    const GaussianSpans a = written.spans(), b = back.spans();
    GSE_CHECK_EQ(a.size, b.size);
    Losses losses;
    losses.blur = blur_of_views(written);
    for (std::size_t row = 0; row < b.size; ++row) {
        const std::size_t source = order.empty() ? row : order[row];
        add_geometry(losses, a, source, b, row);
        add_look(losses, a, source, b, row);
    }
    std::string text;
    const auto tell = [&](const Worst& worst, double rounding, const std::string& words) {
        if (worst.error > rounding) text += (text.empty() ? "" : ", ") + with_count(words, worst);
    };
    tell(losses.smaller, RoundingOfSizes, size_text(losses.smaller.error, "small"));
    tell(losses.larger, RoundingOfSizes, size_text(losses.larger.error, "large"));
    tell(losses.move, RoundingOfPositions * losses.extent,
         fmt::format("positions up to {:.2g} off", losses.move.error));
    tell(losses.turn, RoundingOfTurns, fmt::format("rotations up to {:.2g} degrees off", losses.turn.error));
    tell(losses.opacity, RoundingOfColours, fmt::format("opacities up to {:.2g} off", losses.opacity.error));
    tell(losses.colour, RoundingOfColours, fmt::format("colours up to {:.2g} off", losses.colour.error));
    tell(losses.view_colour, RoundingOfColours,
         fmt::format("view-dependent colours up to {:.2g} off", losses.view_colour.error));
    return text;
}

}  // namespace gse::io
