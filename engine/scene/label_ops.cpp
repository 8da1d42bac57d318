// Screen areas become a byte mask once, so that each row costs one projection and one look-up.
#include "engine/scene/label_ops.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/base/check.h"
#include "engine/math/quantile.h"
#include "engine/scene/depth_range.h"

namespace gse {
namespace {

constexpr std::size_t RowsPerChunk = 16384;

/// Pixels of the image that lie under the area.
class AreaMask {
public:
    AreaMask(const ScreenArea& area, int width, int height) : mask_(width, height) {
        if (!area.polygon.empty()) fill_polygon(area.polygon);
        else fill_stroke(area.circles, area.radius_px);
    }
    bool at(double x, double y) const {
        return x >= 0 && y >= 0 && x < mask_.width && y < mask_.height &&
               mask_.at(static_cast<int>(x), static_cast<int>(y)) != 0;
    }

private:
    using Point = std::array<float, 2>;

    /// Sets the pixels of row y whose centres lie in [from, to).
    void fill_span(int y, double from, double to) {
        const int begin =
            static_cast<int>(std::clamp(std::ceil(from - 0.5), 0.0, static_cast<double>(mask_.width)));
        const int end =
            static_cast<int>(std::clamp(std::ceil(to - 0.5), 0.0, static_cast<double>(mask_.width)));
        for (int x = begin; x < end; ++x) mask_.at(x, y) = 1;
    }

    std::pair<int, int> rows_between(double low, double high) const {
        return {static_cast<int>(std::clamp(std::ceil(low - 0.5), 0.0, static_cast<double>(mask_.height))),
                static_cast<int>(std::clamp(std::ceil(high - 0.5), 0.0, static_cast<double>(mask_.height)))};
    }

    void fill_polygon(const std::vector<Point>& polygon) {
        std::vector<std::vector<double>> crossings(static_cast<std::size_t>(mask_.height));
        for (std::size_t i = 0; i < polygon.size(); ++i) {
            const Point& a = polygon[i];
            const Point& b = polygon[(i + 1) % polygon.size()];
            if (!std::isfinite(a[0] + a[1] + b[0] + b[1])) continue;
            const auto [begin, end] = rows_between(std::min(a[1], b[1]), std::max(a[1], b[1]));
            for (int y = begin; y < end; ++y) {
                const double share = (y + 0.5 - static_cast<double>(a[1])) /
                                     (static_cast<double>(b[1]) - static_cast<double>(a[1]));
                crossings[static_cast<std::size_t>(y)].push_back(
                    static_cast<double>(a[0]) +
                    share * (static_cast<double>(b[0]) - static_cast<double>(a[0])));
            }
        }
        for (int y = 0; y < mask_.height; ++y) {
            auto& row = crossings[static_cast<std::size_t>(y)];
            std::sort(row.begin(), row.end());
            for (std::size_t i = 0; i + 1 < row.size(); i += 2) fill_span(y, row[i], row[i + 1]);
        }
    }

    void fill_circle(double cx, double cy, double radius) {
        const auto [begin, end] = rows_between(cy - radius, cy + radius);
        for (int y = begin; y < end; ++y) {
            const double dy = y + 0.5 - cy;
            const double half = std::sqrt(std::max(0.0, radius * radius - dy * dy));
            fill_span(y, cx - half, cx + half);
        }
    }

    void fill_stroke(const std::vector<Point>& centres, float radius_px) {
        const double radius = static_cast<double>(radius_px);
        if (!(radius > 0)) return;
        // The rim of the joined stroke waves by under 1 % of the radius.
        const double spacing = std::max(1.0, radius / 4);
        for (std::size_t i = 0; i < centres.size(); ++i) {
            const double x = static_cast<double>(centres[i][0]), y = static_cast<double>(centres[i][1]);
            if (!std::isfinite(x + y)) continue;
            fill_circle(x, y, radius);
            if (i == 0 || !std::isfinite(centres[i - 1][0] + centres[i - 1][1])) continue;
            const double dx = static_cast<double>(centres[i - 1][0]) - x,
                         dy = static_cast<double>(centres[i - 1][1]) - y;
            constexpr double most = 65536;  // a jump across any screen
            const int between = static_cast<int>(std::min(most, std::hypot(dx, dy) / spacing));
            for (int k = 1; k <= between; ++k)
                fill_circle(x + dx * k / (between + 1), y + dy * k / (between + 1), radius);
        }
    }

    Mask mask_;
};

/// Point in cells of the neighbour search.
struct Cell {
    std::int64_t x = 0, y = 0, z = 0;
};

/// Rows in cubic cells. Answers whether any lies within the radius of a point.
class CellIndex {
public:
    CellIndex(std::span<const float> position, double radius) : position_(position), radius_(radius) {}

