// Cameras of files and folders, and beside scenes.
#include "engine/io/cameras/cameras.h"

#include <algorithm>
#include <array>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/log.h"
#include "engine/io/bytes/letter_case.h"
#include "engine/io/cameras/any_case.h"
#include "engine/io/cameras/camera_folders.h"
#include "engine/io/scene/scene_file.h"

namespace gse {
namespace {

namespace fs = std::filesystem;

CameraList load_colmap(const io::ColmapFiles& model) {
    const FileBytes cameras(model.cameras), images(model.images);
    return model.binary ? parse_colmap_binary(cameras.bytes(), images.bytes())
                        : parse_colmap_text(cameras.text(), images.text());
}

CameraList load_json(const fs::path& path, const fs::path& scene) {
    const FileBytes file(path);
    const std::size_t first = file.text().find_first_not_of(" \t\r\n\xef\xbb\xbf");
    if (first != std::string_view::npos && file.text()[first] == '[') return parse_cameras_json(file.text());
    std::error_code ignored;
    return parse_transforms_json(file.text(), path.parent_path(),
                                 fs::is_directory(scene, ignored) ? scene : scene.parent_path());
}

CameraList load_folder(const fs::path& folder, const fs::path& scene) {
    auto found = io::find_in_folder(folder);
    if (!found)
        throw Error(ErrorCode::NotFound, "the folder holds no cameras",
                    "it needs cameras.json, transforms.json or a COLMAP sparse model", folder);
    CameraList list = with_path(found->path, [&] {
        return found->colmap ? load_colmap(*found->colmap) : load_json(found->path, scene);
    });
    if (!found->note.empty()) list.notes.push_back(std::move(found->note));
    return list;
}

CameraList load_any(const fs::path& path, const fs::path& scene) {
    std::error_code ignored;
    if (fs::is_directory(path, ignored)) return load_folder(path, scene);
    if (!fs::exists(path, ignored))
        throw Error(ErrorCode::NotFound, "the camera file does not exist", "check the name", path);
    const std::string ending = io::lower_case(path.extension().string());
    if (ending == ".json") return load_json(path, scene);
    if (ending == ".bin" || ending == ".txt") {
        const fs::path folder = path.parent_path();
        if (const auto model = io::colmap_files(folder, ending)) return load_colmap(*model);
        throw Error(ErrorCode::NotFound, "a COLMAP model needs both cameras and images files", "", folder);
    }
    throw Error(ErrorCode::Unsupported, "this is no camera file that can be read",
                "known are cameras.json, transforms.json and COLMAP's cameras/images .bin or .txt", path);
}

/// Folders that may hold a scene's cameras: its own, and those above it as far as the layout of 3DGS training
/// goes.
std::vector<fs::path> folders_of(const fs::path& scene_path) {
    std::error_code ignored;
    const fs::path absolute = fs::absolute(scene_path, ignored).lexically_normal();
    fs::path folder = fs::is_directory(absolute, ignored) ? absolute : absolute.parent_path();
    if (!folder.has_filename()) folder = folder.parent_path();
    std::vector<fs::path> folders = {folder};
    const auto inside_training = [](const fs::path& place) {
        const std::string name = place.filename().string();
        return name.starts_with("iteration_") || name == "point_cloud";
    };
    while (inside_training(folder)) folders.push_back(folder = folder.parent_path());
    return folders;
}

}  // namespace

CameraList read_cameras(const fs::path& path, const fs::path& scene) {
    return with_path(path, [&] { return load_any(path, scene); });
}

std::vector<View> load_cameras(const fs::path& path, const fs::path& scene) {
    CameraList list = read_cameras(path, scene);
    for (const std::string& note : list.notes) log::warning("{}", note);
    return std::move(list.views);
}

bool only_cameras(const fs::path& path) {
    std::error_code ignored;
    const std::string name = io::lower_case(path.filename().string());
    const std::string ending = io::lower_case(path.extension().string());
    if (!fs::is_directory(path, ignored)) {
        if (ending == ".json") return name.ends_with("cameras.json") || name.starts_with("transforms");
        const std::string stem = io::lower_case(path.stem().string());
        const bool colmap = (ending == ".bin" || ending == ".txt") && (stem == "cameras" || stem == "images");
        return colmap && io::colmap_files(path.parent_path(), ending).has_value();
    }
    try {
        return io::find_in_folder(path) && !holds_scene(path);
    } catch (const Error&) {  // it cannot be read: whoever opens it says so
        return false;
    }
}

double visible_share(const std::vector<View>& views, std::span<const float> position) {
    constexpr std::size_t MostViews = 16, MostPoints = 2000;
    const std::size_t points = position.size() / 3;
    if (views.empty() || points == 0) return 0;
    const std::size_t view_step = (views.size() + MostViews - 1) / MostViews;
    const std::size_t point_step = (points + MostPoints - 1) / MostPoints;
    std::size_t inside = 0, tested = 0;
    for (std::size_t v = 0; v < views.size(); v += view_step) {
        const Camera& camera = views[v].camera;
        for (std::size_t i = 0; i < points; i += point_step, ++tested) {
            const Vec3 p = camera.to_camera({position[i * 3], position[i * 3 + 1], position[i * 3 + 2]});
            const double x = camera.fx * p.x / p.z + camera.cx, y = camera.fy * p.y / p.z + camera.cy;
            inside += p.z > 0 && x >= 0 && x < camera.width && y >= 0 && y < camera.height ? 1u : 0u;
        }
    }
    return static_cast<double>(inside) / static_cast<double>(tested);
}

std::optional<fs::path> find_cameras(const fs::path& scene_path) {
    const fs::path own = scene_path.stem().string() + ".cameras.json";
    if (auto found = io::AnyCase().find(scene_path.parent_path(), own)) return found;
    for (const fs::path& folder : folders_of(scene_path))
        if (io::find_in_folder(folder)) return folder;
    return std::nullopt;
}

bool names_transforms(const fs::path& path) {
    return io::lower_case(path.filename().string()).starts_with("transforms");
}

void save_cameras(const fs::path& path, const std::vector<View>& views) {
    if (io::lower_case(path.extension().string()) != ".json")
        throw Error(ErrorCode::InvalidArgument,
                    "the name does not end in a camera format that can be written",
                    "use cameras.json (3DGS) or transforms.json (nerfstudio)", path);
    if (views.empty()) throw Error(ErrorCode::InvalidArgument, "there are no cameras to write", "", path);
    if (names_transforms(path)) save_transforms_json(path, views);
    else save_cameras_json(path, views);
}

}  // namespace gse
