// Depth row by row, or blurred brightness against a plane fitted to the surface farther away.
#include "engine/heal/shadow.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/heal/distance.h"
#include "engine/heal/shade_depth.h"
#include "engine/math/quantile.h"

namespace gse::heal {
namespace {

constexpr double ContactCells = 1.5;  // distance from the thing at which it stands on a cell
constexpr std::array AlongCells{2.5, 4.0,
                                6.0};     // standard deviations of the mean along the rim, tried in turn
constexpr double AcrossCells = 0.8;       // standard deviation of the mean towards the thing and away from it
constexpr double TwoTones = 0.2;          // of the variance of brightness, that two tones leave at most
constexpr double LeastContrast = 0.15;    // standard deviation of such a surface, in logarithms
constexpr double ToneHue = 0.12;          // difference of hue, in logarithms, that tells tones apart
constexpr double ToneNear = 0.25;         // of the darker tone's brightness, in logarithms, where hue decides
constexpr double ToneSlack = 0.1;         // in logarithms, by which a cell may be brighter than its tone
constexpr double CalmSpread = 0.05;       // of the surface's own brightness, in logarithms, after the mean
constexpr std::size_t MostBeyond = 1500;  // cells of it that are looked at
constexpr double BeyondShare = 0.3;       // of the surface's cells that lie beyond at least
constexpr double TintLimit = 1.15;        // of a channel's gain over that of the brightness
constexpr double Darkest = 0.02;          // channel value that logarithms start from
constexpr double ClearlyDarker = 0.13, SlightlyDarker = 0.04;
constexpr double LeastLit = 0.02;                        // in logarithms of brightness
constexpr double ClearSpread = 2.0, SlightSpread = 1.0;  // spreads of the surface beyond
constexpr double HueLimit = 0.08, HueSlack = 0.2;  // difference of a channel from brightness, in logarithms:
                                                   // at least, and for each of darkness
constexpr std::size_t LeastBeyond = 25;            // cells beyond the shadow to compare with
constexpr double MostGain = 3.2, MostContactGain = 2.6;
constexpr double DeepShadow = 1.15, DeepContact = 0.9;  // in logarithms of brightness, that is filled anew
constexpr double NearCells = 2.5;                       // from the thing, where its shadow is deepest
constexpr std::size_t Nearest = 6, Enough = 12;         // rows beside a row, of those that are compared
constexpr double LeastTrust = 0.02;                     // of a row that others hide
constexpr double PlainNoise = 0.03;   // of colours that tell light from paint row by row, in logarithms
constexpr double RoughNoise = 0.1;    // of colours that do not
constexpr double ContactReach = 0.5;  // of the reach, that a contact shadow hardly leaves
constexpr double FarShare = 0.25;     // of the squared depth, that it has beyond at most
constexpr double WholeFoot = 0.85;    // of the foot's cells, that tell its depth themselves
constexpr double LargestLit = 4;      // cells, standard deviation of a row that is lit
constexpr double RoughSpread = 0.09;  // of a surface whose means are no measure
constexpr int RetinexSweeps = 300;
constexpr double RetinexRelax = 1.8, RetinexNoise = 0.16;  // over-relaxation; what light may be by chance
constexpr double PaintHue = 0.06, PaintStep = 0.25;        // between cells, in logarithms
constexpr double BrightShare = 0.97;  // of the rows of the surface beyond, that are darker than its brightest
constexpr double FitScale = 0.15;     // in logarithms, beyond which a cell counts little
constexpr int GainRounds = 4;         // of the gain, each on what the one before left

struct Trend {
    double base = 0, along_x = 0, along_y = 0;
    double at(double x, double y) const { return base + along_x * x + along_y * y; }
};

using Values = std::vector<std::array<double, 4>>;  // red, green, blue, brightness, in logarithms

/// Plane through one of the values of the cells, by reweighted least squares in coordinates of about one.
Trend fit_trend(const Values& values, std::size_t channel, const std::vector<std::size_t>& cells,
                const BitGrid& grid) {
    const double unit = 0.5 * std::max(grid.width, grid.height);
    const auto width = static_cast<std::size_t>(grid.width);
    Trend trend;
    for (int round = 0; round < 6; ++round) {
        std::array<std::array<double, 4>, 3> m{};
        for (std::size_t i = 0; i < cells.size(); ++i) {
            const double x = static_cast<double>(cells[i] % width) / unit - 1;
            const double y = static_cast<double>(cells[i] / width) / unit - 1;
            const double value = values[i][channel];
            const double off = round == 0 ? 0 : (trend.at(x, y) - value) / FitScale;
            const double w = 1 / (1 + off * off);
            const double terms[4] = {1, x, y, value};
            for (std::size_t r = 0; r < 3; ++r)
                for (std::size_t c = 0; c < 4; ++c) m[r][c] += w * terms[r] * terms[c];
        }
        const double slack = 0.02 * m[0][0] + 1e-9;  // a slope must be worth it
        m[1][1] += slack, m[2][2] += slack;
        for (std::size_t k = 0; k < 3; ++k)
            for (std::size_t r = k + 1; r < 3; ++r) {
                const double factor = m[r][k] / m[k][k];
                for (std::size_t c = k; c < 4; ++c) m[r][c] -= factor * m[k][c];
            }
        trend.along_y = m[2][3] / m[2][2];
        trend.along_x = (m[1][3] - m[1][2] * trend.along_y) / m[1][1];
        trend.base = (m[0][3] - m[0][1] * trend.along_x - m[0][2] * trend.along_y) / m[0][0];
    }
    return trend;
}

double brightness(const Vec3& c) { return 0.3 * c.x + 0.59 * c.y + 0.11 * c.z; }

std::array<double, 4> logarithms(const Vec3& colour) {
    std::array<double, 4> values{};
    for (int c = 0; c < 3; ++c) values[static_cast<std::size_t>(c)] = std::log(std::max(colour[c], Darkest));
    values[3] = std::log(std::max(brightness(colour), Darkest));
    return values;
}

/// One or two usual colours of a surface, in logarithms, the darker first. Checks and stripes have two.
class Tones {
public:
    explicit Tones(std::vector<std::array<double, 4>> cells, bool by_hue) : by_hue_(by_hue) {
        std::sort(cells.begin(), cells.end(), [](const auto& a, const auto& b) { return a[3] < b[3]; });
        const double count = static_cast<double>(cells.size());
        double sum = 0, squares = 0, low = 0, best = 0;
        for (const auto& cell : cells) sum += cell[3], squares += cell[3] * cell[3];
        const double total = squares / count - sum * sum / (count * count);
        std::size_t split = 0;
        for (std::size_t i = 0; i + 1 < cells.size(); ++i) {  // the split of Otsu (1979)
            low += cells[i][3];
            const double n = static_cast<double>(i + 1), other = count - n;
            const double step = (sum - low) / other - low / n;
            const double between = n * other / (count * count) * step * step;
            if (between > best) best = between, split = i + 1;
        }
        const bool two = total > LeastContrast * LeastContrast && total - best < TwoTones * total;
        if (two) add(cells, 0, split);
        add(cells, two ? split : 0, cells.size());
    }
    /// Difference of a cell's colour from the darkest tone that is not darker.
    std::array<double, 4> off(const Vec3& colour) const {
        auto values = logarithms(colour);
        const double hue = hue_step(values, tones_.front()) - hue_step(values, tones_.back());
        if (by_hue_ && std::abs(hue) > ToneHue && std::abs(values[3] - tones_.front()[3]) < ToneNear) {
            const auto& like = hue < 0 ? tones_.front() : tones_.back();
            for (std::size_t c = 0; c < 4; ++c) values[c] -= like[c];
            return values;
        }
        const auto& tone = values[3] <= tones_.front()[3] + ToneSlack ? tones_.front() : tones_.back();
        for (std::size_t c = 0; c < 4; ++c) values[c] -= tone[c];
        return values;
    }

private:
    static double hue_step(const std::array<double, 4>& a, const std::array<double, 4>& b) {
        const double steps[] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
        return std::max({steps[0], steps[1], steps[2]}) - std::min({steps[0], steps[1], steps[2]});
    }
    void add(const std::vector<std::array<double, 4>>& cells, std::size_t first, std::size_t last) {
        std::array<double, 4> mean{};
        for (std::size_t i = first; i < last; ++i)
            for (std::size_t c = 0; c < 4; ++c) mean[c] += cells[i][c] / static_cast<double>(last - first);
        tones_.push_back(mean);
    }
    std::vector<std::array<double, 4>> tones_;
    bool by_hue_ = false;
};

class Finder {
public:
    Finder(Chart& chart, std::span<SurfaceRow> rows, const BitGrid& hole, BitGrid foot, double reach)
        : chart_(chart), rows_(rows), hole_(hole) {
        double all = 0, whole = 0;
        for (std::size_t i = 0; i < foot.cells.size(); ++i) {
            all += foot.cells[i];
            if (foot.cells[i] != 0 && hole.cells[i] == 0 && chart.known.cells[i] != 0) whole += 1;
            foot.cells[i] |= hole.cells[i];
        }
        whole_ = whole > WholeFoot * all;
        away_ = distance_to(foot);
        surface_ = chart.known;
        std::vector<double> distances;
        for (std::size_t i = 0; i < foot.cells.size(); ++i) {
            if (hole.cells[i] != 0) surface_.cells[i] = 0;
            if (surface_.cells[i] != 0) distances.push_back(away_.cells[i]);
        }
        if (distances.empty()) return;
        const auto far = distances.begin() + static_cast<std::ptrdiff_t>(
                                                 (1 - BeyondShare) * static_cast<double>(distances.size()));
        std::nth_element(distances.begin(), far, distances.end());
        reach_ = reach = std::min(reach, *far);
        std::vector<std::size_t> beyond;
        place_ = Grid<std::int32_t>(hole.width, hole.height, -1);
        for (std::size_t i = 0; i < foot.cells.size(); ++i) {
            if (surface_.cells[i] == 0) continue;
            if (away_.cells[i] > reach) beyond.push_back(i);
            else place_.cells[i] = static_cast<std::int32_t>(within_.size()), within_.push_back(i);
        }
        const std::size_t count = std::min(beyond.size(), MostBeyond);
        for (std::size_t k = 0; k < count; ++k) beyond_.push_back(beyond[k * beyond.size() / count]);
    }

