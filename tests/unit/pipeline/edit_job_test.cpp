// Jobs that share one loaded model: what one of them teaches it, no other job sees.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <memory>

#include "engine/io/scene_io.h"
#include "engine/pipeline/edit_job.h"
#include "engine/pipeline/installed.h"

#ifdef GSE_NEURAL
namespace {

using namespace gse;
using namespace gse::pipeline;

EditRecipe bear_recipe(bool learns, std::uint64_t seed = 0) {
    EditRecipe recipe;
    recipe.request.source = "bear";
    recipe.request.prompt = "a red bear";
    recipe.request.target = "red";
    recipe.request.views = 2;
    recipe.use_dreambooth = learns;
    recipe.dreambooth.steps = 2;
    recipe.dreambooth.batch = 1;
    recipe.dreambooth.class_images = 0;
    recipe.dreambooth.seed = seed;
    return recipe;
}

std::unique_ptr<EditJob> job_on(const std::shared_ptr<neural::TextToImage>& model, const Scene& scene, bool learns,
                                std::uint64_t seed = 0) {
    auto job = std::make_unique<EditJob>(bear_recipe(learns, seed), EditJobInput{scene, {}, model}, JobControl{});
    if (learns) job->tune();
    return job;
}

std::vector<float> picture_of(neural::TextToImage& model) {
    neural::SampleRequest request;
    request.prompt = "a red bear";
    request.steps = 2;
    return model.sample(request).data;
}

}  // namespace

DOCTEST_TEST_CASE("edit job: a scene that one job learned is unknown to the next job on the same model") {
    const auto scene = load_scene(assets_path() / "scenes/bear/scene.ply");
    const auto model = load_recipe_model({});
    const auto untouched = picture_of(*model);
    auto learned = job_on(model, scene, true);
    const auto first = picture_of(learned->model());
    DOCTEST_CHECK(first != untouched);
    const auto plain = job_on(model, scene, false);
    DOCTEST_CHECK(picture_of(plain->model()) == untouched);
    auto other = job_on(model, scene, true, 1);
    const auto second = picture_of(other->model());
    DOCTEST_CHECK(second != first);
    DOCTEST_CHECK(picture_of(learned->model()) == first);
    const auto given = [&](bool learns) {   // what `learned` learned
        return EditJob(bear_recipe(learns), EditJobInput{scene, {}, model, {}, {}, learned->tuned()}, JobControl{});
    };
    auto heir = given(true), other_way = given(false);
    DOCTEST_CHECK(heir.tuning().has_value());
    DOCTEST_CHECK(picture_of(heir.model()) == first);
    DOCTEST_CHECK(!other_way.tuning().has_value());
    DOCTEST_CHECK(picture_of(other_way.model()) == untouched);
    learned.reset();   // the end of one tuning takes nothing from another
    DOCTEST_CHECK(picture_of(other->model()) == second);
    DOCTEST_CHECK(picture_of(plain->model()) == untouched);
}
#endif