    /// Takes in these rows, as far as they are finite.
    void build(const std::vector<std::uint32_t>& rows) {
        std::size_t slots = 16;
        while (slots < rows.size() * 2) slots *= 2;
        first_.assign(slots, None);
        next_.assign(rows.size(), None);
        rows_ = rows;
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const std::size_t slot = slot_of(cell_of(rows[i]));
            next_[i] = first_[slot];
            first_[slot] = static_cast<std::uint32_t>(i);
        }
    }

    bool any_near(std::uint32_t row) const {
        const Cell cell = cell_of(row);
        for (std::int64_t dz = -1; dz <= 1; ++dz)
            for (std::int64_t dy = -1; dy <= 1; ++dy)
                for (std::int64_t dx = -1; dx <= 1; ++dx)
                    if (any_in(slot_of({cell.x + dx, cell.y + dy, cell.z + dz}), row)) return true;
        return false;
    }

private:
    static constexpr std::uint32_t None = ~std::uint32_t{0};

    Cell cell_of(std::uint32_t row) const {
        const auto axis = [&](std::size_t i) {
            constexpr double most = 1e15;  // far worlds share cells: slower, never wrong
            return static_cast<std::int64_t>(std::clamp(
                std::floor(static_cast<double>(position_[std::size_t{row} * 3 + i]) / radius_), -most, most));
        };
        return {axis(0), axis(1), axis(2)};
    }
    std::size_t slot_of(const Cell& cell) const {
        std::uint64_t hash = static_cast<std::uint64_t>(cell.x) * 0x9e3779b97f4a7c15ULL;
        hash = (hash ^ (hash >> 29)) + static_cast<std::uint64_t>(cell.y) * 0xbf58476d1ce4e5b9ULL;
        hash = (hash ^ (hash >> 31)) + static_cast<std::uint64_t>(cell.z) * 0x94d049bb133111ebULL;
        return static_cast<std::size_t>(hash ^ (hash >> 30)) & (first_.size() - 1);
    }
    bool any_in(std::size_t slot, std::uint32_t row) const {
        const float* p = &position_[std::size_t{row} * 3];
        for (std::uint32_t i = first_[slot]; i != None; i = next_[i]) {
            const float* q = &position_[std::size_t{rows_[i]} * 3];
            double sum = 0;
            for (int axis = 0; axis < 3; ++axis) {
                const double d = static_cast<double>(p[axis]) - static_cast<double>(q[axis]);
                sum += d * d;
            }
            if (sum <= radius_ * radius_) return true;
        }
        return false;
    }

    std::span<const float> position_;
    double radius_;
    std::vector<std::uint32_t> first_, next_, rows_;
};

bool finite_row(std::span<const float> position, std::size_t row) {
    return std::isfinite(position[row * 3]) && std::isfinite(position[row * 3 + 1]) &&
           std::isfinite(position[row * 3 + 2]);
}

std::vector<std::int8_t> manual_of(const NamedLabel& label) {
    if (label.manual != nullptr) return *label.manual;
    return std::vector<std::int8_t>(label.bits->size(), 0);
}

NamedLabel with_manual(NamedLabel label, std::vector<std::int8_t> manual) {
    label.manual = std::make_shared<const std::vector<std::int8_t>>(std::move(manual));
    return with_bits(std::move(label));
}

/// Distance from `row` to its `Nearest`-th nearest other row.
double spacing_at(std::span<const float> position, std::size_t row) {
    constexpr std::size_t nearest = 8;
    std::array<float, nearest> best;
    best.fill(std::numeric_limits<float>::infinity());
    const float x = position[row * 3], y = position[row * 3 + 1], z = position[row * 3 + 2];
    for (std::size_t other = 0; other < position.size() / 3; ++other) {
        const float dx = position[other * 3] - x, dy = position[other * 3 + 1] - y,
                    dz = position[other * 3 + 2] - z;
        const float distance = dx * dx + dy * dy + dz * dz;
        if (!(distance < best.back()) || other == row) continue;
        std::size_t at = nearest - 1;
        for (; at > 0 && best[at - 1] > distance; --at) best[at] = best[at - 1];
        best[at] = distance;
    }
    return std::sqrt(static_cast<double>(best.back()));
}

/// One step: rows of side `from` within the radius of a row of the other side change sides.
void grow_once(std::span<const float> position, double radius, std::vector<std::uint8_t>& bits,
               std::uint8_t from) {
    std::array<double, 3> low, high;
    low.fill(std::numeric_limits<double>::infinity());
    high.fill(-std::numeric_limits<double>::infinity());
    // Only what lies in the label's box, widened by the radius, can matter on either side.
    for (std::size_t row = 0; row < bits.size(); ++row)
        if (bits[row] != 0 && finite_row(position, row))
            for (std::size_t axis = 0; axis < 3; ++axis) {
                low[axis] = std::min(low[axis], static_cast<double>(position[row * 3 + axis]) - radius);
                high[axis] = std::max(high[axis], static_cast<double>(position[row * 3 + axis]) + radius);
            }
    const auto inside = [&](std::size_t row) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double value = static_cast<double>(position[row * 3 + axis]);
            if (!(value >= low[axis] && value <= high[axis])) return false;
        }
        return true;
    };
    std::vector<std::uint32_t> sources, candidates;
    for (std::size_t row = 0; row < bits.size(); ++row)
        if (inside(row))
            (bits[row] == from ? candidates : sources).push_back(static_cast<std::uint32_t>(row));
    CellIndex index(position, radius);
    index.build(sources);
    for (const std::uint32_t row : candidates)
        if (index.any_near(row)) bits[row] = from == 0 ? 1 : 0;
}

}  // namespace

