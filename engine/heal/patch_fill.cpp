// From coarse to fine: search for the nearest patch of every cell, then a vote of the patches over it. At the
// end shifts are made coherent, since Gaussians are copied along with their neighbours.
#include "engine/heal/patch_fill.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "engine/base/random.h"
#include "engine/heal/distance.h"
#include "engine/heal/smooth_fill.h"

namespace gse::heal {
namespace {

enum class State : std::uint8_t { Void, Known, Hole };

constexpr int MostLevels = 6;
constexpr double CoarsestDepth = 2.5;     // cells from the rim to the middle of a hole at the coarsest level
constexpr int CoarsestSide = 12;          // cells of the shorter side at the coarsest level
constexpr std::size_t LeastSources = 12;  // patches to copy from
constexpr int WideReach = 3, NarrowReach = 1;  // of a patch to either side, in cells
constexpr double VoidCost = 0.12;              // squared colour difference of a cell and none
constexpr double Confidence = 1.25;            // falls by this with every cell from the rim
constexpr int CoarsestRounds = 10, Rounds = 4;
constexpr int Searches = 2;           // passes of propagation and random search in a round
constexpr double ChangeCost = 0.004;  // squared colour difference that a change of shift costs beside
constexpr double SeamWeight = 2.0;    // of the colours on both sides of a change of shift
constexpr int CoherenceSweeps = 4;

struct Level {
    Grid<Vec3> colour;
    Grid<State> state;
    Grid<Shift> shift;
    Grid<double> cost, trust;
    BitGrid avoid;                   // cells that are copied only if there are too few others
    BitGrid source;                  // cells whose whole patch may be copied
    std::vector<std::size_t> holes;  // in raster order
    std::vector<std::size_t> sources;
    int reach = WideReach;
    int side() const { return 2 * reach + 1; }
};

BitGrid bits_of(const Grid<State>& state, State wanted) {
    BitGrid bits(state.width, state.height, 0);
    for (std::size_t i = 0; i < bits.cells.size(); ++i) bits.cells[i] = state.cells[i] == wanted ? 1 : 0;
    return bits;
}

void list_sources(Level& level, bool avoiding) {
    level.source = BitGrid(level.state.width, level.state.height, 0);
    level.holes.clear();
    level.sources.clear();
    each_cell(level.state, [&](int x, int y) {
        const std::size_t cell = level.state.index(x, y);
        if (level.state.cells[cell] == State::Hole) level.holes.push_back(cell);
        if (level.state.cells[cell] != State::Known || (avoiding && level.avoid.cells[cell] != 0)) return;
        bool whole = true;
        each_neighbour(level.state, x, y, level.reach,
                       [&](int nx, int ny) { whole = whole && level.state.at(nx, ny) != State::Hole; });
        if (whole) level.source.cells[cell] = 1, level.sources.push_back(cell);
    });
}

/// Lists holes and sources. False where there is not enough to copy from with patches of this reach.
bool prepare(Level& level, int reach) {
    level.reach = reach;
    list_sources(level, true);
    if (level.sources.size() < LeastSources) list_sources(level, false);
    level.shift = Grid<Shift>(level.state.width, level.state.height);
    level.cost = Grid<double>(level.state.width, level.state.height, 0);
    level.trust = distance_to(bits_of(level.state, State::Known));
    for (auto& value : level.trust.cells) value = std::pow(Confidence, -std::min(value, 40.0));
    return level.sources.size() >= LeastSources;
}

/// Level of half the size. A cell is a hole where most of its four are; colours are those of known ones.
Level halved(const Level& fine) {
    const int width = (fine.state.width + 1) / 2, height = (fine.state.height + 1) / 2;
    Level level;
    level.colour = Grid<Vec3>(width, height);
    level.state = Grid<State>(width, height, State::Void);
    level.avoid = BitGrid(width, height, 0);
    each_cell(fine.avoid, [&](int x, int y) { level.avoid.at(x / 2, y / 2) |= fine.avoid.at(x, y); });
    each_cell(level.state, [&](int x, int y) {
        Vec3 sum;
        int known = 0, hole = 0;
        for (int dy = 0; dy < 2; ++dy)
            for (int dx = 0; dx < 2; ++dx) {
                const int fx = 2 * x + dx, fy = 2 * y + dy;
                if (!fine.state.inside(fx, fy)) continue;
                if (fine.state.at(fx, fy) == State::Known) ++known, sum += fine.colour.at(fx, fy);
                if (fine.state.at(fx, fy) == State::Hole) ++hole;
            }
        if (known > 0) level.colour.at(x, y) = sum / static_cast<double>(known);
        level.state.at(x, y) = hole > 0 && hole >= known ? State::Hole
                               : known > 0               ? State::Known
                                                         : State::Void;
    });
    return level;
}

/// Cost of copying the patch around (sx, sy) to (x, y); gives up beyond `most`.
double patch_cost(const Level& level, int x, int y, int sx, int sy, double most) {
    double sum = 0;
    for (int dy = -level.reach; dy <= level.reach; ++dy) {
        for (int dx = -level.reach; dx <= level.reach; ++dx) {
            const bool here = level.state.inside(x + dx, y + dy),
                       there = level.state.inside(sx + dx, sy + dy);
            const std::size_t a = here ? level.state.index(x + dx, y + dy) : 0;
            const std::size_t b = there ? level.state.index(sx + dx, sy + dy) : 0;
            const bool shown = here && level.state.cells[a] != State::Void;
            if (shown != (there && level.state.cells[b] == State::Known)) sum += VoidCost;
            else if (shown) {
                const Vec3 d = level.colour.cells[a] - level.colour.cells[b];
                sum += level.trust.cells[a] * dot(d, d);
            }
        }
        if (sum >= most) return sum;
    }
    return sum;
}

class Searcher {
public:
    Searcher(Level& level, Random& random) : level_(level), random_(random) {}

