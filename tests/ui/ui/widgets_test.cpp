// The parts of the window that are plain functions: counts, listings, sentences, pictures, words for numbers.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>

#include "engine/base/file.h"
#include "engine/base/random.h"
#include "engine/edit/request/checked_request.h"
#include "tests/test_paths.h"
#include "tests/ui/support/harness.h"
#include "ui/keys/keys.h"
#include "ui/model/threshold_picture.h"
#include "ui/state/sentence.h"
#include "ui/state/state.h"
#include "ui/widgets/controls.h"

namespace gse::test::widgets_test {

DOCTEST_TEST_CASE("the histogram counts what is above, to a bin") {
    Random random(2);
    auto weight = std::make_shared<std::vector<float>>(5000);
    for (auto& value : *weight) value = static_cast<float>(random.uniform());
    weight->push_back(1.0f);
    weight->push_back(0.0f);
    ui::WeightHistogram histogram;
    histogram.update(weight);
    for (const float threshold : {0.0f, 0.1f, 0.5f, 0.93f, 1.0f}) {
        std::size_t above = 0, near = 0;
        for (const float value : *weight) {
            above += value > threshold ? 1 : 0;
            near += std::abs(value - threshold) <= 1.0f / ui::WeightHistogram::Bins ? 1 : 0;
        }
        const auto counted = histogram.above(threshold);
        DOCTEST_CHECK(counted + near >= above);
        DOCTEST_CHECK(counted <= above + near);
    }
    histogram.update(nullptr);
    DOCTEST_CHECK(histogram.above(0) == 0);
}

DOCTEST_TEST_CASE("a listing has folders first, known files only, and names in any script") {
    const ScratchFolder scratch;
    const auto root = scratch.path();
    std::filesystem::create_directories(root / "zebra");
    std::filesystem::create_directories(root / ui::path_of("\xD0\xBC\xD0\xB8\xD1\x88\xD0\xBA\xD0\xB0"));
    for (const char* name : {"b.PLY", "a.spz", "notes.txt", ".hidden.ply", "b\xC3\xA4r.ply"})
        write_file(root / ui::path_of(name), "x");
    const std::vector<std::string> endings{".ply", ".spz"};
    const auto listing = ui::list_folder(root, endings);
    DOCTEST_REQUIRE(listing.entries.size() == 5);
    DOCTEST_CHECK(listing.entries[0].is_folder);
    DOCTEST_CHECK(listing.entries[1].is_folder);
    DOCTEST_CHECK(listing.entries[2].name == "a.spz");
    DOCTEST_CHECK(listing.entries[3].name == "b.PLY");
    DOCTEST_CHECK(listing.entries[4].name == "b\xC3\xA4r.ply");
    DOCTEST_CHECK(ui::list_folder(root, {}).entries.size() == 6);
    DOCTEST_CHECK(!ui::list_folder(root / "nowhere", {}).problem.empty());
    const std::string base = root.string();
    DOCTEST_CHECK(ui::completed_path(base + "/ze") == base + "/zebra/");
    DOCTEST_CHECK(ui::completed_path(base + "/no") == base + "/notes.txt");
    DOCTEST_CHECK(ui::completed_path(base + "/b") == base + "/b");
    DOCTEST_CHECK(ui::completed_path(base + "/q") == base + "/q");
}

DOCTEST_TEST_CASE("the file browser opens, goes up, completes and saves") {
    const ScratchFolder scratch;
    std::filesystem::create_directories(scratch.path() / "inner");
    write_file(scratch.path() / "inner" / "b\xC3\xA4r.ply", "x");
    Harness harness({1280, 720, 1, Situation::Scene, false});
    harness.application.model().unsaved = false;
    harness.application.model().recent = {(scratch.path() / "inner" / "b\xC3\xA4r.ply").string()};
    const auto ask = [&harness] {
        harness.modifiers(false, true, false);
        harness.key('O');
        harness.modifiers(false, false, false);
        harness.frame(3);
    };
    ask();
    harness.click("files.entry.b\xC3\xA4r.ply");
    harness.click("files.confirm");
    harness.frame(3);
    DOCTEST_CHECK(
        harness.application.asked("open " + (scratch.path() / "inner" / "b\xC3\xA4r.ply").string()));
    // By keys alone: up, into the folder, the file.
    harness.application.calls.clear();
    ask();
    harness.key(ui::key::Backspace);
    harness.type("inn");
    harness.key(ui::key::Enter);
    harness.key(ui::key::Down);
    harness.key(ui::key::Enter);
    harness.frame(3);
    DOCTEST_CHECK(
        harness.application.asked("open " + (scratch.path() / "inner" / "b\xC3\xA4r.ply").string()));
    // The folder itself.
    harness.application.calls.clear();
    ask();
    harness.click("files.confirm");
    harness.frame(3);
    DOCTEST_CHECK(harness.application.asked("open " + (scratch.path() / "inner").string()));
    // Escape does nothing but close.
    harness.application.calls.clear();
    ask();
    harness.key(ui::key::Escape);
    harness.frame(3);
    DOCTEST_CHECK(harness.find("files.confirm") == nullptr);
    DOCTEST_CHECK(!harness.application.asked("open"));
}

DOCTEST_TEST_CASE("saving asks for a name, and before it overwrites") {
    const ScratchFolder scratch;
    write_file(scratch.path() / "there.gsep", "x");
    Harness harness({1280, 720, 1, Situation::Scene, false});
    harness.application.model().project_path = (scratch.path() / "there.gsep").string();
    harness.modifiers(true, true, false);
    harness.key('S');
    harness.modifiers(false, false, false);
    harness.frame(3);
    harness.click("files.confirm");
    DOCTEST_CHECK(!harness.application.asked("save_project"));
    harness.click("files.confirm");
    harness.frame(3);
    DOCTEST_CHECK(harness.application.asked("save_project " + (scratch.path() / "there.gsep").string()));
}

DOCTEST_TEST_CASE("what is said about a sentence") {
    const std::vector<std::string> known{"a", "bear", "wearing", "red", "hat", "golden"};
    edit::EditRequest request;
    request.source = "baer";
    request.prompt = "A bear wearing a red hta!";
    request.target = "red";
    const ui::SentenceGround ground{.known = known};
    const auto facts = ui::facts_of(request, ground);
    DOCTEST_REQUIRE(facts.chips.size() == 6);
    DOCTEST_CHECK(facts.chips[0].known);
    DOCTEST_CHECK(facts.chips[4].target);
    DOCTEST_CHECK(!facts.chips[4].guessed);
    DOCTEST_CHECK(!facts.chips[5].known);
    DOCTEST_CHECK(facts.chips[5].suggestion == "hat");
    DOCTEST_CHECK(!facts.source_known);
    DOCTEST_CHECK(facts.source_suggestions == std::vector<std::string>{"bear"});
    // What is looked for must be known, unless a label says where it is; other words only warn.
    DOCTEST_CHECK(facts.problem.find("\"baer\"") != std::string::npos);
    DOCTEST_CHECK(facts.problem.find("click on it") != std::string::npos);
    DOCTEST_CHECK(!facts.locate_problem.empty());
    DOCTEST_CHECK(ui::facts_of(request, {.known = known, .labelled_by_hand = true}).problem.empty());
    request.source = "bear";
    DOCTEST_CHECK(ui::facts_of(request, ground).problem.empty());
    request.target = "hta";
    DOCTEST_CHECK(ui::facts_of(request, ground).problem.find("\"hta\"") != std::string::npos);
    DOCTEST_CHECK(ui::facts_of(request, ground).locate_problem.empty());  // it can be looked for all the same
    request.target = "red";
    // A model without a list of words knows every word.
    for (const auto& chip : ui::facts_of(request, ui::SentenceGround{}).chips) DOCTEST_CHECK(chip.known);
    DOCTEST_CHECK(ui::with_word("A bear, wearing", 1, "dog") == "a dog wearing");
    request.prompt.clear();
    DOCTEST_CHECK(!ui::facts_of(request, ground).problem.empty());
    // Locate needs no sentence, Edit does.
    DOCTEST_CHECK(ui::facts_of(request, ground).locate_problem.empty());
    DOCTEST_CHECK(edit::source_alone(request).prompt == "a bear");
    request.prompt = "a golden bear";
    request.target = "golden";
    DOCTEST_CHECK(ui::facts_of(request, ground).problem.empty());
    request.source = "two words";
    request.prompt.clear();
    DOCTEST_CHECK(!ui::facts_of(request, ground).locate_problem.empty());
}

DOCTEST_TEST_CASE("the target follows the sentence, against what the scene shows already") {
    edit::EditRequest request;
    request.source = "bear";
    request.prompt = "a blue bear wearing a red hat";
    const auto target = [&](const ui::SentenceGround& ground) {
        return ui::facts_of(request, ground).guessed_target;
    };
    DOCTEST_CHECK(target({}) == "blue");  // of the first of two changes
    DOCTEST_CHECK(ui::facts_of(request, {}).steps.size() == 2);
    DOCTEST_CHECK(target({.said = {"a", "bear", "wearing", "hat", "red"}}) == "blue");
    DOCTEST_CHECK(target({.said = {"a", "blue", "bear"}}) == "hat");
}

DOCTEST_TEST_CASE("what cannot be made is said in a line, however many words the model knows") {
    edit::EditRequest request;
    request.source = "bear";
    request.prompt = "a unicorn on the grass";
    request.target = "unicorn";
    ui::SentenceGround ground{.known = {"a", "bear", "red", "on", "the", "grass"}};
    for (char a = 'a'; a <= 'z'; ++a)
        for (char b = 'a'; b <= 'z'; ++b) ground.known.push_back(std::string("zz") + a + b);
    constexpr std::size_t line = 160;  // letters: two lines of the panel
    DOCTEST_CHECK(ui::facts_of(request, ground).problem.find("under Models") != std::string::npos);
    DOCTEST_CHECK(ui::facts_of(request, ground).problem.find("colours") == std::string::npos);
    DOCTEST_CHECK(ui::facts_of(request, ground).problem.size() < line);
    ground.drawn = {"pink", "rabbit"};
    DOCTEST_CHECK(ui::facts_of(request, ground).problem.find("colours") != std::string::npos);
    DOCTEST_CHECK(ui::facts_of(request, ground).problem.size() < line);
    request.prompt = "a rabit on the grass";
    request.target = "rabit";
    DOCTEST_CHECK(ui::facts_of(request, ground).problem.find("\"rabbit\"") != std::string::npos);
}

DOCTEST_TEST_CASE("things of several words are marked, checked and looked for whole") {
    edit::EditRequest request;
    request.source = "teddy bear";
    request.prompt = "a teddy bear wearing a top hat";
    request.target = "top hat";
    const std::vector<std::string> known{"a", "teddy", "bear", "wearing", "top", "hat"};
    auto facts = ui::facts_of(request, {.known = known});
    DOCTEST_CHECK(facts.problem.empty());
    DOCTEST_CHECK(facts.locate_problem.empty());
    for (std::size_t i = 0; i < facts.chips.size(); ++i) {
        DOCTEST_CHECK(facts.chips[i].source == (i == 1 || i == 2));
        DOCTEST_CHECK(facts.chips[i].target == (i == 5 || i == 6));
    }
    DOCTEST_CHECK(
        !ui::facts_of(request, {.known = known, .words_read = 6}).problem.empty());  // "hat" is not read
    DOCTEST_CHECK(edit::source_alone(request).target == "teddy bear");
    request.source = "tedyd bear";
    facts = ui::facts_of(request, {.known = known});
    DOCTEST_CHECK(facts.source_suggestions == std::vector<std::string>{"teddy bear"});
    DOCTEST_CHECK(facts.locate_problem.find("\"tedyd\"") != std::string::npos);
    // With Shift the target reaches to the word that is clicked, on either side.
    DOCTEST_CHECK(ui::target_to(request.prompt, "hat", 5) == "top hat");
    DOCTEST_CHECK(ui::target_to(request.prompt, "teddy", 2) == "teddy bear");
    DOCTEST_CHECK(ui::target_to(request.prompt, "", 2) == "bear");
}

DOCTEST_TEST_CASE("where the text encoder stops reading is said, and a target beyond it is refused") {
    edit::EditRequest request;
    request.source = "bear";
    request.prompt = "a bear standing on the grass wearing a red hat";
    auto facts = ui::facts_of(request, {.words_read = 8});
    DOCTEST_CHECK(facts.cut_at == "red");
    DOCTEST_CHECK(facts.chips[7].read);
    DOCTEST_CHECK(!facts.chips[8].read);
    DOCTEST_CHECK(facts.problem.find("\"hat\"") != std::string::npos);
    facts = ui::facts_of(request, {.words_read = 10});
    DOCTEST_CHECK(facts.cut_at.empty());
    DOCTEST_CHECK(facts.problem.empty());
}

DOCTEST_TEST_CASE("a word that a label stands for is not said to have no effect") {
    edit::EditRequest request;
    request.source = "guitar";
    request.prompt = "a blue guitar";
    ui::SentenceGround ground;
    ground.known = {"bear", "blue", "a"};
    DOCTEST_CHECK_FALSE(ui::facts_of(request, ground).chips.back().known);
    ground.labelled_by_hand = true;
    const auto facts = ui::facts_of(request, ground);
    for (const auto& chip : facts.chips) DOCTEST_CHECK_MESSAGE(chip.known, chip.text);
}

DOCTEST_TEST_CASE("words of an order that no model draws are not said to have no effect") {
    ui::SentenceGround ground;
    ground.known = {"bear", "red", "a", "golden"};
    edit::EditRequest request;
    request.source = "bear";
    for (const std::string prompt : {"make the bear bigger", "two bears", "move the bear to the left",
                                     "remove the bear", "make the bear red and bigger"}) {
        request.prompt = prompt;
        const auto facts = ui::facts_of(request, ground);
        DOCTEST_CAPTURE(prompt);
        DOCTEST_CHECK(facts.problem.empty());
        for (const auto& chip : facts.chips) DOCTEST_CHECK_MESSAGE(chip.known, chip.text);
    }
    request.source = "guitar";  // which the model cannot find
    request.prompt = "make the guitar bigger";
    for (const auto& chip : ui::facts_of(request, ground).chips)
        DOCTEST_CHECK_MESSAGE(chip.known == (chip.text != "guitar"), chip.text);
    request.prompt = "a shiny guitar";
    DOCTEST_CHECK_FALSE(ui::facts_of(request, ground).chips[1].known);
}

DOCTEST_TEST_CASE("for a source that the model does not know only things are offered") {
    edit::EditRequest request;
    request.source = request.prompt = "guitar";
    ui::SentenceGround ground;
    ground.known = {"bear", "hat", "red", "wooden", "a"};
    DOCTEST_CHECK(ui::facts_of(request, ground).source_help == "a word it knows: bear, hat");
}

DOCTEST_TEST_CASE("an order is told as a description, and its own words are not marked as unknown") {
    edit::EditRequest request;
    request.source = "bear";
    request.prompt = "give it a red hat";
    ui::SentenceGround ground;
    ground.known = {"bear", "hat", "red", "a", "wearing"};
    const auto facts = ui::facts_of(request, ground);
    DOCTEST_CHECK(facts.problem.empty());
    DOCTEST_CHECK(facts.told.prompt == "a bear wearing a red hat");
    DOCTEST_CHECK(facts.guessed_target == "hat");
    for (const auto& chip : facts.chips) DOCTEST_CHECK_MESSAGE(chip.known, chip.text);
    request.prompt = "give it a red fez";  // nothing that the model can make
    DOCTEST_CHECK_FALSE(ui::facts_of(request, ground).problem.empty());
    request.prompt = "undo the last change";
    DOCTEST_CHECK(ui::facts_of(request, ground).problem.find("no change") != std::string::npos);
    request.prompt = "remove the bear";
    DOCTEST_CHECK(ui::facts_of(request, ground).problem.empty());
    request.prompt = "paint it red and give it a hat";
    DOCTEST_CHECK(ui::facts_of(request, ground).problem.empty());
    DOCTEST_CHECK(ui::facts_of(request, ground).steps.size() == 2);
    request.prompt = "ein roter Hut";
    DOCTEST_CHECK(ui::facts_of(request, ground).problem.find("English") != std::string::npos);
}

DOCTEST_TEST_CASE("the thresholded picture keeps what is above and darkens the rest") {
    Image render(40, 30, 3, 0.5f), map(20, 15, 1, 0.1f);
    for (int y = 4; y < 10; ++y)
        for (int x = 5; x < 15; ++x) map.at(x, y, 0) = 0.8f;
    map.at(0, 0, 0) = std::numeric_limits<float>::quiet_NaN();
    const auto result = ui::threshold_picture(render, map, 0.5);
    DOCTEST_CHECK(result.share == doctest::Approx(60.0 / 300));
    DOCTEST_CHECK(result.picture.at(20, 14, 0) > result.picture.at(1, 25, 0));
    DOCTEST_CHECK(result.picture.at(0, 0, 0) < 0.5f);
    DOCTEST_CHECK(ui::threshold_picture(render, map, 0.9).share == 0);
    DOCTEST_CHECK(ui::threshold_picture(render, map, 0).share > 0.99);
    DOCTEST_CHECK(ui::threshold_picture(Image(), map, 0.5).picture.data.empty());
}

DOCTEST_TEST_CASE("the thresholded picture follows the slider in the same frame") {
    Harness harness({1920, 1080, 1, Situation::Located, false});
    const auto bar = harness.rect("attention.threshold");
    const auto before = harness.shell.state().attention.above;
    harness.move(bar.x + bar.width * 0.35f, bar.y + 8);
    harness.press();
    ImGui::GetIO().MousePos.x = bar.x + bar.width * 0.02f;
    harness.frame(2);
    DOCTEST_CHECK(harness.shell.state().attention.above > before);
    harness.release();
}

DOCTEST_TEST_CASE("numbers in words") {
    DOCTEST_CHECK(ui::count_text(0) == "0");
    DOCTEST_CHECK(ui::count_text(999) == "999");
    DOCTEST_CHECK(ui::count_text(1234567) == "1 234 567");
    DOCTEST_CHECK(ui::duration_text(4.25) == "4.2 s");
    DOCTEST_CHECK(ui::duration_text(62) == "1 min 02 s");
    DOCTEST_CHECK(ui::duration_text(3725) == "1 h 02 min");
    DOCTEST_CHECK(ui::duration_text(-1) == "unknown");
    DOCTEST_CHECK(ui::bytes_text(850e6) == "850 MB");
    DOCTEST_CHECK(ui::bytes_text(9.1e9) == "9.1 GB");
}

DOCTEST_TEST_CASE("shortened text fits, keeps both ends and whole letters") {
    Harness harness({800, 600, 1, Situation::Nothing, false});
    ImGui::NewFrame();
    const std::string text =
        "/home/\xD0\xBC\xD0\xB8\xD1\x88\xD0\xBA\xD0\xB0/a very long name of a "
        "folder/\xC3\xA4\xC3\xB6\xC3\xBC.ply";
    for (float width = 20; width < 400; width += 7) {
        const std::string fit = ui::shortened(text, width);
        DOCTEST_CHECK((ImGui::CalcTextSize(fit.c_str()).x <= width || fit == "..."));
        for (std::size_t at = 0; at < fit.size(); ++at)
            if ((fit[at] & 0xC0) == 0x80) DOCTEST_CHECK((at > 0 && (fit[at - 1] & 0xC0) == 0xC0));
    }
    DOCTEST_CHECK(ui::shortened("short", 400) == "short");
    ImGui::EndFrame();
}

DOCTEST_TEST_CASE("every key of the table is told once") {
    for (std::size_t a = 0; a < ui::KeyTable.size(); ++a) {
        DOCTEST_CHECK(ui::KeyTable[a].keys != nullptr);
        DOCTEST_CHECK(ui::KeyTable[a].what != nullptr);
        for (std::size_t b = a + 1; b < ui::KeyTable.size(); ++b)
            DOCTEST_CHECK(std::string(ui::KeyTable[a].keys) != ui::KeyTable[b].keys);
    }
}

DOCTEST_TEST_CASE("the map of widgets is written as JSON") {
    const ScratchFolder scratch;
    Harness harness({1280, 720, 1, Situation::Scene, false});
    harness.shell.write_widgets(scratch.path() / "map.json");
    const auto json = nlohmann::json::parse(read_file(scratch.path() / "map.json"));
    DOCTEST_CHECK(json.at("prompt.edit").at("width").get<float>() > 10);
    DOCTEST_CHECK(json.at("viewport").at("visible").get<bool>());
}

DOCTEST_TEST_CASE("long text breaks at spaces only, and nothing of it is lost") {
    Harness harness({});
    harness.frame();
    const std::string text =
        "Estimate: about 3.3 s (draft 1.5 s, normal 3.3 s, fine 9.5 s), 0.15 TFLOP,\n567 MB of 23.2 GB free";
    for (const float width : {1.0f, 60.0f, 120.0f, 250.0f, 2000.0f}) {
        const std::string lines = ui::broken_at_spaces(text, width);
        DOCTEST_REQUIRE(lines.size() == text.size());
        for (std::size_t i = 0; i < text.size(); ++i) {
            if (lines[i] != text[i]) DOCTEST_CHECK((text[i] == ' ' && lines[i] == '\n'));
        }
        std::istringstream rows(lines);
        for (std::string row; std::getline(rows, row);) {
            const auto spaces = std::count(row.begin(), row.end(), ' ');
            const bool one_piece = spaces == 0 || (spaces == 1 && row[0] >= '0' && row[0] <= '9');
            DOCTEST_CHECK((one_piece || ImGui::CalcTextSize(row.c_str()).x <= width));
        }
    }
    DOCTEST_CHECK(ui::broken_at_spaces("took 12.5 s for 1 234 567 splats, 85 %.", 1) ==
                  "took\n12.5 s\nfor\n1 234 567\nsplats,\n85 %.");
    DOCTEST_CHECK(ui::broken_at_spaces("3 views of 2 rooms", 1) == "3\nviews\nof\n2\nrooms");
    DOCTEST_CHECK(ui::broken_at_spaces("", 10).empty());
}

}  // namespace gse::test::widgets_test
