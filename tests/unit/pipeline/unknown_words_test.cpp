// Words that the bundled model was not trained on, in sentences that it can follow without them.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/io/project/load_scene.h"
#include "engine/language/words.h"
#include "engine/math/sh.h"
#include "engine/pipeline/models/installed.h"
#include "engine/pipeline/models/model_words.h"
#include "engine/pipeline/models/neural_loader.h"
#include "engine/pipeline/run/edit_job.h"
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
    const auto read = [](const std::vector<std::string>& words) {
        return words_read(starter_model_path(), words);
    };
    const auto long_sentence = language::words_of(
        "a wonderful magnificent extraordinary little bear wearing a blue hat on the grass");
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
    EditJob named(recipe_of("gadget", "a blue gadget on the grass", "blue"),
                  EditJobInput{scene, {}, model, bits}, JobControl{});
    named.locate();
    named.run();
    const double before = blueness(scene.gaussians, bits),
                 after = blueness(named.result().set, named.result().label);
    DOCTEST_CAPTURE(before);
    DOCTEST_CHECK(after > before + 0.3);  // of the range: plainly blue, which the bear is not
    DOCTEST_CHECK(named.result().changed_outside_label == 0);
}

DOCTEST_TEST_CASE(
    "a colour that the model has no word for comes out; dark eyes stay dark, and nothing outside changes") {
    if (neural_library().empty() || !test::available(starter_model_path() / "model_index.json")) return;
    const auto scene = load_scene(assets_path() / "scenes/bear/scene.ply");
    const auto model = load_recipe_model({});
    const auto colours_of = [](const GaussianSet& set) {
        std::vector<Vec3> colours;
        const std::size_t stride = set.sh().size() / set.size();
        for (std::size_t row = 0; row < set.size(); ++row) {
            const float* sh = &set.sh()[row * stride];
            colours.push_back({colour_from_sh(sh[0]), colour_from_sh(sh[1]), colour_from_sh(sh[2])});
        }
        return colours;
    };
    std::vector<std::uint8_t> label;
    for (const auto* word : {"dark pink", "striped"}) {
        EditJob job(recipe_of("bear", "a " + std::string(word) + " bear on the grass",
                              language::words_of(word).back()),
                    EditJobInput{scene, {}, model, label}, JobControl{});
        job.locate();
        DOCTEST_REQUIRE(job.found());
        if (label.empty()) label = *job.located().label.bits;
        std::vector<edit::EditSnapshot> snapshots;
        EditObserver observer;
        observer.snapshot = [&](edit::EditSnapshot snapshot) { snapshots.push_back(std::move(snapshot)); };
        job.run(observer);
        DOCTEST_CHECK(job.result().changed_outside_label == 0);
        DOCTEST_REQUIRE(!snapshots.empty());
        const auto shown = snapshots.back().materialise();  // striped, too
        std::size_t alike = 0;
        for (std::size_t i = 0; shown.size() == job.result().set.size() && i < shown.sh().size(); ++i)
            alike += std::abs(shown.sh()[i] - job.result().set.sh()[i]) < 0.5 ? 1 : 0;
        DOCTEST_CHECK(static_cast<double>(alike) > 0.95 * static_cast<double>(shown.sh().size()));
        const auto before = colours_of(scene.gaussians), after = colours_of(job.result().set);
        double red = 0, pink = 0, grey = 0, dark = 0, still_dark = 0;
        for (std::size_t row = 0; row < before.size(); ++row) {
            const auto now = job.result().base_to_new[row];
            if (now < 0 || job.result().label[static_cast<std::size_t>(now)] == 0) continue;
            const auto &b = before[row], &a = after[static_cast<std::size_t>(now)];
            if (std::max({b.x, b.y, b.z}) < 0.12)
                dark += 1, still_dark += std::max({a.x, a.y, a.z}) < 0.35 ? 1 : 0;
            if (b.x < 0.35 || b.x < 3 * std::max(b.y, b.z)) continue;
            red += 1;
            pink += a.x > a.z && a.z > a.y + 0.05 * a.x && a.y > 0.3 * a.x ? 1 : 0;
            grey += std::max({a.x, a.y, a.z}) - std::min({a.x, a.y, a.z}) < 0.15 ? 1 : 0;
        }
        DOCTEST_CAPTURE(word);
        DOCTEST_REQUIRE(red > 500);
        DOCTEST_REQUIRE(dark > 10);
        DOCTEST_CHECK(still_dark > 0.8 * dark);
        if (std::string(word) != "striped") DOCTEST_CHECK(pink > 0.8 * red);
        else DOCTEST_CHECK(grey > 0.8 * red);  // stripes are black and white
    }
}

DOCTEST_TEST_CASE(
    "a thing that the model only draws comes in its usual colour, and its encoder, which has no word for it, "
    "does not judge it") {
    if (neural_library().empty() || !test::available(starter_model_path() / "model_index.json")) return;
    const auto model = load_recipe_model({});
    const auto drawn = model->generated_vocabulary(), known = model->known_words();
    DOCTEST_REQUIRE(std::find(drawn.begin(), drawn.end(), "frog") != drawn.end());
    DOCTEST_CHECK(std::find(known.begin(), known.end(), "frog") == known.end());
    for (const auto& word : drawn) DOCTEST_CHECK(std::find(known.begin(), known.end(), word) == known.end());
    EditJob job(recipe_of("bear", "a frog on the grass", "frog"),
                EditJobInput{load_scene(assets_path() / "scenes/bear/scene.ply"), {}, model}, JobControl{});
    job.locate();
    DOCTEST_REQUIRE(job.found());
    std::vector<EditQuality> judged;
    EditObserver observer;
    observer.judged = [&](const EditQuality& verdict, const edit::ViewTargets&) {
        judged.push_back(verdict);
    };
    job.run(observer);
    DOCTEST_REQUIRE(judged.size() == 1);
    DOCTEST_CHECK_FALSE(judged.front().score.has_value());
    DOCTEST_CHECK(job.result().changed_outside_label == 0);
    const auto& set = job.result().set;
    const std::size_t stride = set.sh().size() / set.size();
    double green = 0, all = 0;
    for (std::size_t row = 0; row < set.size(); ++row) {
        if (job.result().label[row] == 0 || job.result().hole_fill[row] != 0)
            continue;  // not the ground that the bear hid
        const float* sh = &set.sh()[row * stride];
        all += 1, green += sh[1] > sh[0] && sh[1] > sh[2] ? 1 : 0;
    }
    DOCTEST_CHECK(all > 300);
    DOCTEST_CHECK(green > 0.7 * all);
    DOCTEST_CHECK_THROWS_AS(
        EditJob(recipe_of("frog", "a red frog on the grass", "red"),
                EditJobInput{load_scene(assets_path() / "scenes/bear/scene.ply"), {}, model}, JobControl{}),
        Error);
}

}  // namespace unknown_words_test
