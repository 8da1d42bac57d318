// One project in two windows: the second one is told, and its save asks whose work is to stay.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "engine/base/file.h"
#include "engine/scene/label_ops.h"
#include "tests/ui/app/session.h"

namespace two_windows_test {

using namespace gse;
using namespace gse::test;

namespace {

fs::path own_scene(const Place& place) {
    const auto file = place.folder / "bear/scene.ply";
    fs::create_directories(file.parent_path());
    fs::copy_file(app::assets_path() / "scenes/bear/scene.ply", file);
    return file;
}

void open(Session& session, const fs::path& path) {
    session.app.run(command::Open{path});
    DOCTEST_REQUIRE(session.until([&] { return session.app.model().document != nullptr; }));
    DOCTEST_REQUIRE(session.idle());
}

void turn(Session& session, const std::string& up) {
    session.app.run(command::SetUpAxis{up});
    session.app.update(session.preview);
}

/// A session that tells a question from one that was answered.
struct Window : Session {
    std::uint64_t answered = 0;  // number of the last question that was
    bool asks() {
        app.update(preview);
        return app.model().question.number != answered;
    }
    /// Answers by the answer that begins so.
    void answer(const std::string& text) {
        const auto question = app.model().question;
        answered = question.number;
        for (std::size_t index = 0; index < question.answers.size(); ++index)
            if (question.answers[index].text.starts_with(text)) return app.run(command::Answer{index});
        DOCTEST_FAIL("no answer begins with ", text);
    }
};

}  // namespace

DOCTEST_TEST_CASE(
    "a project that another window has open is said to be, and a save asks before it replaces") {
    const Place place;
    const auto scene = own_scene(place), project = scene.parent_path() / "bear.gsep";
    Window first, second;
    open(first, scene);
    first.app.run(command::SaveProject{project});
    DOCTEST_REQUIRE(first.until([&] { return !first.app.model().project_path.empty(); }));
    DOCTEST_REQUIRE(first.idle());

    open(second, project);
    DOCTEST_REQUIRE(second.asks());
    DOCTEST_CHECK(second.app.model().question.text.find("another window") != std::string::npos);
    second.answer("Go on");
    DOCTEST_CHECK_FALSE(second.asks());

    turn(first, "x");
    first.app.run(command::SaveProject{});
    DOCTEST_REQUIRE(first.idle());
    DOCTEST_CHECK_FALSE(first.asks());  // it has the lock
    const auto kept = read_file(project);

    turn(second, "y");
    second.app.run(command::SaveProject{});
    DOCTEST_REQUIRE(second.asks());
    DOCTEST_REQUIRE(second.idle());
    DOCTEST_CHECK(read_file(project) == kept);
    second.answer("Save as bear-2.gsep");
    DOCTEST_REQUIRE(second.until([&] { return second.app.model().project_path.ends_with("bear-2.gsep"); }));
    DOCTEST_CHECK(fs::exists(project.parent_path() / "bear-2.gsep"));
    DOCTEST_CHECK(read_file(project) == kept);

    turn(second, "z");
    second.app.run(command::SaveProject{});  // its own now
    DOCTEST_REQUIRE(second.idle());
    DOCTEST_CHECK_FALSE(second.asks());
    DOCTEST_CHECK_FALSE(second.app.model().unsaved);
}

DOCTEST_TEST_CASE("a project that was written elsewhere since it was opened is not replaced unasked") {
    const Place place;
    const auto scene = own_scene(place), project = scene.parent_path() / "bear.gsep";
    Window session;
    open(session, scene);
    session.app.run(command::SaveProject{project});
    DOCTEST_REQUIRE(session.until([&] { return !session.app.model().project_path.empty(); }));
    DOCTEST_REQUIRE(session.idle());
    write_file(project, "of another program");
    turn(session, "x");
    session.app.run(command::SaveProject{});
    DOCTEST_REQUIRE(session.asks());
    session.answer("Cancel");
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_CHECK(read_file(project) == "of another program");
    session.app.run(command::SaveProject{});
    DOCTEST_REQUIRE(session.asks());
    session.answer("Replace");
    DOCTEST_REQUIRE(session.until([&] { return read_file(project) != "of another program"; }));
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_CHECK_FALSE(session.asks());
}

}  // namespace two_windows_test