    /// Gives every cell the best of its own shift and a random one.
    void start(bool keep) {
        for (const auto cell : level_.holes) {
            const auto [x, y] = place(cell);
            level_.cost.cells[cell] = std::numeric_limits<double>::infinity();
            if (keep) attempt(cell, x, y, level_.shift.cells[cell]);
            for (int i = 0; i < (keep ? 1 : 8); ++i) attempt_random(cell, x, y);
        }
    }
    /// Costs of the present shifts, for colours that have changed.
    void measure() {
        for (const auto cell : level_.holes) {
            const auto [x, y] = place(cell);
            const Shift shift = level_.shift.cells[cell];
            level_.cost.cells[cell] =
                patch_cost(level_, x, y, x + shift.x, y + shift.y, std::numeric_limits<double>::infinity());
        }
    }
    void pass(bool backwards) {
        const int step = backwards ? 1 : -1;
        const std::size_t count = level_.holes.size();
        for (std::size_t k = 0; k < count; ++k) {
            const std::size_t cell = level_.holes[backwards ? count - 1 - k : k];
            const auto [x, y] = place(cell);
            take_over(cell, x, y, x + step, y);
            take_over(cell, x, y, x, y + step);
            search_around(cell, x, y);
        }
    }

private:
    std::pair<int, int> place(std::size_t cell) const {
        const auto width = static_cast<std::size_t>(level_.state.width);
        return {static_cast<int>(cell % width), static_cast<int>(cell / width)};
    }
    void attempt(std::size_t cell, int x, int y, Shift shift) {
        const int sx = x + shift.x, sy = y + shift.y;
        if (!level_.source.inside(sx, sy) || level_.source.at(sx, sy) == 0) return;
        const double cost = patch_cost(level_, x, y, sx, sy, level_.cost.cells[cell]);
        if (cost < level_.cost.cells[cell]) level_.cost.cells[cell] = cost, level_.shift.cells[cell] = shift;
    }
    void attempt_random(std::size_t cell, int x, int y) {
        const auto [sx, sy] = place(level_.sources[random_.below(level_.sources.size())]);
        attempt(cell, x, y, {static_cast<std::int16_t>(sx - x), static_cast<std::int16_t>(sy - y)});
    }
    void take_over(std::size_t cell, int x, int y, int nx, int ny) {
        if (level_.state.inside(nx, ny) && level_.state.at(nx, ny) == State::Hole)
            attempt(cell, x, y, level_.shift.at(nx, ny));
    }
    void search_around(std::size_t cell, int x, int y) {
        attempt_random(cell, x, y);
        for (int reach = std::max(level_.state.width, level_.state.height) / 2; reach >= 1; reach /= 2) {
            const Shift best = level_.shift.cells[cell];
            const auto wander = [&] {
                return static_cast<int>(random_.below(2 * static_cast<std::uint64_t>(reach) + 1)) - reach;
            };
            const int dx = wander(), dy = wander();
            attempt(cell, x, y,
                    {static_cast<std::int16_t>(best.x + dx), static_cast<std::int16_t>(best.y + dy)});
        }
    }