std::vector<std::uint8_t> rows_in_area(const GaussianSet& set, const Camera& camera, const ScreenArea& area,
                                       const PickOptions& options) {
    const auto scaled = [](double place, int size, int of) {
        return std::clamp(static_cast<int>(place * size / of), 0, size - 1);
    };
    std::vector<std::uint8_t> rows(set.size(), 0);
    if (set.empty() || camera.width <= 0 || camera.height <= 0) return rows;
    const AreaMask mask(area, camera.width, camera.height);
    const auto position = set.position();
    const auto opacity = set.opacity_logit();
    const Image* depth = options.depth;
    if (depth != nullptr && depth->data.empty()) depth = nullptr;
    const double least_logit = options.least_opacity > 0
                                   ? std::log(options.least_opacity / (1 - options.least_opacity))
                                   : -std::numeric_limits<double>::infinity();
    const double near = options.near > 0 ? options.near : fitted_near_plane(set.spans(), camera);
    const auto pick = [&](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t row = begin; row < end; ++row) {
            const Vec3 world{static_cast<double>(position[row * 3]),
                             static_cast<double>(position[row * 3 + 1]),
                             static_cast<double>(position[row * 3 + 2])};
            const Vec3 p = camera.to_camera(world);
            if (!(p.z > near) || !(static_cast<double>(opacity[row]) >= least_logit)) continue;
            const double x = camera.fx * p.x / p.z + camera.cx, y = camera.fy * p.y / p.z + camera.cy;
            if (!mask.at(x, y)) continue;
            if (options.mask != nullptr &&
                options.mask->at(scaled(x, options.mask->width, camera.width),
                                 scaled(y, options.mask->height, camera.height)) == 0)
                continue;
            if (depth != nullptr) {
                const double z = static_cast<double>(depth->at(scaled(x, depth->width, camera.width),
                                                               scaled(y, depth->height, camera.height), 0));
                if (z > 0 && std::isfinite(z) && p.z > z * (1 + options.depth_tolerance)) continue;
            }
            rows[row] = 1;
        }
    };
    if (options.pool != nullptr) options.pool->parallel_for(set.size(), RowsPerChunk, pick);
    else pick(0, set.size(), 0);
    return rows;
}

std::string free_label_name(const std::vector<NamedLabel>& labels, const std::string& name) {
    const auto taken = [&](const std::string& wanted) {
        return std::any_of(labels.begin(), labels.end(),
                           [&](const NamedLabel& label) { return label.name == wanted; });
    };
    std::string free = name;
    for (int number = 2; taken(free); ++number) free = name + " " + std::to_string(number);
    return free;
}

NamedLabel empty_label(std::string name, std::size_t count) {
    NamedLabel label;
    label.name = std::move(name);
    return with_manual(std::move(label), std::vector<std::int8_t>(count, 0));
}

NamedLabel combine(NamedLabel label, std::span<const std::uint8_t> rows, LabelOperation operation) {
    std::vector<std::int8_t> manual = manual_of(label);
    GSE_CHECK_EQ(rows.size(), manual.size());
    for (std::size_t row = 0; row < rows.size(); ++row) {
        const bool inside = rows[row] != 0;
        switch (operation) {
            case LabelOperation::Add:
                if (inside) manual[row] = 1;
                break;
            case LabelOperation::Remove:
                if (inside) manual[row] = -1;
                break;
            case LabelOperation::Intersect:
                if (!inside) manual[row] = -1;
                break;
            case LabelOperation::Replace: manual[row] = inside ? std::int8_t{1} : std::int8_t{-1}; break;
        }
    }
    return with_manual(std::move(label), std::move(manual));
}

