// Steps of healing: what goes, the surfaces around, their holes and shadows, the texture, the Gaussians.
#include "engine/heal/heal.h"

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/heal/foot.h"
#include "engine/heal/held_parts.h"
#include "engine/heal/hole.h"
#include "engine/heal/lay.h"
#include "engine/heal/patch_fill.h"
#include "engine/heal/shadow.h"
#include "engine/heal/smooth_fill.h"
#include "engine/heal/supports.h"
#include "engine/scene/scene.h"

namespace gse::heal {
namespace {

constexpr double Margin = 1.0;              // of the thing's size, that is looked at around it
constexpr double Band = 0.6;                // of the thing's size, in which surfaces are looked for
constexpr double RoughestTolerance = 0.08;  // that is tried where no plane was found
constexpr double Tolerance = 0.02;          // of the thing's size, of rows from their plane
constexpr std::size_t MostSurfaces = 5;
constexpr double HidingShare =
    0.5;  // of the thing's size: parts of it that are farther hide nothing for long
constexpr double ShadowReach = 0.45;    // of the thing's size
constexpr int FootRim = 2;              // cells around a foot that nothing saw, in which colours are mixed
constexpr int MixedRim = 3;             // cells around a foot that nothing is copied from
constexpr double LargestCleared = 2.0;  // cells, standard deviation of a row that is taken out of a hole
constexpr double LeastAround = 0.6, LeastAroundSteep = 0.8;  // of the cells around a hole or foot, that show
                                                             // a level surface, and another one
constexpr double LevelNormal = 0.7;      // cosine between up and the normal of a surface with a shadow
constexpr double LeastGain = 1.02;       // of a row that is lit again
constexpr double LeastOpenShare = 0.02;  // of the thing's size squared: open area worth a sentence

class Healer {
public:
    Healer(const HealInput& input, const HealSettings& settings)
        : input_(input), settings_(settings), up_(normalized(input.up)) {
        if (input.thing.size() != input.scene.size())
            throw Error(ErrorCode::InvalidArgument, "the label does not have a value for every splat",
                        "make the label on this scene");
        if (length(up_) == 0) throw Error(ErrorCode::InvalidArgument, "the up direction is zero");
        check_fields(settings);
        usable_ = usable_rows(input.scene);
        healed_.removed.assign(input.scene.size(), 0);
        healed_.added.sh_degree = input.scene.sh_degree();
    }

    Healed remove() {
        if (!begin()) return std::move(healed_);
        if (settings_.held_parts) take_held();
        reach_ = settings_.reach * body_.size;
        heal(settings_.shadow);
        return std::move(healed_);
    }

    std::vector<std::uint8_t> held() {
        if (begin()) take_held();
        return std::move(healed_.removed);
    }

    Healed fill(const Vec3& centre, double radius) {
        if (!(radius > 0) || !std::isfinite(radius))
            throw Error(ErrorCode::InvalidArgument, "the radius of the brush is not positive");
        for (std::size_t row = 0; row < input_.thing.size(); ++row)
            if (input_.thing[row] != 0) healed_.removed[row] = 1;
        body_ = ball_body(centre, radius);
        look_around();
        reach_ = 0;
        heal(false);
        return std::move(healed_);
    }

private:
    /// Takes the thing's rows and looks around them. False where nothing of the thing can be seen.
    bool begin() {
        for (std::size_t row = 0; row < input_.thing.size(); ++row)
            if (input_.thing[row] != 0) healed_.removed[row] = 1, any_ = true;
        if (!any_) throw Error(ErrorCode::InvalidArgument, "no splat is labelled", "select the thing first");
        thing_ = surface_rows(input_.scene, usable_,
                              [&](std::size_t row, const Vec3&) { return healed_.removed[row] != 0; });
        body_ = body_of(thing_);
        if (body_.empty()) return false;
        look_around();
        return true;
    }

    void step(const char* stage, int at, int total) {
        if (input_.control.stop_requested()) throw Error(ErrorCode::Cancelled, "healing was stopped");
        input_.control.report(stage, at, total);
    }

