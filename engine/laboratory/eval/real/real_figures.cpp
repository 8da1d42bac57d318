// Sums over rows and pixels.
#include "engine/laboratory/eval/real/real_figures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>

#include "engine/io/bytes/encoding.h"

namespace gse::bench {
namespace {

constexpr double Clear = 0.3;         // opacity of rows that a thing's bounds are taken from
constexpr double AlmostAll = 0.01;    // of the thing's rows beyond each of its bounds
constexpr double MostOfScene = 0.02;  // of the scene's rows
constexpr double Margin = 1.15;       // around the thing
constexpr double LeastPart = 0.3;     // of the scene that a picture shows
constexpr double FieldOfView = 40 * pipeline::Degree;
constexpr double SideElevation = 15 * pipeline::Degree, AboveElevation = 50 * pipeline::Degree;
constexpr double Distance = 1.02;  // times that at which a ball fits
constexpr int SeenByte = 200;      // red of a painted row, above which it is what is seen
constexpr int VisibleBytes = 25;   // a tenth of the range of a channel

using PositionKey = std::array<std::uint32_t, 3>;

std::vector<PositionKey> position_keys(const GaussianSet& set) {
    std::vector<PositionKey> keys(set.size());
    if (!keys.empty()) std::memcpy(keys.data(), set.position().data(), set.position().size_bytes());
    return keys;
}

int byte_of(float value) { return io::to_byte(static_cast<double>(value) * 255); }

/// Bounds of chosen points, without a share of them at each end of every axis.
Bounds bounds_within(const std::vector<Vec3>& points, const Rows& chosen, double share) {
    Bounds bounds;
    for (int axis = 0; axis < 3; ++axis) {
        std::vector<double> values;
        for (std::size_t row = 0; row < points.size(); ++row)
            if (chosen[row] != 0) values.push_back(points[row][axis]);
        bounds.low[axis] = quantile_of(values, share);
        bounds.high[axis] = quantile_of(values, 1 - share);
    }
    return bounds;
}

Rows both(const Rows& a, const Rows& b) {
    Rows result(a.size());
    for (std::size_t row = 0; row < a.size(); ++row) result[row] = a[row] != 0 && b[row] != 0 ? 1 : 0;
    return result;
}

bool any(const Rows& rows) { return std::find(rows.begin(), rows.end(), 1) != rows.end(); }

Overlap ratios(double common, double mine, double theirs) {
    const double whole = mine + theirs - common;
    return {whole > 0 ? common / whole : 0, theirs > 0 ? common / theirs : 0, mine > 0 ? common / mine : 0};
}

bool is_changed(const Image& before, const Image& after, std::size_t pixel) {
    for (std::size_t i = pixel * 3; i < pixel * 3 + 3; ++i)
        if (std::abs(byte_of(before.data[i]) - byte_of(after.data[i])) > VisibleBytes) return true;
    return false;
}

/// The set in one colour where rows are chosen and in its opposite elsewhere.
GaussianSet painted(const GaussianSet& set, const Rows& rows) {
    constexpr double SphericalHarmonic0 = 0.28209479177387814;
    constexpr auto full = static_cast<float>(0.5 / SphericalHarmonic0);
    std::vector<float> colours(set.size() * 3);
    for (std::size_t i = 0; i < colours.size(); ++i) colours[i] = rows[i / 3] != 0 ? full : -full;
    auto buffers = set.buffers();
    buffers.sh_degree = 0;
    buffers.sh = std::make_shared<const std::vector<float>>(std::move(colours));
    return GaussianSet(std::move(buffers));
}

}  // namespace

nlohmann::ordered_json Overlap::json() const {
    return {{"iou", iou}, {"recall", recall}, {"precision", precision}};
}

std::vector<Vec3> world_centres(const GaussianSet& set, const Vec3& offset) {
    const auto position = set.position();
    std::vector<Vec3> centres(set.size());
    for (std::size_t row = 0; row < centres.size(); ++row)
        centres[row] = Vec3{position[row * 3], position[row * 3 + 1], position[row * 3 + 2]} + offset;
    return centres;
}

std::vector<double> opacities(const GaussianSet& set) {
    std::vector<double> values(set.size());
    for (std::size_t row = 0; row < values.size(); ++row)
        values[row] = 1 / (1 + std::exp(-static_cast<double>(set.opacity_logit()[row])));
    return values;
}

TruthRows truth_rows(const RealThing& thing, const std::vector<Vec3>& centres) {
    TruthRows truth{Rows(centres.size()), Rows(centres.size())};
    for (std::size_t row = 0; row < centres.size(); ++row) {
        const bool either = std::any_of(thing.either.begin(), thing.either.end(),
                                        [&](const auto& region) { return region.contains(centres[row]); });
        truth.either[row] = either ? 1 : 0;
        truth.thing[row] = !either && thing.region.contains(centres[row]) ? 1 : 0;
    }
    return truth;
}

Overlap row_overlap(const Rows& label, const TruthRows& truth, const std::vector<double>& weight) {
    double common = 0, mine = 0, theirs = 0;
    for (std::size_t row = 0; row < label.size(); ++row) {
        if (truth.either[row] != 0) continue;
        if (label[row] != 0) mine += weight[row];
        if (truth.thing[row] != 0) theirs += weight[row];
        if (label[row] != 0 && truth.thing[row] != 0) common += weight[row];
    }
    return ratios(common, mine, theirs);
}

Overlap seen_overlap(const std::vector<Mask>& label, const std::vector<Mask>& truth) {
    double common = 0, mine = 0, theirs = 0;
    for (std::size_t i = 0; i < label.size(); ++i)
        for (std::size_t p = 0; p < label[i].data.size(); ++p) {
            mine += label[i].data[p];
            theirs += truth[i].data[p];
            common += label[i].data[p] * truth[i].data[p];
        }
    return ratios(common, mine, theirs);
}

Rows new_rows(const GaussianSet& after, const GaussianSet& before) {
    auto known = position_keys(before);
    std::sort(known.begin(), known.end());
    const auto keys = position_keys(after);
    Rows rows(keys.size());
    for (std::size_t row = 0; row < keys.size(); ++row)
        rows[row] = std::binary_search(known.begin(), known.end(), keys[row]) ? 0 : 1;
    return rows;
}

std::optional<PlaceShare> place_share(const TruthRegion& place, const GaussianSet& after, const Rows& added,
                                      const Vec3& offset) {
    const auto centres = world_centres(after, offset);
    const auto weight = opacities(after);
    double inside = 0, all = 0, inside_rows = 0, rows = 0;
    for (std::size_t row = 0; row < added.size(); ++row) {
        if (added[row] == 0) continue;
        const bool within = place.contains(centres[row]);
        all += weight[row];
        rows += 1;
        inside += within ? weight[row] : 0;
        inside_rows += within ? 1 : 0;
    }
    if (rows == 0) return std::nullopt;
    return PlaceShare{all > 0 ? inside / all : 0, inside_rows / rows};
}

double quantile_of(std::vector<double>& values, double share) {
    std::erase_if(values, [](double value) { return !std::isfinite(value); });
    if (values.empty()) return 0;
    const double at = share * static_cast<double>(values.size() - 1);
    const auto index = static_cast<std::size_t>(at);
    const auto low = values.begin() + static_cast<std::ptrdiff_t>(index);
    std::nth_element(values.begin(), low, values.end());
    if (index + 1 == values.size()) return *low;
    const double next = *std::min_element(low + 1, values.end());
    return *low + (next - *low) * (at - static_cast<double>(index));
}

RealCameras real_cameras(const RealScene& scene, const RealTask& task, const GaussianSet& set,
                         const Vec3& offset, const Rows& about) {
    const auto points = world_centres(set, {});
    const auto weight = opacities(set);
    Rows clear(points.size()), all(points.size(), 1);
    for (std::size_t row = 0; row < clear.size(); ++row) clear[row] = weight[row] > Clear ? 1 : 0;
    const Rows chosen = both(task.kind == "ground" || task.about.empty() ? all : about, clear);
    Bounds bounds = bounds_within(points, any(chosen) ? chosen : all, AlmostAll);
    if (task.place_box && task.kind == "add")
        for (int axis = 0; axis < 3; ++axis) {
            bounds.low[axis] = std::min(bounds.low[axis], task.place_box->low[axis] - offset[axis]);
            bounds.high[axis] = std::max(bounds.high[axis], task.place_box->high[axis] - offset[axis]);
        }
    const double whole = bounds_within(points, any(clear) ? clear : all, MostOfScene).radius();
    const double radius = std::max(std::max(bounds.radius(), 1e-6) * Margin, LeastPart * whole);
    OrbitParameters orbit{bounds.centre(), pipeline::parse_up(scene.up, {}),
                          radius / std::sin(FieldOfView / 2) * Distance, SideElevation, FieldOfView};
    const auto camera = [&](double side) {
        const double azimuth = (scene.front.value_or(0) + side) * pipeline::Degree;
        return orbit_camera(orbit, azimuth, RealPictureSide, RealPictureSide);
    };
    RealCameras cameras;
    for (const double side : scene.sides) cameras.sides.push_back(camera(side));
    orbit.elevation = AboveElevation;
    cameras.above = camera(scene.sides.front());
    return cameras;
}

Image real_picture(pipeline::Painter& painter, const GaussianSet& set, const SceneInfo& info,
                   const Camera& camera) {
    pipeline::RenderParameters parameters;
    parameters.background = "grey";
    return painter.paint(set.spans(), camera, pipeline::raster_settings(parameters, info)).colour;
}

std::vector<Mask> seen_rows(pipeline::Painter& painter, const GaussianSet& set, const Rows& rows,
                            const RealCameras& cameras) {
    const GaussianSet shown = painted(set, rows);
    auto all = cameras.sides;
    all.push_back(cameras.above);
    std::vector<Mask> masks;
    for (const auto& camera : all) {
        const Image picture = real_picture(painter, shown, {}, camera);
        Mask mask(picture.width, picture.height);
        for (std::size_t p = 0; p < mask.data.size(); ++p)
            mask.data[p] = byte_of(picture.data[p * 3]) > SeenByte ? 1 : 0;
        masks.push_back(std::move(mask));
    }
    return masks;
}

SeenChange seen_change(const std::vector<Image>& before, const std::vector<Image>& after,
                       const std::vector<Mask>& truth) {
    double inside = 0, outside = 0, area = 0;
    for (const auto& mask : truth) area += static_cast<double>(mask.count());
    for (std::size_t i = 0; i < before.size(); ++i)
        for (std::size_t p = 0; p < truth[i].data.size(); ++p)
            if (is_changed(before[i], after[i], p)) (truth[i].data[p] != 0 ? inside : outside) += 1;
    const double divisor = std::max(area, 1.0);
    return {inside / divisor, outside / divisor};
}

}  // namespace gse::bench
