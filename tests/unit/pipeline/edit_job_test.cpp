// Jobs that share one loaded model: what one of them teaches it, no other job sees.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "engine/io/project/load_scene.h"
#include "engine/laboratory/synth/without_ground.h"
#include "engine/pipeline/models/installed.h"
#include "engine/pipeline/run/edit_job.h"

namespace edit_job_test {

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

std::unique_ptr<EditJob> job_on(const std::shared_ptr<neural::TextToImage>& model, const Scene& scene,
                                bool learns, std::uint64_t seed = 0) {
    auto job =
        std::make_unique<EditJob>(bear_recipe(learns, seed), EditJobInput{scene, {}, model}, JobControl{});
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
    const auto given = [&](bool learns) {  // what `learned` learned
        return EditJob(bear_recipe(learns), EditJobInput{scene, {}, model, {}, {}, learned->tuned()},
                       JobControl{});
    };
    auto heir = given(true), other_way = given(false);
    DOCTEST_CHECK(heir.tuning().has_value());
    DOCTEST_CHECK(picture_of(heir.model()) == first);
    DOCTEST_CHECK(!other_way.tuning().has_value());
    DOCTEST_CHECK(picture_of(other_way.model()) == untouched);
    learned.reset();  // the end of one tuning takes nothing from another
    DOCTEST_CHECK(picture_of(other->model()) == second);
    DOCTEST_CHECK(picture_of(plain->model()) == untouched);
}

DOCTEST_TEST_CASE(
    "edit job: the word that is new is read off the scene, which is looked at from where the model knows "
    "it") {
    const auto model = load_recipe_model({});
    synth::SceneSpec spec;
    spec.object = "bear";
    spec.material = "red";
    spec.accessory = "hat";
    spec.ground = "snow";
    spec.seed = 5;
    const auto scene = synth::generate(spec);
    const auto read = [&](const char* source, const char* sentence,
                          const std::vector<std::string>& said = {}) {
        EditRecipe recipe;
        recipe.request.source = source;
        recipe.request.prompt = sentence;
        recipe.request.views = 6;
        EditJob job(recipe, EditJobInput{scene.scene, {}, model, {}, {}, {}, said}, JobControl{});
        const double fitted = length(job.views()[0].camera.centre());
        job.locate();
        DOCTEST_CHECK(job.target_read());
        DOCTEST_CHECK(job.found());
        DOCTEST_CHECK(length(job.views()[0].camera.centre()) <
                      0.6 * fitted);  // most of the fitted picture is ground
        return job.recipe().request.target();
    };
    DOCTEST_CHECK(read("bear", "a golden bear wearing a hat on the snow") == "golden");
    DOCTEST_CHECK(read("bear", "a red bear wearing a hat and a scarf on the snow") == "scarf");
    DOCTEST_CHECK(read("snow", "a red bear wearing a hat on the sand") == "sand");
    DOCTEST_CHECK(read("bear", "a red bear wearing a hat on the snow", {"a", "bear", "hat"}) == "red");
    // A word that an earlier edit brought along is no news, whether the model knows it or not.
    DOCTEST_CHECK(read("bear", "a golden shiny bear", {"a", "shiny", "red", "bear"}) == "golden");
}

DOCTEST_TEST_CASE(
    "edit job: what takes the place of a thing, or is worn, is drawn from where the starter learned to draw "
    "things") {
    // Share of the figure: what is nearer to the aim than a twentieth of the distance is not framed anew.
    constexpr double Near = 0.09;
    struct Case {
        std::string object, prompt;
        double height;
        edit::EditMode mode;
    };
    const auto model = load_recipe_model({});
    for (const auto& [object, prompt, height, mode] :
         {Case{"tree", "a red bear on the snow", 0.98, edit::EditMode::Replace},
          Case{"car", "a red bear on the snow", 0.97,
               edit::EditMode::Replace},  // low, but as wide as a figure is that high
          Case{"dog", "a blue dog wearing sunglasses on the snow", 0.98, edit::EditMode::Add}}) {
        DOCTEST_CAPTURE(object);
        synth::SceneSpec spec;
        spec.object = object;
        spec.material = "blue";
        spec.ground = "snow";
        spec.seed = 5;
        const auto scene = synth::generate(spec);
        EditRecipe recipe;
        recipe.request.source = object;
        recipe.request.prompt = prompt;
        recipe.request.views = 6;
        EditJob job(recipe, EditJobInput{scene.scene, {}, model}, JobControl{});
        job.locate();
        DOCTEST_REQUIRE(job.found());
        DOCTEST_REQUIRE(job.located().mode == mode);
        for (const auto& view : job.views()) {
            // synth::scene_camera() aims at 0.59 of a figure's height and sees 0.87 of it to either side of
            // there.
            const Vec3 aim = view.camera.to_camera({0, -0.59 * height, 0});
            DOCTEST_CHECK(std::abs(aim.x) < Near * height);
            DOCTEST_CHECK(std::abs(aim.y) < Near * height);
            DOCTEST_CHECK(0.5 * view.camera.width / view.camera.fx * aim.z ==
                          doctest::Approx(0.87 * height).epsilon(2 * Near));
        }
    }
}

DOCTEST_TEST_CASE(
    "edit job: what reaches beyond the pictures of the thing that wears it is looked for from farther off") {
    synth::SceneSpec spec;
    spec.object = "vase";  // its neck is of another colour: the label ends below it
    spec.material = "blue";
    spec.ground = "snow";
    spec.seed = 5;
    const auto scene = synth::generate(spec);
    EditRecipe recipe;
    recipe.request.source = "vase";
    recipe.request.prompt = "a blue vase wearing a hat on the snow";
    recipe.request.views = 6;
    EditJob job(recipe, EditJobInput{scene.scene, {}, load_recipe_model({})}, JobControl{});
    job.locate();
    DOCTEST_REQUIRE(job.found());
    int cut = 0;
    for (const auto& view : job.located().views) {
        int rim = 0;
        for (int x = 0; x < view.mask.width; ++x) rim += view.mask.at(x, 0) != 0 ? 1 : 0;
        cut += rim * 7 >= view.mask.width ? 1 : 0;  // a seventh of the picture's top
    }
    DOCTEST_CHECK(cut < 3);  // of 6
}

DOCTEST_TEST_CASE(
    "edit job: what is worn is found from as far as its wearer is known, and what wears it is no news") {
    synth::SceneSpec spec;
    spec.object = "bear";
    spec.material = "red";
    spec.accessory = "hat";
    spec.accessory_colour = "blue";
    spec.seed = 7;
    const auto scene = synth::generate(spec);
    EditRecipe recipe;
    // Fills the pictures where it is framed alone: there the network looks for one above it.
    recipe.request.source = "hat";
    recipe.request.prompt = "a bear wearing a green hat on the grass";
    EditJob job(recipe, EditJobInput{scene.scene, {}, load_recipe_model({})}, JobControl{});
    job.locate();
    DOCTEST_REQUIRE(job.found());
    DOCTEST_CHECK(job.located().mode == edit::EditMode::Modify);
    DOCTEST_CHECK(job.recipe().request.target() == "green");
    const auto& bits = *job.located().label.bits;
    DOCTEST_REQUIRE(bits.size() == scene.parts.size());
    std::size_t both = 0, either = 0;
    for (std::size_t row = 0; row < bits.size(); ++row) {
        const bool hat = scene.parts[row] == synth::Part::Accessory;
        both += hat && bits[row] != 0 ? 1 : 0;
        either += hat || bits[row] != 0 ? 1 : 0;
    }
    DOCTEST_CHECK(both * 10 >= either * 7);
    recipe.request.prompt = "a bear wearing a golden crown";
    EditJob other(recipe, EditJobInput{scene.scene, {}, load_recipe_model({})}, JobControl{});
    other.locate();
    DOCTEST_REQUIRE(other.found());
    DOCTEST_CHECK(other.located().mode == edit::EditMode::Replace);
    DOCTEST_CHECK(other.recipe().request.target() == "crown");
    DOCTEST_CHECK(other.located().confidence.value >= 0);  // it was looked for
}

DOCTEST_TEST_CASE(
    "edit job: a word finds all of a thing that was cut out of its surroundings, and shows the model a "
    "ground below it") {
    const auto model = load_recipe_model({});
    for (const std::string object : {"dog", "mushroom"}) {
        synth::SceneSpec spec;
        spec.object = object;
        spec.material = "red";
        spec.seed = 7;
        const auto made = synth::without_ground(synth::generate(spec));
        EditRecipe recipe;
        recipe.request.source = object;
        recipe.request.prompt = "a golden " + object + " on the grass";
        const auto search = [&](bool plain_ground) {
            recipe.guidance.plain_ground = plain_ground;
            auto job = std::make_unique<EditJob>(recipe, EditJobInput{made.scene, {}, model}, JobControl{});
            job->locate();
            return job;
        };
        const auto job = search(true);
        DOCTEST_REQUIRE(job->found());
        const auto& bits = *job->located().label.bits;
        DOCTEST_CHECK(std::count(bits.begin(), bits.end(), std::uint8_t{1}) * 10 >= std::ssize(bits) * 8);
        DOCTEST_CHECK(job->located().confidence.part("labelled_share") < 0.7);  // the ground is seen, too
        // Least blue of a corner: the sky's, or that of the background or of the thing from near by.
        const auto sky = [](const EditJob& of) {
            float least = 1;
            for (const auto& view : of.located().views) least = std::min(least, view.render.at(0, 0, 2));
            return least;
        };
        DOCTEST_CHECK(sky(*job) > 0.5f);
        DOCTEST_CHECK(sky(*search(false)) < 0.1f);
    }
    const auto whole = synth::generate({});
    RunContext context(whole.scene, model, {});
    context.look_for_ground(orbit_views({}, 4, 64, 64));
    DOCTEST_CHECK_FALSE(context.ground("a bear").has_value());
}

DOCTEST_TEST_CASE("the front is read off the scene where the recipe leaves it open") {
    auto recipe = check(bear_recipe(false));
    recipe.request.views = 8;
    RunContext context(load_scene(assets_path() / "scenes/bear/scene.ply"), load_recipe_model({}),
                       recipe.job);
    const auto found = [&](const std::string& front) {
        recipe.job.front = front;
        return locate(context, recipe, choose_views(context.scene(), recipe, {}), {}, {}).views;
    };
    const Views read = found("");
    DOCTEST_REQUIRE(read.front_read);
    DOCTEST_CHECK(std::abs(std::remainder(*read.front_read, 360 * Degree)) <
                  45 * Degree);  // the bear looks at the first view
    DOCTEST_CHECK(read.words.size() == read.views.size());
    const Views said = found("90");
    DOCTEST_CHECK(!said.front_read);
    DOCTEST_CHECK(said.words.size() == said.views.size());
    DOCTEST_CHECK(said.words != read.words);
    DOCTEST_CHECK(found("none").words.empty());
}

DOCTEST_TEST_CASE(
    "the side that the artist looks at is the front of what is searched for, where the pictures are not sure "
    "of one") {
    const auto model = load_recipe_model({});
    const auto front_of = [&](const std::string& object, const std::string& looked_from) {
        synth::SceneSpec spec;
        spec.object = object;
        spec.material = "red";
        spec.seed = 7;
        const auto made = synth::without_ground(synth::generate(spec));
        EditRecipe recipe;
        recipe.request.source = object;
        recipe.request.prompt = "a golden " + object;
        recipe.request.views = 6;
        recipe.job.looked_from = looked_from;
        EditJob job(recipe, EditJobInput{made.scene, {}, model}, JobControl{});
        job.locate();
        DOCTEST_CHECK(job.found());
        DOCTEST_REQUIRE(job.front_read());
        DOCTEST_CHECK(job.film_front() == *job.front_read());  // films and thumbnails begin there
        return *job.front_read() / Degree;
    };
    DOCTEST_CHECK(front_of("mushroom", "120") == doctest::Approx(120));  // round, and alike from all sides
    DOCTEST_CHECK(std::abs(front_of("mushroom", "") - 120) > 30);
    DOCTEST_CHECK(std::abs(front_of("house", "120")) < 45);
}

DOCTEST_TEST_CASE(
    "what is worn stays what it was found to be with its wearer around it, though from near by the model "
    "takes it for the wearer") {
    const auto model = load_recipe_model({});
    for (const std::uint64_t seed : {7, 8}) {
        synth::SceneSpec spec;
        spec.object = "dog";
        spec.material = "stone";
        spec.accessory = "hat";
        spec.accessory_colour = "red";
        spec.seed = seed;
        const auto made = synth::without_ground(synth::generate(spec));
        EditRecipe recipe;
        recipe.request.source = "hat";
        recipe.request.prompt = "a stone dog wearing a golden crown";
        EditJob job(recipe, EditJobInput{made.scene, {}, model}, JobControl{});
        job.locate();
        DOCTEST_REQUIRE(job.found());
        double both = 0, either = 0;
        for (std::size_t row = 0; row < made.parts.size(); ++row) {
            const bool hat = made.parts[row] == synth::Part::Accessory,
                       labelled = (*job.located().label.bits)[row] != 0;
            both += hat && labelled ? 1 : 0;
            either += hat || labelled ? 1 : 0;
        }
        DOCTEST_CHECK(both > 0.8 * either);
    }
}

DOCTEST_TEST_CASE(
    "what takes the place of something worn is drawn on its wearer, from where that is seen as a figure") {
    constexpr double Near = 0.09;  // as for things that are framed themselves
    const auto model = load_recipe_model({});
    synth::SceneSpec spec;
    spec.object = "bear";
    spec.material = "blue";
    spec.accessory = "hat";
    spec.seed = 5;
    const auto whole = synth::generate(spec);
    for (const auto& made : {synth::without_ground(whole), whole}) {
        std::vector<std::uint8_t> hat;
        double top = 0;
        for (std::size_t row = 0; row < made.parts.size(); ++row) {
            hat.push_back(made.parts[row] == synth::Part::Accessory ? 1 : 0);
            if (made.parts[row] == synth::Part::Object)
                top = std::max(top, -double{made.scene.gaussians.position()[row * 3 + 1]});
        }
        EditRecipe recipe;
        recipe.request.source = "hat";
        recipe.request.prompt = "a blue bear wearing a crown on the grass";
        recipe.request.views = 6;
        recipe.job.use_label = true;
        EditJob job(recipe, EditJobInput{made.scene, {}, model, hat}, JobControl{});
        job.locate();
        DOCTEST_REQUIRE(job.found());
        DOCTEST_CHECK(job.located().mode == edit::EditMode::Replace);
        for (const auto& view : job.views()) {
            const Vec3 aim = view.camera.to_camera({0, -0.59 * top, 0});
            DOCTEST_CHECK(std::abs(aim.y) < Near * top);
            DOCTEST_CHECK(0.5 * view.camera.width / view.camera.fx * aim.z ==
                          doctest::Approx(0.87 * top).epsilon(2 * Near));
        }
    }
}

DOCTEST_TEST_CASE("what is worn elsewhere than what it takes the place of goes there, and that goes") {
    synth::SceneSpec spec;
    spec.object = "bear";
    spec.material = "blue";
    spec.accessory = "hat";
    spec.seed = 5;
    const auto made = synth::generate(spec);
    EditRecipe recipe;
    recipe.request.source = "hat";
    recipe.request.prompt = "a blue bear wearing a yellow scarf on the grass";
    recipe.job.use_label = true;
    std::vector<std::uint8_t> hat;
    double brim = 0;  // height of the hat's lowest splat
    for (std::size_t row = 0; row < made.parts.size(); ++row) {
        hat.push_back(made.parts[row] == synth::Part::Accessory ? 1 : 0);
        const double height = -made.scene.gaussians.position()[row * 3 + 1];
        if (hat.back() != 0) brim = brim == 0 ? height : std::min(brim, height);
    }
    EditJob job(recipe, EditJobInput{made.scene, {}, load_recipe_model({}), hat}, JobControl{});
    job.locate();
    DOCTEST_REQUIRE(job.found());
    DOCTEST_CHECK(!job.located().room.empty());
    job.run();
    const auto& result = job.result();
    double seen = 0, below = 0;
    for (std::size_t row = 0; row < result.set.size(); ++row) {
        if (result.label[row] == 0 || !(result.set.opacity_logit()[row] > 0)) continue;
        seen += 1;
        below += -result.set.position()[row * 3 + 1] < brim ? 1 : 0;
    }
    DOCTEST_CHECK(seen > 100);
    DOCTEST_CHECK(below > 0.95 * seen);
}

DOCTEST_TEST_CASE(
    "a label that is not what the words find is looked at itself; one that is a part of it corrects what "
    "they find") {
    const auto model = load_recipe_model({});
    synth::SceneSpec spec;
    spec.object = "bear";
    spec.material = "blue";
    spec.accessory = "hat";
    spec.seed = 5;
    const auto made = synth::generate(spec);
    const auto locate_with = [&](synth::Part part, double share) {
        std::vector<std::uint8_t> label(made.parts.size());
        for (std::size_t row = 0; row < label.size(); ++row)
            label[row] = made.parts[row] == part && static_cast<double>(row % 10) < 10 * share ? 1 : 0;
        EditRecipe recipe;
        recipe.request.source = "bear";
        recipe.request.prompt = "a golden bear wearing a hat on the grass";
        recipe.request.views = 6;
        EditJob job(recipe, EditJobInput{made.scene, {}, model, label}, JobControl{});
        job.locate();
        DOCTEST_REQUIRE(job.found());
        return *job.located().label.bits == label;
    };
    DOCTEST_CHECK(locate_with(synth::Part::Accessory, 1));  // the words find the bear without its hat
    DOCTEST_CHECK_FALSE(locate_with(synth::Part::Object, 0.5));
}

DOCTEST_TEST_CASE("stages: each is a value that names what it follows from, and only that") {
    EditRecipe written = bear_recipe(false);
    written.request.prompt = "a blue bear on the grass";
    written.request.target = "blue";
    written.request.views = 6;
    written.request.iterations = 3;
    const auto recipe = check(written);
    RunContext context(load_scene(assets_path() / "scenes/bear/scene.ply"), load_recipe_model({}),
                       recipe.job);
    const Views views = choose_views(context.scene(), recipe, {});
    DOCTEST_CHECK(choose_views(context.scene(), recipe, {}).key == views.key);
    auto turned = recipe;
    turned.job.front = "90";
    DOCTEST_CHECK(choose_views(context.scene(), turned, {}).key != views.key);  // the views have words now
    DOCTEST_CHECK(views_on(nearer(views.orbit, 0.7), recipe).key != views.key);

    const Located located = locate(context, recipe, views, {}, {});
    const auto bits = *located.result.label.bits;
    DOCTEST_REQUIRE_MESSAGE(located.found(), located.result.message);
    const auto asked = context.questions();
    auto stricter = located.recipe;
    stricter.request.attention_threshold = context.stated_threshold() + 0.2;
    const Located again = locate_again(context, located, stricter, {});
    DOCTEST_CHECK(context.questions() == asked);  // no network is asked for a threshold
    DOCTEST_CHECK(again.key != located.key);
    DOCTEST_CHECK(*again.result.label.bits != bits);
    DOCTEST_CHECK(*located.result.label.bits == bits);  // a value stays what it is
    DOCTEST_CHECK(locate_again(context, again, located.recipe, {}).key == located.key);
    DOCTEST_CHECK(with_label(located, std::vector<std::uint8_t>(bits.size(), 1)).key != located.key);
    Located doubtful = located;
    doubtful.label_doubt = "look at it";
    DOCTEST_CHECK(with_label(doubtful, bits).label_doubt.empty());  // who corrects it has looked

    const auto plan = plan_of(context, located, recipe);
    const Edited edited = edit_scene(context, located, plan, recipe, {}, {});
    DOCTEST_CHECK(edit_scene(context, located, plan, recipe, {}, {}).key == edited.key);
    auto slower = recipe;
    slower.request.rate_colour = 0.5 * slower.request.rate_colour;
    const Edited other = edit_scene(context, located, plan, slower, {}, {});
    DOCTEST_CHECK(other.key != edited.key);
    DOCTEST_CHECK(!std::equal(other.result.set.sh().begin(), other.result.set.sh().end(),
                              edited.result.set.sh().begin()));
}
#endif

}  // namespace edit_job_test
