// Picture, box, mask, votes.
#include "engine/pipeline/select/cut_out.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/printable.h"
#include "engine/edit/placement/ground_rows.h"
#include "engine/edit/search/grabcut_segmenter.h"
#include "engine/edit/search/thing_parts.h"
#include "engine/localize/back_projection.h"
#include "engine/localize/clusters.h"
#include "engine/math/quantile.h"
#include "engine/pipeline/scene/scene_tools.h"
#include "engine/pipeline/select/box_cut.h"
#include "engine/pipeline/select/box_support.h"
#include "engine/pipeline/select/cut_out_sides.h"
#include "engine/pipeline/select/named_picture.h"
#include "engine/pipeline/select/point_out.h"
#include "engine/pipeline/select/scene_ground.h"

namespace gse::pipeline {
namespace {

constexpr int LongestSide = 512;      // pixels of the picture: GrabCut takes a third of a second for it
constexpr double Surroundings = 0.5;  // of the box's sides, that the picture shows around it
constexpr double MostEnlarged = 4;    // of the screen's pixels
constexpr float Opaque = 0.5f;        // alpha
// Share of the picture's longer side: Gaussians that far beside the outline may be the object's.
constexpr double Beside = 0.02;

/// The part of the view around the area.
struct Section {
    Camera camera;
    double left = 0, top = 0, scale = 1;  // of its pixels in the view's
    ScreenArea area;                      // in its pixels
    edit::BoxPrompt box;
};

edit::BoxPrompt box_of(const ScreenArea& area) {
    edit::BoxPrompt box{1e9, 1e9, -1e9, -1e9};
    for (const auto& point : area.polygon)
        box = {std::min<double>(box.x0, point[0]), std::min<double>(box.y0, point[1]),
               std::max<double>(box.x1, point[0]), std::max<double>(box.y1, point[1])};
    return box;
}

std::optional<Section> section_of(const CutOutRequest& request) {
    const auto& view = request.camera;
    auto box = box_of(request.area);
    const double across = (box.x1 - box.x0) * Surroundings, down = (box.y1 - box.y0) * Surroundings;
    Section section;
    section.left = std::floor(std::clamp(box.x0 - across, 0.0, 1.0 * view.width));
    section.top = std::floor(std::clamp(box.y0 - down, 0.0, 1.0 * view.height));
    const double width = std::ceil(std::clamp(box.x1 + across, 0.0, 1.0 * view.width)) - section.left;
    const double height = std::ceil(std::clamp(box.y1 + down, 0.0, 1.0 * view.height)) - section.top;
    if (request.area.polygon.empty() || box.x1 - box.x0 < 1 || box.y1 - box.y0 < 1 || width < 1 || height < 1)
        return std::nullopt;
    section.scale = std::min(MostEnlarged, LongestSide / std::max(width, height));
    section.camera = view;
    section.camera.width = std::max(1, static_cast<int>(std::lround(width * section.scale)));
    section.camera.height = std::max(1, static_cast<int>(std::lround(height * section.scale)));
    section.camera.fx *= section.scale, section.camera.fy *= section.scale;
    section.camera.cx = (view.cx - section.left) * section.scale,
    section.camera.cy = (view.cy - section.top) * section.scale;
    for (const auto& point : request.area.polygon)
        section.area.polygon.push_back({static_cast<float>((point[0] - section.left) * section.scale),
                                        static_cast<float>((point[1] - section.top) * section.scale)});
    box = box_of(section.area);
    section.box = {std::clamp(box.x0, 0.0, 1.0 * section.camera.width),
                   std::clamp(box.y0, 0.0, 1.0 * section.camera.height),
                   std::clamp(box.x1, 0.0, 1.0 * section.camera.width),
                   std::clamp(box.y1, 0.0, 1.0 * section.camera.height)};
    return section;
}

bool holds(const edit::BoxPrompt& box, int x, int y) {
    return x + 0.5 >= box.x0 && x + 0.5 < box.x1 && y + 0.5 >= box.y0 && y + 0.5 < box.y1;
}

Mask mask_of(const Section& section) {
    Mask mask(section.camera.width, section.camera.height);
    for (int y = 0; y < mask.height; ++y)
        for (int x = 0; x < mask.width; ++x) mask.at(x, y) = holds(section.box, x, y) ? 1 : 0;
    return mask;
}

/// Share of a pixel's colour that the surroundings of the box do not explain, in [0,1]. GrabCut begins with
/// it, because most of a box may show the surroundings.
Image unexplained(const Image& picture, const edit::BoxPrompt& box) {
    constexpr int levels = 16;  // of a channel
    const auto bin_of = [&](int x, int y) {
        std::size_t bin = 0;
        for (int c = 0; c < 3; ++c)
            bin = bin * levels + static_cast<std::size_t>(
                                     std::min(levels - 1, static_cast<int>(picture.at(x, y, c) * levels)));
        return bin;
    };
    std::vector<double> inside(levels * levels * levels), outside(inside.size());
    double in = 0, out = 0;
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) {
            const bool within = holds(box, x, y);
            ++(within ? inside : outside)[bin_of(x, y)];
            ++(within ? in : out);
        }
    Image hint(picture.width, picture.height, 1);
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) {
            if (!holds(box, x, y)) continue;
            const auto bin = bin_of(x, y);
            hint.at(x, y, 0) =
                out > 0 ? static_cast<float>(std::max(0.0, 1 - outside[bin] / out * in / inside[bin])) : 1.0f;
        }
    return hint;
}