    /// Rows near the body that stay.
    void look_around() {
        rows_ = surface_rows(input_.scene, usable_, [&](std::size_t row, const Vec3& at) {
            return healed_.removed[row] == 0 && body_.near(at, Margin * body_.size);
        });
    }

    void take_held() {
        step("held parts", 0, 1);
        const auto held = held_parts(thing_, rows_, body_, Margin * body_.size, up_);
        std::vector<SurfaceRow> rest;
        for (std::size_t i = 0; i < rows_.size(); ++i) {
            if (held[i] == 0) {
                rest.push_back(rows_[i]);
                continue;
            }
            healed_.removed[rows_[i].row] = 1;
            ++healed_.carried;
        }
        rows_.swap(rest);
        step("held parts", 1, 1);
    }

    /// Removes what the label left out, as far as no surface is made of it.
    void take_remnants() {
        std::vector<SurfaceRow> loose;
        std::vector<std::size_t> place;
        for (std::size_t i = 0; i < rows_.size(); ++i)
            if (taken_[i] == 0) loose.push_back(rows_[i]), place.push_back(i);
        const auto left = remnants(thing_, loose, body_, Margin * body_.size);
        for (std::size_t k = 0; k < left.size(); ++k) {
            if (left[k] == 0) continue;
            healed_.removed[loose[k].row] = 1;
            ++healed_.cleared;
        }
    }

    /// Charts of the surfaces around, the one with most evidence first. Where nothing is flat enough, planes
    /// may be rougher.
    void find_surfaces() {
        Random random = Random::stream(settings_.seed, 1);
        taken_.assign(rows_.size(), 0);
        auto samples = plane_samples(rows_, body_, Band * body_.size);
        double total = 0;
        for (const auto& sample : samples) total += sample.weight;
        double tolerance = Tolerance * body_.size;
        for (std::size_t tries = 0; tries < 2 * MostSurfaces && charts_.size() < MostSurfaces; ++tries) {
            step("surfaces", static_cast<int>(tries), 2 * static_cast<int>(MostSurfaces));
            const auto plane = find_plane(samples, total, tolerance, body_, random);
            auto chart = plane ? make_chart(rows_, taken_, *plane, tolerance, body_, up_) : std::nullopt;
            if (!chart && charts_.empty() && tolerance < RoughestTolerance * body_.size) {
                tolerance *= 2;
                continue;
            }
            if (!plane) break;
            if (chart)
                for (const auto i : chart->own) taken_[i] = 1;
            std::erase_if(samples, [&](const PlaneSample& sample) {
                return taken_[sample.index] != 0 || std::abs(plane->height(sample.at)) < tolerance;
            });
            if (chart) charts_.push_back(std::move(*chart));
        }
    }

    void heal(bool whole_thing) {
        gain_.assign(rows_.size(), Vec3(1));
        find_surfaces();
        if (whole_thing) take_remnants();
        std::vector<BitGrid> under, near;
        for (const auto& chart : charts_) {
            under.push_back(cells_under(chart));
            near.push_back(grown(under.back(), static_cast<int>(std::ceil(reach_ / chart.cell)) + 2));
        }
        for (std::size_t k = 0; k < charts_.size(); ++k) {
            step("holes", static_cast<int>(k), static_cast<int>(charts_.size()));
            Chart& chart = charts_[k];
            const BitGrid border = borders(charts_, near, k);
            BitGrid foot(chart.height.width, chart.height.height, 0);
            if (whole_thing) foot = clear_foot(chart, border);
            const bool stands = std::find(foot.cells.begin(), foot.cells.end(), 1) != foot.cells.end();
            Hole hole = find_hole(chart, near[k], stands ? foot : under[k], border);
            drop_shown(chart, rows_, healed_.removed, body_, hole.cells);
            drop_seams(hole.cells, foot);
            drop_loose(chart, border, hole);
            heal_surface(chart, std::move(hole), foot, stands && level(chart) && settings_.shadow);
        }
        say_what_is_open();
    }

