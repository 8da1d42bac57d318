// A server's settings in recipes, and what must not stand there.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "engine/base/error.h"
#include "engine/pipeline/models/server_instruction.h"
#include "engine/pipeline/models/view_server.h"
#include "engine/pipeline/recipe/recipe.h"

namespace server_recipe_test {

using namespace gse;
using namespace gse::pipeline;

DOCTEST_TEST_CASE("server recipe: settings come back as written, the address without secrets") {
    EditRecipe recipe;
    recipe.request.source = "bear";
    DOCTEST_CHECK(!recipe_to_json(recipe).contains("server"));
    recipe.server.url = "https://user:geheim@host:7860/sd?token=geheim#geheim";
    recipe.server.kind = "webui";
    recipe.server.agreement = "sheet";
    recipe.server.side = 768;
    const auto json = recipe_to_json(recipe);
    DOCTEST_CHECK(json.dump().find("geheim") == std::string::npos);
    const auto read = recipe_from_json(json, "/tmp");
    DOCTEST_CHECK(read.server.url == "https://host:7860/sd");
    DOCTEST_CHECK(read.server.kind == "webui");
    DOCTEST_CHECK(read.server.agreement == "sheet");
    DOCTEST_CHECK(read.server.side == 768);
    DOCTEST_CHECK(read.given.contains("server.side"));
}

DOCTEST_TEST_CASE("server recipe: options, LoRAs and pictures come back, files beside the recipe") {
    EditRecipe recipe;
    recipe.request.source = "bear";
    recipe.server.url = "http://host:7860";
    recipe.server.option = {"scheduler=karras"};
    recipe.server.lora = {"bronze:0.8"};
    recipe.server.target_picture = {"view 3=mine=1.png"};
    recipe.server.key_view = "view 3";
    recipe.server.workflow = "flow.json";
    auto read = recipe_from_json(recipe_to_json(recipe), "/tmp");
    DOCTEST_CHECK(read.server.workflow == "/tmp/flow.json");
    recipe.server.workflow = "edit";  // a bundled one is no file
    read = recipe_from_json(recipe_to_json(recipe), "/tmp");
    DOCTEST_CHECK(read.server.workflow == "edit");
    DOCTEST_CHECK(read.server.option == recipe.server.option);
    DOCTEST_CHECK(read.server.lora == recipe.server.lora);
    DOCTEST_CHECK(read.server.target_picture == std::vector<std::string>{"view 3=/tmp/mine=1.png"});
    DOCTEST_CHECK(read.server.key_view == "view 3");
    DOCTEST_CHECK(remote::file_name_of_view("photos/a b.JPG") == "photos_a_b.JPG");
    for (const char* text : {"", "view", "=file", "view="})
        DOCTEST_CHECK_THROWS_AS(remote::target_picture_of(text), Error);
}

DOCTEST_TEST_CASE("server recipe: an address is cut where secrets may stand") {
    DOCTEST_CHECK(remote::without_secrets("http://127.0.0.1:1234") == "http://127.0.0.1:1234");
    DOCTEST_CHECK(remote::without_secrets("host:80/a@b") == "host:80/a@b");
    DOCTEST_CHECK(remote::without_secrets("me@pw@host/x?y=z") == "host/x");
}

DOCTEST_TEST_CASE("server instruction: tells the change in a sentence with articles") {
    const auto told = [](const char* source, const char* prompt, const char* target, edit::EditMode mode) {
        edit::EditRequest request;
        request.source = source, request.prompt = prompt, request.target = target;
        return server_instruction(edit::check(request), mode);
    };
    using Mode = edit::EditMode;
    DOCTEST_CHECK(told("bear", "a golden bear", "golden", Mode::Modify) ==
                  "turn the bear into a golden bear");
    DOCTEST_CHECK(told("bear", "a bear made of gold", "gold", Mode::Modify) ==
                  "turn the bear into a bear made of gold");
    DOCTEST_CHECK(told("hat", "a bear wearing a green hat", "green", Mode::Modify) ==
                  "turn the hat into a green hat");
    DOCTEST_CHECK(told("grass", "a bear on the snow", "snow", Mode::Modify) == "turn the grass into snow");
    DOCTEST_CHECK(told("bear", "a bear wearing a golden sombrero", "sombrero", Mode::Add) ==
                  "add a golden sombrero to the bear");
    DOCTEST_CHECK(told("bear", "a bear wearing black sunglasses", "sunglasses", Mode::Add) ==
                  "add black sunglasses to the bear");
    DOCTEST_CHECK(told("bear", "a red panda", "panda", Mode::Replace) == "replace the bear with a red panda");
    edit::EditRequest own;
    own.source = "bear", own.prompt = "a golden bear", own.target = "golden";
    own.instruction = "gild it";
    DOCTEST_CHECK(server_instruction(edit::check(own), Mode::Modify) == "gild it");
}

DOCTEST_TEST_CASE("server plan: views and masks grow together") {
    edit::EditPlan plan;
    View view;
    view.camera = Camera::look_at({0, 0, -4}, {0, 0, 0}, {0, -1, 0}, 0.8, 96, 96);
    plan.views = {view};
    Mask mask(96, 96);
    for (int y = 24; y < 72; ++y)
        for (int x = 24; x < 72; ++x) mask.at(x, y) = 1;
    plan.masks = {mask};
    const auto larger = plan_at_side(plan, 512);
    DOCTEST_CHECK(larger.views[0].camera.width == 512);
    DOCTEST_CHECK(larger.masks[0].width == 512);
    DOCTEST_CHECK(static_cast<double>(larger.masks[0].count()) ==
                  doctest::Approx(0.25 * 512 * 512).epsilon(0.02));
    const Vec3 point{0.3, 0.2, 0.1};
    const auto place = [&](const Camera& camera) {
        const Vec3 seen = camera.to_camera(point);
        return (camera.fx * seen.x / seen.z + camera.cx) / camera.width;
    };
    DOCTEST_CHECK(place(larger.views[0].camera) == doctest::Approx(place(view.camera)));
}

}  // namespace server_recipe_test
