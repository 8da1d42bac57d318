// kill -9 at random moments of a session that edits, autosaves and saves: what was said to be saved is there,
// bit for bit.
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <thread>

#include "engine/base/log.h"
#include "engine/io/project/autosave.h"
#include "tests/unit/io/project_helpers.h"

namespace kill_test {

using namespace gse;
using namespace gse::test;
namespace fs = std::filesystem;

namespace {

constexpr int Kills = 14;
constexpr std::size_t Splats = 20000;
constexpr int SaveEvery = 3;         // autosaves per save of the project
constexpr int WritesPerStep = 4;     // so that most moments fall into a write
constexpr int LongestDelayMs = 160;  // several autosaves and saves long

/// The document after `step` changes; the same in every process.
ProjectData project_at(const SceneSource& source, int step) {
    Scene scene;
    scene.gaussians = source.loaded;
    ProjectData project;
    project.source = source;
    project.state = initial_state(scene, {random_view(static_cast<std::uint64_t>(step))});
    for (int edit = 0; edit < 1 + step % 3; ++edit)
        project.state =
            with_edit(project.state, random_node(project.state, static_cast<std::uint64_t>(step / 4 + edit)));
    project.state.labels = {random_label(project.state, static_cast<std::uint64_t>(step))};
    project.jobs = {{"step", step}};
    return project;
}

struct Paths {
    fs::path scene, project, autosaves;
};

/// The session: announces "a 7" before autosave 7, "A 7" after it, "p 7" and "P 7" around saves of the
/// project.
[[noreturn]] void run_session(const Paths& paths, int first_step, int announce) {
    const auto say = [&](char what, int step) {
        char line[32];
        const int size = std::snprintf(line, sizeof line, "%c %d\n", what, step);
        if (write(announce, line, static_cast<std::size_t>(size)) != size) _exit(4);
    };
    try {
        const SceneSource source = scene_source(paths.scene, load_scene(paths.scene).gaussians);
        Autosave autosave(paths.autosaves);
        ProjectWriter writer;
        for (int step = first_step;; ++step) {
            const ProjectData project = project_at(source, step);
            for (int again = 0; again < WritesPerStep; ++again) {
                say('a', step);
                autosave.write(project, paths.project, writer);
                say('A', step);
            }
            if (step % SaveEvery != 0) continue;
            say('p', step);
            writer.save(paths.project, project);
            say('P', step);
        }
    } catch (...) { _exit(3); }
}

/// Words of a session before it died.
struct Announced {
    int autosaved = -1, autosaving = -1, saved = -1, saving = -1;
    bool in_flight = false;

    void hear(char what, int step) {
        (what == 'a' ? autosaving : what == 'A' ? autosaved : what == 'p' ? saving : saved) = step;
        in_flight = what == 'a' || what == 'p';
    }
};

struct Session {
    pid_t process = -1;
    FILE* words = nullptr;
    Announced announced;

    bool listen() {
        char what = 0;
        int step = 0;
        if (std::fscanf(words, "%c %d\n", &what, &step) != 2) return false;
        announced.hear(what, step);
        return true;
    }
};

Session start_session(const Paths& paths, int first_step) {
    int ends[2] = {-1, -1};
    DOCTEST_REQUIRE(pipe(ends) == 0);
    Session session;
    session.process = fork();
    DOCTEST_REQUIRE(session.process >= 0);
    if (session.process == 0) {
        close(ends[0]);
        run_session(paths, first_step, ends[1]);
    }
    close(ends[1]);
    session.words = fdopen(ends[0], "r");
    return session;
}

/// Lets the session save the project once, waits, kills it and hears its last words.
void kill_session(Session& session, int delay_ms) {
    while (session.announced.saved < 0) DOCTEST_REQUIRE(session.listen());
    std::this_thread::sleep_for(std::chrono::milliseconds(delay_ms));
    kill(session.process, SIGKILL);
    int status = 0;
    DOCTEST_REQUIRE(waitpid(session.process, &status, 0) == session.process);
    DOCTEST_CHECK(WIFSIGNALED(status));  // it did not end by itself
    while (session.listen()) continue;
    std::fclose(session.words);
}

/// The file holds, bit for bit, the step that was announced or the one that was being written; returns it.
int check_file(const fs::path& path, const SceneSource& source, int saved, int saving) {
    DOCTEST_CAPTURE(path.string());
    const ProjectData project = load_project(path);
    const int step = project.jobs.at("step").get<int>();
    const bool expected = step == saved || step == saving;
    DOCTEST_CHECK(expected);
    DOCTEST_CHECK(difference(project_at(source, step).state, project.state) == "");
    return step;
}

}  // namespace

DOCTEST_TEST_CASE("kill -9 at random moments loses nothing that was said to be saved") {
    log::set_level(log::Level::Error);
    const ScratchFolder folder;
    const Paths paths{folder.path() / "scene.ply", folder.path() / "work.gsep", folder.path() / "state"};
    save_scene(paths.scene, random_scene(Splats, 1, 1));
    const SceneSource source = scene_source(paths.scene, load_scene(paths.scene).gaussians);
    Random random(20240607);
    int in_flight = 0;
    for (int round = 0; round < Kills; ++round) {
        DOCTEST_CAPTURE(round);
        Session session = start_session(paths, round * 1000);
        kill_session(session, static_cast<int>(random.below(LongestDelayMs)));
        const Announced& said = session.announced;
        in_flight += said.in_flight ? 1 : 0;
        const int project_step = check_file(paths.project, source, said.saved, said.saving);
        int newest = project_step;
        for (const auto& entry : fs::directory_iterator(paths.autosaves))
            if (entry.path().extension() == ".gsep" && !entry.path().filename().string().starts_with('.'))
                newest = std::max(newest, check_file(entry.path(), source, said.autosaved, said.autosaving));
        DOCTEST_CHECK(newest >= std::max(said.autosaved, said.saved));
        // The window offers it exactly when it is newer than the project.
        const auto offers = find_recoverable(paths.autosaves);
        DOCTEST_CHECK(offers.size() <= 1);
        if (newest > project_step) DOCTEST_CHECK(offers.size() == 1);
        for (const auto& offer : offers) {
            DOCTEST_CHECK(offer.project == paths.project);
            discard(offer);
        }
    }
    std::printf("%d kills, %d of them while a file was being written\n", Kills, in_flight);
    DOCTEST_CHECK(in_flight > 0);  // else the moments prove nothing
    log::set_level(log::Level::Info);
}

}  // namespace kill_test
