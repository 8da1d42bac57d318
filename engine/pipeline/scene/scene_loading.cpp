// Which cameras are a scene's own, and what they say of it.
#include "engine/pipeline/scene/scene_loading.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/io/cameras/cameras.h"
#include "engine/io/project/load_scene.h"
#include "engine/io/project/project_file.h"
#include "engine/pipeline/inventory/no_scene.h"
#include "engine/scene/layout/surroundings.h"
#include "engine/scene/origin/world_offset.h"

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

SceneCameras cameras_of_scene(const PlacedScene& scene, const std::string& named) {
    SceneCameras cameras;
    if (named == "none") return cameras;
    try {
        CameraList list;
        if (!named.empty()) list = read_cameras(named, scene.path);
        else if (const auto found = find_cameras(scene.path)) list = read_cameras(*found, scene.path);
        cameras.views = std::move(list.views);
        for (const std::string& note : list.notes) cameras.notes.push_back(fmt::format("Cameras: {}.", note));
    } catch (const Error& error) {
        if (!named.empty()) throw;
        cameras.notes.push_back(std::string("The cameras beside the scene cannot be used: ") + error.what());
    }
    cameras.views = views_of_scene(std::move(cameras.views), scene.set, scene.offset);
    if (cameras.views.empty() || visible_share(cameras.views, scene.set.position()) >= LeastVisibleShare)
        return cameras;
    cameras.views.clear();
    cameras.notes.push_back(named.empty()
                                ? "The cameras found beside the scene look elsewhere; they are left out."
                                : "The cameras look elsewhere than at this scene; they are left out.");
    return cameras;
}

std::vector<View> views_of_scene(std::vector<View> views, const GaussianSet& set, const Vec3& offset) {
    if (views.empty() || !has_offset(offset)) return views;
    std::vector<View> nearer = moved(views, -offset);
    const bool gains = visible_share(nearer, set.position()) >= visible_share(views, set.position());
    return gains ? nearer : views;
}

std::string guess_up(SceneInfo& info, const std::vector<View>& views) {
    const auto up = info.up_known ? std::nullopt : up_of_cameras(views);
    if (!up) return {};
    info.up = *up;
    info.up_unsure = false;
    return fmt::format("The file does not say which way is up: guessed from {} cameras.", views.size());
}

std::optional<UpGuess> guess_up(SceneInfo& info, const GaussianSet& set) {
    if (info.up_known) return std::nullopt;
    const UpGuess guess = guess_up_axis(set, surrounding_rows(set));
    info.up_unsure = !guess.sure();
    if (guess.sure()) info.up = guess.up();
    return guess;
}

std::string up_note(const SceneInfo& info, const std::optional<UpGuess>& guess) {
    if (!guess || (guess->sure() && guess->up() == SceneInfo().up)) return {};
    if (guess->sure())
        return fmt::format("The file does not say which way is up: {}, as its splats stand.",
                           direction_name(guess->best));
    std::size_t taken = 0;
    while (taken + 1 < Directions && direction(taken) != info.up) ++taken;
    return fmt::format("Which way is up is not sure: {} is taken. If that is wrong, choose another ({}).",
                       direction_name(taken), "--up, or the panel Scene");
}

std::string surroundings_note(const SceneStatistics& statistics) {
    const std::size_t haze = statistics.haze_rows, sky = statistics.sky_rows;
    if (haze + sky == 0) return {};
    return fmt::format("{} splats far around the scene are {}: pictures frame the scene without them.",
                       haze + sky,
                       sky == 0    ? "haze"
                       : haze == 0 ? "sky"
                                   : "haze and sky");
}

namespace {

/// True for a name that trainers and exporters give to any scene.
bool names_nothing(const std::string& name) {
    constexpr std::array<std::string_view, 7> Usual{"scene", "point_cloud", "splat", "splats",
                                                    "model", "output",      "meta"};
    return name.empty() || name.starts_with("iteration_") ||
           std::find(Usual.begin(), Usual.end(), name) != Usual.end();
}

}  // namespace

std::string name_of_thing(const std::filesystem::path& path) {
    std::error_code ignored;
    auto place = std::filesystem::absolute(path, ignored).lexically_normal();
    if (!place.has_filename()) place = place.parent_path();
    std::string first;
    for (; place.has_relative_path(); place = place.parent_path()) {
        std::string name = place.filename().string();
        name.resize(std::min(name.size(), name.find('.', 1)));
        if (!names_nothing(name)) return name;
        if (first.empty()) first = std::move(name);
    }
    return first;
}

Scene load_standing_scene(const std::filesystem::path& path, const std::string& up,
                          const ReadingOptions& options) {
    refuse_weights(path);
    Scene scene = load_scene(path, options);
    if (is_project_file(path) || find_cameras(path)) return scene;
    const auto guess = guess_up(scene.info, scene.gaussians);
    if (up == "auto" && scene.info.up_unsure) log::warning("{}", up_note(scene.info, guess));
    return scene;
}

LoadedScene load_scene_with_cameras(const std::filesystem::path& path, const std::string& cameras,
                                    const ReadingOptions& options) {
    refuse_weights(path);
    LoadedScene loaded{load_scene(path, options), {}, {}, {}};
    SceneCameras found = cameras_of_scene({loaded.scene.gaussians, loaded.scene.info.offset, path}, cameras);
    loaded.views = std::move(found.views);
    loaded.notes = std::move(found.notes);
    if (auto note = guess_up(loaded.scene.info, loaded.views); !note.empty())
        loaded.notes.push_back(std::move(note));
    else if (loaded.views.empty() && !is_project_file(path)) {
        const auto guess = guess_up(loaded.scene.info, loaded.scene.gaussians);
        loaded.up_note = up_note(loaded.scene.info, guess);
    }
    return loaded;
}

}  // namespace gse::pipeline