    Shade find() {
        Shade shade{std::vector<Vec3>(rows_.size(), Vec3(1)), BitGrid(hole_.width, hole_.height, 0)};
        if (beyond_.size() < LeastBeyond) return shade;
        Values colours;
        for (const auto cell : beyond_) colours.push_back(logarithms(chart_.colour.cells[cell]));
        const Tones tones(std::move(colours), false);
        double along = 0;
        for (const double cells : AlongCells) {
            measure(tones, along = cells);
            if (spread_ < CalmSpread) break;
        }
        hue_ = dark_;
        const bool rough = spread_ > RoughSpread;
        measure_depth();
        BitGrid shaded = connected();
        const bool contact = !whole_ && (rough || is_contact(shaded));
        if (contact) {
            contact_ = true;
            measure(tones, along);
            retinex_ = spread_ > RoughSpread;
            if (retinex_) measure(tones, along);
            hue_ = dark_;
            shaded = connected();
        }
        find_brightest();
        for (std::size_t k = 0; k < within_.size(); ++k)
            if (shaded.cells[within_[k]] != 0 && dark_[k][3] < -(contact ? DeepContact : DeepShadow))
                shade.deep.cells[within_[k]] = 1;
        if (!contact) lighten(shaded, shade.gain);
        for (int round = 0; contact && round < GainRounds; ++round) {
            if (round > 0) measure(tones, along);
            lighten_alike(shaded, shade.gain);
        }
        return shade;
    }

private:
    /// Means over the cells around that are as far from the thing. Textures average out, a shadow's slope
    /// does not.
    std::array<double, 4> mean_at(std::size_t cell, double along) const {
        const auto width = static_cast<std::size_t>(hole_.width);
        const int cx = static_cast<int>(cell % width), cy = static_cast<int>(cell / width);
        const int reach = static_cast<int>(std::ceil(2 * along));
        std::array<double, 4> sum{};
        double weight = 0;
        for (int y = std::max(0, cy - reach); y <= std::min(hole_.height - 1, cy + reach); ++y)
            for (int x = std::max(0, cx - reach); x <= std::min(hole_.width - 1, cx + reach); ++x) {
                const std::size_t other = surface_.index(x, y);
                const double step = (away_.cells[other] - away_.cells[cell]) / AcrossCells;
                if (surface_.cells[other] == 0 || step * step > 9) continue;
                const double d2 = (x - cx) * (x - cx) + (y - cy) * (y - cy);
                const double w = std::exp(-0.5 * (step * step + d2 / (along * along)));
                for (std::size_t c = 0; c < 4; ++c) sum[c] += w * off_.cells[other][c];
                weight += w;
            }
        for (auto& value : sum) value /= weight;
        return sum;
    }

