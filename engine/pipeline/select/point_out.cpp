// Surface under the click, and what grows from it.
#include "engine/pipeline/select/point_out.h"
#include "engine/edit/search/thing_parts.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/printable.h"
#include "engine/edit/placement/ground_rows.h"
#include "engine/evaluate/metrics.h"
#include "engine/math/quantile.h"
#include "engine/math/unproject.h"
#include "engine/pipeline/select/named_picture.h"
#include "engine/scene/framing.h"

namespace gse::pipeline {
namespace {

constexpr float Shown = 0.5f;       // alpha of a pixel that shows something
constexpr double Framed = 1.6;      // radii of a scene: height of the picture that shows it
constexpr double SamePart = 0.5;    // IoU of a boxed part and of what grows from its middle
constexpr double WholeBoxed = 0.9;  // IoU from which a box holds the whole thing
constexpr double NearClick = 0.02;  // of the picture's height: a click that near to something is on it

NamedPicture picture_of_click(const std::string& text) {
    auto picture = named_picture(text, 2, {0, 2, 3});
    if (!picture)
        throw Error(ErrorCode::InvalidArgument, "--at \"" + printable(text) + "\" is no place",
                    "give X,Y as shares of the picture, as in 0.5,0.4, and ,AZIMUTH,ELEVATION or "
                    ",AZIMUTH,ELEVATION,ZOOM behind it where needed");
    return *std::move(picture);
}

/// Shown pixel nearest to the click, within reach.
std::optional<std::pair<int, int>> shown_at(const Image& alpha, double x, double y) {
    const double reach = NearClick * alpha.height;
    std::optional<std::pair<int, int>> nearest;
    double least = reach * reach;
    const auto from = [&](double value) { return std::max(0, static_cast<int>(std::floor(value - reach))); };
    const auto to = [&](double value, int size) {
        return std::min(size - 1, static_cast<int>(std::floor(value + reach)));
    };
    for (int v = from(y); v <= to(y, alpha.height); ++v)
        for (int u = from(x); u <= to(x, alpha.width); ++u) {
            const double squared = std::pow(u + 0.5 - x, 2.0) + std::pow(v + 0.5 - y, 2.0);
            if (!(alpha.at(u, v, 0) > Shown) || squared > least) continue;
            least = squared, nearest = {u, v};
        }
    return nearest;
}

/// Takes the ground's rows below the thing off it.
localize::GrownThing without_ground(const GaussianSet& set, localize::GrownThing thing, const Vec3& up) {
    const Vec3 axis = std::abs(normalized(up)[0]) < 0.5 ? Vec3{1, 0, 0} : Vec3{0, 0, 1};
    for (const auto row : edit::ground_rows(set, thing.rows, up, normalized(cross(up, axis))))
        thing.rows[row] = 0;
    return thing;
}

/// Vessels and plants are told by their shapes.
bool means_part(const ClickRequest& request) {
    return request.part && !request.ground && request.nature != ThingNature::Vessel &&
           request.nature != ThingNature::Plant;
}

/// IoU of a box and of the bounds of a label's solid rows in the picture.
double filled(const GaussianSet& set, const std::vector<std::uint8_t>& label, const Camera& camera,
              const edit::BoxPrompt& box) {
    constexpr float solid = 0;              // logit
    constexpr double beside_bounds = 0.02;  // share of the rows at each side
    std::vector<double> x, y;
    for (std::size_t row = 0; row < set.size(); ++row) {
        if (label[row] == 0 || !(set.opacity_logit()[row] > solid)) continue;
        const auto* place = &set.position()[row * 3];
        const Vec3 at = camera.to_camera({place[0], place[1], place[2]});
        if (!(at[2] > 0)) continue;
        x.push_back(camera.fx * at[0] / at[2] + camera.cx);
        y.push_back(camera.fy * at[1] / at[2] + camera.cy);
    }
    if (x.empty()) return 0;
    const edit::BoxPrompt bounds{nearest_quantile(x, beside_bounds), nearest_quantile(y, beside_bounds),
                                 nearest_quantile(x, 1 - beside_bounds),
                                 nearest_quantile(y, 1 - beside_bounds)};
    const auto area = [](const edit::BoxPrompt& of) {
        return std::max(0.0, of.x1 - of.x0) * std::max(0.0, of.y1 - of.y0);
    };
    const double both = area({std::max(box.x0, bounds.x0), std::max(box.y0, bounds.y0),
                              std::min(box.x1, bounds.x1), std::min(box.y1, bounds.y1)});
    return both / std::max(area(box) + area(bounds) - both, 1e-9);
}

void require_going(const JobControl& control) {
    if (control.stop_requested()) throw Error(ErrorCode::Cancelled, "labelling the thing was stopped");
}

}  // namespace

ClickRequest click_request(const std::string& text, const Scene& scene, const std::string& up) {
    auto [place, parameters] = picture_of_click(text);
    if (place[0] < 0 || place[0] > 1 || place[1] < 0 || place[1] > 1)
        throw Error(ErrorCode::InvalidArgument,
                    "the place of --at \"" + printable(text) + "\" does not lie in the picture",
                    "X and Y are shares from 0 to 1");
    parameters.up = up;
    check_fields(parameters);
    ClickRequest request;
    request.camera = choose_camera(scene, {}, parameters);
    request.x = place[0] * parameters.width, request.y = place[1] * parameters.height;
    request.settings = raster_settings(parameters, scene.info);
    request.up = parse_up(up, scene.info);
    return request;
}

double azimuth_of_click(const std::string& text) { return picture_of_click(text).parameters.azimuth; }

localize::GrownThing thing_at(const GaussianSet& set, const ClickRequest& request,
                              const JobControl& control) {
    require_going(control);
    Painter painter;
    const auto& picture = painter.paint(set.spans(), request.camera, request.settings);
    const auto pixel = shown_at(picture.alpha, request.x, request.y);
    if (!pixel) return {std::vector<std::uint8_t>(set.size(), 0)};
    const auto [x, y] = *pixel;
    const auto depth = static_cast<double>(picture.depth.at(x, y, 0) / picture.alpha.at(x, y, 0));
    require_going(control);
    localize::GrowRequest grow;
    grow.seed = unprojected(request.camera, x + 0.5, y + 0.5, depth);
    grow.up = request.up;
    grow.extent = depth * request.camera.height / request.camera.fy;
    grow.ground = request.ground;
    grow.part = means_part(request);
    auto thing = localize::grow_thing(set.spans(), grow);
    if (request.ground) return thing;
    thing = without_ground(set, std::move(thing), request.up);
    thing.rows = edit::without_parts_beside(set, std::move(thing.rows), request.nature, request.up);
    return thing;
}

localize::GrownThing largest_thing(const GaussianSet& set, const Vec3& up, const JobControl& control) {
    require_going(control);
    const gse::Bounds bounds = framing_bounds(set);
    localize::GrowRequest grow;
    grow.up = up, grow.extent = Framed * bounds.radius();
    const auto seed = localize::largest_thing(set.spans(), bounds.centre(), bounds.radius(), up);
    if (!seed || !(grow.extent > 0)) return {std::vector<std::uint8_t>(set.size(), 0)};
    require_going(control);
    grow.seed = *seed;
    return without_ground(set, localize::grow_thing(set.spans(), grow), up);
}

std::string part_doubt(const localize::GrownThing& thing, const ClickRequest& request) {
    if (!means_part(request)) return {};
    if (thing.from_whole)
        return "a click does not tell where a part ends; look at the label, and put a box around the part or "
               "correct the label where it is wrong";
    if (thing.from_above || thing.from_thread) return {};
    return "the whole thing is labelled, for nothing parts what was clicked from the rest; put a box around "
           "the part, or correct the label";
}

BoxedPart boxed_part(const GaussianSet& set, const ClickRequest& middle, const edit::BoxPrompt& box,
                     std::vector<std::uint8_t> cut, const JobControl& control) {
    if (!means_part(middle)) return {std::move(cut), {}};
    auto grown = thing_at(set, middle, control);
    const double alike = evaluate::row_overlap(grown.rows, cut).iou;
    if (alike < SamePart) {
        const bool fits = filled(set, grown.rows, middle.camera, box) > filled(set, cut, middle.camera, box);
        return {fits ? std::move(grown.rows) : std::move(cut),
                "another part grows from the middle of the box than is cut out of it; look at the label, and "
                "correct it where it is wrong"};
    }
    if (grown.from_whole || grown.from_above || grown.from_thread || alike < WholeBoxed)
        return {std::move(cut), {}};
    return {std::move(cut),
            "the box holds all of what the part belongs to, and nothing parts the two; correct the label"};
}

std::string parted_text(const localize::GrownThing& thing) {
    std::vector<std::string_view> from;
    if (thing.from_support) from.emplace_back("what it stands on");
    if (thing.from_above) from.emplace_back("what stands on it");
    if (thing.from_thread) from.emplace_back("what a thin part joins it to");
    if (thing.from_whole) from.emplace_back("the rest of what it is a part of");
    return from.empty() ? std::string() : fmt::format("parted from {}", fmt::join(from, " and from "));
}

}  // namespace gse::pipeline
