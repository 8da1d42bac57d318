// Sentences as plans of edits: what one edit can do, in which words, and what is refused.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <string>
#include <tuple>
#include <utility>

#include "engine/base/error.h"
#include "engine/edit/request/sentence_plan.h"
#include "engine/language/plan/plan_text.h"

namespace sentence_plan_test {

using namespace gse;
namespace plan = language::plan;

namespace {

edit::EditRequest request(const std::string& prompt, const std::string& source = "bear") {
    edit::EditRequest result;
    result.prompt = prompt;
    result.source = source;
    return result;
}

std::string refused(const edit::EditRequest& wanted) {
    try {
        edit::check(wanted);
    } catch (const Error& error) {
        DOCTEST_CHECK(error.code() == ErrorCode::InvalidArgument);
        DOCTEST_CHECK(!error.hint().empty());
        return error.message();
    }
    return {};
}

}  // namespace

DOCTEST_TEST_CASE("a description with one change is told as it is typed") {
    for (const std::string prompt :
         {"a golden bear on the grass", "a blue bear", "a bear wearing a red hat on the grass",
          "a red cat on the grass", "a bear made of stone", "a bear in flames", "a pink spotted bear",
          "a bear with a ball beside it"}) {
        DOCTEST_CAPTURE(prompt);
        const auto checked = edit::check(request(prompt));
        DOCTEST_CHECK(checked.prompt() == prompt);
        DOCTEST_CHECK(checked.target_open());
    }
    const auto ground = edit::check(request("a bear on the snow", "grass"));
    DOCTEST_CHECK(ground.prompt() == "a bear on the snow");
    DOCTEST_CHECK(ground.target() == "snow");
}

DOCTEST_TEST_CASE("an order becomes the description of the scene after it") {
    const auto hat = edit::check(request("give it a red hat"));
    DOCTEST_CHECK(hat.prompt() == "a bear wearing a red hat");
    DOCTEST_CHECK(hat.target() == "hat");
    DOCTEST_CHECK(hat.mode == edit::EditMode::Add);
    const auto cat = edit::check(request("swap the bear for a black cat"));
    DOCTEST_CHECK(cat.sentence().replacement() == "cat");
    DOCTEST_CHECK(cat.mode == edit::EditMode::Replace);
    const auto blue = edit::check(request("could you please paint it blue?"));
    DOCTEST_CHECK(blue.source() == "bear");
    DOCTEST_CHECK(blue.target() == "blue");
    DOCTEST_CHECK(language::decide_mode(blue.sentence(), blue.mode).first == edit::EditMode::Modify);
}

DOCTEST_TEST_CASE("what no edit does is refused in words, and not done otherwise") {
    DOCTEST_CHECK(!refused(request("don't touch the bear")).empty());
    DOCTEST_CHECK(refused(request("mach den Bären blau")).find("English") != std::string::npos);
    DOCTEST_CHECK(!refused(request("undo the last change")).empty());
    DOCTEST_CHECK(refused(request("paint the bear blue and give it a hat")).find("2 changes") !=
                  std::string::npos);
}

DOCTEST_TEST_CASE("an order about where a thing is becomes an edit in which nothing is drawn") {
    const auto gone = edit::check(request("remove the bear"));
    DOCTEST_CHECK(gone.mode == edit::EditMode::Remove);
    DOCTEST_CHECK(gone.is_rearranged());
    DOCTEST_CHECK(gone.prompt() == "remove the bear");
    DOCTEST_CHECK(gone.source() == "bear");
    DOCTEST_CHECK(gone.sentence().prompt() == "a bear");  // models are told the scene as it is
    const auto bigger = edit::check(request("make the bear bigger"));
    DOCTEST_CHECK(bigger.mode == edit::EditMode::Transform);
    DOCTEST_CHECK(bigger.change == "bigger");
    DOCTEST_CHECK(bigger.prompt() == "make the bear bigger");
    const auto again = edit::check(bigger.plain());  // as a recipe has it
    DOCTEST_CHECK(again.words().prompt == bigger.words().prompt);
    DOCTEST_CHECK(again.sentence().prompt() == bigger.sentence().prompt());
    DOCTEST_CHECK(again.mode == bigger.mode);
}

DOCTEST_TEST_CASE("a ground is looked for beneath what stands on it, and is not called anything else") {
    const auto scene = plan::scene_words("red bear; blue hat; grass");
    const auto steps = edit::planned_steps(edit::plan_of(request("remove the grass"), scene), scene);
    DOCTEST_REQUIRE(steps.size() == 1);
    DOCTEST_REQUIRE(steps[0].words);
    DOCTEST_CHECK(steps[0].words->source == "grass");
    DOCTEST_CHECK(steps[0].words->description == "a red bear on the grass");
    const auto alone = plan::scene_words("grass");
    const auto only = edit::planned_steps(edit::plan_of(request("remove the grass", "grass"), alone), alone);
    DOCTEST_REQUIRE(only.size() == 1);
    DOCTEST_REQUIRE(only[0].words);
    DOCTEST_CHECK(only[0].words->description == "grass");
}

DOCTEST_TEST_CASE("what is worn is looked for by itself, and goes with its wearer") {
    const auto scene = plan::scene_words("red bear; blue hat; grass");
    const auto steps = edit::planned_steps(edit::plan_of(request("remove the hat"), scene), scene);
    DOCTEST_REQUIRE(steps.size() == 1);
    DOCTEST_REQUIRE(steps[0].words);
    DOCTEST_CHECK(steps[0].words->mode == edit::EditMode::Remove);
    DOCTEST_CHECK(steps[0].words->source == "hat");
    DOCTEST_CHECK(steps[0].words->description == "a blue hat");
    const auto checked = edit::check(edit::request_of(request("remove the hat"), *steps[0].words));
    DOCTEST_CHECK(checked.sentence().prompt() == "a blue hat");
    const auto rest = plan::after({plan::Operation::Remove, {{{"bear", "", {}}}, false}}, scene);
    DOCTEST_REQUIRE(rest.things.size() == 1);
    DOCTEST_CHECK(rest.things[0].noun == "grass");
}

DOCTEST_TEST_CASE("a description of a thing without the source takes the source away") {
    for (const auto& [prompt, source] :
         {std::pair{"a house without balloons", "balloons"}, std::pair{"a bear without a hat", "hat"},
          std::pair{"the house with no balloons", "balloons"}}) {
        const std::string typed = prompt;
        DOCTEST_CAPTURE(typed);
        const auto checked = edit::check(request(typed, source));
        DOCTEST_CHECK(checked.mode == edit::EditMode::Remove);
        DOCTEST_CHECK(checked.source() == source);
    }
}

DOCTEST_TEST_CASE("a new look of what carries a thing leaves the thing as it is") {
    for (const auto& [prompt, source] :
         {std::pair{"a statue on a white pedestal", "pedestal"},
          std::pair{"a guitar on a golden stand", "stand"}, std::pair{"a plant in a red pot", "pot"}}) {
        const std::string typed = prompt;
        DOCTEST_CAPTURE(typed);
        const auto wanted = request(typed, source);
        const auto steps = edit::planned_steps(edit::plan_of(wanted, edit::assumed_scene(wanted)),
                                               edit::assumed_scene(wanted));
        DOCTEST_REQUIRE(steps.size() == 1);
        DOCTEST_CHECK(plan::changes_look(steps[0].step.operation));
        DOCTEST_CHECK(steps[0].step.subject.root() == source);
        DOCTEST_REQUIRE(steps[0].words);
        DOCTEST_CHECK(steps[0].words->mode == edit::EditMode::Modify);
        const auto checked = edit::check(wanted);
        DOCTEST_CHECK_FALSE(checked.target_open());
        DOCTEST_CHECK(language::decide_mode(checked.sentence(), checked.mode).first ==
                      edit::EditMode::Modify);
    }
    const auto added = request("a cactus in a pot", "pot");
    DOCTEST_CHECK(edit::assumed_scene(added).things.size() == 1);
}

DOCTEST_TEST_CASE("a new look of what a thing wears, holds or has is no wish for that thing") {
    for (const auto& [prompt, source] :
         {std::pair{"a bear wearing a red hat", "hat"}, std::pair{"a man holding a white helmet", "helmet"},
          std::pair{"a bulldozer with a green bucket", "bucket"},
          std::pair{"the bear wears a red hat", "hat"}, std::pair{"a cat in a blue scarf", "scarf"},
          std::pair{"a kitchen with a red oven", "oven"}, std::pair{"a vase with red flowers", "flowers"},
          std::pair{"a man wearing black shoes", "shoes"}, std::pair{"a car with red wheels", "wheels"}}) {
        const std::string typed = prompt;
        DOCTEST_CAPTURE(typed);
        const auto wanted = request(typed, source);
        const auto scene = edit::assumed_scene(wanted);
        const auto steps = edit::planned_steps(edit::plan_of(wanted, scene), scene);
        DOCTEST_REQUIRE(steps.size() == 1);
        DOCTEST_CHECK(steps[0].step.operation == plan::Operation::Recolour);
        DOCTEST_CHECK(steps[0].step.subject.root() == source);
    }
    // Without a new look of the source the other thing is what is new.
    const auto beside = request("a cat with a ball", "ball");
    DOCTEST_CHECK(edit::assumed_scene(beside).things.size() == 1);
    for (const std::string listed :
         {"a cat with balls", "a cat with milk and balls", "blue balls", "a balls"})
        DOCTEST_CHECK(edit::assumed_scene(request(listed, "balls")).things.size() == 1);
}

DOCTEST_TEST_CASE("what another thing wears, holds or has is told from things of their own") {
    const auto borne = [](const std::string& prompt, const std::string& source) {
        return edit::is_borne(language::Sentence(prompt), source);
    };
    DOCTEST_CHECK(borne("a man wearing a red hat", "hat"));
    DOCTEST_CHECK(borne("a bulldozer with a green bucket", "bucket"));
    DOCTEST_CHECK(borne("a statue with golden wings", "wings"));
    DOCTEST_CHECK(borne("a guitar on a golden stand", "stand"));
    DOCTEST_CHECK_FALSE(borne("a red hat", "hat"));
    DOCTEST_CHECK_FALSE(borne("a man with a golden dog", "dog"));
    DOCTEST_CHECK_FALSE(borne("a blue guitar", "guitar"));
}

DOCTEST_TEST_CASE("an edit in which nothing is drawn needs its thing by name") {
    auto wanted = request("anything", "");
    wanted.mode = "remove";
    DOCTEST_CHECK(refused(wanted).find("which thing") != std::string::npos);
    wanted.source = "bear";
    wanted.prompt.clear();
    DOCTEST_CHECK(edit::check(wanted).prompt() == "remove the bear");
    wanted.whole_scene = true;
    DOCTEST_CHECK(refused(wanted).find("whole scene") != std::string::npos);
}

DOCTEST_TEST_CASE("what a description may only repeat is left to pictures of the scene") {
    for (const auto& [prompt, source] :
         {std::pair{"a red bear wearing a hat and a scarf on the snow", "bear"},
          std::pair{"a bear wearing a golden crown", "hat"},
          std::pair{"a blue cat wearing a purple crown on the sand", "snow"},
          std::pair{"a bear standing on the grass wearing a red hat", "bear"}}) {
        const std::string typed = prompt;
        DOCTEST_CAPTURE(typed);
        const auto checked = edit::check(request(typed, source));
        DOCTEST_CHECK(checked.prompt() == typed);
        DOCTEST_CHECK(checked.target_open());
    }
}

DOCTEST_TEST_CASE("what earlier edits said is no change of its own") {
    const edit::News news{{"a", "bear", "hat"}};
    const auto checked = edit::check(request("a red bear wearing a hat on the snow"), news);
    DOCTEST_CHECK(checked.prompt() == "a red bear wearing a hat on the snow");
    DOCTEST_CHECK(checked.target() == "red");
    DOCTEST_CHECK(checked.target_open());
}

DOCTEST_TEST_CASE("words that were chosen are taken as they are") {
    auto wanted = request("remove the bear");
    wanted.target = "bear";
    DOCTEST_CHECK(refused(wanted).empty());
    auto mode = request("paint the bear blue and give it a hat");
    mode.mode = "add";
    DOCTEST_CHECK(refused(mode).empty());
    auto without = request("a blue bear", "");
    without.target = "blue";
    DOCTEST_CHECK(refused(without).empty());
}

DOCTEST_TEST_CASE("each step is described in the scene that the steps before it leave") {
    const auto scene = plan::scene_words("red bear; grass");
    const auto steps =
        edit::planned_steps(edit::plan_of(request("a blue bear wearing a red hat"), scene), scene);
    DOCTEST_REQUIRE(steps.size() == 2);
    DOCTEST_REQUIRE(steps[0].words);
    DOCTEST_CHECK(steps[0].words->prompt == "a blue bear on the grass");
    DOCTEST_CHECK(steps[0].words->target == "blue");
    DOCTEST_REQUIRE(steps[1].words);
    DOCTEST_CHECK(steps[1].words->prompt == "a blue bear wearing a red hat on the grass");
    DOCTEST_CHECK(steps[1].words->target == "hat");
    DOCTEST_CHECK(steps[1].words->mode == edit::EditMode::Add);
    DOCTEST_CHECK(plan::step_text(steps[0].step) == "colour: bear, blue");
}

DOCTEST_TEST_CASE("every step that can be done is an edit whose words pass the check as they are") {
    const auto scene = plan::scene_words("red bear; grass");
    for (const std::string prompt :
         {"a blue bear wearing a red hat", "turn the bear into a wooden cat and give it sunglasses",
          "make the bear golden and put snow on the ground", "a striped bear with a ball beside it",
          "replace the bear with a dog, and make it black"}) {
        DOCTEST_CAPTURE(prompt);
        for (const auto& step : edit::planned_steps(edit::plan_of(request(prompt), scene), scene)) {
            DOCTEST_CAPTURE(plan::step_text(step.step));
            if (!step.words) {
                DOCTEST_CHECK(!step.problem.reason.empty());
                DOCTEST_CHECK(!step.problem.remedy.empty());
                continue;
            }
            const auto checked = edit::check(edit::request_of(request(prompt), *step.words));
            DOCTEST_CHECK(checked.prompt() == step.words->prompt);
            DOCTEST_CHECK(checked.target() == step.words->target);
        }
    }
}

DOCTEST_TEST_CASE("a part is described with its thing, and refused where the model cannot find it") {
    const auto scene = plan::scene_words("red bear; grass");
    const auto step_for = [&](const std::string& prompt, const plan::ModelAbility& model) {
        const auto steps = edit::planned_steps(edit::plan_of(request(prompt), scene), scene, model);
        DOCTEST_REQUIRE(steps.size() == 1);
        return steps.front();
    };
    const plan::ModelAbility open{true, {}},
        few{false, {"a", "bear", "on", "the", "grass", "blue", "golden"}};
    const auto ears = step_for("make the bear's ears blue", open);
    DOCTEST_REQUIRE(ears.words);
    DOCTEST_CHECK(ears.words->source == "ears");
    DOCTEST_CHECK(ears.words->part_of == "bear");
    DOCTEST_CHECK(ears.words->prompt == "a bear with blue ears on the grass");
    const auto checked = edit::check(edit::request_of(request("make the bear's ears blue"), *ears.words));
    DOCTEST_CHECK(checked.search_for_whole().prompt() == "a bear on the grass");
    DOCTEST_CHECK(checked.search_for_whole().source() == "bear");
    DOCTEST_CHECK(checked.in_look_of_whole().prompt() == "a blue bear on the grass");
    DOCTEST_CHECK(edit::instruction_of(checked) == "make the ears of the bear blue");
    const auto unknown = step_for("make the bear's ears blue", few);
    DOCTEST_CHECK(!unknown.words);
    DOCTEST_CHECK(unknown.problem.reason.find("ears") != std::string::npos);
    const auto head = step_for("a bear with a golden head", few);
    DOCTEST_REQUIRE(head.words);
    DOCTEST_CHECK(head.words->prompt == "a bear with a golden head on the grass");
    DOCTEST_CHECK(!step_for("replace the bear's ears with horns", open).words);
}

DOCTEST_TEST_CASE("styles and weather are steps of a model that is told any word") {
    const auto scene = plan::scene_words("red bear; blue hat; grass");
    for (const auto& [prompt, told, instruction, whole] :
         {std::tuple{"at night", "a red bear on the grass at night", "make it night", true},
          std::tuple{"make it winter", "a red bear on the grass in winter", "make it winter", true},
          std::tuple{"turn the scene into a watercolor", "a red bear on the grass in the style of watercolor",
                     "make it look like watercolor", true}}) {
        const std::string typed = prompt;
        DOCTEST_CAPTURE(typed);
        const auto plan = edit::plan_of(request(typed), scene);
        const auto closed = edit::planned_steps(plan, scene).front();
        DOCTEST_CHECK(!closed.words);
        DOCTEST_CHECK(closed.problem.remedy.find("Stable Diffusion") != std::string::npos);
        const auto open = edit::planned_steps(plan, scene, {true, {}}).front();
        DOCTEST_REQUIRE(open.words);
        DOCTEST_CHECK(open.words->prompt == told);
        DOCTEST_CHECK(open.words->instruction == instruction);
        DOCTEST_CHECK(open.words->whole_scene == whole);
        DOCTEST_CHECK(edit::check(edit::request_of(request(typed), *open.words)).whole_scene());
    }
}

DOCTEST_TEST_CASE("the source is among the scene's words, whatever they leave out") {
    const auto wanted = request("make it golden");
    DOCTEST_CHECK(edit::with_source("red bear; grass", wanted) == "red bear; grass");
    for (const std::string words : {";;", "grass", "red house; grass"}) {
        DOCTEST_CAPTURE(words);
        const auto scene = plan::scene_words(edit::with_source(words, wanted));
        DOCTEST_CHECK(to_string(edit::plan_of(wanted, scene)) == "material(bear, golden)");
    }
}

DOCTEST_TEST_CASE("pictures are asked where a look or a ground may be there already, and only there") {
    DOCTEST_CHECK(edit::pictures_decide(request("a blue bear wearing a red hat")));
    DOCTEST_CHECK(edit::pictures_decide(request("a golden bear on the snow")));
    DOCTEST_CHECK(!edit::pictures_decide(request("a golden bear")));
    DOCTEST_CHECK(!edit::pictures_decide(request("paint the bear blue and give it a hat")));

    const std::vector<std::string> words{"bear", "golden", "snow"};
    DOCTEST_CHECK(edit::pictures_decide(request("a golden bear on the snow"), words));
    auto unknown = request("a golden guitar on the snow");
    unknown.source = "guitar";  // labelled by hand
    DOCTEST_CHECK_FALSE(edit::pictures_decide(unknown, words));
}

}  // namespace sentence_plan_test
