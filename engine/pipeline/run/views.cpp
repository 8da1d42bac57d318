// Cameras of a run and the words for their directions.
#include "engine/pipeline/run/views.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "engine/base/content_hash.h"
#include "engine/base/error.h"
#include "engine/edit/search/front_reading.h"
#include "engine/math/framing.h"
#include "engine/scene/viewpoints.h"

namespace gse::pipeline {
namespace {

/// The camera, cropped to a centred square of `side` pixels.
Camera square_camera(const Camera& camera, int side) {
    const double shorter = std::min(camera.width, camera.height);
    const double scale = side / shorter;
    Camera result = camera;
    result.width = result.height = side;
    result.fx *= scale;
    result.fy *= scale;
    result.cx = (camera.cx - 0.5 * (camera.width - shorter)) * scale;
    result.cy = (camera.cy - 0.5 * (camera.height - shorter)) * scale;
    return result;
}

/// Level unit direction from the orbit's centre to its camera at `azimuth`.
Vec3 direction_at(const OrbitParameters& orbit, double azimuth) {
    OrbitParameters level = orbit;
    level.elevation = 0;
    return normalized(orbit_camera(level, azimuth, 8, 8).centre() - orbit.centre);
}

/// Key of all inputs of the views' renders beside the scene.
std::string key_of(const Views& views, const CheckedRecipe& recipe) {
    ContentHash hash;
    for (const auto& view : views.views) {
        const Camera& camera = view.camera;
        const Vec3 centre = camera.centre();
        hash.numbers(camera.fx, camera.fy, camera.cx, camera.cy, centre.x, centre.y, centre.z, camera.width,
                     camera.height);
        for (int i = 0; i < 9; ++i) hash.numbers(camera.rotation(i / 3, i % 3));
    }
    hash.texts(views.words);
    hash.text(recipe.request.background);
    return hash.key().hex();
}

/// Fills in all values that follow from cameras and orbit.
Views finished(Views views, const CheckedRecipe& recipe, const std::map<std::string, std::string>& words) {
    const auto front = parse_front(recipe.job.front);
    views.front = direction_at(views.orbit, front.value_or(0));
    for (const auto& view : views.views) {
        if (!words.empty()) views.words.push_back(words.at(view.name));
        else if (front) {
            views.azimuths.push_back(azimuth_of(view.camera, views.orbit) - *front);
            views.words.push_back(edit::view_words(views.azimuths.back(), recipe.request.sided_view_words));
        }
    }
    views.key = key_of(views, recipe);
    return views;
}

}  // namespace

double azimuth_of(const Camera& camera, const OrbitParameters& orbit) {
    const Vec3 front = direction_at(orbit, 0);
    const Vec3 side = cross(normalized(orbit.up), front);
    const Vec3 direction = camera.centre() - orbit.centre;
    return std::atan2(dot(direction, side), dot(direction, front));
}

double looked_from(const Camera& camera, const Vec3& up) {
    OrbitParameters orbit;
    orbit.up = up;
    orbit.centre = camera.centre() + camera.forward();
    const double degrees = std::round(azimuth_of(camera, orbit) / Degree);
    return std::fmod(degrees + 360, 360);
}

std::string turned_to(const Camera& camera, const Vec3& up) {
    constexpr double WholeDegrees = 1;  // what rounding may be off by
    constexpr double FromAbove = 0.9;   // sine of 64 degrees: from there no side is looked at
    if (std::abs(dot(camera.forward(), normalized(up))) > FromAbove) return {};
    const double degrees = looked_from(camera, up);
    return std::abs(std::remainder(degrees - HomeAzimuth / Degree, 360)) <= WholeDegrees
               ? std::string()
               : fmt::format("{:.0f}", degrees);
}

Views facing(Views views, double front, const CheckedRecipe& recipe) {
    views.front = direction_at(views.orbit, front);
    views.front_read = front;
    views.azimuths = azimuths_around(views);
    views.words = words_around(views, recipe.request.sided_view_words);
    views.key = key_of(views, recipe);
    return views;
}

std::vector<View> farthest_views(const std::vector<View>& views, std::size_t count) {
    if (views.size() <= count) return views;
    std::vector<double> distance(views.size(), std::numeric_limits<double>::infinity());
    std::vector<std::size_t> chosen{0};
    // From one place, as on a tripod, they differ by where they look.
    const bool turns = std::all_of(views.begin(), views.end(), [&](const View& view) {
        return view.camera.centre() == views.front().camera.centre();
    });
    const auto place_of = [turns](const View& view) {
        return turns ? view.camera.forward() : view.camera.centre();
    };
    while (chosen.size() < count) {
        const Vec3 last = place_of(views[chosen.back()]);
        for (std::size_t i = 0; i < views.size(); ++i)
            distance[i] = std::min(distance[i], length(place_of(views[i]) - last));
        distance[chosen.back()] = -1;  // not once more
        chosen.push_back(
            static_cast<std::size_t>(std::max_element(distance.begin(), distance.end()) - distance.begin()));
    }
    std::sort(chosen.begin(), chosen.end());
    std::vector<View> result;
    for (const auto index : chosen) result.push_back(views[index]);
    return result;
}

std::vector<double> azimuths_around(const Views& views) {
    const Vec3 side = cross(normalized(views.orbit.up), views.front);
    std::vector<double> azimuths;
    for (const auto& view : views.views) {
        const Vec3 direction = view.camera.centre() - views.orbit.centre;
        azimuths.push_back(std::atan2(dot(direction, side), dot(direction, views.front)));
    }
    return azimuths;
}

std::vector<double> elevations_above(const Views& views) {
    std::vector<double> elevations;
    for (const auto& view : views.views)
        elevations.push_back(std::asin(
            dot(normalized(view.camera.centre() - views.orbit.centre), normalized(views.orbit.up))));
    return elevations;
}

std::vector<std::string> words_around(const Views& views, bool sided) {
    std::vector<std::string> words;
    for (const double azimuth : azimuths_around(views)) words.push_back(edit::view_words(azimuth, sided));
    return words;
}

std::optional<double> parse_front(const std::string& text, const std::string& option) {
    if (text.empty() || text == "none") return std::nullopt;
    std::size_t used = 0;
    double value = 0;
    try {
        value = std::stod(text, &used);
    } catch (const std::exception&) { used = 0; }
    if (used == 0 || used != text.size() || !std::isfinite(value))
        throw Error(ErrorCode::InvalidArgument, "\"" + text + "\" is not an angle",
                    "give " + option + " in degrees, for example 0, or none");
    return value * Degree;
}

OrbitParameters nearer(OrbitParameters orbit, double share) {
    orbit.radius *= share;
    return orbit;
}

raster::Settings render_settings(const Scene& scene, const edit::SearchSettings& search) {
    raster::Settings settings;
    settings.background = parse_colour(search.background);
    settings.antialiased = scene.info.antialiased;
    return settings;
}

Views choose_views(const Scene& scene, const CheckedRecipe& recipe, const GivenCameras& given) {
    RenderParameters render;
    render.up = recipe.job.up;
    render.elevation = recipe.request.elevation;
    const OrbitParameters orbit = scene_orbit(scene, render);
    if (given.cameras.size() < LeastViewpoints) return views_on(orbit, recipe);  // bookmarks, not a capture
    Views views;
    views.orbit = orbit;
    views.views = farthest_views(given.cameras, static_cast<std::size_t>(recipe.request.views));
    for (auto& view : views.views) view.camera = square_camera(view.camera, recipe.request.image_size);
    return finished(std::move(views), recipe, given.words);
}

Views some_views(const Views& views, const CheckedRecipe& recipe) {
    const int side = recipe.request.image_size;
    const auto count = std::min(views.views.size(), static_cast<std::size_t>(recipe.request.views));
    std::map<std::string, std::string> words;
    for (std::size_t v = 0; v < views.words.size(); ++v) words[views.views[v].name] = views.words[v];
    Views some;
    some.orbit = views.orbit;
    for (std::size_t i = 0; i < count; ++i) {
        some.views.push_back(views.views[i * views.views.size() / count]);
        some.views.back().camera = some.views.back().camera.resized(side, side);
    }
    return finished(std::move(some), recipe, words);
}

Views views_on(const OrbitParameters& orbit, const CheckedRecipe& recipe) {
    const int side = recipe.request.image_size;
    Views views;
    views.orbit = orbit;
    views.automatic = true;
    views.views = orbit_views(orbit, recipe.request.views, side, side);
    return finished(std::move(views), recipe, {});
}

}  // namespace gse::pipeline