    /// Cells under the thing, seen along the normal.
    BitGrid cells_under(const Chart& chart) const {
        BitGrid under(chart.height.width, chart.height.height, 0);
        for (const auto& point : body_.points) {
            const Vec3 at = chart.local(point);
            const int x = static_cast<int>(std::floor(at.x)), y = static_cast<int>(std::floor(at.y));
            if (under.inside(x, y) && std::abs(at.z - chart.height.at(x, y)) < HidingShare * body_.size)
                under.at(x, y) = 1;
        }
        return under;
    }

    bool level(const Chart& chart) const { return dot(chart.normal, up_) > LevelNormal; }
    double least_around(const Chart& chart) const { return level(chart) ? LeastAround : LeastAroundSteep; }

    /// Leaves holes open that the surface does not show around.
    void drop_loose(const Chart& chart, const BitGrid& border, Hole& hole) {
        std::vector<std::size_t> sizes;
        const auto groups = groups_of(hole.cells, sizes);
        for (int group = 1; group < static_cast<int>(sizes.size()); ++group) {
            BitGrid one(groups.width, groups.height, 0);
            for (std::size_t i = 0; i < one.cells.size(); ++i)
                one.cells[i] = groups.cells[i] == group ? 1 : 0;
            if (known_around(chart, one, border) >= least_around(chart)) continue;
            for (std::size_t i = 0; i < one.cells.size(); ++i)
                if (one.cells[i] != 0) hole.cells.cells[i] = 0, ++hole.open;
        }
    }

    /// Removes what is left of the thing where it stood, and the surface there if no picture can have shown
    /// it.
    BitGrid clear_foot(Chart& chart, const BitGrid& border) {
        BitGrid foot = foot_cells(chart, body_);
        if (known_around(chart, foot, border) < least_around(chart))
            return BitGrid(foot.width, foot.height, 0);
        const bool garbage = foot_is_garbage(chart, foot, rows_);
        if (garbage) foot = grown(foot, FootRim);
        each_remain(chart, foot, rows_, taken_, body_, garbage, [&](std::size_t i) {
            if (healed_.removed[rows_[i].row] != 0) return;
            healed_.removed[rows_[i].row] = 1;
            ++healed_.cleared;
        });
        if (garbage) clear_cells(chart, foot, body_.size);
        return foot;
    }

    void heal_surface(Chart& chart, Hole hole, const BitGrid& foot, bool shadows) {
        const std::size_t before = healed_.added.size();
        if (shadows) light_again(chart, hole.cells, foot);
        HealedSurface surface{chart.origin, chart.normal, chart.cell};
        std::size_t cells = 0;
        for (const auto bit : hole.cells.cells) cells += bit;
        if (cells > 0) {
            clear_hole(chart, hole.cells);
            fill_heights(chart, hole.cells);
            BitGrid known = chart.known;
            for (std::size_t i = 0; i < known.cells.size(); ++i)
                if (hole.cells.cells[i] != 0) known.cells[i] = 0;
            step("texture", 0, 1);
            const auto texture =
                fill_by_patches(chart.colour, known, hole.cells, grown(foot, MixedRim), settings_.seed);
            surface.copied = texture.found;
            lay_rows(input_.scene, rows_, chart, hole.cells, texture, rim_gain(chart, hole.cells, texture),
                     gain_, healed_.added);
        }
        const double area = chart.cell * chart.cell;
        surface.healed_area = area * static_cast<double>(cells);
        surface.open_area = area * static_cast<double>(hole.open);
        surface.rows = healed_.added.size() - before;
        healed_.surfaces.push_back(surface);
    }

