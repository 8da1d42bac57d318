// Frames, camera paths and their interpolation.
#include "engine/pipeline/report/film.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/json.h"
#include "engine/base/staged_folder.h"
#include "engine/io/image/image_file.h"
#include "engine/io/image/video.h"

namespace gse::pipeline {
namespace {

constexpr double SensorMm = 36;

Camera camera_at(const Vec3& eye, const Quat& to_world, double focal_px, int width, int height) {
    Camera camera;
    camera.width = width;
    camera.height = height;
    camera.fx = camera.fy = focal_px;
    camera.cx = width / 2.0;
    camera.cy = height / 2.0;
    camera.rotation = rotation_matrix(to_world).transposed();
    camera.translation = -(camera.rotation * eye);
    return camera;
}

Vec3 catmull_rom(const std::array<Vec3, 4>& p, double t) {
    return (p[1] * 2.0 + (p[2] - p[0]) * t + (p[0] * 2.0 - p[1] * 5.0 + p[2] * 4.0 - p[3]) * (t * t) +
            (p[1] * 3.0 - p[0] - p[2] * 3.0 + p[3]) * (t * t * t)) *
           0.5;
}

/// How far between two keys, for a share of their time.
double eased(Easing easing, double t) {
    switch (easing) {
        case Easing::In: return t * t;
        case Easing::Out: return t * (2 - t);
        case Easing::InOut: return t < 0.5 ? 2 * t * t : 1 - 2 * (1 - t) * (1 - t);
        case Easing::Linear: break;
    }
    return t;
}

[[noreturn]] void throw_bad_path(const std::string& what, const std::filesystem::path& path) {
    throw Error(ErrorCode::Malformed, what, "export the path again", path);
}

/// A number of Easing, or the word that earlier versions wrote.
Easing read_easing(const nlohmann::json& key, const std::filesystem::path& path) {
    const auto found = key.find("easing");
    if (found == key.end() || found->is_null() || *found == "linear") return Easing::Linear;
    for (const auto easing : {Easing::Linear, Easing::In, Easing::Out, Easing::InOut})
        if (*found == static_cast<int>(easing)) return easing;
    throw_bad_path(fmt::format("a camera of this path has the easing {}; 0 to 3 are known", found->dump()),
                   path);
}

/// One entry of a path file; every number of it finite.
CameraKey read_key(const nlohmann::json& entry, int width, int height, const std::filesystem::path& path) {
    const auto& p = entry.at("position");
    const auto& q = entry.at("rotation");
    const Vec3 eye{p.at(0).get<double>(), p.at(1).get<double>(), p.at(2).get<double>()};
    const Quat rotation{q.at(0).get<double>(), q.at(1).get<double>(), q.at(2).get<double>(),
                        q.at(3).get<double>()};
    const double focal = entry.at("focal_length_mm").get<double>() / SensorMm * width;
    const double time = entry.at("time").get<double>(), size = dot(rotation, rotation);
    if (!(focal > 0) || !(size > 1e-12) || !std::isfinite(focal + size + length(eye) + time))
        throw_bad_path("a camera of this path is not valid", path);
    return {time, camera_at(eye, rotation, focal, width, height), read_easing(entry, path)};
}

constexpr const char* FramesReport = "frames.json";

std::string frame_name(int frame) { return fmt::format("frame_{:04}.png", frame); }

FolderContents frame_contents(int frames) {
    FolderContents contents{FramesReport, {FramesReport}};
    for (int frame = 0; frame < frames; ++frame) contents.names.push_back(frame_name(frame));
    return contents;
}

}  // namespace

Image transparent_picture(const raster::ForwardOutput& output) {
    Image picture(output.colour.width, output.colour.height, 4);
    for (std::size_t i = 0; i < picture.pixel_count(); ++i) {
        const float alpha = std::clamp(output.alpha.data[i], 0.0f, 1.0f);
        for (std::size_t c = 0; c < 3; ++c)  // the render is over black: colour times alpha
            picture.data[i * 4 + c] =
                alpha > 0 ? std::clamp(output.colour.data[i * 3 + c] / alpha, 0.0f, 1.0f) : 0.0f;
        picture.data[i * 4 + 3] = alpha;
    }
    return picture;
}

void write_film(const std::filesystem::path& output, const FilmRequest& request, const JobControl& job) {
    if (request.cameras.empty())
        throw Error(ErrorCode::InvalidArgument, "the film has no frames", "give it some", output);
    const bool film = output.has_extension();
    if (film && output.extension() != ".mp4" && output.extension() != ".webm")
        throw Error(ErrorCode::InvalidArgument, "films are written as .mp4, .webm, or as PNGs into a folder",
                    "choose one of these names", output);
    raster::Settings settings = request.settings;
    const bool transparent = request.transparent && !film && !request.second;
    if (transparent) settings.background = {0, 0, 0};
    Painter painter;
    std::unique_ptr<VideoWriter> writer;
    std::unique_ptr<StagedFolder> folder;
    const int total = static_cast<int>(request.cameras.size());
    if (!film) folder = std::make_unique<StagedFolder>(output, frame_contents(total));
    for (int frame = 0; frame < total; ++frame) {
        if (job.stop_requested()) throw Error(ErrorCode::Cancelled, "the film was stopped", "", output);
        const Camera& camera = request.cameras[static_cast<std::size_t>(frame)];
        const auto& painted = painter.paint(request.first.spans(), camera, settings);
        Image picture = transparent ? transparent_picture(painted) : painted.colour;
        if (request.second)
            picture = side_by_side(picture, painter.paint(request.second->spans(), camera, settings).colour);
        if (film) {
            if (!writer)
                writer = std::make_unique<VideoWriter>(output, picture.width, picture.height, request.fps);
            writer->add(picture);
        } else {
            write_png(folder->path() / frame_name(frame), picture);
        }
        job.report("frames", frame + 1, total);
    }
    if (writer) writer->finish();
    if (!folder) return;
    const nlohmann::ordered_json report{
        {"fps", request.fps}, {"frames", total}, {"files", folder->listing()}};
    write_file(folder->path() / FramesReport, report.dump(1) + "\n");
    folder->commit();
}

std::vector<Camera> turn_cameras(const OrbitParameters& orbit, const TurntableParameters& turn,
                                 double start_degrees, int width, int height) {
    std::vector<Camera> cameras;
    for (const double azimuth : turntable_azimuths(turn, start_degrees))
        cameras.push_back(orbit_camera(orbit, azimuth, width, height));
    return cameras;
}

void save_camera_path(const std::filesystem::path& path, const std::vector<CameraKey>& keys) {
    nlohmann::ordered_json json;
    json["version"] = 1;
    json["clip_duration"] = keys.empty() ? 0.0 : keys.back().time;
    json["keyframes"] = nlohmann::ordered_json::array();
    for (const auto& key : keys) {
        const Vec3 eye = key.camera.centre();
        const Quat q = quaternion(key.camera.rotation.transposed());
        json["keyframes"].push_back({{"time", key.time},
                                     {"position", {eye.x, eye.y, eye.z}},
                                     {"rotation", {q.w, q.x, q.y, q.z}},
                                     {"focal_length_mm", key.camera.fx / key.camera.width * SensorMm},
                                     {"easing", static_cast<int>(key.easing)}});
    }
    write_file(path, json.dump(1) + "\n");
}

std::vector<CameraKey> load_camera_path(const std::filesystem::path& path, int width, int height) {
    std::vector<CameraKey> keys;
    try {
        const auto json = parse_json(read_file(path), "the camera path");
        for (const auto& entry : json.at("keyframes")) keys.push_back(read_key(entry, width, height, path));
    } catch (const nlohmann::json::exception&) {
        throw Error(ErrorCode::Malformed, "this is not a camera path",
                    "use a file that Export > Camera path wrote", path);
    }
    const auto not_later = [](const auto& a, const auto& b) { return a.time >= b.time; };
    if (std::adjacent_find(keys.begin(), keys.end(), not_later) != keys.end())
        throw_bad_path("the cameras of this path are not in the order of time", path);
    return keys;
}

std::vector<Camera> path_cameras(const std::vector<CameraKey>& keys, double fps, int width, int height) {
    std::vector<Camera> cameras;
    if (keys.empty() || fps <= 0) return cameras;
    const double total = std::round((keys.back().time - keys.front().time) * fps) + 1;
    if (!(total <= MostFilmFrames))
        throw Error(
            ErrorCode::InvalidArgument,
            fmt::format(
                "the camera path takes {:.0f} frames at {} frames a second, and a film has {} at most", total,
                fps, MostFilmFrames),
            "bring its cameras closer together in time, or take fewer frames a second");
    const auto frames = static_cast<int>(total);
    std::size_t segment = 0;
    for (int frame = 0; frame < frames; ++frame) {
        const double time = keys.front().time + frame / fps;
        while (segment + 2 < keys.size() && time > keys[segment + 1].time) ++segment;
        const auto& a = keys[segment];
        const auto& b = keys[std::min(segment + 1, keys.size() - 1)];
        const double span = b.time - a.time;
        const double t = eased(a.easing, span > 0 ? std::clamp((time - a.time) / span, 0.0, 1.0) : 0.0);
        const auto& before = keys[segment > 0 ? segment - 1 : segment];
        const auto& after = keys[std::min(segment + 2, keys.size() - 1)];
        const Vec3 eye = catmull_rom(
            {before.camera.centre(), a.camera.centre(), b.camera.centre(), after.camera.centre()}, t);
        const Quat rotation = glm::slerp(quaternion(a.camera.rotation.transposed()),
                                         quaternion(b.camera.rotation.transposed()), t);
        const double focal = (1 - t) * a.camera.fx / a.camera.width + t * b.camera.fx / b.camera.width;
        cameras.push_back(camera_at(eye, rotation, focal * width, width, height));
    }
    return cameras;
}

}  // namespace gse::pipeline
