// A project only refers to its scene: that is said at the first save, the scene can be put in, and a scene
// that moved is found again.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "engine/io/project/project_file.h"
#include "engine/scene/label_ops.h"
#include "tests/ui/app/session.h"

namespace scene_links_test {

using namespace gse;
using namespace gse::test;

namespace {

struct Files {
    fs::path scene, project;
};

Files files_in(const Place& place) {
    const Files files{place.folder / "scenes/scene.ply", place.folder / "bear.gsep"};
    fs::create_directories(files.scene.parent_path());
    fs::copy_file(app::assets_path() / "scenes/bear/scene.ply", files.scene);
    return files;
}

/// A project with a label made by hand.
std::size_t save_work(Session& session, const Files& files) {
    auto& app = session.app;
    app.run(command::Open{files.scene});
    DOCTEST_REQUIRE(session.until([&] { return app.model().document != nullptr; }));
    ui::ScreenRegion stroke;
    stroke.circles = {{160, 120}};
    stroke.radius_px = 20;
    app.run(command::Select{stroke, ui::SetOperation::Add, true});
    app.run(command::SaveProject{files.project});
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_REQUIRE_FALSE(app.model().project_path.empty());
    return count_labelled(app.document().state().labels.front());
}

/// Index of the toast that has that button; the number of toasts where none has.
std::size_t toast_with(const app::Application& app, const std::string& button) {
    const auto& toasts = app.model().toasts;
    for (std::size_t index = 0; index < toasts.size(); ++index)
        if (toasts[index].button == button) return index;
    return toasts.size();
}

bool opens(Session& session, const fs::path& project) {
    session.app.run(command::Open{project});
    DOCTEST_REQUIRE(session.idle());
    session.app.update(session.preview);
    return session.app.model().document != nullptr;
}

}  // namespace

DOCTEST_TEST_CASE("the first save says that the scene is not in the project, and a press puts it in") {
    const Place place;
    const auto files = files_in(place);
    std::size_t labelled = 0;
    {
        Session session;
        auto& app = session.app;
        labelled = save_work(session, files);
        app.update(session.preview);
        const auto index = toast_with(app, "Put it in");
        DOCTEST_REQUIRE(index < app.model().toasts.size());
        DOCTEST_CHECK(app.model().toasts[index].text.find("scene.ply") != std::string::npos);
        DOCTEST_CHECK_FALSE(app.model().embeds);
        const auto linked_bytes = fs::file_size(files.project);
        app.run(command::PressToast{index});
        DOCTEST_REQUIRE(session.idle());
        DOCTEST_CHECK(app.model().embeds);
        DOCTEST_CHECK_FALSE(app.model().unsaved);
        DOCTEST_CHECK(fs::file_size(files.project) > linked_bytes);
        app.run(command::SaveProject{});
        DOCTEST_REQUIRE(session.idle());
        app.update(session.preview);
        DOCTEST_CHECK(toast_with(app, "Put it in") == app.model().toasts.size());  // said once
        app.shut_down();
    }
    fs::remove(files.scene);
    Session again;
    DOCTEST_REQUIRE(opens(again, files.project));
    DOCTEST_CHECK(count_labelled(again.app.document().state().labels.front()) == labelled);
    DOCTEST_CHECK(again.app.model().embeds);
    again.app.run(command::SaveProject{place.folder / "copy.gsep"});
    DOCTEST_REQUIRE(again.idle());
    again.app.update(again.preview);
    DOCTEST_CHECK(toast_with(again.app, "Put it in") == again.app.model().toasts.size());
    again.app.shut_down();
}

DOCTEST_TEST_CASE(
    "a scene that moved is asked for, checked, and its project keeps its edits and its new place") {
    const Place place;
    const auto files = files_in(place);
    std::size_t labelled = 0;
    {
        Session session;
        labelled = save_work(session, files);
        session.app.shut_down();
    }
    const auto moved = place.folder / "elsewhere/bear.ply", wrong = place.folder / "wrong.ply";
    fs::create_directories(moved.parent_path());
    fs::rename(files.scene, moved);
    {
        const auto bytes = fs::file_size(moved);
        fs::copy_file(moved, wrong);
        fs::resize_file(wrong, bytes - 4);
    }
    {
        Session session;
        auto& app = session.app;
        DOCTEST_REQUIRE_FALSE(opens(session, files.project));
        DOCTEST_CHECK(app.model().lost.name == "bear.gsep");
        DOCTEST_CHECK(app.model().lost.scene == files.scene.string());
        app.run(command::FindScene{wrong});
        DOCTEST_REQUIRE(session.idle());
        app.update(session.preview);
        DOCTEST_CHECK(app.model().document == nullptr);
        DOCTEST_REQUIRE_FALSE(app.model().toasts.empty());
        DOCTEST_CHECK(app.model().toasts.back().is_error);
        DOCTEST_CHECK(app.model().toasts.back().text.find("not the scene") != std::string::npos);
        DOCTEST_CHECK_FALSE(app.model().lost.project.empty());  // another one can be chosen
        app.run(command::FindScene{moved});
        DOCTEST_REQUIRE(session.until([&] { return app.model().document != nullptr; }));
        app.update(session.preview);
        DOCTEST_CHECK(app.model().lost.project.empty());
        DOCTEST_CHECK(count_labelled(app.document().state().labels.front()) == labelled);
        DOCTEST_CHECK(app.model().project_path == files.project.string());
        DOCTEST_CHECK(app.model().unsaved);  // the file does not know the place yet
        app.run(command::SaveProject{});
        DOCTEST_REQUIRE(session.idle());
        app.shut_down();
    }
    Session again;
    DOCTEST_CHECK(opens(again, files.project));
    DOCTEST_CHECK(again.app.model().scene_path == moved.string());
    again.app.shut_down();
}

DOCTEST_TEST_CASE("a scene that is not found is left alone, and what is open stays open") {
    const Place place;
    const auto files = files_in(place);
    Session session;
    auto& app = session.app;
    save_work(session, files);
    fs::rename(files.scene, place.folder / "scenes/other.ply");
    fs::rename(files.project, place.folder / "moved.gsep");
    const auto revision = app.document().revision();
    app.run(command::Open{place.folder / "moved.gsep"});
    DOCTEST_REQUIRE(session.until([&] { return !app.model().lost.project.empty(); }));
    DOCTEST_CHECK(app.document().revision() == revision);
    app.run(command::ForgetLostScene{});
    DOCTEST_CHECK(app.model().lost.project.empty());
    app.run(command::FindScene{place.folder / "scenes/other.ply"});  // of nothing
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_CHECK(app.document().revision() == revision);
    app.shut_down();
}

}  // namespace scene_links_test
