// What the model is told of things whose name it does not know.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/io/scene_io.h"
#include "engine/math/sh.h"
#include "engine/pipeline/edit_job.h"
#include "engine/pipeline/installed.h"
#include "engine/pipeline/model_settings.h"
#include "engine/pipeline/neural_loader.h"
#include "engine/pipeline/told.h"
#include "tests/test_paths.h"

namespace {

using namespace gse;
using namespace gse::pipeline;

const std::vector<std::string> Known{"a", "an", "the", "on", "wearing", "red", "orange", "vase", "bear", "grass", "hat"};

edit::EditRequest request(const std::string& prompt, const std::string& source, const std::string& target) {
    edit::EditRequest asked;
    asked.prompt = prompt;
    asked.source = source;
    asked.target = target;
    return asked;
}

Told told(const edit::EditRequest& asked, const std::string& stand_in = "vase", edit::EditMode mode = edit::EditMode::Modify) {
    return told_of(asked, mode, Known, stand_in);
}

/// How blue the labelled splats are: base colours, blue less the mean of the others.
double blueness(const GaussianSet& set, const std::vector<std::uint8_t>& bits) {
    double sum = 0, count = 0;
    const std::size_t stride = set.sh().size() / set.size();
    for (std::size_t row = 0; row < set.size(); ++row) {
        if (bits[row] == 0) continue;
        const float* sh = &set.sh()[row * stride];
        sum += colour_from_sh(sh[2]) - (colour_from_sh(sh[0]) + colour_from_sh(sh[1])) / 2;
        ++count;
    }
    return sum / count;
}

}  // namespace

DOCTEST_TEST_CASE("a noun that the model does not know is told as one that it knows, in both sentences") {
    const auto guitar = told(request("a red guitar on the grass", "guitar", "red"));
    DOCTEST_CHECK(guitar.after == "a red vase on the grass");
    DOCTEST_CHECK(guitar.before == "a vase on the grass");
    DOCTEST_CHECK(guitar.stands_in);
    DOCTEST_CHECK(told(request("a red electric guitar", "electric guitar", "red")).after == "a red vase");   // a phrase is one noun
    const auto apple = told(request("an orange apple", "apple", "orange"));   // the article is that of what follows it
    DOCTEST_CHECK(apple.after == "an orange vase");
    DOCTEST_CHECK(apple.before == "a vase");
}

DOCTEST_TEST_CASE("the sentences stay as they are where the model knows the noun, takes any, has none to tell, or draws anew") {
    const auto plain = request("a red guitar on the grass", "guitar", "red");
    DOCTEST_CHECK_FALSE(told(request("a red bear on the grass", "bear", "red")).stands_in);
    DOCTEST_CHECK_FALSE(told_of(plain, edit::EditMode::Modify, {}, "vase").stands_in);
    DOCTEST_CHECK_FALSE(told(plain, "").stands_in);
    DOCTEST_CHECK_FALSE(told(request("the guitar wearing a red hat", "guitar", "hat"), "vase", edit::EditMode::Add).stands_in);
    DOCTEST_CHECK_FALSE(told(request("a red bear", "guitar", "bear"), "vase", edit::EditMode::Replace).stands_in);
    DOCTEST_CHECK(told(plain, "").after == "a red guitar on the grass");
    DOCTEST_CHECK(told(plain, "").before == "a guitar on the grass");
}

DOCTEST_TEST_CASE("the bundled model turns a thing whose name it does not know bluer when it is told another") {
    if (neural_library().empty() || !test::available(starter_model_path() / "model_index.json")) return;
    const auto scene = load_scene(assets_path() / "scenes/bear/scene.ply");
    const auto model = load_recipe_model({});
    EditRecipe recipe;
    recipe.job.front = "0";
    recipe.request = request("a bear", "bear", "bear");
    recipe.request.views = 8;
    recipe.request.image_size = 64;
    recipe.request.edited_views = 4;
    EditJob search(recipe, EditJobInput{scene, {}, model}, JobControl{});
    search.locate();
    DOCTEST_REQUIRE(search.found());
    const auto bits = *search.located().label.bits;
    recipe.request.source = "gadget";
    recipe.request.prompt = "a blue gadget on the grass";
    recipe.request.target = "blue";
    apply_profile(profile_of(recipe.job), recipe, {});
    DOCTEST_CHECK(recipe.guidance.stand_in == "vase");
    const auto edited = [&](const std::string& stand_in) {
        recipe.guidance.stand_in = stand_in;
        EditJob job(recipe, EditJobInput{scene, {}, model, bits}, JobControl{});
        job.locate();
        job.run();
        DOCTEST_REQUIRE(!job.targets().empty());
        DOCTEST_CHECK(job.targets().front().sentence == (stand_in.empty() ? "" : "a blue vase on the grass"));
        DOCTEST_CHECK(job.result().changed_outside_label == 0);
        return blueness(job.result().set, job.result().label);
    };
    const double before = blueness(scene.gaussians, bits), own = edited(""), other = edited("vase");
    DOCTEST_CAPTURE(own);
    DOCTEST_CHECK(other > own);
    DOCTEST_CHECK(other > before + 0.3);   // of the range: plainly blue, which the bear is not
    recipe.guidance.stand_in = "gizmo";
    DOCTEST_CHECK_THROWS_AS(EditJob(recipe, EditJobInput{scene, {}, model, bits}, JobControl{}), Error);
}
