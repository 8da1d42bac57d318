// Films of any row of cameras, and camera paths as JSON.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "engine/base/progress.h"
#include "engine/pipeline/scene/scene_tools.h"
#include "engine/scene/camera_key.h"

namespace gse::pipeline {

/// Scenes of a film. With `second` every frame shows `first` on the left half and `second` on the right.
struct FilmRequest {
    std::vector<Camera> cameras;  // one per frame, all of one size
    GaussianSet first;
    std::shared_ptr<const GaussianSet> second;
    raster::Settings settings;
    bool transparent = false;  // PNG frames only
    double fps = 30;
};

/// Writes .mp4 or .webm, or PNG frames into a folder when `output` has no extension. A stopped or failed film
/// leaves nothing. Throws Error (Cancelled, Unwritable, Unsupported).
void write_film(const std::filesystem::path& output, const FilmRequest& request, const JobControl& job);

/// Cameras of a turn around `orbit`.
std::vector<Camera> turn_cameras(const OrbitParameters& orbit, const TurntableParameters& turn,
                                 double start_degrees, int width, int height);

/// The picture with straight alpha [H,W,4]: colour without the background.
Image transparent_picture(const raster::ForwardOutput& output);

/// Camera path file that other editors read. JSON: {"version", "clip_duration", "keyframes": [{"time",
/// "position", "rotation", "focal_length_mm", "easing"}]}. Rotations are w,x,y,z, camera to world. Focal
/// lengths are those of a 36 mm wide sensor. Easings are the numbers of Easing.
void save_camera_path(const std::filesystem::path& path, const std::vector<CameraKey>& keys);
/// Reads a camera path. Throws Error (Malformed). Sizes are not part of the format: cameras come as width x
/// height.
std::vector<CameraKey> load_camera_path(const std::filesystem::path& path, int width, int height);

/// Most frames of a film of a path: nine hours at 30 frames a second.
constexpr int MostFilmFrames = 1'000'000;
/// Smooth walk through the keys (positions Catmull-Rom, rotations slerp), `fps` frames a second. Throws Error
/// (InvalidArgument) for more than MostFilmFrames.
std::vector<Camera> path_cameras(const std::vector<CameraKey>& keys, double fps, int width, int height);

}  // namespace gse::pipeline
