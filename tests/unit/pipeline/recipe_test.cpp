// Searches that a changed recipe makes necessary, and those that it does not.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <set>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/edit/request/checked_request.h"
#include "engine/pipeline/recipe/recipe.h"
#include "tests/test_paths.h"

namespace recipe_test {

namespace {

using namespace gse;
using test::ScratchFolder;

pipeline::EditRecipe plain() {
    pipeline::EditRecipe recipe;
    recipe.request.source = "bear";
    recipe.request.prompt = "a blue bear on the grass";
    recipe.request = edit::check(recipe.request).plain();
    return recipe;
}

std::string key_of(const pipeline::EditRecipe& recipe) {
    return pipeline::search_key(pipeline::check(recipe));
}

/// Another value of the same type.
void change(bool& value) { value = !value; }
void change(std::string& value) { value += "x"; }
template <class Number> void change(Number& value) { value = value == 0 ? Number{1} : value / 2; }

template <class Part> std::set<std::string> names() {
    std::set<std::string> found;
    const Part part{};
    Part::visit_fields(
        part, [&](const char* name, const auto&, const char*, const auto&...) { found.insert(name); });
    return found;
}

}  // namespace

DOCTEST_TEST_CASE(
    "the words and the settings of the search decide what is found, those of the loop and the thresholds do "
    "not") {
    const auto searched = names<edit::SearchSettings>();
    const auto before = key_of(plain());
    std::size_t checked = 0;
    for (const auto& name : names<edit::EditSettings>()) {
        auto recipe = pipeline::check(plain());
        edit::EditSettings::visit_fields(recipe.request,
                                         [&](const char* field, auto& value, const char*, const auto&...) {
                                             if (field == name) change(value);
                                         });
        DOCTEST_CAPTURE(name);
        DOCTEST_CHECK((pipeline::search_key(recipe) != before) == searched.contains(name));
        ++checked;
    }
    DOCTEST_CHECK(checked > 60);
    for (const auto& [field, value] : {std::pair{&edit::EditWords::source, "grass"},
                                       {&edit::EditWords::prompt, "a blue bear"},
                                       {&edit::EditWords::target, "grass"},
                                       {&edit::EditWords::mode, "modify"}}) {
        auto recipe = plain();
        recipe.request.*field = value;
        DOCTEST_CAPTURE(value);
        DOCTEST_CHECK(key_of(recipe) != before);
    }
    auto recipe = plain();
    recipe.guidance.guidance_scale += 1;
    DOCTEST_CHECK(key_of(recipe) == before);
}

DOCTEST_TEST_CASE(
    "a recipe with the names of before gives its settings, which count as given under their present ones") {
    const auto recipe = pipeline::recipe_from_json(
        {{"version", 1},
         {"request", {{"prompt", "a red bear"}, {"tau", 0.75}, {"left_out", "3"}, {"focus", false}}}},
        {});
    DOCTEST_CHECK(recipe.request.label_threshold == 0.75);
    DOCTEST_CHECK(recipe.request.excluded_views == "3");
    DOCTEST_CHECK_FALSE(recipe.request.reframe_views);
    DOCTEST_CHECK(recipe.given == std::set<std::string>{"request.prompt", "request.label_threshold",
                                                        "request.excluded_views", "request.reframe_views"});
}

DOCTEST_TEST_CASE("every field of a request belongs to one part of it") {
    const auto all = names<edit::EditRequest>();
    const std::size_t parts = names<edit::EditWords>().size() + names<edit::SearchSettings>().size() +
                              names<edit::LabelThresholds>().size() + names<edit::LoopSettings>().size() +
                              names<edit::RearrangeSettings>().size();
    DOCTEST_CHECK(parts == all.size());
}

DOCTEST_TEST_CASE("another model, up axis, front or set of cameras looks again; the film's size does not") {
    const auto before = key_of(plain());
    for (const auto field : {&pipeline::JobParameters::model, &pipeline::JobParameters::up,
                             &pipeline::JobParameters::front, &pipeline::JobParameters::cameras}) {
        auto recipe = plain();
        recipe.job.*field = "other";
        DOCTEST_CHECK(key_of(recipe) != before);
    }
    auto tuned = plain();
    tuned.job.lora = {"a.safetensors:0.5"};
    DOCTEST_CHECK(key_of(tuned) != before);
    auto recipe = plain();
    recipe.job.rasterizer = "cuda";
    DOCTEST_CHECK(key_of(recipe) != before);
    recipe.job.rasterizer = "cpu";  // which "auto" is
    recipe.job.turntable_frames = 7;
    DOCTEST_CHECK(key_of(recipe) == before);
    recipe.use_dreambooth = true;
    DOCTEST_CHECK(key_of(recipe) != before);
}

DOCTEST_TEST_CASE("LoRAs are a list of the recipe; their files are those beside it, with their strength") {
    const ScratchFolder scratch;
    auto recipe = plain();
    recipe.job.lora = {"style.safetensors:0.7", "/models/lcm.safetensors", "colon:name.safetensors"};
    const auto path = scratch.path() / "recipe.json";
    write_file(path, pipeline::recipe_to_json(recipe).dump());
    const auto read = pipeline::read_recipe(path).job.lora;
    DOCTEST_REQUIRE(read.size() == 3);
    const auto folder = std::filesystem::weakly_canonical(scratch.path()).string();
    DOCTEST_CHECK(read[0] == folder + "/style.safetensors:0.7");
    DOCTEST_CHECK(read[1] == "/models/lcm.safetensors");
    DOCTEST_CHECK(read[2] == folder + "/colon:name.safetensors");
    for (const char* wrong : {"\"one\"", "[1]", "{}"}) {
        auto json = pipeline::recipe_to_json(recipe);
        json["job"]["lora"] = nlohmann::ordered_json::parse(wrong);
        write_file(path, json.dump());
        DOCTEST_CHECK_THROWS_AS(pipeline::read_recipe(path), Error);
    }
}

DOCTEST_TEST_CASE("a target that is left to be guessed is the one that was guessed") {
    auto recipe = plain();
    const auto guessed = key_of(recipe);
    recipe.request.target.clear();
    DOCTEST_CHECK(key_of(recipe) == guessed);
}

}  // namespace recipe_test