/// The square of the distance to a colour that all but a few of the opaque pixels have; negative where there
/// are none.
double distance_from_most(const raster::ForwardOutput& picture, const std::array<float, 3>& colour,
                          std::vector<float>& distances) {
    constexpr double few = 0.05;
    distances.clear();
    for (std::size_t pixel = 0; pixel < picture.alpha.data.size(); ++pixel) {
        if (picture.alpha.data[pixel] < Opaque) continue;
        float sum = 0;
        for (std::size_t c = 0; c < 3; ++c)
            sum += std::pow(std::clamp(picture.colour.data[pixel * 3 + c], 0.0f, 1.0f) - colour[c], 2.0f);
        distances.push_back(sum);
    }
    return distances.empty() ? -1 : static_cast<double>(lower_quantile(distances, few));
}

/// Something dark before a dark nothing has no outline: where much of what is opaque looks like the
/// background, another colour, which is least like any of it. Elsewhere the background stays: black, it also
/// stands for shadows, which are not the thing.
std::array<float, 3> telling_background(const raster::ForwardOutput& picture,
                                        const std::array<float, 3>& background) {
    constexpr double alike = 0.16 * 0.16,
                     least_nothing = 0.005;  // in RGB; of the pixels: less has no outline anyway
    constexpr std::array<std::array<float, 3>, 9> colours{{{1, 1, 1},
                                                           {0.5f, 0.5f, 0.5f},
                                                           {0, 0, 0},
                                                           {0, 1, 0},
                                                           {1, 0, 1},
                                                           {0, 0, 1},
                                                           {0, 1, 1},
                                                           {1, 1, 0},
                                                           {1, 0, 0}}};
    std::vector<float> scratch;
    scratch.reserve(picture.alpha.data.size());
    const double distance = distance_from_most(picture, background, scratch);
    const double nothing = static_cast<double>(picture.alpha.data.size() - scratch.size());
    if (distance < 0 || distance > alike ||
        nothing < least_nothing * static_cast<double>(picture.alpha.data.size()))
        return background;
    std::array<float, 3> best = background;
    double farthest = distance;
    for (const auto& colour : colours)
        if (const double far = distance_from_most(picture, colour, scratch); far > farthest)
            farthest = far, best = colour;
    return best;
}

