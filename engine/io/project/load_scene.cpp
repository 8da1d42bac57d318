// Reads a scene file, or a project as the scene it shows.
#include "engine/io/project/load_scene.h"

#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/io/project/project_file.h"
#include "engine/io/scene/scene_file.h"

namespace gse {
namespace {

/// Scene of a project, whose own scene may be a project again.
Scene load_project_scene(const std::filesystem::path& path) {
    constexpr int Deepest = 8;
    thread_local int depth = 0;
    struct Deeper {
        Deeper() { ++depth; }
        ~Deeper() { --depth; }
    } const deeper;
    if (depth > Deepest)
        throw Error(ErrorCode::Malformed, "projects refer to each other as their scenes",
                    "export the scene of one of them", path);
    const ProjectData project = load_project(path);
    for (const auto& warning : project.warnings) log::warning("{}: {}", path.filename().string(), warning);
    return scene_of_project(project);
}

}  // namespace

Scene load_scene(const std::filesystem::path& path, const ReadingOptions& options) {
    if (!is_project_file(path)) return load_scene_file(path, options);
    if (options.activated)
        throw Error(ErrorCode::InvalidArgument, "a project remembers how its scene was opened",
                    "leave out --activated", path);
    return load_project_scene(path);
}

}  // namespace gse
