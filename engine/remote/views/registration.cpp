// Pyramid of grey pictures; shifts at its top, Gauss-Newton below (Lucas and Kanade 1981).
#include "engine/remote/views/registration.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "engine/base/check.h"

namespace gse::remote {
namespace {

constexpr double LeastShare = 0.01;  // of the pixels that count, for an estimate
constexpr int CoarsestSide = 64;     // px of the exhaustive search, at most
constexpr int FinestSide = 512;      // px: larger pictures add nothing to the precision that is needed
constexpr double SearchShare = 0.1;  // of the side: shifts that the search tries
constexpr double MostReach = 0.2;    // share of the side: beyond it the steps have diverged
constexpr int Iterations = 12;       // of Gauss-Newton on a level
constexpr double Outlier = 0.1;      // residual from which on a pixel counts less (Huber)
constexpr double LeastStep = 1e-4;   // px: a smaller step ends a level
constexpr int Reach = 2;             // px around a pixel that its slope and its interpolation touch
constexpr std::size_t Unknowns = 5;  // scale, rotation, two shifts, brightness

/// A level of the pyramid, [S,S] grey.
struct Level {
    int side = 0;
    std::vector<float> sent, drawn, weight;

    float value(const std::vector<float>& image, int x, int y) const {
        return image[static_cast<std::size_t>(y) * static_cast<std::size_t>(side) +
                     static_cast<std::size_t>(x)];
    }
    /// Bilinear value at pixel coordinates whose centres are whole; the rim is repeated.
    double sampled(const std::vector<float>& image, double x, double y) const {
        const double most = side - 1;
        x = std::clamp(x, 0.0, most), y = std::clamp(y, 0.0, most);
        const int x0 = std::min(static_cast<int>(x), side - 2), y0 = std::min(static_cast<int>(y), side - 2);
        const double u = x - x0, v = y - y0;
        return (1 - v) * ((1 - u) * value(image, x0, y0) + u * value(image, x0 + 1, y0)) +
               v * ((1 - u) * value(image, x0, y0 + 1) + u * value(image, x0 + 1, y0 + 1));
    }
    bool inside(double x, double y) const { return x >= 0 && y >= 0 && x <= side - 1 && y <= side - 1; }
};

std::vector<float> grey_of(const Image& picture) {
    std::vector<float> grey(picture.pixel_count());
    for (std::size_t i = 0; i < grey.size(); ++i)
        grey[i] = (picture.data[i * 3] + picture.data[i * 3 + 1] + picture.data[i * 3 + 2]) / 3;
    return grey;
}

std::vector<float> halved(const std::vector<float>& image, int side) {
    const int half = side / 2;
    std::vector<float> result(static_cast<std::size_t>(half) * static_cast<std::size_t>(half));
    const auto at = [&](int x, int y) {
        return image[static_cast<std::size_t>(y) * static_cast<std::size_t>(side) +
                     static_cast<std::size_t>(x)];
    };
    for (int y = 0; y < half; ++y)
        for (int x = 0; x < half; ++x)
            result[static_cast<std::size_t>(y) * static_cast<std::size_t>(half) +
                   static_cast<std::size_t>(x)] =
                (at(2 * x, 2 * y) + at(2 * x + 1, 2 * y) + at(2 * x, 2 * y + 1) + at(2 * x + 1, 2 * y + 1)) /
                4;
    return result;
}

/// Weights that count only where all neighbours do: interpolation and slopes touch nothing that changed.
void erode_weights(Level& level) {
    const auto before = level.weight;
    const auto lost = [&](int x, int y) {
        for (int v = std::max(0, y - Reach); v <= std::min(level.side - 1, y + Reach); ++v)
            for (int u = std::max(0, x - Reach); u <= std::min(level.side - 1, x + Reach); ++u)
                if (level.value(before, u, v) < 1) return true;
        return false;
    };
    for (int y = 0; y < level.side; ++y)
        for (int x = 0; x < level.side; ++x)
            if (lost(x, y))
                level.weight[static_cast<std::size_t>(y) * static_cast<std::size_t>(level.side) +
                             static_cast<std::size_t>(x)] = 0;
}

/// Finest level first.
std::vector<Level> pyramid_of(const Image& sent, const Image& drawn, const Mask& changed) {
    Level level{sent.width, grey_of(sent), grey_of(drawn), {}};
    for (const auto bit : changed.data) level.weight.push_back(bit != 0 ? 0.0f : 1.0f);
    std::vector<Level> levels;
    for (;;) {
        if (level.side <= FinestSide || level.side / 2 < CoarsestSide) levels.push_back(level);
        if (!levels.empty() && levels.back().side == level.side) erode_weights(levels.back());
        if (level.side / 2 < CoarsestSide / 2 || level.side <= CoarsestSide) return levels;
        level = {level.side / 2, halved(level.sent, level.side), halved(level.drawn, level.side),
                 halved(level.weight, level.side)};
    }
}

/// Variance of the difference of the pictures at a shift of whole pixels; infinite where too few overlap.
double mismatch(const Level& level, int dx, int dy) {
    double weights = 0, sum = 0, squares = 0, all = 0;
    for (int y = 0; y < level.side; ++y)
        for (int x = 0; x < level.side; ++x) {
            const double weight = level.value(level.weight, x, y);
            all += weight;
            if (weight <= 0 || !level.inside(x + dx, y + dy)) continue;
            const double difference =
                level.value(level.drawn, x + dx, y + dy) - level.value(level.sent, x, y);
            weights += weight, sum += weight * difference, squares += weight * difference * difference;
        }
    if (weights < all / 2) return std::numeric_limits<double>::infinity();
    return squares / weights - (sum / weights) * (sum / weights);
}

Similarity best_shift(const Level& level) {
    const int most = static_cast<int>(std::ceil(SearchShare * level.side));
    double least = mismatch(level, 0, 0);
    Similarity best;
    for (int dy = -most; dy <= most; ++dy)
        for (int dx = -most; dx <= most; ++dx) {
            const double here = mismatch(level, dx, dy);
            if (here >= least) continue;
            least = here;
            best.dx = static_cast<double>(dx) / level.side, best.dy = static_cast<double>(dy) / level.side;
        }
    return best;
}

using Normal = std::array<std::array<double, Unknowns + 1>, Unknowns>;  // matrix with its right side

/// Solves by elimination with pivots; false where the matrix is singular.
bool solve(Normal& system, std::array<double, Unknowns>& solution) {
    for (std::size_t column = 0; column < Unknowns; ++column) {
        std::size_t pivot = column;
        for (std::size_t row = column + 1; row < Unknowns; ++row)
            if (std::abs(system[row][column]) > std::abs(system[pivot][column])) pivot = row;
        if (!(std::abs(system[pivot][column]) > 1e-9)) return false;
        std::swap(system[pivot], system[column]);
        for (std::size_t row = 0; row < Unknowns; ++row) {
            if (row == column) continue;
            const double share = system[row][column] / system[column][column];
            for (std::size_t i = column; i <= Unknowns; ++i) system[row][i] -= share * system[column][i];
        }
    }
    for (std::size_t i = 0; i < Unknowns; ++i) solution[i] = system[i][Unknowns] / system[i][i];
    return true;
}

/// a, b, dx, dy and a brightness, in pixels of a level about its middle. A place goes to
/// x' = (1+a) x - b y + dx, y' = b x + (1+a) y + dy. The brightness is added to the sent picture.
using Parameters = std::array<double, Unknowns>;

Normal normal_equations(const Level& level, const Parameters& p) {
    Normal system{};
    const double middle = (level.side - 1) / 2.0;
    for (int row = 0; row < level.side; ++row)
        for (int column = 0; column < level.side; ++column) {
            const double weight = level.value(level.weight, column, row);
            const double x = column - middle, y = row - middle;
            const double u = (1 + p[0]) * x - p[1] * y + p[2] + middle,
                         v = p[1] * x + (1 + p[0]) * y + p[3] + middle;
            if (weight <= 0 || !level.inside(u, v)) continue;
            if (level.value(level.weight, static_cast<int>(std::lround(u)),
                            static_cast<int>(std::lround(v))) <= 0)
                continue;
            const double gx =
                (level.sampled(level.drawn, u + 1, v) - level.sampled(level.drawn, u - 1, v)) / 2;
            const double gy =
                (level.sampled(level.drawn, u, v + 1) - level.sampled(level.drawn, u, v - 1)) / 2;
            const double residual =
                level.sampled(level.drawn, u, v) - level.value(level.sent, column, row) - p[4];
            const double counts =
                weight * (std::abs(residual) > Outlier ? Outlier / std::abs(residual) : 1.0);
            const std::array<double, Unknowns> slope{gx * x + gy * y, gy * x - gx * y, gx, gy, -1};
            for (std::size_t i = 0; i < Unknowns; ++i) {
                for (std::size_t j = 0; j < Unknowns; ++j) system[i][j] += counts * slope[i] * slope[j];
                system[i][Unknowns] -= counts * slope[i] * residual;
            }
        }
    return system;
}

/// Improves the similarity on one level; false where the pictures show no structure.
bool refine(const Level& level, Similarity& similarity) {
    Parameters p{similarity.scale * std::cos(similarity.angle) - 1,
                 similarity.scale * std::sin(similarity.angle), similarity.dx * level.side,
                 similarity.dy * level.side, 0};
    for (int iteration = 0; iteration < Iterations; ++iteration) {
        auto system = normal_equations(level, p);
        Parameters step{};
        if (!solve(system, step)) return false;
        for (std::size_t i = 0; i < Unknowns; ++i) p[i] += step[i];
        const double moved =
            std::abs(step[2]) + std::abs(step[3]) + (std::abs(step[0]) + std::abs(step[1])) * level.side / 2;
        if (moved < LeastStep) break;
    }
    similarity = {std::hypot(1 + p[0], p[1]), std::atan2(p[1], 1 + p[0]), p[2] / level.side,
                  p[3] / level.side};
    return std::isfinite(similarity.scale) && std::isfinite(similarity.dx) && std::isfinite(similarity.dy);
}

}  // namespace

double Similarity::reach() const {
    double most = 0;
    for (const double x : {-0.5, 0.5})
        for (const double y : {-0.5, 0.5}) {
            const double u = scale * (std::cos(angle) * x - std::sin(angle) * y) + dx - x;
            const double v = scale * (std::sin(angle) * x + std::cos(angle) * y) + dy - y;
            most = std::max(most, std::hypot(u, v));
        }
    return most;
}

std::optional<Similarity> register_pictures(const Image& sent, const Image& drawn, const Mask& changed) {
    GSE_CHECK_EQ(sent.data.size(), drawn.data.size());
    GSE_CHECK_EQ(changed.data.size(), sent.pixel_count());
    const auto counted = static_cast<double>(changed.data.size() - changed.count());
    if (counted < LeastShare * static_cast<double>(changed.data.size())) return std::nullopt;
    const auto levels = pyramid_of(sent, drawn, changed);
    Similarity similarity = best_shift(levels.back());
    for (auto level = levels.rbegin(); level != levels.rend(); ++level)
        if (!refine(*level, similarity) || similarity.reach() > MostReach) return std::nullopt;
    return similarity;
}

Image moved_back(const Image& drawn, const Similarity& similarity) {
    const Level grid{drawn.width, {}, {}, {}};
    Image result(drawn.width, drawn.height, drawn.channels);
    const double middle = (drawn.width - 1) / 2.0;
    const double a = similarity.scale * std::cos(similarity.angle),
                 b = similarity.scale * std::sin(similarity.angle);
    std::vector<float> channel(drawn.pixel_count());
    for (int c = 0; c < drawn.channels; ++c) {
        for (std::size_t i = 0; i < channel.size(); ++i)
            channel[i] =
                drawn.data[i * static_cast<std::size_t>(drawn.channels) + static_cast<std::size_t>(c)];
        for (int row = 0; row < result.height; ++row)
            for (int column = 0; column < result.width; ++column) {
                const double x = column - middle, y = row - middle;
                result.at(column, row, c) = static_cast<float>(
                    grid.sampled(channel, a * x - b * y + similarity.dx * drawn.width + middle,
                                 b * x + a * y + similarity.dy * drawn.width + middle));
            }
    }
    return result;
}

}  // namespace gse::remote
