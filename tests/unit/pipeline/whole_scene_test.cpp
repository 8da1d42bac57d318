// Edits of a whole scene: styles and weather, by models that are told any word.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <memory>
#include <string>

#include "engine/base/error.h"
#include "engine/edit/request/sentence_plan.h"
#include "engine/laboratory/synth/synth.h"
#include "engine/pipeline/run/edit_job.h"
#include "tests/unit/pipeline/open_model.h"

namespace whole_scene_test {

namespace {

using namespace gse;
using namespace gse::pipeline;

const language::plan::ModelAbility Open{true, {}};

EditRecipe recipe_for(const std::string& sentence) {
    EditRecipe recipe;
    recipe.request.source = "bear";
    recipe.request.prompt = sentence;
    recipe.request.views = 6;
    recipe.request.image_size = 64;
    recipe.request.edited_views = 6;
    const auto scene = language::plan::scene_words("red bear; grass");
    const auto steps = edit::planned_steps(edit::plan_of(recipe.request, scene), scene, Open);
    DOCTEST_REQUIRE(steps.size() == 1);
    DOCTEST_REQUIRE(steps.front().words);
    recipe.request = edit::request_of(recipe.request, *steps.front().words);
    return recipe;
}

synth::SynthScene red_bear() {
    synth::SceneSpec spec;
    spec.gaussian_budget = 2000;
    return synth::generate(spec);
}

double mean_light(const GaussianSet& set) {
    double sum = 0;
    const std::size_t stride = set.sh().size() / set.size();
    for (std::size_t row = 0; row < set.size(); ++row)
        for (std::size_t channel = 0; channel < 3; ++channel) sum += set.sh()[row * stride + channel];
    return sum / static_cast<double>(3 * set.size());
}

}  // namespace

DOCTEST_TEST_CASE("a style changes everything as the redrawn views say, and nothing is looked for") {
    const auto made = red_bear();
    const auto model = std::make_shared<open_model::OpenModel>();
    EditJob job(recipe_for("turn the scene into a van gogh painting"), EditJobInput{made.scene, {}, model},
                JobControl{});
    job.locate();
    DOCTEST_REQUIRE(job.found());
    DOCTEST_CHECK(model->asked.words.empty());
    const auto& bits = *job.located().label.bits;
    DOCTEST_CHECK(std::count(bits.begin(), bits.end(), std::uint8_t{1}) ==
                  static_cast<std::ptrdiff_t>(made.scene.gaussians.size()));
    job.run();
    DOCTEST_CHECK(model->asked.words.empty());
    DOCTEST_REQUIRE(!model->asked.prompts.empty());
    DOCTEST_CHECK(model->asked.prompts.front().find("in the style of") != std::string::npos);
    DOCTEST_CHECK(model->asked.masked == model->asked.pixels);
    DOCTEST_CHECK(model->asked.pixels > 0);
    DOCTEST_CHECK(mean_light(job.result().set) < mean_light(made.scene.gaussians));
    double darker = 0;
    const auto &before = made.scene.gaussians, &after = job.result().set;
    const std::size_t stride = before.sh().size() / before.size();
    for (std::size_t row = 0; row < before.size(); ++row) {
        const auto now = job.result().base_to_new[row];
        if (now < 0) continue;
        darker += after.sh()[static_cast<std::size_t>(now) * stride] <= before.sh()[row * stride] ? 1 : 0;
    }
    constexpr double Most = 0.9;  // of the splats: those that no view shows stay as they are
    DOCTEST_CHECK(darker > Most * static_cast<double>(before.size()));
}

DOCTEST_TEST_CASE("a model that edits by instructions is told what to do, not what is to be seen") {
    const auto made = red_bear();
    const auto model = std::make_shared<open_model::OpenModel>(neural::BundleKind::InstructPix2Pix);
    EditJob job(recipe_for("at night"), EditJobInput{made.scene, {}, model}, JobControl{});
    job.locate();
    job.run();
    DOCTEST_REQUIRE(!model->asked.prompts.empty());
    DOCTEST_CHECK(model->asked.prompts.front() == "make it night");
}

DOCTEST_TEST_CASE("a style of one thing changes that thing") {
    const auto made = red_bear();
    const auto model = std::make_shared<open_model::OpenModel>();
    EditJob job(recipe_for("make the bear look like a van gogh painting"),
                EditJobInput{made.scene, {}, model}, JobControl{});
    DOCTEST_CHECK(job.recipe().request.source() == "bear");
    DOCTEST_CHECK(!job.recipe().request.whole_scene());
    job.locate();
    DOCTEST_REQUIRE(job.found());
    const auto& bits = *job.located().label.bits;
    std::size_t grass = 0;
    for (std::size_t row = 0; row < bits.size(); ++row)
        grass += made.parts[row] == synth::Part::Ground ? bits[row] : 0;
    DOCTEST_CHECK(grass < bits.size() / 50);
    DOCTEST_CHECK(!model->asked.words.empty());
}

#ifdef GSE_NEURAL
DOCTEST_TEST_CASE("a model of few words refuses a whole scene, and says what would do it") {
    const auto made = red_bear();
    try {
        EditJob job(recipe_for("in winter"), EditJobInput{made.scene, {}, load_recipe_model({})},
                    JobControl{});
        DOCTEST_FAIL("the edit was not refused");
    } catch (const Error& error) {
        DOCTEST_CHECK(error.code() == ErrorCode::InvalidArgument);
        DOCTEST_CHECK(error.hint().find("Stable Diffusion") != std::string::npos);
    }
}
#endif

}  // namespace whole_scene_test
