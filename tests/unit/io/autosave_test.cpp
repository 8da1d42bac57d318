// Autosaves, settings and recent files in folders of their own.
#include <fmt/core.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "engine/base/log.h"
#include "engine/io/files/user_files.h"
#include "engine/io/project/autosave.h"
#include "tests/unit/io/project_helpers.h"

namespace autosave_test {

using namespace gse;
using namespace gse::test;
namespace fs = std::filesystem;

namespace {

std::size_t count_files(const fs::path& folder) {
    std::size_t count = 0;
    for (const auto& entry : fs::directory_iterator(folder)) count += entry.is_regular_file() ? 1 : 0;
    return count;
}

/// Makes the autosave look like one of a process that died.
void kill_owner(const fs::path& autosave) {
    const auto sidecar = fs::path(autosave).replace_extension(".json");
    auto json = nlohmann::json::parse(read_file(sidecar));
    json["start"] = "1";
    write_file(sidecar, json.dump());
}

/// Start of a process as /proc tells it, field 22 of its line.
std::string start_of(pid_t process) {
    std::ifstream stream(fmt::format("/proc/{}/stat", process));
    std::string line, field;
    std::getline(stream, line);
    std::istringstream fields(line.substr(line.rfind(')') + 1));
    for (int number = 3; number <= 22; ++number) fields >> field;
    return field;
}

struct Quiet {
    Quiet() { log::set_level(log::Level::Off); }
    ~Quiet() { log::set_level(log::Level::Info); }
};

}  // namespace

DOCTEST_TEST_CASE("an autosave is offered once its process is gone, while it is newer than its project") {
    const ScratchFolder folder;
    const auto autosaves = folder.path() / "state";
    const auto project_path = folder.path() / "work.gsep";
    const ProjectData project = random_project(saved_source(folder.path() / "scene.ply", 70, 1), 1);
    DOCTEST_CHECK(find_recoverable(autosaves).empty());
    Autosave autosave(autosaves);
    ProjectWriter writer;
    autosave.write(project, "", writer);
    const auto unsaved = autosave.path();
    DOCTEST_CHECK(unsaved.filename().string().starts_with("unsaved-"));
    DOCTEST_CHECK(find_recoverable(autosaves).empty());  // this process lives
    kill_owner(unsaved);
    DOCTEST_REQUIRE(find_recoverable(autosaves).size() == 1);
    const Recoverable found = find_recoverable(autosaves)[0];
    DOCTEST_CHECK(found.file == unsaved);
    DOCTEST_CHECK(found.project.empty());
    DOCTEST_CHECK(found.scene == project.source.path);
    DOCTEST_CHECK(found.saved_at > 1600000000);
    DOCTEST_CHECK(difference(project.state, load_project(found.file).state) == "");
    // The artist names the project: the autosave moves with it, the nameless one goes.
    autosave.write(project, project_path, writer);
    DOCTEST_CHECK_FALSE(fs::exists(unsaved));
    DOCTEST_CHECK(count_files(autosaves) == 2);
    kill_owner(autosave.path());
    writer.save(project_path, project);
    fs::last_write_time(project_path, fs::last_write_time(autosave.path()) - std::chrono::seconds(5));
    DOCTEST_REQUIRE(find_recoverable(autosaves).size() == 1);
    DOCTEST_CHECK(find_recoverable(autosaves)[0].project == project_path);
    fs::last_write_time(project_path, fs::last_write_time(autosave.path()) + std::chrono::seconds(5));
    DOCTEST_CHECK(find_recoverable(autosaves).empty());
    DOCTEST_CHECK(count_files(autosaves) == 0);
    autosave.discard();
}

DOCTEST_TEST_CASE("an autosave that was left is offered while its process lives, and not written to again") {
    const ScratchFolder folder;
    const ProjectData project = random_project({{}, 0, 0, random_set(20, 0, 1)}, 1);
    ProjectWriter writer;
    Autosave autosave(folder.path());
    autosave.leave();  // nothing was written: nothing happens
    autosave.write(project, "", writer);
    const auto left = autosave.path();
    DOCTEST_CHECK(find_recoverable(folder.path()).empty());
    autosave.leave();
    DOCTEST_REQUIRE(find_recoverable(folder.path()).size() == 1);
    DOCTEST_CHECK(find_recoverable(folder.path())[0].file == left);
    autosave.write(project, "", writer);
    DOCTEST_CHECK(autosave.path() != left);
    autosave.discard();
    DOCTEST_CHECK(find_recoverable(folder.path()).size() == 1);
    DOCTEST_CHECK(fs::exists(left));
}

DOCTEST_TEST_CASE("work of a killed process is offered before its parent has asked for the process") {
    const ScratchFolder folder;
    ProjectWriter writer;
    Autosave autosave(folder.path());
    autosave.write(random_project({{}, 0, 0, random_set(20, 0, 1)}, 1), "", writer);
    const pid_t child = fork();
    if (child == 0)
        while (true) pause();
    const auto sidecar = fs::path(autosave.path()).replace_extension(".json");
    auto json = nlohmann::json::parse(read_file(sidecar));
    json["process"] = child;
    json["start"] = start_of(child);
    write_file(sidecar, json.dump());
    DOCTEST_CHECK(find_recoverable(folder.path()).empty());  // it lives
    kill(child, SIGKILL);
    siginfo_t ended{};
    DOCTEST_REQUIRE(waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOWAIT) == 0);  // a zombie
    DOCTEST_CHECK(find_recoverable(folder.path()).size() == 1);
    waitpid(child, nullptr, 0);
}

