// The suite of evaluation edits, and the honesty of its means.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <set>

#include "engine/base/error.h"
#include "engine/bench/eval_scenes.h"
#include "engine/bench/eval_suite.h"
#include "engine/bench/eval_summary.h"
#include "tests/test_paths.h"

namespace {

using namespace gse;
using namespace gse::bench;
using namespace gse::pipeline;
using Json = nlohmann::ordered_json;

Json changed_edit(int index, double iou, double reduction, double psnr) {
    return {{"index", index},
            {"kind", "recolour"},
            {"prompt", "a red bear"},
            {"word", "bear"},
            {"target", "red"},
            {"mode_right", true},
            {"weighted_iou", iou},
            {"l1_before", 0.4},
            {"l1_after", 0.4 * (1 - reduction)},
            {"l1_reduction", reduction},
            {"psnr_outside_db", psnr},
            {"leak_rate", 0.0},
            {"drift", 0},
            {"direction", nullptr},
            {"seconds", {{"total", 1.0}}}};
}

Json report_of(Json edits) {
    return {{"edits", std::move(edits)},
            {"ablations", Json::array()},
            {"scenes", Json::array()},
            {"text_image_score", false},
            {"parameters", {{"success_direction", 0.0}}}};
}

}  // namespace

DOCTEST_TEST_CASE("every edit of the suite ends in a combination that training never saw") {
    const auto suite = make_suite(7, 48, {"recolour", "material", "add"});
    std::map<std::string, int> kinds;
    std::set<std::uint64_t> seeds;
    for (const auto& edit : suite) {
        DOCTEST_CAPTURE(edit.prompt);
        ++kinds[edit.kind];
        seeds.insert(edit.source.seed);
        DOCTEST_CHECK(synth::held_out(edit.target));
        DOCTEST_CHECK(edit.source.seed == edit.target.seed);
        // The sentence alone leads from the source to the target.
        const auto applied = synth::apply_edit(edit.source, edit.prompt);
        DOCTEST_CHECK(applied.object == edit.target.object);
        DOCTEST_CHECK(applied.material == edit.target.material);
        DOCTEST_CHECK(applied.accessory == edit.target.accessory);
        DOCTEST_CHECK(applied.accessory_colour == edit.target.accessory_colour);
        DOCTEST_CHECK(applied.ground == edit.target.ground);
        DOCTEST_CHECK(edit.prompt.find(edit.target_word) != std::string::npos);
        const bool added = edit.kind == "add";
        DOCTEST_CHECK(edit.source.accessory.empty() == (added || edit.target.accessory.empty()));
        DOCTEST_CHECK((edit.source.material != edit.target.material) == !added);
    }
    DOCTEST_CHECK(kinds == std::map<std::string, int>{{"recolour", 16}, {"material", 16}, {"add", 16}});
    DOCTEST_CHECK(seeds.size() == suite.size());
}

DOCTEST_TEST_CASE("the suite is a function of its seed, and a shorter one is the beginning of a longer one") {
    const auto prompts = [](std::uint64_t seed, int count) {
        std::vector<std::string> list;
        for (const auto& edit : make_suite(seed, count, eval_kinds())) list.push_back(edit.prompt);
        return list;
    };
    const auto eight = prompts(3, 8), four = prompts(3, 4);
    DOCTEST_CHECK(eight == prompts(3, 8));
    DOCTEST_CHECK(eight != prompts(4, 8));
    DOCTEST_CHECK(std::equal(four.begin(), four.end(), eight.begin()));
    DOCTEST_CHECK_THROWS_AS(make_suite(3, 4, {"melt"}), Error);
}

DOCTEST_TEST_CASE("a failed edit counts as one that found and changed nothing") {
    Json broken = changed_edit(1, 0, 0, 0);
    for (const char* key :
         {"weighted_iou", "l1_before", "l1_after", "l1_reduction", "psnr_outside_db", "mode_right"})
        broken.erase(key);
    broken["error"] = "no splat was labelled";
    const Json report = report_of(Json::array({changed_edit(0, 0.9, 0.8, 40), broken}));
    const auto summary = eval_summary(report);
    DOCTEST_CHECK(summary["failed"]["value"] == 1);
    DOCTEST_CHECK(summary["failed"]["met"] == false);
    DOCTEST_CHECK(summary["existing_weighted_iou"]["value"] == doctest::Approx(0.45));
    DOCTEST_CHECK(summary["existing_weighted_iou"]["met"] == false);
    DOCTEST_CHECK(summary["change_l1_reduction"]["value"] == doctest::Approx(0.4));
    // What it would have kept is not averaged in.
    DOCTEST_CHECK(summary["psnr_outside_db"]["value"] == doctest::Approx(40));
}

DOCTEST_TEST_CASE("what was not measured is null, not zero and not met") {
    const auto summary = eval_summary(report_of(Json::array({changed_edit(0, 0.9, 0.8, 40)})));
    for (const char* name : {"change_success", "added_visible", "added_place_recall"}) {
        DOCTEST_CHECK(summary[name]["value"].is_null());
        DOCTEST_CHECK(summary[name]["met"].is_null());
    }
    DOCTEST_CHECK(summary["change_l1_reduction"]["met"] == true);
}

DOCTEST_TEST_CASE("one edit that ruins the rest shows in the pooled figure") {
    const auto summary =
        eval_summary(report_of(Json::array({changed_edit(0, 0.9, 0.8, 100), changed_edit(1, 0.9, 0.8, 20)})));
    DOCTEST_CHECK(summary["psnr_outside_db"]["value"] == doctest::Approx(60));
    DOCTEST_CHECK(summary["psnr_outside_pooled_db"]["value"] == doctest::Approx(23.01).epsilon(1e-3));
}

DOCTEST_TEST_CASE("the ablations' order is judged against the whole method on the same edits") {
    Json report = report_of(Json::array({changed_edit(0, 0.9, 0.8, 40), changed_edit(1, 0.9, 0.8, 10)}));
    Json without = changed_edit(0, 0.9, 0.8, 30);
    without["leak_rate"] = 0.2;
    report["ablations"] =
        Json::array({{{"name", "no_localization"}, {"edits", Json::array({without})}},
                     {{"name", "no_pseudo_gt"}, {"edits", Json::array({changed_edit(0, 0.9, 0.8, 50)})}}});
    const auto summary = eval_summary(report);
    DOCTEST_CHECK(summary["ablation_means"][0]["psnr_outside_db"] == doctest::Approx(40));
    DOCTEST_CHECK(summary["no_localization_worse"]["met"] == true);
    DOCTEST_CHECK(summary["no_pseudo_gt_worse"]["met"] == false);
}

DOCTEST_TEST_CASE("a real scene names its edit, or gets one") {
    const std::string path = (gse::test::source_folder() / "assets/scenes/bear").string();
    const std::vector<std::string> known{"bear", "statue", "hat"};
    const auto guessed = parse_real_edit(path, known);
    DOCTEST_CHECK(guessed.source == "bear");
    DOCTEST_CHECK(guessed.prompt == "a golden bear");
    const auto named = parse_real_edit(path + ":bear:a bear wearing a hat:hat", known);
    DOCTEST_CHECK(named.prompt == "a bear wearing a hat");
    DOCTEST_CHECK(named.target == "hat");
    DOCTEST_CHECK_THROWS_AS(parse_real_edit("/no/such/scene.ply", known), Error);
    DOCTEST_CHECK_THROWS_AS(parse_real_edit(path + ":a:b:c:d", known), Error);
}
