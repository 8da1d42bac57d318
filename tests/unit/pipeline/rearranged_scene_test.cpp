// Things of which the scene has a label: found by its name, turned and copied with the shadow that they have.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/laboratory/synth/synth.h"
#include "engine/pipeline/models/installed.h"
#include "engine/pipeline/models/neural_loader.h"
#include "engine/pipeline/run/edit_job.h"
#include "engine/pipeline/scene/label_names.h"
#include "engine/scene/delta.h"
#include "tests/test_paths.h"

namespace rearranged_scene_test {

namespace {

using namespace gse;
using namespace gse::pipeline;

constexpr const char* Name = "Gizmo";  // no word of the model

/// A bear on sand, labelled by a name that the model does not know.
Scene labelled_scene() {
    synth::SceneSpec spec;
    spec.object = "bear";
    spec.material = "red";
    spec.seed = 700;
    auto made = synth::generate(spec);
    std::vector<float> weight;
    for (const auto part : made.parts) weight.push_back(part == synth::Part::Object ? 1.0f : 0.0f);
    made.scene.labels.labels = {make_label(Name, std::move(weight), 0.5f)};
    return made.scene;
}

EditRecipe recipe_of(const std::string& change, const std::string& anchor = {}) {
    EditRecipe recipe;
    recipe.job.front = "0";
    recipe.request.source = "gizmo";
    recipe.request.prompt = change == "remove" ? "remove the gizmo" : change + " the gizmo";
    recipe.request.mode = change == "remove" ? "remove" : "transform";
    if (change != "remove") recipe.request.change = change;
    recipe.request.anchor = anchor;
    recipe.request.views = 8;
    recipe.request.image_size = 64;
    return recipe;
}

std::unique_ptr<EditJob> run(const Scene& scene, const EditRecipe& recipe) {
    auto job =
        std::make_unique<EditJob>(recipe, EditJobInput{scene, {}, load_recipe_model({})}, JobControl{});
    job->locate();
    DOCTEST_REQUIRE(job->found());
    job->run();
    return job;
}

bool has_model() {
    return !neural_library().empty() && test::available(starter_model_path() / "model_index.json");
}

/// Rows of the scene that the label does not mark and that are gone.
std::size_t replaced(const EditJob& job) {
    const auto& bits = *job.scene().labels.labels[0].bits;
    std::size_t count = 0;
    for (std::size_t row = 0; row < bits.size(); ++row)
        count += bits[row] == 0 && job.result().base_to_new[row] < 0 ? 1 : 0;
    return count;
}

}  // namespace

DOCTEST_TEST_CASE("labels are found by their names, whatever the case, and follow their rows") {
    const Scene scene = labelled_scene();
    DOCTEST_CHECK(label_named(scene.labels, "gizmo") == &scene.labels.labels[0]);
    DOCTEST_CHECK(label_named(scene.labels, "bear") == nullptr);
    DOCTEST_CHECK(label_named(scene.labels, "") == nullptr);
    DOCTEST_CHECK(label_names(scene.labels) == std::vector<std::string>{"gizmo"});
    DOCTEST_CHECK(label_for(scene.labels, "gizmo", {"bear"}) == &scene.labels.labels[0]);
    DOCTEST_CHECK(label_for(scene.labels, "gizmo", {"bear", "gizmo"}) == nullptr);
    const auto& bits = *scene.labels.labels[0].bits;
    const auto thing = std::find(bits.begin(), bits.end(), std::uint8_t{1}) - bits.begin();
    const std::vector<std::int64_t> sources{-1, thing, 0};
    const auto moved = gathered(scene.labels, sources);
    DOCTEST_CHECK(*moved.labels[0].bits == std::vector<std::uint8_t>{0, 1, bits[0]});
    DOCTEST_CHECK(label_names(gathered(scene.labels, std::vector<std::int64_t>{-1})).empty());
    LabelSet files = scene.labels;
    files.labels[0].name = "object_guitar";
    DOCTEST_CHECK(label_named(files, "guitar") == &files.labels[0]);
    DOCTEST_CHECK(label_named(files, "object") == nullptr);
    DOCTEST_CHECK(label_names(files) == std::vector<std::string>{"object guitar", "guitar"});
}

DOCTEST_TEST_CASE("the name of a label is a word of the scene: what it marks is removed, and nothing else") {
    if (!has_model()) return;
    const Scene scene = labelled_scene();
    const auto job = run(scene, recipe_of("remove"));
    const auto& bits = *scene.labels.labels[0].bits;
    for (std::size_t row = 0; row < bits.size(); ++row)
        if (bits[row] != 0) DOCTEST_REQUIRE(job->result().base_to_new[row] < 0);
    DOCTEST_CHECK(job->result().changed_outside_label == 0);
    Scene unlabelled = scene;
    unlabelled.labels = {};
    DOCTEST_CHECK_THROWS_AS(run(unlabelled, recipe_of("remove")), Error);
}

DOCTEST_TEST_CASE("a thing that is turned where it stands leaves the ground and its shadow as they are") {
    if (!has_model()) return;
    const auto job = run(labelled_scene(), recipe_of("rotate 90"));
    DOCTEST_CHECK(replaced(*job) == 0);
    DOCTEST_CHECK(job->result().changed_outside_label == 0);
}

DOCTEST_TEST_CASE("a copy has a shadow of its own: the ground there is darker, and none of it is missing") {
    if (!has_model()) return;
    auto recipe = recipe_of("rotate 90");
    recipe.request.change.clear();
    recipe.request.copies = 2;
    const auto job = run(labelled_scene(), recipe);
    const auto& result = job->result();
    const auto& base = job->scene().gaussians;
    DOCTEST_REQUIRE(replaced(*job) > 0);
    double before = 0, after = 0;
    std::size_t darker = 0;
    const auto stride = base.sh().size() / base.size();
    for (std::size_t row = 0; row < base.size(); ++row)
        if (result.base_to_new[row] < 0) before += base.sh()[row * stride];
    for (std::size_t row = 0; row < result.set.size(); ++row)
        if (result.hole_fill[row] != 0) after += result.set.sh()[row * stride], ++darker;
    DOCTEST_CHECK(darker == replaced(*job));
    DOCTEST_CHECK(after < before);
    DOCTEST_CHECK(result.changed_outside_label == 0);
}

}  // namespace rearranged_scene_test
