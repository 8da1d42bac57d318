// Which cameras are a scene's own, and what they say of it.
#include "engine/pipeline/run/scene_loading.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "engine/base/error.h"
#include "engine/io/cameras/cameras.h"
#include "engine/io/project/load_scene.h"

namespace gse::pipeline {
namespace {

constexpr double LeastVisibleShare = 0.05;  // cameras that see less of the splats belong to another world

/// Up as the mean of the cameras' own (they stand upright more often than not); nothing when they disagree.
std::optional<Vec3> up_of_cameras(const std::vector<View>& views) {
    constexpr double least_agreement = 0.5;
    Vec3 sum;
    for (const auto& view : views) sum = sum - view.camera.rotation.row(1);
    const double share = length(sum) / static_cast<double>(std::max<std::size_t>(views.size(), 1));
    if (views.empty() || share < least_agreement) return std::nullopt;
    return normalized(sum);
}

}  // namespace

SceneCameras cameras_of_scene(const GaussianSet& set, const std::filesystem::path& scene_path,
                              const std::string& named) {
    SceneCameras cameras;
    if (named == "none") return cameras;
    try {
        CameraList list;
        if (!named.empty()) list = read_cameras(named, scene_path);
        else if (const auto found = find_cameras(scene_path)) list = read_cameras(*found, scene_path);
        cameras.views = std::move(list.views);
        for (const std::string& note : list.notes) cameras.notes.push_back(fmt::format("Cameras: {}.", note));
    } catch (const Error& error) {
        if (!named.empty()) throw;
        cameras.notes.push_back(std::string("The cameras beside the scene cannot be used: ") + error.what());
    }
    if (cameras.views.empty() || visible_share(cameras.views, set.position()) >= LeastVisibleShare)
        return cameras;
    cameras.views.clear();
    cameras.notes.push_back(named.empty()
                                ? "The cameras found beside the scene look elsewhere; they are left out."
                                : "The cameras look elsewhere than at this scene; they are left out.");
    return cameras;
}

std::string guess_up(SceneInfo& info, const std::vector<View>& views) {
    const auto up = info.up_known ? std::nullopt : up_of_cameras(views);
    if (!up) return {};
    info.up = *up;
    return fmt::format("The file does not say which way is up: guessed from {} cameras.", views.size());
}

LoadedScene load_scene_with_cameras(const std::filesystem::path& path, const std::string& cameras) {
    LoadedScene loaded{load_scene(path), {}, {}};
    SceneCameras found = cameras_of_scene(loaded.scene.gaussians, path, cameras);
    loaded.views = std::move(found.views);
    loaded.notes = std::move(found.notes);
    if (auto note = guess_up(loaded.scene.info, loaded.views); !note.empty())
        loaded.notes.push_back(std::move(note));
    return loaded;
}

}  // namespace gse::pipeline