    Level& level_;
    Random& random_;
};

/// Colours of the hole as weighted means of what the patches over each cell say.
void vote(Level& level, Grid<Vec3>& sum, Grid<double>& weight, std::vector<double>& costs) {
    costs.clear();
    for (const auto cell : level.holes) {
        sum.cells[cell] = {}, weight.cells[cell] = 0;
        costs.push_back(level.cost.cells[cell]);
    }
    const auto upper = costs.begin() + static_cast<std::ptrdiff_t>(costs.size() * 3 / 4);
    std::nth_element(costs.begin(), upper, costs.end());
    const double usual = 2 * std::max(*upper, 1e-6);
    const auto width = static_cast<std::size_t>(level.state.width);
    for (const auto cell : level.holes) {
        const int x = static_cast<int>(cell % width), y = static_cast<int>(cell / width);
        const Shift shift = level.shift.cells[cell];
        const double w = level.trust.cells[cell] * std::exp(-level.cost.cells[cell] / usual) + 1e-9;
        for (int dy = -level.reach; dy <= level.reach; ++dy)
            for (int dx = -level.reach; dx <= level.reach; ++dx) {
                const int tx = x + dx, ty = y + dy, sx = tx + shift.x, sy = ty + shift.y;
                if (!level.state.inside(tx, ty) || level.state.at(tx, ty) != State::Hole) continue;
                if (!level.state.inside(sx, sy) || level.state.at(sx, sy) != State::Known) continue;
                sum.at(tx, ty) += level.colour.at(sx, sy) * w;
                weight.at(tx, ty) += w;
            }
    }
    for (const auto cell : level.holes)
        if (weight.cells[cell] > 0) level.colour.cells[cell] = sum.cells[cell] / weight.cells[cell];
}

void complete(Level& level, bool first, Random& random) {
    Searcher searcher(level, random);
    Grid<Vec3> sum(level.state.width, level.state.height);
    Grid<double> weight(level.state.width, level.state.height, 0);
    std::vector<double> costs;
    searcher.start(!first);
    for (int round = 0; round < (first ? CoarsestRounds : Rounds); ++round) {
        if (round > 0) searcher.measure();
        for (int pass = 0; pass < Searches; ++pass) searcher.pass((round * Searches + pass) % 2 != 0);
        vote(level, sum, weight, costs);
    }
    searcher.measure();
}

/// Shifts of the coarser level, doubled; colours of the hole from their sources.
void inherit(Level& fine, const Level& coarse) {
    const auto width = static_cast<std::size_t>(fine.state.width);
    BitGrid unset(fine.state.width, fine.state.height, 0);
    for (const auto cell : fine.holes) {
        const int x = static_cast<int>(cell % width), y = static_cast<int>(cell / width);
        const bool same = coarse.state.at(x / 2, y / 2) == State::Hole;
        const Shift half = same ? coarse.shift.at(x / 2, y / 2) : Shift{};
        fine.shift.cells[cell] = {static_cast<std::int16_t>(2 * half.x),
                                  static_cast<std::int16_t>(2 * half.y)};
        const int sx = x + 2 * half.x, sy = y + 2 * half.y;
        if (same && fine.state.inside(sx, sy) && fine.state.at(sx, sy) == State::Known)
            fine.colour.cells[cell] = fine.colour.at(sx, sy);
        else fine.colour.cells[cell] = coarse.colour.at(x / 2, y / 2);
    }
}

/// Shifts with few and invisible changes between neighbours (Pritch et al. 2009), by iterated conditional
/// modes over the shifts that occur around a cell.
class Coherence {
public:
    explicit Coherence(Level& level) : level_(level) {}

    void run() {
        const auto width = static_cast<std::size_t>(level_.state.width);
        const std::size_t count = level_.holes.size();
        for (int sweep = 0; sweep < CoherenceSweeps; ++sweep)
            for (std::size_t k = 0; k < count; ++k) {
                const std::size_t cell = level_.holes[sweep % 2 != 0 ? count - 1 - k : k];
                improve(cell, static_cast<int>(cell % width), static_cast<int>(cell / width));
            }
    }

private:
    bool shows(int x, int y) const {
        return level_.state.inside(x, y) && level_.state.at(x, y) == State::Known;
    }

