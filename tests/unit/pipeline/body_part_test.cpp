// Parts of things: told by the thing's shape, or looked for within it.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/edit/placement/body_part.h"
#include "engine/laboratory/synth/head_rows.h"
#include "engine/pipeline/run/edit_job.h"
#include "tests/unit/pipeline/open_model.h"

namespace body_part_test {

namespace {

using namespace gse;
using namespace gse::pipeline;
using Bits = std::vector<std::uint8_t>;

const Vec3 Up{0, -1, 0};
constexpr double SameHead = 0.85;  // IoU; where a neck ends is a matter of a slice or two

double iou(const Bits& a, const Bits& b) {
    double both = 0, either = 0;
    for (std::size_t i = 0; i < a.size(); ++i) both += a[i] & b[i], either += a[i] | b[i];
    return either > 0 ? both / either : 0;
}

bool is_empty(const Bits& bits) { return std::find(bits.begin(), bits.end(), std::uint8_t{1}) == bits.end(); }

Bits object_rows(const synth::SynthScene& made) {
    Bits bits;
    for (const auto part : made.parts) bits.push_back(part == synth::Part::Object ? 1 : 0);
    return bits;
}

synth::SynthScene figure(const std::string& object, std::uint64_t seed, const std::string& material = "red") {
    synth::SceneSpec spec;
    spec.object = object;
    spec.material = material;
    spec.seed = seed;
    return synth::generate(spec);
}

EditRecipe part_recipe(const std::string& part, const std::string& prompt, const std::string& look) {
    EditRecipe recipe;
    recipe.job.front = "0";
    recipe.request.source = part;
    recipe.request.part_of = "bear";
    recipe.request.prompt = prompt;
    recipe.request.target = look;
    recipe.request.mode = "modify";
    recipe.request.views = 8;
    recipe.request.image_size = 64;
    recipe.request.edited_views = 4;
    return recipe;
}

}  // namespace

DOCTEST_TEST_CASE("a head that the shape tells is the head; a figure without a neck has none") {
    std::set<std::string> found;
    for (const std::string object :
         {"bear", "dog", "cat", "duck", "statue", "rabbit", "horse", "elephant", "pig", "lion", "penguin",
          "owl", "frog", "turtle", "dinosaur", "snowman", "robot"})
        for (std::uint64_t seed = 700; seed < 708; ++seed) {
            DOCTEST_CAPTURE(object);
            DOCTEST_CAPTURE(seed);
            const auto made = figure(object, seed);
            const auto head = edit::labelled_part("head", made.scene.gaussians, object_rows(made), Up);
            if (is_empty(head)) continue;
            found.insert(object);
            DOCTEST_CHECK(iou(head, synth::head_rows(made)) > SameHead);
        }
    for (const std::string object :
         {"bear", "cat", "duck", "statue", "lion", "penguin", "dinosaur", "snowman", "robot"}) {
        DOCTEST_CAPTURE(object);
        DOCTEST_CHECK(found.contains(object));
    }
    DOCTEST_CHECK(!found.contains("dog"));
}

DOCTEST_TEST_CASE("two halves are the thing, one above the other") {
    const auto made = figure("bear", 700);
    const auto& set = made.scene.gaussians;
    const auto thing = object_rows(made);
    const auto upper = edit::labelled_part("upper half", set, thing, Up),
               lower = edit::labelled_part("bottom half", set, thing, Up);
    float lowest = -1e9f, highest = 1e9f;  // of the upper half, of the lower half; y is down
    for (std::size_t row = 0; row < thing.size(); ++row) {
        DOCTEST_REQUIRE(upper[row] + lower[row] == thing[row]);
        const float y = set.position()[row * 3 + 1];
        if (upper[row] != 0) lowest = std::max(lowest, y);
        if (lower[row] != 0) highest = std::min(highest, y);
    }
    DOCTEST_CHECK(lowest <= highest);
    DOCTEST_CHECK(is_empty(edit::labelled_part("elbow", set, thing, Up)));
    DOCTEST_CHECK(!edit::is_told_by_shape("elbow"));
}

DOCTEST_TEST_CASE("a part is looked for within its thing, and nothing else is labelled") {
    const auto made = figure("bear", 700);
    const auto model = std::make_shared<open_model::OpenModel>();
    const auto thing = object_rows(made);
    EditJob job(part_recipe("ears", "a bear with blue ears on the grass", "blue"),
                EditJobInput{made.scene, {}, model}, JobControl{});
    job.locate();
    DOCTEST_REQUIRE(job.found());
    const auto& words = model->asked.words;
    DOCTEST_CHECK(std::find(words.begin(), words.end(), "bear") != words.end());
    DOCTEST_CHECK(std::find(words.begin(), words.end(), "ears") != words.end());
    const auto& bits = *job.located().label.bits;
    std::size_t labelled = 0, beside = 0;
    for (std::size_t row = 0; row < bits.size(); ++row) {
        labelled += bits[row];
        beside += bits[row] != 0 && thing[row] == 0 ? 1 : 0;
    }
    DOCTEST_CHECK(labelled > 0);
    DOCTEST_CHECK(beside < labelled / 20);  // splats of grass that touch the bear
    DOCTEST_CHECK(labelled < static_cast<std::size_t>(std::count(thing.begin(), thing.end(), 1)));
}

#ifdef GSE_NEURAL
DOCTEST_TEST_CASE("the bundled model changes a head that it has no word for, and nothing of the body") {
    const auto made = figure("bear", 700);
    const auto model = load_recipe_model({});
    auto recipe = part_recipe("head", "a bear with a blue head on the grass", "blue");
    recipe.request.views = 12;
    recipe.request.image_size = 96;
    EditJob job(recipe, EditJobInput{made.scene, {}, model}, JobControl{});
    job.locate();
    DOCTEST_REQUIRE(job.found());
    const auto head = *job.located().label.bits;
    DOCTEST_CHECK(iou(head, synth::head_rows(made)) > SameHead);
    job.run();
    const auto &before = made.scene.gaussians, &after = job.result().set;
    const std::size_t stride = before.sh().size() / before.size();
    double bluer = 0;
    for (std::size_t row = 0; row < before.size(); ++row) {
        const auto now = job.result().base_to_new[row];
        if (now < 0) {
            DOCTEST_REQUIRE(head[row] != 0);
            continue;
        }
        const float *old = &before.sh()[row * stride],
                    *changed = &after.sh()[static_cast<std::size_t>(now) * stride];
        if (head[row] == 0) DOCTEST_REQUIRE(std::equal(old, old + stride, changed));
        else bluer += (changed[2] - changed[0]) - (old[2] - old[0]);
    }
    DOCTEST_CHECK(bluer > 0);
}

DOCTEST_TEST_CASE("a head that the shape tells is resized, and nothing of the body changes") {
    const auto made = figure("bear", 700);
    auto recipe = part_recipe("head", "scale the head of the bear 2", "head");
    recipe.request.mode = "transform";
    recipe.request.change = "scale 2";
    EditJob job(recipe, EditJobInput{made.scene, {}, load_recipe_model({})}, JobControl{});
    job.locate();
    DOCTEST_REQUIRE(job.found());
    DOCTEST_CHECK(job.located().mode == edit::EditMode::Transform);
    job.run();
    const auto &before = made.scene.gaussians, &after = job.result().set;
    const auto& head = *job.located().label.bits;
    constexpr double Rounding = 1e-5;  // of logarithms of a size, kept as float
    for (std::size_t row = 0; row < head.size(); ++row) {
        const auto now = job.result().base_to_new[row];
        DOCTEST_REQUIRE(now >= 0);
        const double grown =
            after.log_scale()[static_cast<std::size_t>(now) * 3] - before.log_scale()[row * 3];
        DOCTEST_REQUIRE(std::abs(grown - (head[row] != 0 ? std::log(2.0) : 0)) < Rounding);
    }
}

DOCTEST_TEST_CASE(
    "a part without a word or a shape is refused before anything runs; a missing one is not found") {
    const auto model = load_recipe_model({});
    const auto made = figure("dog", 700);
    auto ears = part_recipe("ears", "a dog with blue ears", "blue");
    ears.request.part_of = "dog";
    try {
        EditJob job(ears, EditJobInput{made.scene, {}, model}, JobControl{});
        DOCTEST_FAIL("the part was not refused");
    } catch (const Error& error) {
        DOCTEST_CHECK(error.code() == ErrorCode::InvalidArgument);
        DOCTEST_CHECK(error.message().find("no word for the part \"ears\"") != std::string::npos);
        DOCTEST_CHECK(error.hint().find("by hand") != std::string::npos);
    }
    auto head = part_recipe("head", "a dog with a blue head", "blue");
    head.request.part_of = "dog";
    EditJob job(head, EditJobInput{made.scene, {}, model}, JobControl{});
    job.locate();
    DOCTEST_CHECK(!job.found());
    DOCTEST_CHECK(is_empty(*job.located().label.bits));
    DOCTEST_CHECK(job.located().message.find("head") != std::string::npos);
}
#endif

}  // namespace body_part_test
