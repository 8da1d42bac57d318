// Recipe -> Views: the cameras from which a run looks at its scene.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "engine/pipeline/recipe/recipe.h"
#include "engine/pipeline/scene/scene_tools.h"
#include "engine/scene/scene.h"

namespace gse::pipeline {

/// Cameras of a scene. A value: nothing changes it, other views are other values.
struct Views {
    std::vector<View> views;         // squares of the request's image_size
    std::vector<std::string> words;  // "front view" and so on per view, or empty
    std::vector<double> azimuths;  // of the cameras from the front that the words go by, radians, positive to
                                   // the left; or empty
    OrbitParameters orbit;         // that they lie on; for given cameras, the one fitted to the scene
    Vec3 front;                    // where the scene's front looks, world, unit length
    std::optional<double>
        front_read;          // azimuth of the front on the orbit, radians, where the pictures said it
    bool automatic = false;  // on an orbit of the program's own choice: a search may move it
    std::string
        key;  // of cameras, words, background and size: views with the same key show the same of a scene
};

/// Cameras that the artist or the scene brings along.
struct GivenCameras {
    std::vector<View> cameras;  // fewer than LeastViewpoints = an orbit is fitted
    std::map<std::string, std::string>
        words;  // what they see, by the camera's name; empty = from the recipe's front
};

/// First views of a run: the given cameras, of many those farthest apart (METHOD.md, Viewpoints), or an orbit
/// fitted to the scene.
Views choose_views(const Scene& scene, const CheckedRecipe& recipe, const GivenCameras& given);

/// Views on another orbit, as many as the request asks for.
Views views_on(const OrbitParameters& orbit, const CheckedRecipe& recipe);

/// Views spread over these, as many and as large as the request asks for.
Views some_views(const Views& views, const CheckedRecipe& recipe);

/// "front view" and so on of every view. The front is the direction of `views.front`; `sided` as in
/// edit::view_words.
std::vector<std::string> words_around(const Views& views, bool sided);

/// Azimuths of every view from `views.front`, radians.
std::vector<double> azimuths_around(const Views& views);

/// Elevations of every camera above the orbit's centre, radians.
std::vector<double> elevations_above(const Views& views);

/// These views of a scene whose front is seen from an azimuth of their orbit (radians), with words for their
/// directions.
Views facing(Views views, double front, const CheckedRecipe& recipe);

/// Azimuth from which a camera sees the orbit's centre, in radians in the convention of orbit_camera.
double azimuth_of(const Camera& camera, const OrbitParameters& orbit);

/// The orbit at a share of its radius.
OrbitParameters nearer(OrbitParameters orbit, double share);

/// Farthest-point sample of the cameras, first camera first, in the order of the file.
std::vector<View> farthest_views(const std::vector<View>& views, std::size_t count);

/// --front in radians. Nothing if it is open or "none". Throws Error (InvalidArgument).
std::optional<double> parse_front(const std::string& text, const std::string& option = "--front");

/// Azimuth, as orbit_camera() counts it, of an orbit's camera with this direction. Whole degrees in [0,360).
double looked_from(const Camera& camera, const Vec3& up);

/// Azimuth of a camera that somebody turned, as a recipe has it. Empty for the direction in which a scene is
/// shown first, and from far above or below.
std::string turned_to(const Camera& camera, const Vec3& up);

/// Settings of the renders of a run's views.
raster::Settings render_settings(const Scene& scene, const edit::SearchSettings& search);

}  // namespace gse::pipeline