/// Tells whether a row's centre lies in the mask or just beside it.
bool centred(const GaussianSet& set, std::size_t row, const Camera& camera, const Mask& mask) {
    const auto positions = set.spans().position;
    const Vec3 at = camera.to_camera({positions[row * 3], positions[row * 3 + 1], positions[row * 3 + 2]});
    if (!(at[2] > 0)) return false;
    const double x = camera.fx * at[0] / at[2] + camera.cx, y = camera.fy * at[1] / at[2] + camera.cy;
    const double reach = Beside * std::max(mask.width, mask.height);
    if (!(x > -reach && x < mask.width + reach && y > -reach && y < mask.height + reach)) return false;
    const auto from = [&](double value) { return std::max(0, static_cast<int>(std::floor(value - reach))); };
    const auto to = [&](double value, int size) {
        return std::min(size - 1, static_cast<int>(std::floor(value + reach)));
    };
    for (int v = from(y); v <= to(y, mask.height); ++v)
        for (int u = from(x); u <= to(x, mask.width); ++u)
            if (mask.at(u, v) != 0) return true;
    return false;
}

/// Rows in the mask that are seen mostly inside it, the most visible first, until they make up nearly all of
/// it. Rows behind them are seen through them a little, and the far ends of neighbours show in it.
std::vector<std::uint8_t> seen_rows(const GaussianSet& set, const Camera& camera, const Mask& mask,
                                    const raster::Settings& settings, Painter& painter) {
    constexpr double mostly = 0.5, nearly_all = 0.98;
    localize::MaskedView view{camera, Image(mask.width, mask.height, 1)};
    std::copy(mask.data.begin(), mask.data.end(), view.mask.data.begin());
    const auto votes = localize::back_project(set.spans(), {&view, 1}, settings, painter.rasterizer());
    std::vector<std::uint32_t> inside;
    double all = 0;
    for (std::size_t row = 0; row < set.size(); ++row) {
        if (!(static_cast<double>(votes.probability[row]) > mostly) || !(votes.coverage[row] > 0) ||
            !centred(set, row, camera, mask))
            continue;
        inside.push_back(static_cast<std::uint32_t>(row));
        all += votes.coverage[row];
    }
    std::sort(inside.begin(), inside.end(), [&](std::uint32_t a, std::uint32_t b) {
        return votes.coverage[a] != votes.coverage[b] ? votes.coverage[a] > votes.coverage[b] : a < b;
    });
    std::vector<std::uint8_t> rows(set.size(), 0);
    double sum = 0;
    for (std::size_t i = 0; i < inside.size() && sum < nearly_all * all; ++i) {
        rows[inside[i]] = 1;
        sum += votes.coverage[inside[i]];
    }
    return rows;
}

/// Click on the middle of the box.
ClickRequest middle_of(const CutOutRequest& request) {
    const auto box = box_of(request.area);
    return {request.camera, (box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2, request.settings,
            request.up,     request.ground,        request.nature,        request.part};
}

constexpr const char* BoxHint =
    "give LEFT,TOP,RIGHT,BOTTOM as shares of the picture, as in 0.3,0.2,0.7,0.9, and ,AZIMUTH,ELEVATION,ZOOM "
    "behind it where needed";

NamedPicture picture_of_box(const std::string& text) {
    const auto picture = named_picture(text, 4, {0, 3});
    if (!picture)
        throw Error(ErrorCode::InvalidArgument, "--cut-out \"" + printable(text) + "\" is no box", BoxHint);
    return *picture;
}

}  // namespace

