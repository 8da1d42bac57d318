// Words that the bundled model was not trained on, in sentences that it can follow without them.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <memory>
#include <string>
#include <vector>

#include "engine/edit/words.h"
#include "engine/io/scene_io.h"
#include "engine/math/sh.h"
#include "engine/pipeline/edit_job.h"
#include "engine/pipeline/installed.h"
#include "engine/pipeline/model_words.h"
#include "engine/pipeline/neural_loader.h"
#include "tests/test_paths.h"

namespace unknown_words_test {

namespace {

using namespace gse;
using namespace gse::pipeline;

EditRecipe recipe_of(const std::string& source, const std::string& prompt, const std::string& target) {
    EditRecipe recipe;
    recipe.job.front = "0";
    recipe.request.source = source;
    recipe.request.prompt = prompt;
    recipe.request.target = target;
    recipe.request.views = 8;
    recipe.request.image_size = 64;
    recipe.request.edited_views = 4;
    return recipe;
}

/// Base colours of the labelled splats, blue less the mean of the others.
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

DOCTEST_TEST_CASE("words that the model is not told take no room in what it reads") {
    if (neural_library().empty() || !test::available(starter_model_path() / "model_index.json")) return;
    const auto read = [](const std::vector<std::string>& words) { return words_read(starter_model_path(), words); };
    const auto long_sentence = edit::words_of("a wonderful magnificent extraordinary little bear wearing a blue hat on the grass");
    DOCTEST_CHECK(read(long_sentence) == long_sentence.size());
    std::vector<std::string> bears(40, "bear");
    const auto most = read(bears);
    DOCTEST_CHECK(most < bears.size());
    bears.insert(bears.begin(), "wonderful");
    DOCTEST_CHECK(read(bears) == most + 1);
}

DOCTEST_TEST_CASE("words that the model does not know change neither what is found nor what comes of it") {
    if (neural_library().empty() || !test::available(starter_model_path() / "model_index.json")) return;
    const auto scene = load_scene(assets_path() / "scenes/bear/scene.ply");
    const auto model = load_recipe_model({});
    std::vector<std::uint8_t> bits;
    double plain = 0;
    for (const auto* prompt : {"a blue bear on the grass", "a shiny blue bear on the soft grass"}) {
        EditJob job(recipe_of("bear", prompt, "blue"), EditJobInput{scene, {}, model}, JobControl{});
        job.locate();
        DOCTEST_REQUIRE(job.found());
        job.run();
        const double blue = blueness(job.result().set, job.result().label);
        if (bits.empty()) {
            bits = *job.located().label.bits;
            plain = blue;
            continue;
        }
        DOCTEST_CHECK(*job.located().label.bits == bits);
        DOCTEST_CHECK(blue == doctest::Approx(plain).epsilon(0.05));
    }
    // Where a label says where it is, a thing may have any name.
    EditJob named(recipe_of("gadget", "a blue gadget on the grass", "blue"), EditJobInput{scene, {}, model, bits}, JobControl{});
    named.locate();
    named.run();
    const double before = blueness(scene.gaussians, bits), after = blueness(named.result().set, named.result().label);
    DOCTEST_CAPTURE(before);
    DOCTEST_CHECK(after > before + 0.3);   // of the range: plainly blue, which the bear is not
    DOCTEST_CHECK(named.result().changed_outside_label == 0);
}

}  // namespace unknown_words_test
