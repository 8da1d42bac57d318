// Names that are not UTF-8 come back from projects, autosaves and the list of recent files.
#include <cstdlib>

#include "engine/io/files/user_files.h"
#include "engine/io/project/autosave.h"
#include "tests/unit/io/project_helpers.h"

namespace names_test {

using namespace gse;
using namespace gse::test;

DOCTEST_TEST_CASE("projects, autosaves and recent files keep names that are not UTF-8") {
    const ScratchFolder scratch;
    const auto folder = scratch.path() / "sz\xe9ne";
    const auto scene_path = folder / "b\xe4r.ply", project_path = folder / "work\xff.gsep";
    save_scene(scene_path, random_scene(20, 0, 1));
    ProjectData project;
    project.source = scene_source(scene_path, load_scene(scene_path).gaussians);
    Scene scene;
    scene.gaussians = project.source.loaded;
    project.state = initial_state(scene, {});
    save_project(project_path, project);
    const ProjectData back = load_project(project_path);
    DOCTEST_CHECK(back.warnings.empty());
    DOCTEST_CHECK(back.source.path == scene_path);

    Autosave autosave(scratch.path() / "state");
    ProjectWriter writer;
    autosave.write(project, project_path, writer);
    for (const auto& entry : std::filesystem::directory_iterator(scratch.path() / "state"))
        if (entry.path().extension() == ".json") {
            auto json = nlohmann::json::parse(read_file(entry.path()));
            json["process"] = 0;  // as if its session had died
            write_file(entry.path(), json.dump());
        }
    std::filesystem::remove(project_path);
    const auto offers = find_recoverable(scratch.path() / "state");
    DOCTEST_REQUIRE(offers.size() == 1);
    DOCTEST_CHECK(offers[0].project == project_path);
    DOCTEST_CHECK(offers[0].scene == scene_path);

    setenv("GSE_CONFIG_DIR", (scratch.path() / "config").c_str(), 1);
    add_recent(scene_path);
    const auto recent = load_recent();
    unsetenv("GSE_CONFIG_DIR");
    DOCTEST_REQUIRE(recent.size() == 1);
    DOCTEST_CHECK(recent[0] == scene_path);
}

}  // namespace names_test