NamedLabel with_added(NamedLabel label, std::span<const std::uint8_t> added) {
    if (!label.weight) return combine(std::move(label), added, LabelOperation::Add);
    std::vector<float> weight(*label.weight);
    GSE_CHECK_EQ(weight.size(), added.size());
    for (std::size_t row = 0; row < added.size(); ++row)
        if (added[row] != 0) weight[row] = 1;
    label.weight = std::make_shared<const std::vector<float>>(std::move(weight));
    label.found = nullptr;
    return with_bits(std::move(label));
}

NamedLabel invert(NamedLabel label) {
    std::vector<std::int8_t> manual(label.bits->size());
    for (std::size_t row = 0; row < manual.size(); ++row)
        manual[row] = (*label.bits)[row] != 0 ? std::int8_t{-1} : std::int8_t{1};
    return with_manual(std::move(label), std::move(manual));
}

NamedLabel clear(NamedLabel label) {
    label.absent = nullptr;
    std::vector<std::int8_t> manual(label.bits->size(), std::int8_t{-1});
    return with_manual(std::move(label), std::move(manual));
}

NamedLabel without_corrections(NamedLabel label) {
    std::vector<std::int8_t> manual(label.bits->size(), std::int8_t{0});
    return with_manual(std::move(label), std::move(manual));
}

NamedLabel with_threshold(NamedLabel label, float threshold) {
    label.threshold = threshold;
    return with_bits(std::move(label));
}

std::shared_ptr<const std::vector<float>> view_probability(const NamedLabel& label) {
    if (label.found == nullptr) return label.weight;
    return {label.found, &label.found->field.probability};
}

double growth_radius(const GaussianSet& set, std::span<const std::uint8_t> bits) {
    GSE_CHECK_EQ(bits.size(), set.size());
    // Each is a walk over all rows; the median over so many is steady to ~10 %.
    constexpr std::size_t samples = 48;
    const auto position = set.position();
    std::vector<std::size_t> labelled;
    for (std::size_t row = 0; row < bits.size(); ++row)
        if (bits[row] != 0 && finite_row(position, row)) labelled.push_back(row);
    if (labelled.empty()) return 0;
    std::vector<double> spacings;
    const std::size_t count = std::min(samples, labelled.size());
    for (std::size_t i = 0; i < count; ++i) {
        const double spacing = spacing_at(position, labelled[i * labelled.size() / count]);
        if (std::isfinite(spacing)) spacings.push_back(spacing);
    }
    return spacings.empty() ? 0 : upper_median(spacings);
}

NamedLabel grow(NamedLabel label, const GaussianSet& set, int steps, double radius) {
    GSE_CHECK_EQ(label.bits->size(), set.size());
    if (!(radius > 0)) radius = growth_radius(set, *label.bits);
    if (!(radius > 0) || !std::isfinite(radius) || steps == 0) return label;
    const std::uint8_t from = steps > 0 ? 0 : 1;
    std::vector<std::uint8_t> bits = *label.bits;
    for (int step = 0; step < std::abs(steps); ++step) grow_once(set.position(), radius, bits, from);
    std::vector<std::int8_t> manual = manual_of(label);
    for (std::size_t row = 0; row < bits.size(); ++row)
        if (bits[row] != (*label.bits)[row]) manual[row] = bits[row] != 0 ? std::int8_t{1} : std::int8_t{-1};
    return with_manual(std::move(label), std::move(manual));
}

WeightHistogram weight_histogram(const NamedLabel& label) {
    WeightHistogram histogram;
    if (label.weight == nullptr) {
        histogram.zeros = label.bits != nullptr ? label.bits->size() : 0;
        return histogram;
    }
    for (const float weight : *label.weight) {
        if (weight > 0) ++histogram.bins[static_cast<std::size_t>(std::min(weight * 256.0f, 255.0f))];
        else if (weight == 0) ++histogram.zeros;
    }
    histogram.highest = *std::max_element(histogram.bins.begin(), histogram.bins.end());
    return histogram;
}

std::size_t count_labelled(const NamedLabel& label) {
    if (label.bits == nullptr) return 0;
    return static_cast<std::size_t>(
        std::count_if(label.bits->begin(), label.bits->end(), [](auto bit) { return bit != 0; }));
}

LabelSet label_set(const DocumentState& state) {
    const auto none = std::make_shared<const std::vector<float>>(state.current.size(), 0.0f);
    LabelSet set;
    for (const NamedLabel& label : state.labels)
        set.labels.push_back({label.name, label.weight ? label.weight : none, label.bits});
    return set;
}

}  // namespace gse
