// Cameras, pictures and turntables for the commands.
#include "engine/pipeline/scene/scene_tools.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

#include "engine/base/error.h"
#include "engine/io/cameras/cameras.h"
#include "engine/io/image/image_file.h"
#include "engine/io/project/load_scene.h"
#include "engine/io/project/project_file.h"
#include "engine/pipeline/scene/scene_loading.h"
#include "engine/scene/framing.h"
#include "engine/scene/origin/world_offset.h"

namespace gse::pipeline {

std::array<float, 3> parse_colour(const std::string& text) {
    if (text == "black") return {0, 0, 0};
    if (text == "white") return {1, 1, 1};
    if (text == "grey" || text == "gray") return {0.5f, 0.5f, 0.5f};
    unsigned value = 0;
    if (text.size() == 7 && text[0] == '#') {
        const auto [end, failure] = std::from_chars(text.data() + 1, text.data() + 7, value, 16);
        if (failure == std::errc() && end == text.data() + 7)
            return {static_cast<float>(value >> 16 & 255) / 255, static_cast<float>(value >> 8 & 255) / 255,
                    static_cast<float>(value & 255) / 255};
    }
    throw Error(ErrorCode::InvalidArgument, "\"" + text + "\" is not a colour",
                "use black, white, grey or #rrggbb");
}

Vec3 parse_up(const std::string& text, const SceneInfo& info) {
    if (text == "auto") return info.up;
    const double sign = text.starts_with('-') ? -1 : 1;
    const std::string axis = text.starts_with('-') || text.starts_with('+') ? text.substr(1) : text;
    if (axis == "x") return {sign, 0, 0};
    if (axis == "y") return {0, sign, 0};
    if (axis == "z") return {0, 0, sign};
    throw Error(ErrorCode::InvalidArgument, "\"" + text + "\" is not an up axis",
                "use auto, x, y, z, -x, -y or -z");
}

raster::Settings raster_settings(const RenderParameters& parameters, const SceneInfo& info) {
    raster::Settings settings;
    settings.background = parse_colour(parameters.background);
    settings.antialiased = parameters.antialiased || info.antialiased;
    settings.sh_degree = parameters.sh_degree;
    return settings;
}

namespace {

OrbitParameters fitted(const SceneStatistics& statistics, const SceneInfo& info,
                       const RenderParameters& parameters) {
    OrbitParameters orbit = fit_orbit(statistics, parse_up(parameters.up, info));
    // fit_orbit assumes its own field of view; keep what is framed when another one is asked for.
    const double fov = parameters.fov * Degree;
    orbit.radius *= std::tan(orbit.fov_x / 2) / std::tan(fov / 2) / parameters.zoom;
    orbit.fov_x = fov;
    orbit.elevation = parameters.elevation * Degree;
    return orbit;
}

/// Means of splats in the box: all, or in a large scene every so many.
std::vector<Vec3> some_points_in(const Bounds& bounds, const GaussianSet& set) {
    constexpr std::size_t Most = 100'000;
    const auto position = set.position();
    const std::size_t step = set.size() / Most + 1;
    std::vector<Vec3> points;
    for (std::size_t row = 0; row < set.size(); row += step) {
        const Vec3 at{position[row * 3], position[row * 3 + 1], position[row * 3 + 2]};
        if (at.x >= bounds.low.x && at.y >= bounds.low.y && at.z >= bounds.low.z && at.x <= bounds.high.x &&
            at.y <= bounds.high.y && at.z <= bounds.high.z)
            points.push_back(at);
    }
    return points;
}

}  // namespace

OrbitParameters scene_orbit(const Scene& scene, const RenderParameters& parameters) {
    return fitted(compute_statistics(scene.gaussians), scene.info, parameters);
}

OrbitParameters whole_orbit(const Scene& scene, const RenderParameters& parameters) {
    constexpr int Sides = 16;
    OrbitParameters orbit = scene_orbit(scene, parameters);
    const Bounds bounds = framing_bounds(scene.gaussians);
    const auto points = some_points_in(bounds, scene.gaussians);
    const auto fitting_from = [&](Vec3 centre) {
        double fitting = 0;
        for (int side = 0; side < Sides; ++side) {
            const auto camera =
                orbit_camera(orbit, 2 * std::numbers::pi * side / Sides, parameters.width, parameters.height);
            fitting = std::max(fitting, fitting_distance(points, centre, camera.rotation, orbit.fov_x,
                                                         parameters.width, parameters.height));
        }
        return fitting;
    };
    if (points.empty() || fitting_from(orbit.centre) <= orbit.radius * parameters.zoom) return orbit;
    orbit.centre = bounds.centre();
    orbit.radius = fitting_from(orbit.centre) / parameters.zoom;
    return orbit;
}

std::vector<View> scene_cameras(const std::filesystem::path& scene_path, const std::string& cameras) {
    if (!cameras.empty()) return load_cameras(cameras, scene_path);
    if (is_project_file(scene_path)) {
        const ProjectSummary project = read_project_summary(scene_path);
        return moved(project.views, project.info.offset);
    }
    const auto found = find_cameras(scene_path);
    return found ? load_cameras(*found, scene_path) : std::vector<View>{};
}

std::vector<View> viewpoints_of(const std::filesystem::path& path, int orbit) {
    const bool project = is_project_file(path);
    const RenderParameters usual;
    if (orbit > 0) {
        const Scene scene = load_standing_scene(path);
        return moved(orbit_views(scene_orbit(scene, usual), orbit, usual.width, usual.height),
                     scene.info.offset);
    }
    std::vector<View> views = only_cameras(path) ? load_cameras(path) : scene_cameras(path, "");
    if (views.empty())
        throw Error(ErrorCode::NotFound,
                    project ? "the project holds no viewpoints" : "there are no cameras beside the scene",
                    "--orbit 24 makes viewpoints around the scene", path);
    return views;
}

Camera choose_camera(const Scene& scene, const std::filesystem::path& scene_path,
                     const RenderParameters& parameters) {
    if (parameters.view >= 0 || !parameters.cameras.empty()) {
        const auto views =
            views_of_scene(scene_cameras(scene_path, parameters.cameras), scene.gaussians, scene.info.offset);
        const auto index = static_cast<std::size_t>(std::max(parameters.view, 0));
        if (index >= views.size())
            throw Error(ErrorCode::InvalidArgument,
                        fmt::format("view {} was asked for but there are {} cameras", index, views.size()),
                        "choose a smaller --view or name the cameras with --cameras", scene_path);
        return views[index].camera.resized(parameters.width, parameters.height);
    }
    return orbit_camera(whole_orbit(scene, parameters), parameters.azimuth * Degree, parameters.width,
                        parameters.height);
}

Painter::Painter(unsigned threads, const std::string& rasterizer)
    : pool_(threads), rasterizer_(raster::make_rasterizer(rasterizer, pool_)) {}

const raster::ForwardOutput& Painter::paint(const GaussianSpans& gaussians, const Camera& camera,
                                            const raster::Settings& settings) {
    rasterizer_->forward(gaussians, camera, settings, output_);
    return output_;
}

std::vector<double> turntable_azimuths(const TurntableParameters& parameters, double start_degrees) {
    std::vector<double> azimuths;
    for (int frame = 0; frame < parameters.frames; ++frame) {
        // A full turn must not show its first frame twice, so the last frame stops one step short.
        double share = static_cast<double>(frame) / parameters.frames;
        if (parameters.ease) share = share * share * (3 - 2 * share);
        azimuths.push_back((start_degrees + share * parameters.degrees) * Degree);
    }
    return azimuths;
}

Image side_by_side(const Image& left, const Image& right) {
    constexpr int line = 2;
    Image result(left.width + line + right.width, std::max(left.height, right.height), 3, 1.0f);
    const auto copy = [&](const Image& from, int offset) {
        for (int y = 0; y < from.height; ++y)
            std::copy_n(&from.data[static_cast<std::size_t>(y * from.width) * 3],
                        static_cast<std::size_t>(from.width) * 3,
                        &result.data[static_cast<std::size_t>(y * result.width + offset) * 3]);
    };
    copy(left, 0);
    copy(right, left.width + line);
    return result;
}

}  // namespace gse::pipeline
