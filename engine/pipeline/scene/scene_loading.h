// Scenes with the cameras that belong to them: read alike for the window and for the command line.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/io/scene/reading_options.h"
#include "engine/scene/layout/up_axis.h"
#include "engine/scene/scene.h"

namespace gse::pipeline {

/// Cameras that look at a scene, and what was odd about those that were found, one sentence each.
struct SceneCameras {
    std::vector<View> views;
    std::vector<std::string> notes;
};

/// The scene whose cameras are looked for.
struct PlacedScene {
    GaussianSet set;
    Vec3 offset{};  // of its file's world, see SceneInfo
    std::filesystem::path path;
};

/// The cameras named, or those found beside the scene; none for "none". Those that look elsewhere are left
/// out. Throws Error where named ones cannot be read; of those found a note says so.
SceneCameras cameras_of_scene(const PlacedScene& scene, const std::string& named = {});

/// Views of a file's world, less the offset of the scene. Views that see more of it as they are stay: they
/// were made before the scene was brought to its place in the world.
std::vector<View> views_of_scene(std::vector<View> views, const GaussianSet& set, const Vec3& offset);

/// Takes up from the cameras where the file does not state it. Returns the sentence that says so; empty =
/// nothing was guessed.
std::string guess_up(SceneInfo& info, const std::vector<View>& views);

/// Takes up from the splats where the file does not state it and the splats are sure; else notes that it is
/// not sure. Nothing for files that state it.
std::optional<UpGuess> guess_up(SceneInfo& info, const GaussianSet& set);

/// Sentence on a guess; empty = what was assumed anyway.
std::string up_note(const SceneInfo& info, const std::optional<UpGuess>& guess);

/// Sentence on haze and sky far around the scene; empty = there is neither.
std::string surroundings_note(const SceneStatistics& statistics);

/// Name of the thing in a scene's file, without its endings: "guitar" for "guitar.compressed.ply". Of a file
/// that trainers name alike it is that of the folder: "guitar" for "guitar/point_cloud.ply".
std::string name_of_thing(const std::filesystem::path& path);

/// A scene for pictures from around it. Up is guessed where neither its file nor cameras beside it say it.
/// Logs a warning where the guess is not sure and `up` is "auto". Throws Error.
Scene load_standing_scene(const std::filesystem::path& path, const std::string& up = "auto",
                          const ReadingOptions& options = {});

/// A scene, its cameras, and which way is up where the file does not say and the cameras do.
struct LoadedScene {
    Scene scene;
    std::vector<View> views;
    std::vector<std::string> notes;  // one sentence each
    std::string up_note;             // on a guess of up from the splats
};

/// `cameras` as `named` above. Throws Error.
LoadedScene load_scene_with_cameras(const std::filesystem::path& path, const std::string& cameras = {},
                                    const ReadingOptions& options = {});

}  // namespace gse::pipeline
