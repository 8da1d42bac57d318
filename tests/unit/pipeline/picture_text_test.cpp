// Texts of pictures about the edit that made them, and of the program about pictures and scenes.
#include "engine/pipeline/report/picture_text.h"

#include <algorithm>

#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/io/cameras/cameras.h"
#include "engine/io/image/image_file.h"
#include "engine/io/scene/scene_file.h"
#include "engine/pipeline/report/scene_report.h"
#include "engine/pipeline/scene/scene_tools.h"
#include "tests/test_paths.h"

namespace picture_text_test {

using namespace gse;
using namespace gse::pipeline;
using namespace gse::test;

namespace {

EditRecipe some_recipe() {
    EditRecipe recipe;
    recipe.request.source = "bear";
    recipe.request.prompt = "a bear, wearing a \"top hat\"";
    recipe.request.seed = 42;
    return recipe;
}

Scene small_scene() {
    GaussianData data;
    data.resize(3);
    for (std::size_t i = 0; i < 3; ++i) {
        data.position[i * 3] = static_cast<float>(i);
        data.rotation[i * 4] = 1;
    }
    Scene scene;
    scene.gaussians = GaussianSet(std::move(data));
    return scene;
}

}  // namespace

DOCTEST_TEST_CASE(
    "the parameters of a picture: sentence, source, seed and model, then what is not as usual") {
    EditRecipe recipe = some_recipe();
    DOCTEST_CHECK(parameters_text(recipe) ==
                  "a bear, wearing a \"top hat\"\nSource: bear, Seed: 42, Model: starter");
    recipe.request.views = 11;
    recipe.request.target = "hat, top";
    recipe.job.model = "/models/sd15.safetensors";
    recipe.job.lora = {"/loras/ink.safetensors:0.5"};
    const std::string text = parameters_text(recipe);
    for (const char* part :
         {"Model: sd15.safetensors", ", views: 11", ", target: \"hat, top\"", "ink.safetensors:0.5"}) {
        DOCTEST_CAPTURE(part);
        DOCTEST_CHECK(text.find(part) != std::string::npos);
    }
    DOCTEST_CHECK(text.find("image_size") == std::string::npos);
    DOCTEST_CHECK(std::count(text.begin(), text.end(), '\n') == 1);
}

DOCTEST_TEST_CASE("a picture carries its parameters, and the report of it shows them") {
    ScratchFolder scratch;
    const auto path = scratch.path() / "picture.png";
    const EditRecipe recipe = some_recipe();
    write_png(path, Image(5, 4, 3), picture_text(recipe, recipe_to_json(recipe)));
    const auto text = read_png_text(path);
    DOCTEST_CHECK(text.at("parameters") == parameters_text(recipe));
    DOCTEST_CHECK(text.at("Software") == "GSEditPro");
    DOCTEST_CHECK(text.contains("Recipe"));
    const auto report = scene_report(path);
    DOCTEST_CHECK(report.at("width") == 5);
    DOCTEST_CHECK(report.at("height") == 4);
    DOCTEST_CHECK(report.at("text").at("parameters") == parameters_text(recipe));
    const std::string shown = report_text(report);
    DOCTEST_CHECK(shown.find("5 x 4") != std::string::npos);
    DOCTEST_CHECK(shown.find("wearing a \"top hat\"") != std::string::npos);
    DOCTEST_CHECK(shown.find("Seed: 42") != std::string::npos);
    for (std::size_t begin = 0, end = 0; begin < shown.size();
         begin = end + 1) {  // the recipe does not fill the screen
        end = std::min(shown.find('\n', begin), shown.size());
        DOCTEST_CHECK(end - begin < 300);
    }
    DOCTEST_CHECK(report.at("text").at("Recipe") == recipe_to_json(recipe).dump());
    DOCTEST_CHECK(recipe_to_json(read_recipe(path)) == recipe_to_json(recipe));
    write_png(scratch.path() / "plain.png", Image(5, 4, 3), {});
    DOCTEST_CHECK_THROWS_WITH_AS(read_recipe(scratch.path() / "plain.png"),
                                 doctest::Contains("carries no recipe"), Error);
}

DOCTEST_TEST_CASE(
    "the report of a picture lets no text through that a terminal would obey, and refuses what is no PNG") {
    ScratchFolder scratch;
    write_png(scratch.path() / "a.png", Image(1, 1, 3), {{"parameters", "red\x1b[31m\nline"}});
    const std::string shown = report_text(scene_report(scratch.path() / "a.png"));
    DOCTEST_CHECK(shown.find('\x1b') == std::string::npos);
    write_file(scratch.path() / "b.png", "no picture");
    for (const char* name : {"b.png", "none.png"}) {
        bool refused = false;
        try {
            scene_report(scratch.path() / name);
        } catch (const Error& error) { refused = !error.message().empty(); }
        DOCTEST_CHECK(refused);
    }
}

DOCTEST_TEST_CASE("viewpoints come from a camera file, from beside a scene, or from an orbit around it") {
    ScratchFolder scratch;
    const auto scene = scratch.path() / "scene.ply";
    save_scene(scene, small_scene());
    bool refused = false;
    try {
        viewpoints_of(scene);
    } catch (const Error& error) { refused = error.code() == ErrorCode::NotFound; }
    DOCTEST_CHECK(refused);
    const auto orbit = viewpoints_of(scene, 7);
    DOCTEST_CHECK(orbit.size() == 7);
    save_cameras(scratch.path() / "cameras.json", orbit);
    DOCTEST_CHECK(viewpoints_of(scene).size() == 7);
    save_cameras(scratch.path() / "transforms_mine.json", {orbit[0], orbit[1]});
    DOCTEST_CHECK(viewpoints_of(scratch.path() / "transforms_mine.json").size() == 2);
    const auto report = scene_report(scene);
    DOCTEST_CHECK(report.at("splats") == 3);
    DOCTEST_CHECK(report.at("cameras") == 7);
    DOCTEST_CHECK(report_text(report).find("cameras       7") != std::string::npos);
}

}  // namespace picture_text_test