CutOutRequest cut_out_request(const std::string& text, const Scene& scene, const std::string& up) {
    auto [place, parameters] = picture_of_box(text);
    const double left = place[0], top = place[1], right = place[2], bottom = place[3];
    if (left < 0 || top < 0 || right > 1 || bottom > 1 || left >= right || top >= bottom)
        throw Error(ErrorCode::InvalidArgument,
                    "the box of --cut-out \"" + printable(text) + "\" does not lie in the picture",
                    "its sides are shares from 0 to 1: left before right, top before bottom");
    parameters.up = up;
    check_fields(parameters);
    CutOutRequest request;
    request.camera = choose_camera(scene, {}, parameters);
    request.settings = raster_settings(parameters, scene.info);
    request.up = parse_up(up, scene.info);
    const auto width = static_cast<double>(parameters.width), height = static_cast<double>(parameters.height);
    for (const auto& [x, y] :
         {std::pair{left, top}, std::pair{right, top}, std::pair{right, bottom}, std::pair{left, bottom}})
        request.area.polygon.push_back({static_cast<float>(x * width), static_cast<float>(y * height)});
    return request;
}

double azimuth_of_box(const std::string& text) { return picture_of_box(text).parameters.azimuth; }

CutOutThing cut_out(const GaussianSet& set, const CutOutRequest& request, edit::Segmenter* segmenter,
                    const JobControl& control) {
    const auto section = section_of(request);
    if (!section) return {std::vector<std::uint8_t>(set.size(), 0), {}};
    Painter painter;
    auto settings = request.settings;
    // The painter's own: the last picture.
    const raster::ForwardOutput& painted = painter.paint(set.spans(), section->camera, settings);
    settings.background = telling_background(painted, settings.background);
    if (settings.background != request.settings.background)
        painter.paint(set.spans(), section->camera, settings);
    Image picture = painted.colour;
    for (auto& value : picture.data) value = std::clamp(value, 0.0f, 1.0f);
    std::unique_ptr<edit::Segmenter> own;
    if (segmenter == nullptr) {  // what is outside of a box that was drawn around a thing is not the thing
        own = edit::grabcut_available() ? edit::make_grabcut_segmenter({.box_margin = 0})
                                        : edit::make_default_segmenter();
        segmenter = own.get();
    }
    SeenThing seen{section->camera,
                   segmenter->segment(picture, {}, section->box, unexplained(picture, section->box)),
                   {},
                   {},
                   request.up};
    const Mask whole = mask_of(*section);
    for (std::size_t i = 0; i < seen.mask.data.size(); ++i) seen.mask.data[i] &= whole.data[i];
    if (seen.mask.count() == 0) seen.mask = whole;
    const PictureDepth picture_depth{painted.alpha, painted.depth};  // others are painted meanwhile
    const Mask level = level_with(seen.mask, picture_depth, section->camera.fx);
    auto sides = sides_text(cut_sides(seen.mask, level, section->box));
    close_holes(seen.mask, level);
    seen.front = seen_rows(set, section->camera, seen.mask, settings, painter);
    PickOptions options;
    options.pool = &painter.pool();
    const Mask wide = localize::dilate(seen.mask, Beside * std::max(seen.mask.width, seen.mask.height));
    options.mask = &wide;
    seen.cone = rows_in_area(set, section->camera, section->area, options);
    auto bits = follow_around(set, seen, settings, *segmenter, painter, control);
    if (request.ground)
        return {whole_ground(set, edit::lowest_layer(set, bits, request.up), request.up, control), {}};
    const double extent = request.camera.height / request.camera.fy;
    bits = without_support(set, std::move(bits), {seen.camera, seen.mask, extent, request.up, picture_depth},
                           settings, painter);
    auto parted = edit::without_parts_beside(set, bits, request.nature, request.up);
    if (parted != bits) sides.clear();  // its shape told it from what goes on beyond the box
    auto part = boxed_part(set, middle_of(request), box_of(request.area), std::move(parted), control);
    return {std::move(part.rows), std::move(sides), std::move(part.doubt)};
}

std::string cut_text(const CutOutThing& thing) {
    if (thing.cut_sides.empty()) return thing.part_doubt;
    return "the thing goes on beyond the box (" + thing.cut_sides +
           "), and the label may hold a part of something else; draw the box around the whole thing, or "
           "correct the label";
}

}  // namespace gse::pipeline
