// Random regions around what is new.
#include "engine/neural/starter/starter_inpainting.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/base/check.h"

namespace gse::neural {
namespace {

constexpr double NothingShare = 0.2;  // of groups that are shown nothing
constexpr double BackgroundShare =
    0.45;  // of other groups without an accessory: those in which what lies behind is known
constexpr double PlaceShare =
    0.45;                          // of other groups with an accessory: those in which its place is not known
constexpr double RoomShare = 0.8;  // of regions where another thing takes a place
constexpr double BoxShare = 0.5, EllipseShare = 0.25;  // of regions; the others are grown outlines
constexpr std::uint64_t LargestMargin = 5;             // cells
constexpr int LeastCover = 13;                         // of 255: less is the soft rim of a splat

struct Cells {
    int side;
    std::vector<float>& values;
    float& at(int x, int y) const { return values[static_cast<std::size_t>(y * side + x)]; }
};

struct Bounds {
    int left, top, right = -1, bottom = -1;  // inclusive; right < 0 = nothing
};

Bounds bounds_of(const Cells& cells) {
    Bounds bounds{cells.side, cells.side};
    for (int y = 0; y < cells.side; ++y)
        for (int x = 0; x < cells.side; ++x) {
            if (cells.at(x, y) == 0) continue;
            bounds.left = std::min(bounds.left, x), bounds.right = std::max(bounds.right, x);
            bounds.top = std::min(bounds.top, y), bounds.bottom = std::max(bounds.bottom, y);
        }
    return bounds;
}

/// Sets every cell whose middle lies in the ellipse.
void add_ellipse(const Cells& cells, double x0, double y0, double rx, double ry) {
    for (int y = 0; y < cells.side; ++y)
        for (int x = 0; x < cells.side; ++x)
            if (std::hypot((x + 0.5 - x0) / rx, (y + 0.5 - y0) / ry) <= 1) cells.at(x, y) = 1;
}

void grow(const Cells& cells, int by) {
    const std::vector<float> before = cells.values;
    for (int y = 0; y < cells.side; ++y)
        for (int x = 0; x < cells.side; ++x)
            for (int v = std::max(0, y - by); v <= std::min(cells.side - 1, y + by); ++v)
                for (int u = std::max(0, x - by); u <= std::min(cells.side - 1, x + by); ++u)
                    cells.at(x, y) =
                        std::max(cells.at(x, y), before[static_cast<std::size_t>(v * cells.side + u)]);
}

void add_region(const Cells& cells, Random& random) {
    const Bounds thing = bounds_of(cells);
    const auto margin = [&] { return static_cast<int>(1 + random.below(LargestMargin)); };
    const double kind = random.uniform();
    if (thing.right < 0) {  // hidden in this view: something of the place may be seen
        const double radius = random.uniform(-3, 3), side = cells.side;
        if (radius > 0) add_ellipse(cells, random.uniform(0, side), random.uniform(0, side), radius, radius);
        return;
    }
    grow(cells, 1);
    if (kind < BoxShare) {
        const int left = thing.left - margin(), right = thing.right + margin(), top = thing.top - margin(),
                  bottom = thing.bottom + margin();
        for (int y = std::max(0, top); y <= std::min(cells.side - 1, bottom); ++y)
            for (int x = std::max(0, left); x <= std::min(cells.side - 1, right); ++x) cells.at(x, y) = 1;
    } else if (kind < BoxShare + EllipseShare) {
        const auto radius = [&](int low, int high) {
            return (high + 1 - low) / std::numbers::sqrt2 + margin() - 0.5;
        };
        add_ellipse(cells, (thing.left + thing.right + 1) / 2.0, (thing.top + thing.bottom + 1) / 2.0,
                    radius(thing.left, thing.right), radius(thing.top, thing.bottom));
    } else {
        grow(cells, margin() - 1);
    }
}

}  // namespace

InpaintTask draw_inpaint_task(bool accessory, Random& random) {
    if (random.uniform() < NothingShare) return InpaintTask::Nothing;
    if (accessory) return random.uniform() < PlaceShare ? InpaintTask::Place : InpaintTask::Scene;
    return random.uniform() < BackgroundShare ? InpaintTask::Background : InpaintTask::Around;
}

InpaintCells draw_inpaint_cells(InpaintTask task, std::span<const std::uint8_t> covered,
                                std::span<const std::uint8_t> room, int side, Random& random) {
    const auto count = static_cast<std::size_t>(side) * static_cast<std::size_t>(side);
    GSE_CHECK(covered.size() == count && room.size() == count);
    if (task == InpaintTask::Nothing)
        return {std::vector<float>(count, 1.0f), std::vector<float>(count, 0.0f)};
    InpaintCells cells{std::vector<float>(count), std::vector<float>(count, 1.0f)};
    const bool takes_place =
        task != InpaintTask::Scene && std::ranges::any_of(room, [](auto cell) { return cell > 0; });
    const bool in_room = takes_place && (task == InpaintTask::Place || random.uniform() < RoomShare);
    for (std::size_t i = 0; i < count; ++i)
        cells.mask[i] = (in_room ? room[i] > 0 : covered[i] >= LeastCover) ? 1.0f : 0.0f;
    const Cells mask{side, cells.mask};
    if (!in_room) add_region(mask, random);
    if (task == InpaintTask::Around) {
        for (std::size_t i = 0; i < count; ++i) cells.shown[i] = 1 - cells.mask[i];
    } else if (task == InpaintTask::Background) {
        std::vector<float> hole(count);
        const double radius = random.uniform(-4, 4);
        if (radius > 0)
            add_ellipse({side, hole}, random.uniform(0, side), random.uniform(0.3 * side, side), radius,
                        radius / 2);
        for (std::size_t i = 0; i < count; ++i) cells.shown[i] = 1 - hole[i] * cells.mask[i];
    }
    return cells;
}

}  // namespace gse::neural