    /// Light of the cells by colour retinex (Land and McCann 1971, Funt et al. 1992): steps of brightness
    /// between cells of one hue are light, others are paint. Solves the Poisson equation; the surface beyond
    /// has the light 0.
    void measure_light() {
        Grid<std::array<double, 4>> light(hole_.width, hole_.height);
        Grid<std::array<double, 4>> colour = light;
        for (std::size_t i = 0; i < colour.cells.size(); ++i)
            colour.cells[i] = logarithms(chart_.colour.cells[i]);
        const auto width = static_cast<std::size_t>(hole_.width);
        constexpr int Sides[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
        for (int sweep = 0; sweep < RetinexSweeps; ++sweep)
            for (const auto cell : within_) {
                const int x = static_cast<int>(cell % width), y = static_cast<int>(cell / width);
                std::array<double, 4> sum{};
                double count = 0;
                for (const auto& [dx, dy] : Sides) {
                    if (!surface_.inside(x + dx, y + dy) || surface_.at(x + dx, y + dy) == 0) continue;
                    const std::size_t other = surface_.index(x + dx, y + dy);
                    const auto step = light_step(colour.cells[other], colour.cells[cell]);
                    for (std::size_t c = 0; c < 4; ++c) sum[c] += light.cells[other][c] + step[c];
                    count += 1;
                }
                for (std::size_t c = 0; c < 4 && count > 0; ++c)
                    light.cells[cell][c] += RetinexRelax * (sum[c] / count - light.cells[cell][c]);
            }
        for (std::size_t k = 0; k < within_.size(); ++k) dark_[k] = light.cells[within_[k]];
        spread_ = 0.5 * RetinexNoise;
    }

    /// Step of light between two colours; none where the paint changes.
    static std::array<double, 4> light_step(const std::array<double, 4>& from,
                                            const std::array<double, 4>& to) {
        std::array<double, 4> step{};
        for (std::size_t c = 0; c < 4; ++c) step[c] = to[c] - from[c];
        const double hue = std::max({step[0], step[1], step[2]}) - std::min({step[0], step[1], step[2]});
        if (hue > PaintHue || std::abs(step[3]) > PaintStep) return {};
        return step;
    }

    /// Rows of the surface, and those beside them by the places in `listed_`.
    void list_rows() {
        std::vector<std::int32_t> place(rows_.size(), -1);
        for (const auto i : chart_.own)
            if (rows_[i].longest() <= LargestLit * chart_.cell)
                place[i] = static_cast<std::int32_t>(listed_.size()), listed_.push_back(i);
        shade_rows_.resize(listed_.size());
        std::vector<std::pair<double, std::uint32_t>> found;
        for (std::size_t k = 0; k < listed_.size(); ++k) {
            const Vec3 at = chart_.local(rows_[listed_[k]].at);
            for (const int reach : {1, 3}) {
                found.clear();
                each_neighbour_and_self(at, reach, [&](int x, int y) {
                    for (const auto other : chart_.rows_in(x, y)) {
                        if (place[other] < 0 || other == listed_[k]) continue;
                        const Vec3 d = chart_.local(rows_[other].at) - at;
                        found.emplace_back(d.x * d.x + d.y * d.y, static_cast<std::uint32_t>(place[other]));
                    }
                });
                if (found.size() >= Enough) break;
            }
            ShadeRow& row = shade_rows_[k];
            const std::size_t nearest = std::min(Nearest, found.size());
            std::partial_sort(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(nearest),
                              found.end());
            for (std::size_t n = 0; n < nearest; ++n) join(static_cast<std::uint32_t>(k), found[n].second);
            row.trust = std::max(LeastTrust, static_cast<double>(chart_.shown[listed_[k]]));
        }
    }
    /// Makes two rows neighbours, unless one has enough of them.
    void join(std::uint32_t i, std::uint32_t j) {
        ShadeRow &a = shade_rows_[i], &b = shade_rows_[j];
        const auto end = a.beside.begin() + a.count;
        if (a.count == a.beside.size() || b.count == b.beside.size()) return;
        if (std::find(a.beside.begin(), end, j) != end) return;
        a.beside[a.count++] = j, b.beside[b.count++] = i;
    }
    template <class F> void each_neighbour_and_self(const Vec3& at, int reach, F&& call) const {
        const int x = static_cast<int>(std::floor(at.x)), y = static_cast<int>(std::floor(at.y));
        if (hole_.inside(x, y)) call(x, y);
        each_neighbour(hole_, x, y, reach, call);
    }
    /// Cell that holds a row's middle.
    std::size_t cell_of(std::uint32_t i) const {
        const Vec3 at = chart_.local(rows_[i].at);
        return hole_.index(std::clamp(static_cast<int>(std::floor(at.x)), 0, hole_.width - 1),
                           std::clamp(static_cast<int>(std::floor(at.y)), 0, hole_.height - 1));
    }

    /// Depth of the shadow in all rows.
    void measure_depth() {
        list_rows();
        BitGrid is_beyond(hole_.width, hole_.height, 0);
        for (const auto cell : beyond_) is_beyond.cells[cell] = 1;
        std::vector<std::uint32_t> far, near;
        std::vector<std::size_t> far_cells;
        Values colours;
        for (std::size_t k = 0; k < listed_.size(); ++k) {
            const std::size_t cell = cell_of(listed_[k]);
            if (is_beyond.cells[cell] != 0) {
                far.push_back(static_cast<std::uint32_t>(k)), far_cells.push_back(cell);
                colours.push_back(logarithms(rows_[listed_[k]].colour));
            } else if (away_.cells[cell] <= NearCells) near.push_back(static_cast<std::uint32_t>(k));
        }
        const Tones tones(colours, true);
        for (auto& colour : colours) {
            const Vec3 c{std::exp(colour[0]), std::exp(colour[1]), std::exp(colour[2])};
            colour = tones.off(c);
        }
        std::array<Trend, 3> trends;
        for (std::size_t c = 0; c < 3; ++c) trends[c] = fit_trend(colours, c, far_cells, surface_);
        const double unit = 0.5 * std::max(hole_.width, hole_.height);
        for (std::size_t k = 0; k < listed_.size(); ++k) {
            const Vec3 at = chart_.local(rows_[listed_[k]].at);
            const auto values = tones.off(rows_[listed_[k]].colour);
            for (std::size_t c = 0; c < 3; ++c)
                shade_rows_[k].off[static_cast<int>(c)] =
                    values[c] - trends[c].at((at.x - 0.5) / unit - 1, (at.y - 0.5) / unit - 1);
        }
        shade_ = shade_depth(shade_rows_, far, near);
        spread_ = shade_.spread;
        Grid<double> depth(hole_.width, hole_.height, 0), count = depth;
        for (std::size_t k = 0; k < listed_.size(); ++k)
            depth.cells[cell_of(listed_[k])] += shade_rows_[k].trust * shade_.depth[k],
                count.cells[cell_of(listed_[k])] += shade_rows_[k].trust;
        for (std::size_t k = 0; k < within_.size(); ++k) {
            const auto cell = within_[k];
            double sum = depth.cells[cell], all = count.cells[cell];
            if (all == 0)
                each_neighbour(hole_, static_cast<int>(cell % static_cast<std::size_t>(hole_.width)),
                               static_cast<int>(cell / static_cast<std::size_t>(hole_.width)), 1,
                               [&](int x, int y) { sum += depth.at(x, y), all += count.at(x, y); });
            dark_[k][3] = all > 0 ? sum / all : 0;
        }
    }

    /// Means of all cells less the trend of the surface beyond.
    void measure(const Tones& tones, double along) {
        if (retinex_) return measure_light();
        off_ = Grid<std::array<double, 4>>(hole_.width, hole_.height);
        for (std::size_t i = 0; i < off_.cells.size(); ++i)
            if (surface_.cells[i] != 0) off_.cells[i] = tones.off(chart_.colour.cells[i]);
        Values beyond;
        for (const auto cell : beyond_) beyond.push_back(mean_at(cell, along));
        dark_.clear();
        for (const auto cell : within_) dark_.push_back(mean_at(cell, along));
        const double unit = 0.5 * std::max(hole_.width, hole_.height);
        const auto width = static_cast<std::size_t>(hole_.width);
        double sum = 0;
        for (std::size_t c = 0; c < 4; ++c) {
            const Trend trend = fit_trend(beyond, c, beyond_, surface_);
            const auto expected = [&](std::size_t cell) {
                return trend.at(static_cast<double>(cell % width) / unit - 1,
                                static_cast<double>(cell / width) / unit - 1);
            };
            for (std::size_t k = 0; k < within_.size(); ++k) dark_[k][c] -= expected(within_[k]);
            if (c < 3) continue;
            for (std::size_t k = 0; k < beyond_.size(); ++k) {
                const double off = beyond[k][c] - expected(beyond_[k]);
                sum += std::min(off * off, 1.0);
            }
        }
        spread_ = std::sqrt(sum / static_cast<double>(beyond_.size()));
    }

    /// True for a cell that is darker by the limit, and no darker in one channel than in another.
    bool darker(std::size_t cell, double limit) const {
        if (place_.cells[cell] < 0) return false;
        const auto& dark = dark_[static_cast<std::size_t>(place_.cells[cell])];
        const auto& hue = hue_[static_cast<std::size_t>(place_.cells[cell])];
        if (dark[3] > -limit) return false;
        for (std::size_t c = 0; c < 3; ++c)
            if (std::abs(hue[c] - hue[3]) > HueLimit + HueSlack * std::abs(dark[3])) return false;
        return true;
    }

    /// Clearly darker cells at the foot, and those joined to them that are slightly darker.
    BitGrid connected() const {
        const double clear = std::max(ClearlyDarker, ClearSpread * spread_);
        const double slight = std::max(contact_ ? SlightlyDarker : LeastLit, SlightSpread * spread_);
        BitGrid shaded(hole_.width, hole_.height, 0);
        std::vector<std::size_t> open;
        for (const auto cell : within_)
            if (away_.cells[cell] <= 2.5 && darker(cell, clear)) shaded.cells[cell] = 1, open.push_back(cell);
        const auto width = static_cast<std::size_t>(shaded.width);
        while (!open.empty()) {
            const std::size_t cell = open.back();
            open.pop_back();
            each_neighbour(shaded, static_cast<int>(cell % width), static_cast<int>(cell / width), 1,
                           [&](int x, int y) {
                               const std::size_t next = shaded.index(x, y);
                               if (shaded.cells[next] != 0 || !darker(next, slight)) return;
                               shaded.cells[next] = 1;
                               open.push_back(next);
                           });
        }
        return shaded;
    }

    /// True where nearly all of the shadow is near the thing: its depth depends on the distance alone.
    bool is_contact(const BitGrid& shaded) const {
        if (shade_.noise < PlainNoise) return false;
        if (shade_.noise > RoughNoise) return true;
        double all = 1e-9, far = 0;
        for (const auto cell : within_) {
            if (shaded.cells[cell] == 0) continue;
            const double depth = dark_[static_cast<std::size_t>(place_.cells[cell])][3];
            all += depth * depth;
            if (away_.cells[cell] > ContactReach * reach_) far += depth * depth;
        }
        return far < FarShare * all;
    }

    /// Brightness that few rows of the surface beyond exceed: no row is lit more.
    void find_brightest() {
        std::vector<double> values;
        for (const auto cell : beyond_)
            for (const auto i :
                 chart_.rows_in(static_cast<int>(cell % static_cast<std::size_t>(hole_.width)),
                                static_cast<int>(cell / static_cast<std::size_t>(hole_.width))))
                values.push_back(brightness(rows_[i].colour));
        if (values.empty()) return;
        brightest_ = lower_quantile(values, BrightShare);
    }

    /// Goes on with the values of shaded cells into cells beside them that nothing covers.
    void spread(Grid<Vec3>& more, BitGrid set) const {
        for (int pass = 0; pass < 2; ++pass) {
            const auto values = more;
            const BitGrid before = set;
            each_cell(set, [&](int x, int y) {
                if (before.at(x, y) != 0 || surface_.at(x, y) != 0) return;
                Vec3 sum;
                double count = 0;
                each_neighbour(before, x, y, 1, [&](int nx, int ny) {
                    if (before.at(nx, ny) != 0) sum += values.at(nx, ny), count += 1;
                });
                if (count > 0) more.at(x, y) = sum / count, set.at(x, y) = 1;
            });
        }
    }

    /// Gains of the rows in and beside shaded cells, with which the surface is drawn.
    void lighten(const BitGrid& shaded, std::vector<Vec3>& gain) {
        for (std::size_t k = 0; k < listed_.size(); ++k) {
            SurfaceRow& row = rows_[listed_[k]];
            bool in = false;
            each_neighbour_and_self(chart_.local(row.at), 1,
                                    [&](int x, int y) { in = in || shaded.at(x, y) != 0; });
            if (!in || shade_.depth[k] > -LeastLit) continue;
            Vec3 next;
            for (int c = 0; c < 3; ++c)
                next[c] = std::clamp(std::exp(-shade_.depth[k] * shade_.tint[c]), 1.0, MostGain);
            const double plain = std::max(brightness(row.colour), Darkest);
            const double all = brightness(next), most = std::max(1.0, brightest_ / plain);
            for (int c = 0; c < 3; ++c) next[c] = std::max(1.0, next[c] * std::min(1.0, most / all));
            row.colour = row.colour * next;
            gain[listed_[k]] = next;
        }
        draw_chart(chart_, rows_);
    }

    /// Multiplies the rows' gains by what their cells still lack, and draws the surface with them.
    void lighten_alike(const BitGrid& shaded, std::vector<Vec3>& gain) {
        Grid<Vec3> more(hole_.width, hole_.height, Vec3(0));
        for (std::size_t k = 0; k < within_.size(); ++k)
            if (shaded.cells[within_[k]] != 0)
                more.cells[within_[k]] = {-dark_[k][0], -dark_[k][1], -dark_[k][2]};
        spread(more, shaded);
        for (const auto i : chart_.own) {
            SurfaceRow& row = rows_[i];
            const Vec3 at = chart_.local(row.at), lack = between_cells(more, at.x, at.y);
            if (lack == Vec3(0) || row.longest() > LargestLit * chart_.cell) continue;
            const Vec3 before = gain[i], plain = row.colour / before;
            Vec3 next;
            for (int c = 0; c < 3; ++c)
                next[c] = std::clamp(before[c] * std::exp(lack[c]), 1.0, MostContactGain);
            const double all = std::min(brightness(next), brightest_ / std::max(brightness(plain), Darkest));
            for (int c = 0; c < 3; ++c)
                next[c] = std::max(1.0, std::clamp(next[c], all / TintLimit, all * TintLimit));
            row.colour = plain * next;
            gain[i] = next;
        }
        draw_chart(chart_, rows_);
    }

    Chart& chart_;
    std::span<SurfaceRow> rows_;
    const BitGrid& hole_;
    BitGrid surface_;
    Grid<double> away_;                         // from the hole and the foot, cells
    Grid<std::array<double, 4>> off_;           // of the surface's cells from their tones
    std::vector<std::size_t> within_, beyond_;  // cells that may be in the shadow; some of the others
    Grid<std::int32_t> place_;                  // of a cell in `within_`; -1 = not there
    Values hue_;
    std::vector<std::uint32_t> listed_;
    std::vector<ShadeRow> shade_rows_;
    ShadeDepth shade_;
    Values dark_;  // of the cells of `within_`, less the trend
    double reach_ = 0, spread_ = 0, brightest_ = FarAway;
    bool retinex_ = false, whole_ = false, contact_ = false;
};

}  // namespace

Shade find_shade(Chart& chart, std::span<SurfaceRow> rows, const BitGrid& hole, const BitGrid& foot,
                 double reach) {
    return Finder(chart, rows, hole, foot, reach).find();
}

}  // namespace gse::heal
