// Views, pictures and turntables of scenes, shared by several commands.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "engine/base/fields.h"
#include "engine/base/progress.h"
#include "engine/base/thread_pool.h"
#include "engine/raster/rasterizer.h"
#include "engine/scene/scene.h"

namespace gse::pipeline {

constexpr double Degree = std::numbers::pi / 180;

/// Settings of pictures of a scene.
struct RenderParameters {
    int width = 1280;
    int height = 720;
    double azimuth = 30;
    double elevation = 15;
    double zoom = 1;
    double fov = 50;
    std::string up = "auto";
    std::string background = "black";
    int view = -1;
    std::string cameras;
    bool antialiased = false;
    int sh_degree = 3;

    template <class Self, class F> static void visit_fields(Self& self, F&& f) {
        f("width", self.width, "Picture width in pixels.", Range{1, 16384});
        f("height", self.height, "Picture height in pixels.", Range{1, 16384});
        f("azimuth", self.azimuth, "Direction of the automatic camera in degrees, 0 = front.",
          Range{-3600, 3600});
        f("elevation", self.elevation, "Height of the automatic camera in degrees above the horizon.",
          Range{-89, 89});
        f("zoom", self.zoom,
          "Nearer (above 1) or farther (below 1) than from where the picture shows all of the scene.",
          Range{0.01, 100});
        f("fov", self.fov, "Horizontal field of view of the automatic camera in degrees.", Range{5, 150});
        f("up", self.up, "World up: auto, x, y, z, -x, -y or -z.");
        f("background", self.background, "black, white, grey or #rrggbb.");
        f("view", self.view, "Index of a camera from --cameras instead of the automatic one; -1 = automatic.",
          Range{-1, 1e9});
        f("cameras", self.cameras,
          "COLMAP folder, transforms.json or cameras.json; found beside the scene when empty.");
        f("antialiased", self.antialiased, "Opacity compensation for scenes trained with it.");
        f("sh_degree", self.sh_degree, "Highest spherical-harmonics degree shown.", Range{0, 3});
    }
};

/// Display values of "#rrggbb" or a name. Throws Error.
std::array<float, 3> parse_colour(const std::string& text);

/// Unit vector of "-y" and the like; "auto" gives the scene's own. Throws Error.
Vec3 parse_up(const std::string& text, const SceneInfo& info);

raster::Settings raster_settings(const RenderParameters& parameters, const SceneInfo& info);

/// Orbit fitted to the scene under these parameters.
OrbitParameters scene_orbit(const Scene& scene, const RenderParameters& parameters);
/// Orbit fitted to the scene, with a second way for tall scenes. A picture of that shape at a zoom of 1 would
/// cut off their top or bottom from some side. Then the orbit is around the middle and far enough to see all.
OrbitParameters whole_orbit(const Scene& scene, const RenderParameters& parameters);

/// Cameras named, or those found beside the scene, in the world of the scene's file; none when there are
/// none.
std::vector<View> scene_cameras(const std::filesystem::path& scene_path, const std::string& cameras);

/// Viewpoints to write elsewhere: those of a project, a camera file or folder, or those beside a scene. With
/// `orbit` > 0, so many around the scene of the project or file instead. They are views of the file's world.
/// Throws Error (NotFound) when there are none.
std::vector<View> viewpoints_of(const std::filesystem::path& path, int orbit = 0);

/// Camera of `render`: the one named, or one of whole_orbit().
Camera choose_camera(const Scene& scene, const std::filesystem::path& scene_path,
                     const RenderParameters& parameters);

/// Rasterizer with its threads.
class Painter {
public:
    /// `rasterizer`: auto, cpu or cuda (raster::make_rasterizer, which may throw Error).
    explicit Painter(unsigned threads = 0, const std::string& rasterizer = "auto");
    const raster::ForwardOutput& paint(const GaussianSpans& gaussians, const Camera& camera,
                                       const raster::Settings& settings);
    raster::Rasterizer& rasterizer() { return *rasterizer_; }
    ThreadPool& pool() { return pool_; }

private:
    ThreadPool pool_;
    std::unique_ptr<raster::Rasterizer> rasterizer_;
    raster::ForwardOutput output_;
};

/// A turn around the scene.
struct TurntableParameters {
    int frames = 120;
    double fps = 30;
    double degrees = 360;
    bool ease = false;

    template <class Self, class F> static void visit_fields(Self& self, F&& f) {
        f("frames", self.frames, "Number of frames.", Range{1, 100000});
        f("fps", self.fps, "Frames per second of the film.", Range{1, 240});
        f("degrees", self.degrees, "How far to turn.", Range{-36000, 36000});
        f("ease", self.ease, "Start and stop gently.");
    }
};

/// Azimuths in radians of all frames.
std::vector<double> turntable_azimuths(const TurntableParameters& parameters, double start_degrees);

/// Left and right picture beside each other with a thin line between.
Image side_by_side(const Image& left, const Image& right);

}  // namespace gse::pipeline
