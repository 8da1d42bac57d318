// Sentences with several changes on the Prompt panel: the list, its ticks, and what is asked.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "tests/ui/support/harness.h"
#include "ui/state/state.h"

namespace gse::test::steps_test {
namespace {

constexpr const char* BlueWithHat = "a blue bear wearing a red hat";

void ask(Harness& harness, const std::string& prompt) {
    auto& model = harness.application.model();
    model.known_words.clear();  // any word
    model.request.source = "bear";
    model.request.prompt = prompt;
    model.request.target.clear();
    harness.frame(2);
    harness.application.calls.clear();
}

ui::Question& question(Harness& harness) { return harness.shell.state().question; }

constexpr Harness::Options Large{1920, 1080, 1, Situation::Scene, false};

}  // namespace

DOCTEST_TEST_CASE("a sentence with two changes lists both, and Edit makes what is ticked") {
    Harness harness(Large);
    ask(harness, BlueWithHat);
    const auto& steps = harness.shell.state().prompt.steps;
    DOCTEST_REQUIRE(steps.size() == 2);
    DOCTEST_CHECK(steps[0].text == "colour: bear, blue");
    DOCTEST_CHECK(steps[1].text == "add: red hat, worn by bear");
    DOCTEST_CHECK(harness.find("prompt.step.2") != nullptr);
    DOCTEST_CHECK(harness.asks("prompt.edit", "edit"));
    harness.shell.show(ui::PanelId::Prompt);
    harness.frame(2);
    harness.click("prompt.step.1");
    DOCTEST_CHECK(harness.asks("prompt.edit", "edit without recolour(bear, blue)"));
    harness.shell.show(ui::PanelId::Prompt);
    harness.frame(2);
    harness.click("prompt.step.2");
    DOCTEST_CHECK_FALSE(harness.rect("prompt.edit").enabled);  // nothing is left
    harness.click("prompt.step.1");
    DOCTEST_CHECK(harness.rect("prompt.edit").enabled);
    harness.click("prompt.step.2");
    DOCTEST_CHECK(harness.shell.state().prompt.left_out.empty());
}

DOCTEST_TEST_CASE("ticks are of their sentence: typed again, all of its changes are made") {
    Harness harness(Large);
    ask(harness, BlueWithHat);
    harness.click("prompt.step.1");
    DOCTEST_CHECK(harness.shell.state().prompt.left_out.size() == 1);
    ask(harness, "a golden bear");
    ask(harness, BlueWithHat);
    DOCTEST_CHECK(harness.shell.state().prompt.left_out.empty());
}

DOCTEST_TEST_CASE("where a change cannot be made, the window asks once whether the others are") {
    Harness harness(Large);
    auto& prompt = harness.shell.state().prompt;
    ask(harness, "paint the bear blue and make it smile");
    DOCTEST_REQUIRE(prompt.steps.size() == 2);
    DOCTEST_CHECK(prompt.steps[0].problem.empty());
    DOCTEST_CHECK_FALSE(prompt.steps[1].problem.empty());
    harness.click("prompt.edit");
    DOCTEST_CHECK_FALSE(harness.application.asked("edit"));
    DOCTEST_CHECK(question(harness).text.find(prompt.steps[1].problem) != std::string::npos);
    harness.frame(2);
    // Not run either: it would end the edit when its turn comes.
    DOCTEST_CHECK(harness.asks("question.0", "edit without " + prompt.steps[1].notation));
}

DOCTEST_TEST_CASE("another sentence is about no part of the edit that was taken up again") {
    Harness harness(Large);
    auto& request = harness.application.model().request;
    request.source = "head", request.part_of = "bear", request.prompt = "a bear with a blue head";
    request.whole_scene = true;
    harness.frame(2);
    harness.click("prompt.sentence");
    harness.type(" and a hat");
    DOCTEST_CHECK(request.part_of.empty());
    DOCTEST_CHECK_FALSE(request.whole_scene);
}

DOCTEST_TEST_CASE("a sentence of which nothing can be done says why, and so does one in German") {
    Harness harness(Large);
    for (const char* prompt :
         {"leave the bear as it is", "der Bär soll blau sein und einen Hut tragen", "make the bear smile"}) {
        ask(harness, prompt);
        DOCTEST_CHECK_FALSE(harness.rect("prompt.edit").enabled);
        DOCTEST_CHECK_FALSE(harness.shell.state().prompt.problem.empty());
    }
}

DOCTEST_TEST_CASE("what an applied edit has made can be named, whatever the source field says") {
    edit::EditRequest request;
    request.source = "bear";
    request.prompt = "make the hat green";
    DOCTEST_CHECK_FALSE(ui::facts_of(request, {}).problem.empty());  // there is none
    const auto facts = ui::facts_of(request, {.made = {"hat"}});
    DOCTEST_CHECK(facts.problem.empty());
    DOCTEST_CHECK(facts.told.source == "hat");
    DOCTEST_CHECK(facts.told.target == "green");
}

DOCTEST_TEST_CASE("a thing that is not labelled yet is asked for once, and its steps wait") {
    edit::EditRequest request;
    request.source = "skull";
    request.prompt = "make it blue and give it a red hat";
    const ui::SentenceGround ground{.known = {"a", "bear", "blue", "red", "hat", "wearing"}};
    const auto facts = ui::facts_of(request, ground);
    DOCTEST_REQUIRE(facts.steps.size() == 2);
    for (const auto& step : facts.steps) DOCTEST_CHECK(step.problem == "Waits until \"skull\" is labelled");
    DOCTEST_CHECK(facts.problem.find("click on it") != std::string::npos);
    auto labelled = ground;
    labelled.labelled_by_hand = true;
    DOCTEST_CHECK(ui::facts_of(request, labelled).problem.empty());
}

DOCTEST_TEST_CASE(
    "a thing that nothing in the scene is called is asked for by a click, and then a step like others") {
    edit::EditRequest request;
    request.source = "house";
    request.prompt = "paint the house blue and remove the balloons";
    const auto asked = ui::facts_of(request, {.known = {"house", "blue"}});
    DOCTEST_CHECK_FALSE(asked.refused);  // the house is painted; the window asks about the rest
    DOCTEST_CHECK(asked.missing == "balloon");
    DOCTEST_REQUIRE(asked.steps.size() == 2);
    DOCTEST_CHECK(asked.steps[0].problem.empty());
    DOCTEST_CHECK(asked.steps[1].problem.find("balloon") != std::string::npos);
    request.prompt = "remove the balloons";
    const auto refused = ui::facts_of(request, {.known = {"house", "blue"}});
    DOCTEST_CHECK(refused.refused);
    DOCTEST_CHECK(refused.missing == "balloon");
    request.prompt = "paint the house blue and remove the balloons";
    const auto labelled = ui::facts_of(request, {.known = {"house", "blue"}, .made = {"balloon"}});
    DOCTEST_CHECK_FALSE(labelled.refused);
    DOCTEST_CHECK(labelled.missing.empty());
    DOCTEST_REQUIRE(labelled.steps.size() == 2);
    for (const auto& step : labelled.steps) DOCTEST_CHECK(step.problem.empty());

    Harness harness(Large);
    ask(harness, request.prompt);
    harness.application.model().request.source = "house";
    harness.frame(2);
    DOCTEST_CHECK(harness.asks("prompt.missing.by_hand", "add_label balloon"));
    DOCTEST_CHECK(harness.shell.state().viewport.tool == ui::Tool::CutOut);
}

DOCTEST_TEST_CASE("several changes that are all made already are refused, one is the same edit once more") {
    edit::EditRequest request;
    request.source = "bear";
    request.prompt = "make it blue and give it a red hat";
    const ui::SentenceGround shown{.said = {"blue", "red", "hat"}};
    DOCTEST_CHECK(ui::facts_of(request, shown).problem.find("made already") != std::string::npos);
    request.prompt = "make it blue";
    DOCTEST_CHECK(ui::facts_of(request, shown).problem.empty());
}

DOCTEST_TEST_CASE("a style is a step for a model of any word, and refused by one with few") {
    edit::EditRequest request;
    request.source = "bear";
    request.prompt = "make it night";
    const auto any = ui::facts_of(request, {});
    DOCTEST_REQUIRE(any.steps.size() == 1);
    DOCTEST_CHECK(any.problem.empty());
    DOCTEST_CHECK(any.told.whole_scene);
    DOCTEST_CHECK_FALSE(ui::facts_of(request, {.known = {"bear", "night"}}).problem.empty());
}

DOCTEST_TEST_CASE("a clicked word is the target of one edit, whatever the plan") {
    Harness harness(Large);
    ask(harness, BlueWithHat);
    harness.click("prompt.chip.1");
    DOCTEST_CHECK(harness.application.model().request.target == "blue");
    DOCTEST_CHECK(harness.shell.state().prompt.steps.empty());
    DOCTEST_CHECK(harness.asks("prompt.edit", "edit"));
}

}  // namespace gse::test::steps_test