    /// Removes the surface's own rows in cells that are filled anew, but for those larger than `largest`.
    void clear_cells(Chart& chart, const BitGrid& cells, double largest) {
        const std::size_t before = chart.own.size();
        std::erase_if(chart.own, [&](std::uint32_t i) {
            const Vec3 at = chart.local(rows_[i].at);
            const int x = static_cast<int>(std::floor(at.x)), y = static_cast<int>(std::floor(at.y));
            if (!cells.inside(x, y) || cells.at(x, y) == 0 || rows_[i].longest() > largest) return false;
            healed_.removed[rows_[i].row] = 1;
            ++healed_.cleared;
            return true;
        });
        if (chart.own.size() < before) draw_chart(chart, rows_);
    }

    /// Removes the rows in a hole, and adds the cells to it that only they had covered.
    void clear_hole(Chart& chart, BitGrid& hole) {
        for (bool more = true; more;) {
            const BitGrid before = chart.known;
            clear_cells(chart, hole, LargestCleared * chart.cell);
            more = false;
            for (std::size_t i = 0; i < hole.cells.size(); ++i)
                if (hole.cells[i] == 0 && before.cells[i] != 0 && chart.known.cells[i] == 0)
                    hole.cells[i] = 1, more = true;
        }
    }

    /// Replaces the rows in the shadow by lit copies. Cells in deep shadow become part of the hole.
    void light_again(Chart& chart, BitGrid& hole, const BitGrid& foot) {
        const auto shade = find_shade(chart, rows_, hole, foot, ShadowReach * body_.size / chart.cell);
        auto& measured = healed_.shadow_measured;
        measured.cell = std::max(measured.cell, chart.cell);
        for (const auto i : chart.own) measured.rows.push_back({rows_[i].at, shade.gain[i]});
        for (std::size_t i = 0; i < hole.cells.size(); ++i)
            if (shade.deep.cells[i] != 0) hole.cells[i] = 1;
        clear_hole(chart, hole);
        for (const auto i : chart.own) {
            const Vec3& gain = gain_[i] = shade.gain[i];
            if (std::max({gain.x, gain.y, gain.z}) < LeastGain) continue;
            healed_.removed[rows_[i].row] = 1;
            ++healed_.shadow;
            append_copy(input_.scene, rows_[i].row, rows_[i].at, {1, 0, 0, 0}, gain, healed_.added);
        }
    }

    void say_what_is_open() {
        if (charts_.empty()) {
            healed_.open = "No surface was found around it, so nothing was filled.";
            return;
        }
        double open = 0;
        for (const auto& surface : healed_.surfaces) open += surface.open_area;
        if (open > LeastOpenShare * body_.size * body_.size)
            healed_.open =
                "A part of what it hid stays open, because too little around it shows how it goes on.";
    }

    const HealInput& input_;
    const HealSettings& settings_;
    Vec3 up_;
    bool any_ = false;
    std::vector<std::uint8_t> usable_;
    Body body_;
    double reach_ = 0;                      // world units
    std::vector<SurfaceRow> thing_, rows_;  // the thing; rows around it that stay
    std::vector<std::uint8_t> taken_;       // rows that belong to a surface
    std::vector<Vec3> gain_;                // of the rows' colours, that lights them again
    std::vector<Chart> charts_;
    Healed healed_;
};

}  // namespace

Healed remove_and_heal(const HealInput& input, const HealSettings& settings) {
    return Healer(input, settings).remove();
}

std::vector<std::uint8_t> with_held_parts(const HealInput& input) {
    const HealSettings settings;
    return Healer(input, settings).held();
}

Healed heal_region(const HealInput& input, const Vec3& centre, double radius, const HealSettings& settings) {
    return Healer(input, settings).fill(centre, radius);
}

GaussianSet healed_set(const GaussianSet& scene, const Healed& healed) {
    std::vector<std::uint8_t> keep(healed.removed.size());
    for (std::size_t i = 0; i < keep.size(); ++i) keep[i] = healed.removed[i] == 0 ? 1 : 0;
    GaussianData data = scene.filtered(keep).to_data();
    for (std::size_t row = 0; row < healed.added.size(); ++row) data.append_row(healed.added, row);
    return GaussianSet(std::move(data));
}

}  // namespace gse::heal
