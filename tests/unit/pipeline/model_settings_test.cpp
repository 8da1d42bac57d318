// Which of a model's, a file's and a user's value counts in a recipe, and what the report says of it.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "engine/base/file.h"
#include "engine/pipeline/models/model_settings.h"
#include "tests/test_paths.h"

namespace model_settings_test {

namespace {

using namespace gse;
using namespace gse::pipeline;
using Json = nlohmann::ordered_json;

neural::ModelProfile wide_profile() {
    return {neural::ModelKind::Sd1,
            neural::BundleKind::Plain,
            {{"request", "image_size", 512, "model"},
             {"request", "iterations", 4000, "model"},
             {"guidance", "guidance_scale", 7.5, "model"},
             {"attention", "steps", 20, "file gseditpro.json"},
             {"dreambooth", "steps", 400, "file gseditpro.json"},
             {"job", "threads", 8, "model"}},
            {}};
}

/// "value from source", or "" of a field that is not listed.
std::string listed(const EditRecipe& recipe, const std::string& field) {
    for (const auto& entry : settings_from(recipe))
        if (entry["field"] == field)
            return entry["value"].dump() + " from " + entry["source"].get<std::string>();
    return {};
}

}  // namespace

DOCTEST_TEST_CASE(
    "model settings: a model's values replace the program's, and what the user set replaces both") {
    EditRecipe recipe;
    recipe.request.iterations = 30;
    recipe.guidance.clamp = 2;
    apply_profile(wide_profile(), recipe, {"request.iterations", "guidance.clamp"});
    DOCTEST_CHECK(recipe.request.image_size == 512);
    DOCTEST_CHECK(recipe.request.iterations == 30);
    DOCTEST_CHECK(recipe.request.views == EditRecipe{}.request.views);
    DOCTEST_CHECK(recipe.guidance.guidance_scale == 7.5);
    DOCTEST_CHECK(recipe.guidance.clamp == 2);
    DOCTEST_CHECK(recipe.attention.steps == 20);
    DOCTEST_CHECK(recipe.dreambooth.steps == 400);
    DOCTEST_CHECK(recipe.job.threads == 8);
    DOCTEST_CHECK(listed(recipe, "request.image_size") == "512 from model");
    DOCTEST_CHECK(listed(recipe, "request.iterations") == "30 from user");
    DOCTEST_CHECK(listed(recipe, "guidance.clamp") == "2.0 from user");
    DOCTEST_CHECK(listed(recipe, "attention.steps") == "20 from file gseditpro.json");
    DOCTEST_CHECK(listed(recipe, "job.threads") == "8 from model");
    DOCTEST_CHECK(listed(recipe, "request.views").empty());
    DOCTEST_CHECK(listed(recipe, "dreambooth.steps").empty());  // nothing is learned
    recipe.use_dreambooth = true;
    DOCTEST_CHECK(listed(recipe, "dreambooth.steps") == "400 from file gseditpro.json");
}

DOCTEST_TEST_CASE("model settings: a small model changes no recipe") {
    EditRecipe recipe;
    const auto before = recipe_to_json(recipe);
    apply_profile({}, recipe, {});
    DOCTEST_CHECK(recipe_to_json(recipe) == before);
    DOCTEST_CHECK(settings_from(recipe).empty());
    DOCTEST_CHECK(!before.contains("attention"));
    apply_profile(profile_of(recipe.job), recipe, {});  // the starter's
    DOCTEST_CHECK(recipe_to_json(recipe) == before);
}

DOCTEST_TEST_CASE("model settings: what a recipe's file names was given, also where it is as usual") {
    const test::ScratchFolder scratch;
    const auto path = scratch.path() / "recipe.json";
    write_file(path, R"({"version": 1, "request": {"image_size": 96}, "attention": {"steps": 7}})");
    auto recipe = read_recipe(path);
    DOCTEST_CHECK(recipe.given == std::set<std::string>{"request.image_size", "attention.steps"});
    apply_profile(wide_profile(), recipe, recipe.given);
    DOCTEST_CHECK(recipe.request.image_size == 96);
    DOCTEST_CHECK(recipe.attention.steps == 7);
    DOCTEST_CHECK(recipe.request.iterations == 4000);
    write_file(path, recipe_to_json(recipe).dump());
    DOCTEST_CHECK(read_recipe(path).attention.steps == 7);
}

DOCTEST_TEST_CASE("model settings: a value that a recipe or a user sets to the program's default counts") {
    const Json sparse{{"version", 1}, {"request", {{"colour_coupling", 0.9}}}};
    auto recipe = recipe_from_json(sparse, {});
    DOCTEST_CHECK(recipe.request.colour_coupling.is_set());
    apply_profile({}, recipe, recipe.given);
    DOCTEST_CHECK(listed(recipe, "request.colour_coupling") == "0.9 from user");
    DOCTEST_CHECK(recipe_from_json(recipe_to_json(recipe), {}).request.colour_coupling.is_set());
    // A setting that nobody set is not said to be set, and comes back as it was.
    const auto plain = recipe_from_json(recipe_to_json({}), {});
    DOCTEST_CHECK(!plain.request.colour_coupling.is_set());
    DOCTEST_CHECK(!plain.given.contains("request.colour_coupling"));
    DOCTEST_CHECK(plain.given.contains("request.iterations"));
    // The window: a user's value at the default is a change of what was not set.
    EditRecipe chosen;
    chosen.request.max_aspect = EditRecipe{}.request.max_aspect * 1.0;
    DOCTEST_CHECK(changed_settings(chosen, {}) == std::set<std::string>{"request.max_aspect"});
    // A model that states a value gives way to one that states none.
    EditRecipe stating;
    stating.request.geometry_share = 1;
    auto request = stating.request;
    move_defaults(request, stating.request, edit::EditRequest{});
    DOCTEST_CHECK(!request.geometry_share.is_set());
}

DOCTEST_TEST_CASE("model settings: a model's traits are read from its bundle, the rest is as usual") {
    const test::ScratchFolder scratch;
    JobParameters job;
    job.model = scratch.path().string();
    const edit::ModelTraits usual;
    DOCTEST_CHECK(traits_of(job).figure_aim == usual.figure_aim);
    const auto state = [&](const Json& traits) {
        write_file(scratch.path() / "gseditpro.json", Json{{"traits", traits}}.dump());
    };
    state({{"figure_aim", 0.5}, {"sky", {0, 0.5, 1}}, {"usual_colours", {{"frog", "blue"}}}});
    const auto traits = traits_of(job);
    DOCTEST_CHECK(traits.figure_aim == 0.5);
    DOCTEST_CHECK(traits.sky == edit::ModelTraits::Colour{0, 0.5f, 1});
    DOCTEST_CHECK(traits.usual_colours == std::map<std::string, std::string>{{"frog", "blue"}});
    DOCTEST_CHECK(traits.ground_colours == usual.ground_colours);
    for (const Json& wrong : {Json{{"figure_aim", -1}}, Json{{"no_such", 1}}, Json{{"sky", {0, 1}}},
                              Json{{"sky", {0, 1, 2}}}, Json{{"plain_grounds", {"moss"}}}, Json(5)}) {
        state(wrong);
        DOCTEST_CHECK_THROWS_AS(traits_of(job), Error);
    }
}

DOCTEST_TEST_CASE(
    "model settings: the traits of the bundled model are those that its pictures were drawn by") {
    const auto traits = traits_of({});
    const edit::ModelTraits usual;
    DOCTEST_CHECK(fields_to_json(traits) == fields_to_json(usual));
    DOCTEST_CHECK(traits.sky == usual.sky);
    DOCTEST_CHECK(traits.ground_colours == usual.ground_colours);
    DOCTEST_CHECK(traits.usual_colours == usual.usual_colours);
}

DOCTEST_TEST_CASE("model settings: with another model, only what nobody changed moves on") {
    EditRecipe small, wide;
    apply_profile(wide_profile(), wide, {});
    auto request = small.request;
    request.iterations = 30;
    request.prompt = "a red bear";
    move_defaults(request, small.request, wide.request);
    DOCTEST_CHECK(request.image_size == 512);
    DOCTEST_CHECK(request.iterations == 30);
    DOCTEST_CHECK(request.prompt == "a red bear");
    EditRecipe chosen = wide;
    chosen.request = request;
    DOCTEST_CHECK(changed_settings(chosen, wide) ==
                  std::set<std::string>{"request.iterations", "request.prompt"});
    chosen.job.threads += 1;
    chosen.job.front = "90";  // of the scene, no setting
    chosen.guidance.guidance_scale += 1;
    DOCTEST_CHECK(changed_settings(chosen, wide) == std::set<std::string>{"guidance.guidance_scale",
                                                                          "job.threads", "request.iterations",
                                                                          "request.prompt"});
    move_defaults(request, wide.request, small.request);
    DOCTEST_CHECK(request.image_size == small.request.image_size);
    DOCTEST_CHECK(request.iterations == 30);
}

}  // namespace model_settings_test