    void improve(std::size_t cell, int x, int y) {
        Shift best = level_.shift.cells[cell];
        double least = energy(x, y, best);
        each_neighbour(level_.state, x, y, 1, [&](int nx, int ny) {
            if (level_.state.at(nx, ny) != State::Hole) return;
            const Shift shift = level_.shift.at(nx, ny);
            if (shift == best) return;
            if (const double e = energy(x, y, shift); e < least) least = e, best = shift;
        });
        level_.shift.cells[cell] = best;
    }
    double energy(int x, int y, Shift shift) const {
        const int sx = x + shift.x, sy = y + shift.y;
        if (!shows(sx, sy)) return std::numeric_limits<double>::infinity();
        const double cells = level_.side() * level_.side();
        double sum = 4 * patch_cost(level_, x, y, sx, sy, std::numeric_limits<double>::infinity()) / cells;
        constexpr int Sides[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
        for (const auto& side : Sides) {
            const int nx = x + side[0], ny = y + side[1];
            if (!level_.state.inside(nx, ny)) continue;
            if (level_.state.at(nx, ny) == State::Known)
                sum += SeamWeight * difference(nx + shift.x, ny + shift.y, nx, ny);
            else if (level_.state.at(nx, ny) == State::Hole && !(level_.shift.at(nx, ny) == shift)) {
                const Shift other = level_.shift.at(nx, ny);
                sum += ChangeCost +
                       SeamWeight * (difference(nx + shift.x, ny + shift.y, nx + other.x, ny + other.y) +
                                     difference(sx, sy, x + other.x, y + other.y));
            }
        }
        return sum;
    }
    double difference(int ax, int ay, int bx, int by) const {
        if (!shows(ax, ay) || !shows(bx, by)) return VoidCost;
        const Vec3 d = level_.colour.at(ax, ay) - level_.colour.at(bx, by);
        return dot(d, d);
    }

    Level& level_;
};

std::vector<Level> pyramid(const Grid<Vec3>& colour, const BitGrid& known, const BitGrid& hole,
                           const BitGrid& avoid) {
    std::vector<Level> levels(1);
    levels[0].colour = colour;
    levels[0].avoid = avoid;
    levels[0].state = Grid<State>(known.width, known.height, State::Void);
    for (std::size_t i = 0; i < known.cells.size(); ++i)
        levels[0].state.cells[i] = hole.cells[i] != 0    ? State::Hole
                                   : known.cells[i] != 0 ? State::Known
                                                         : State::Void;
    while (levels.size() < MostLevels) {
        const Level& last = levels.back();
        const auto away = distance_to(bits_of(last.state, State::Known));
        double deepest = 0;
        for (std::size_t i = 0; i < away.cells.size(); ++i)
            if (last.state.cells[i] == State::Hole) deepest = std::max(deepest, away.cells[i]);
        if (deepest <= CoarsestDepth || std::min(last.state.width, last.state.height) < 2 * CoarsestSide)
            break;
        Level next = halved(last);
        if (!prepare(next, WideReach)) break;
        levels.push_back(std::move(next));
    }
    return levels;
}

}  // namespace

PatchFill fill_by_patches(const Grid<Vec3>& colour, const BitGrid& known, const BitGrid& hole,
                          const BitGrid& avoid, std::uint64_t seed) {
    auto levels = pyramid(colour, known, hole, avoid);
    PatchFill fill;
    if (!prepare(levels[0], WideReach)) {
        levels.resize(1);
        fill.found = prepare(levels[0], NarrowReach);
    } else {
        fill.found = true;
    }
    fill_membrane(levels.back().colour, bits_of(levels.back().state, State::Hole),
                  bits_of(levels.back().state, State::Known));
    if (fill.found && !levels[0].holes.empty()) {
        Random random(seed);
        for (std::size_t k = levels.size(); k-- > 0;) {
            const bool first = k + 1 == levels.size();
            if (!first) inherit(levels[k], levels[k + 1]);
            if (!levels[k].holes.empty()) complete(levels[k], first, random);
        }
        Coherence(levels[0]).run();
        const auto width = static_cast<std::size_t>(hole.width);
        for (const auto cell : levels[0].holes) {
            const Shift shift = levels[0].shift.cells[cell];
            const int x = static_cast<int>(cell % width), y = static_cast<int>(cell / width);
            levels[0].colour.cells[cell] = colour.at(x + shift.x, y + shift.y);
        }
    }
    fill.shift = std::move(levels[0].shift);
    fill.colour = std::move(levels[0].colour);
    return fill;
}

}  // namespace gse::heal
