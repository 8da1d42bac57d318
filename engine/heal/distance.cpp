// Lower envelope of parabolas, along rows and then along columns.
#include "engine/heal/distance.h"

#include <algorithm>
#include <cmath>

namespace gse::heal {
namespace {

/// Scratch of one line of cells.
struct Line {
    std::vector<double> in, border;
    std::vector<int> apex;
    explicit Line(std::size_t longest) : in(longest), border(longest + 1), apex(longest) {}

    /// Transform of `count` values that lie `stride` apart.
    void run(double* values, int count, std::ptrdiff_t stride) {
        if (count < 1) return;
        const auto at = [](int i) { return static_cast<std::size_t>(i); };
        for (int i = 0; i < count; ++i) in[at(i)] = values[i * stride];
        int last = 0;
        apex[0] = 0;
        border[0] = -FarAway;
        border[1] = FarAway;
        for (int q = 1; q < count; ++q) {
            double cut = 0;
            for (;; --last) {
                const int p = apex[at(last)];
                cut = (in[at(q)] - in[at(p)] + static_cast<double>(q) * q - static_cast<double>(p) * p) /
                      (2.0 * (q - p));
                if (last == 0 || cut > border[at(last)]) break;
            }
            if (cut > border[at(last)]) ++last;
            apex[at(last)] = q;
            border[at(last)] = last == 0 ? -FarAway : cut;
            border[at(last) + 1] = FarAway;
        }
        for (int q = 0, k = 0; q < count; ++q) {
            while (border[at(k) + 1] < q) ++k;
            const double away = q - apex[at(k)];
            values[q * stride] = std::min(FarAway, away * away + in[at(apex[at(k)])]);
        }
    }
};

}  // namespace

void spread_squared_distances(Grid<double>& values) {
    Line line(static_cast<std::size_t>(std::max({values.width, values.height, 1})));
    for (int y = 0; y < values.height; ++y) line.run(&values.at(0, y), values.width, 1);
    for (int x = 0; x < values.width; ++x) line.run(&values.at(x, 0), values.height, values.width);
}

Grid<double> distance_to(const BitGrid& bits) {
    Grid<double> distance(bits.width, bits.height, FarAway);
    for (std::size_t i = 0; i < bits.cells.size(); ++i)
        if (bits.cells[i] != 0) distance.cells[i] = 0;
    spread_squared_distances(distance);
    for (auto& value : distance.cells) value = value < FarAway ? std::sqrt(value) : FarAway;
    return distance;
}

}  // namespace gse::heal
