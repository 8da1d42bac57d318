// The Prompt panel: words, settings and when Locate and Edit are on.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "tests/ui/support/harness.h"
#include "ui/keys/keys.h"
#include "ui/state/state.h"

namespace gse::test::prompt_test {
namespace {

namespace key = ui::key;
constexpr int Wide = 1920, High = 1080;

}  // namespace

DOCTEST_TEST_CASE("prompt: back to the defaults is back to what suits the model; the words stay") {
    Harness harness({Wide, High, 1, Situation::Scene, false});
    auto& model = harness.application.model();
    model.request_defaults.image_size = 512;
    model.model_settings_defaults.learning.steps = 400;
    model.model_settings_defaults.guidance.guidance_scale = 9;
    model.request.views = 9;
    const auto prompt = model.request.prompt;
    harness.click("prompt.advanced");
    harness.click("prompt.defaults");
    DOCTEST_CHECK(model.request.image_size == 512);
    DOCTEST_CHECK(model.request.views == edit::EditRequest{}.views);
    DOCTEST_CHECK(model.model_settings.learning.steps == 400);
    DOCTEST_CHECK(model.model_settings.guidance.guidance_scale == 9);
    DOCTEST_CHECK(model.request.prompt == prompt);
}

DOCTEST_TEST_CASE("prompt: every setting of a recipe is found by a word of its name or explanation") {
    Harness harness({Wide, High, 1, Situation::Scene, false});
    auto& model = harness.application.model();
    harness.click("prompt.advanced");
    DOCTEST_CHECK(harness.find("guidance.guidance_scale") == nullptr);  // in its group
    const auto search = [&](const char* text) {
        harness.click("prompt.filter");
        for (int letter = 0; letter < 40; ++letter) harness.key(key::Backspace);
        harness.type(text);
        harness.frame();
    };
    for (const auto& wanted :
         {std::pair{"GUIDANCE SC", "guidance.guidance_scale"}, std::pair{"img2img", "attention.method"},
          std::pair{"prior", "learning.prior_weight"}, std::pair{"shows its front", "model_settings.front"},
          std::pair{"device of the networks", "model_settings.device"},
          std::pair{"dbscan", "request.dbscan_eps"}}) {
        search(wanted.first);
        DOCTEST_CHECK_MESSAGE(harness.find(wanted.second) != nullptr, wanted.first);
        DOCTEST_CHECK_MESSAGE(harness.find("request.label_threshold") == nullptr, wanted.first);
    }
    search("shows its front");
    const auto over = harness.middle("prompt.filter");
    harness.move(over.x, over.y);
    for (int turn = 0; turn < 40 && !harness.rect("model_settings.front").visible; ++turn) {
        harness.wheel(-1);
        harness.frame(2);
    }
    harness.click("model_settings.front");
    harness.type("90");
    DOCTEST_CHECK(model.model_settings.front == "90");
    search("no such thing");
    DOCTEST_CHECK(harness.find("model_settings.front") == nullptr);
}

DOCTEST_TEST_CASE("prompt: words, chips, suggestion, mode, seed") {
    Harness harness({Wide, High, 1, Situation::Scene, false});
    auto& request = harness.application.model().request;
    harness.click("prompt.source");
    harness.type("s");
    DOCTEST_CHECK(request.source == "bears");
    harness.key(key::Backspace);
    harness.key(key::Enter);
    DOCTEST_CHECK(request.source == "bear");
    harness.click("prompt.chip.4");
    DOCTEST_CHECK(request.target == "red");
    harness.click("prompt.chip.4");
    DOCTEST_CHECK(request.target.empty());
    harness.frame(60);  // a second after the last letter, words are judged
    harness.click("prompt.chip.5.suggestion");
    DOCTEST_CHECK(request.prompt == "a bear wearing a red hat");
    harness.click("prompt.chip.5");
    DOCTEST_CHECK(request.target == "hat");
    harness.click("prompt.mode.add");
    DOCTEST_CHECK(request.mode == "add");
    const auto seed = request.seed;
    harness.click("prompt.seed.dice");
    DOCTEST_CHECK(request.seed != seed);
    DOCTEST_CHECK(harness.asks("prompt.locate", "locate"));
    DOCTEST_CHECK(harness.asks("prompt.edit", "edit"));
}

DOCTEST_TEST_CASE("a clicked target is that of its sentence, and another sentence has its own") {
    Harness harness({Wide, High, 1, Situation::Scene, false});
    auto& request = harness.application.model().request;
    harness.click("prompt.chip.4");
    DOCTEST_REQUIRE(request.target == "red");
    harness.click("prompt.sentence");
    harness.type(" scarf");
    DOCTEST_CHECK(request.prompt.ends_with(" scarf"));
    DOCTEST_CHECK(request.target.empty());
}

DOCTEST_TEST_CASE("an unknown source is refused before work; a label by hand is the way on") {
    Harness harness({Wide, High, 1, Situation::Scene, false});
    auto& model = harness.application.model();
    model.request.source = "sign";
    model.request.prompt = "a golden sign";
    model.request.target = "golden";
    model.known_words = {"a", "in", "bear", "golden", "sand"};
    harness.frame(2);
    harness.application.calls.clear();
    DOCTEST_CHECK(!harness.rect("prompt.locate").enabled);
    DOCTEST_CHECK(!harness.rect("prompt.edit").enabled);
    DOCTEST_CHECK(harness.find("prompt.source.suggestion") == nullptr);  // "in" is no thing
    DOCTEST_CHECK(harness.asks("prompt.source.by_hand", "add_label sign"));
    DOCTEST_CHECK(harness.shell.state().viewport.tool == ui::Tool::CutOut);
    harness.frame(3);
    DOCTEST_CHECK(harness.find("panel.Prompt") != nullptr);  // the sentence goes on there
    harness.key(key::Escape);
    DOCTEST_CHECK(harness.shell.state().viewport.tool == ui::Tool::Orbit);
    harness.shell.show(ui::PanelId::Prompt);
    harness.frame(3);
    harness.application.calls.clear();
    harness.modifiers(true, false, false);  // who asks for the edit is asked for the thing
    harness.key(key::Enter);
    harness.modifiers(false, false, false);
    harness.frame(2);
    const auto& calls = harness.application.calls;
    DOCTEST_CHECK(std::count(calls.begin(), calls.end(), "add_label sign") == 1);
    DOCTEST_CHECK(std::count(calls.begin(), calls.end(), "edit") == 0);
    DOCTEST_CHECK(harness.shell.state().viewport.tool == ui::Tool::CutOut);
    model.labelled_by_hand = true;  // something was clicked or painted
    harness.shell.show(ui::PanelId::Prompt);
    harness.frame(3);
    DOCTEST_CHECK(!harness.rect("prompt.locate").enabled);
    DOCTEST_CHECK(harness.rect("prompt.edit").enabled);
    DOCTEST_CHECK(harness.asks("prompt.edit", "edit"));
}

DOCTEST_TEST_CASE("another word for a known one is offered as that, and asks for no click") {
    Harness harness({Wide, High, 1, Situation::Scene, false});
    auto& model = harness.application.model();
    model.request.source = "puppy";
    model.request.prompt = "a golden puppy";
    model.request.target = "golden";
    model.known_words = {"a", "dog", "golden"};
    harness.frame(2);
    DOCTEST_REQUIRE(harness.find("prompt.source.suggestion") != nullptr);
    harness.click("prompt.source.suggestion");
    harness.frame(2);
    DOCTEST_CHECK(model.request.source == "dog");
}

DOCTEST_TEST_CASE(
    "above the buttons stands which label the edit changes or what it searches for, and the other way") {
    Harness harness({Wide, High, 1, Situation::Scene, false});
    auto& model = harness.application.model();
    model.request.prompt = "a golden bear";
    model.request.target = "golden";
    harness.frame(2);
    DOCTEST_REQUIRE(harness.find("prompt.scope") != nullptr);
    DOCTEST_CHECK(harness.find("prompt.scope.other") == nullptr);  // there is no label to use
    model.scope = {"hat", 416, false, false};
    harness.frame(2);
    DOCTEST_CHECK(harness.asks("prompt.scope.other", "set_scope label"));
    model.scope.by_label = true;
    harness.frame(2);
    DOCTEST_CHECK(harness.asks("prompt.scope.other", "set_scope search"));
    DOCTEST_CHECK(harness.rect("prompt.scope").y < harness.rect("prompt.edit").y);
    DOCTEST_CHECK(harness.rect("prompt.edit").visible);
    model.request.source = "crane";  // unknown: there is nothing to search for
    harness.frame(2);
    DOCTEST_CHECK(harness.find("prompt.scope.other") == nullptr);
    DOCTEST_CHECK(harness.find("prompt.scope") != nullptr);
}

DOCTEST_TEST_CASE("the reading of a sentence is shown where it is not the sentence that was typed") {
    Harness harness({Wide, High, 1, Situation::Scene, false});
    auto& request = harness.application.model().request;
    request.target.clear();
    const auto shows_reading = [&](const std::string& sentence) {
        request.prompt = sentence;
        harness.frame(2);
        DOCTEST_REQUIRE(harness.find("prompt.scope") != nullptr);
        return harness.find("prompt.read_as") != nullptr;
    };
    DOCTEST_CHECK(shows_reading("give the bear a red hat"));
    const std::string told = harness.shell.state().prompt.told.prompt;
    DOCTEST_REQUIRE_FALSE(told.empty());
    DOCTEST_CHECK_FALSE(shows_reading(told));
    DOCTEST_CHECK_FALSE(shows_reading("A  bear wearing a Red hat ."));
    DOCTEST_CHECK_FALSE(shows_reading(told + "."));
}

DOCTEST_TEST_CASE("the room that a failed search takes is given back with the next scene or search") {
    Harness harness({Wide, High, 1, Situation::Scene, false});
    const auto split = [&] { return harness.find("split.bottom")->y; };
    harness.frame(3);
    const float usual = split();
    auto& search = harness.application.model().search;
    search.problem = edit::SearchProblem::Unsure;
    search.number = 7;
    harness.frame(3);
    DOCTEST_CHECK(split() < usual);
    DOCTEST_CHECK(ui::Layout::from_json(harness.shell.layout()).bottom_share ==
                  ui::Layout::standard().bottom_share);
    search.problem = edit::SearchProblem::None;
    harness.frame(3);
    DOCTEST_CHECK(split() == usual);
}

DOCTEST_TEST_CASE("a search that labelled nothing shows its pictures and the ways on") {
    Harness harness({Wide, High, 1, Situation::Failed, false});
    DOCTEST_REQUIRE(harness.find("panel.Attention") != nullptr);  // it came to the front by itself
    DOCTEST_CHECK(harness.find("attention.view.1") != nullptr);
    DOCTEST_CHECK(harness.find("attention.confidence") != nullptr);
    DOCTEST_CHECK(harness.find("attention.front") != nullptr);
    DOCTEST_CHECK(harness.asks("attention.anyway", "label_anyway"));
    harness.shell.show(ui::PanelId::Log);
    harness.frame(3);
    DOCTEST_CHECK(harness.find("panel.Attention") == nullptr);  // once is enough
    harness.shell.show(ui::PanelId::Attention);
    harness.frame(3);
    DOCTEST_CHECK(harness.asks("attention.by_hand", "set_active_label 0"));  // there is one of that name
    harness.frame(3);
    DOCTEST_CHECK(harness.find("panel.Prompt") != nullptr);
}

DOCTEST_TEST_CASE("an open seed changes with every edit, a locked one does not") {
    Harness harness({Wide, High, 1, Situation::Scene, false});
    auto& request = harness.application.model().request;
    request.prompt = "a bear wearing a red hat";
    harness.frame(2);
    harness.application.calls.clear();
    harness.click("prompt.edit");
    DOCTEST_CHECK(harness.application.asked("edit"));
    DOCTEST_CHECK(request.seed == 0);
    harness.shell.show(ui::PanelId::Prompt);
    harness.click("prompt.seed.lock");
    harness.application.calls.clear();
    harness.click("prompt.edit");
    DOCTEST_CHECK(request.seed != 0);
    DOCTEST_REQUIRE(harness.application.calls.size() >= 2);
    // The seed goes first, then the edit that uses it.
    DOCTEST_CHECK(harness.application.calls[0] == "set_request");
    DOCTEST_CHECK(harness.application.calls[1] == "edit");
}

DOCTEST_TEST_CASE("Edit is off for a reason and then does nothing") {
    Harness harness({Wide, High, 1, Situation::Scene, false});
    harness.application.model().cannot_edit = "No model was found";
    harness.frame(2);
    DOCTEST_CHECK(!harness.rect("prompt.edit").enabled);
    DOCTEST_CHECK(!harness.asks("prompt.edit", "edit"));
    harness.modifiers(true, false, false);
    DOCTEST_CHECK(!harness.key_asks(key::Enter, "edit"));
    harness.modifiers(false, false, false);
    harness.application.model().cannot_edit.clear();
    harness.application.model().request.prompt = "a blue hat";
    harness.application.model().request.target = "golden";
    harness.frame(2);
    DOCTEST_CHECK(!harness.rect("prompt.edit").enabled);
    harness.application.model().request.target = "blue";
    harness.frame(2);
    DOCTEST_CHECK(harness.rect("prompt.edit").enabled);
}

DOCTEST_TEST_CASE("Shift and Ctrl with Enter edit, also while the sentence is typed") {
    Harness harness({Wide, High, 1, Situation::Scene, false});
    harness.application.model().request.prompt = "a bear wearing a red hat";
    harness.click("prompt.sentence");
    harness.modifiers(true, false, false);
    DOCTEST_CHECK(harness.key_asks(key::Enter, "edit"));
    harness.modifiers(false, true, false);
    DOCTEST_CHECK(harness.key_asks(key::Enter, "edit"));
    harness.modifiers(false, false, false);
    harness.key(key::Escape);
    // Plain letters that are typed are not keys.
    harness.click("prompt.sentence");
    DOCTEST_CHECK(!harness.key_asks('V', "set_comparison"));
}

DOCTEST_TEST_CASE("another method is another sentence: a word that is only drawn is no word of sds") {
    Harness harness({Wide, High, 1, Situation::Scene, false});
    auto& model = harness.application.model();
    model.request.prompt = "a bear wearing a crown";
    model.request.target = "crown";
    model.request.mode = "add";
    model.generated_vocabulary = {"crown"};
    harness.frame(2);
    DOCTEST_CHECK(harness.rect("prompt.edit").enabled);
    model.request.method = "sds";
    harness.frame(2);
    DOCTEST_CHECK(!harness.rect("prompt.edit").enabled);
    model.request.method = "views";
    harness.frame(2);
    DOCTEST_CHECK(harness.rect("prompt.edit").enabled);
}

DOCTEST_TEST_CASE("prompt: a source that is not known puts nothing between it and the sentence") {
    Harness harness({Wide, High, 1, Situation::Scene, false});
    auto& request = harness.application.model().request;
    harness.click("prompt.sentence");
    for (int letter = 0; letter < 60; ++letter) harness.key(key::Backspace);
    harness.click("prompt.source");
    const auto sentence = harness.rect("prompt.sentence"), edit = harness.rect("prompt.edit");
    harness.type("xyz");                                              // "bearxyz"
    DOCTEST_CHECK(harness.find("prompt.source.by_hand") == nullptr);  // half a word is not judged
    harness.frame(60);                                                // a second
    DOCTEST_REQUIRE(harness.find("prompt.source.by_hand") != nullptr);
    DOCTEST_CHECK(harness.rect("prompt.sentence").y == sentence.y);
    DOCTEST_CHECK(harness.rect("prompt.edit").y == edit.y);
    harness.key(key::Tab);
    harness.frame(4);
    harness.type("a red chair");
    DOCTEST_CHECK(request.prompt == "a red chair");
    DOCTEST_CHECK(request.source == "bearxyz");
    DOCTEST_CHECK(harness.rect("prompt.edit").y == edit.y);
}

}  // namespace gse::test::prompt_test