DOCTEST_TEST_CASE("discarding removes, damaged sidecars are passed over") {
    const Quiet quiet;
    const ScratchFolder folder;
    const ProjectData project = random_project({{}, 0, 0, random_set(20, 0, 1)}, 1);
    ProjectWriter writer;
    Autosave one(folder.path()), two(folder.path());
    one.write(project, "", writer);
    two.write(project, "", writer);
    DOCTEST_CHECK(one.path() != two.path());
    kill_owner(two.path());
    one.discard();
    write_file(folder.path() / "broken.json", "{\"process\": \"x\"}");
    write_file(folder.path() / "worse.json", "\x01\x02");
    const auto found = find_recoverable(folder.path());
    DOCTEST_REQUIRE(found.size() == 1);
    discard(found[0]);
    DOCTEST_CHECK(find_recoverable(folder.path()).empty());
    DOCTEST_CHECK(count_files(folder.path()) == 2);
}

DOCTEST_TEST_CASE("folders of the user follow the environment") {
    const ScratchFolder folder;
    setenv("GSE_STATE_DIR", (folder.path() / "s").c_str(), 1);
    setenv("GSE_CONFIG_DIR", (folder.path() / "c").c_str(), 1);
    DOCTEST_CHECK(autosave_folder() == folder.path() / "s" / "autosave");
    DOCTEST_CHECK(config_folder() == folder.path() / "c");
    unsetenv("GSE_STATE_DIR");
    setenv("XDG_STATE_HOME", folder.path().c_str(), 1);
    DOCTEST_CHECK(state_folder() == folder.path() / "gseditpro");
    setenv("XDG_STATE_HOME", "relative", 1);
    DOCTEST_CHECK(state_folder() != fs::path("relative") / "gseditpro");
    unsetenv("XDG_STATE_HOME");
}

DOCTEST_TEST_CASE("settings keep keys they do not know, damage sets the file aside") {
    const Quiet quiet;
    const ScratchFolder folder;
    setenv("GSE_CONFIG_DIR", folder.path().c_str(), 1);
    DOCTEST_CHECK(load_settings() == nlohmann::json::object());
    DOCTEST_CHECK(save_settings({{"scale", 2}, {"view", {{"mode", 1}, {"tint", true}}}}));
    DOCTEST_CHECK(save_settings({{"view", {{"mode", 5}}}}));
    DOCTEST_CHECK(load_settings() == nlohmann::json({{"scale", 2}, {"view", {{"mode", 5}, {"tint", true}}}}));
    for (const char* damage : {"{\"scale\": ", "", "[1, 2]", "\xff\xfe"}) {
        write_file(folder.path() / "settings.json", damage);
        DOCTEST_CHECK(load_settings() == nlohmann::json::object());
        DOCTEST_CHECK(fs::exists(folder.path() / "settings.json.damaged"));
        DOCTEST_CHECK_FALSE(fs::exists(folder.path() / "settings.json"));
    }
    DOCTEST_CHECK(save_settings({{"scale", 1}}));
    write_file(folder.path() / "a.ply", "x");
    write_file(folder.path() / "b.ply", "x");
    for (int i = 0; i < 30; ++i) add_recent(folder.path() / fmt::format("gone {}.ply", i));
    add_recent(folder.path() / "a.ply");
    add_recent(folder.path() / "b.ply");
    add_recent(folder.path() / "." / "a.ply");
    DOCTEST_CHECK(load_recent() == std::vector<fs::path>{folder.path() / "a.ply", folder.path() / "b.ply"});
    DOCTEST_CHECK(load_user_json(folder.path() / "recent.json")["files"].size() == 20);
    forget_recent(folder.path() / "a.ply");
    DOCTEST_CHECK(load_recent() == std::vector<fs::path>{folder.path() / "b.ply"});
    write_file(folder.path() / "recent.json", "{\"files\": [3, null, {}]}");
    DOCTEST_CHECK(load_recent().empty());
    unsetenv("GSE_CONFIG_DIR");
}

}  // namespace autosave_test
