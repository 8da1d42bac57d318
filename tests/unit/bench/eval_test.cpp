// The suite of evaluation edits, and the honesty of its means.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "engine/base/error.h"
#include "engine/laboratory/eval/eval_figures.h"
#include "engine/laboratory/eval/eval_scenes.h"
#include "engine/laboratory/eval/eval_suite.h"
#include "engine/laboratory/eval/eval_summary.h"
#include "engine/laboratory/eval/sharpness.h"
#include "engine/localize/clusters.h"
#include "tests/test_paths.h"

namespace eval_test {

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

DOCTEST_TEST_CASE(
    "how often the verdict on redrawn views warns is counted apart for edits that help and those that do "
    "not") {
    const auto judged = [](int index, double l1_reduction, bool warns) {
        Json edit = changed_edit(index, 0.9, l1_reduction, 40);
        edit["gate"] = {{"score", warns ? 0.1 : 0.6}, {"verdict", ""}, {"warns", warns}};
        return edit;
    };
    Json edits = Json::array({judged(0, -0.1, true), judged(1, -0.2, false), judged(2, 0.5, false),
                              judged(3, 0.6, false), judged(4, 0.4, false), judged(5, 0.3, true)});
    const auto summary = eval_summary(report_of(edits));
    DOCTEST_CHECK(summary["gate_warned_of_failures"]["value"] == 0.5);
    DOCTEST_CHECK(summary["gate_warned_of_successes"]["value"] == 0.25);
    edits[2]["gate"]["score"] = nullptr;  // the model has no encoder
    DOCTEST_CHECK(eval_summary(report_of(Json::array({edits[2]}))).contains("gate_warned_of_successes") ==
                  false);
}

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

DOCTEST_TEST_CASE("edits that replace are drawn apart: the others are the same with and without them") {
    const auto lines = [](const std::vector<EvalCase>& suite, bool replaced) {
        std::vector<std::string> list;
        for (const auto& edit : suite)
            if ((edit.kind == "replace") == replaced)
                list.push_back(fmt::format("{} {} {}", edit.kind, edit.prompt, edit.source.seed));
        return list;
    };
    const std::vector<std::string> first_four{"recolour", "material", "add", "ground"};
    const auto all = make_suite(1, 30, eval_kinds());
    DOCTEST_CHECK(lines(all, false) == lines(make_suite(1, 24, first_four), false));
    DOCTEST_CHECK(lines(all, true) == lines(make_suite(1, 6, {"replace"}), true));
    // A case of the suite as it was before edits that replace were in it.
    DOCTEST_CHECK(lines(all, false).front() ==
                  "recolour a white duck with red wings on the grass 10220632845217208698");
}

DOCTEST_TEST_CASE("what comes is called by words that are drawn only, where that is asked for") {
    std::set<std::string> words;
    for (const auto& edit : make_suite(5, 40, {"replace", "add"}, true)) {
        DOCTEST_CAPTURE(edit.prompt);
        const auto& list = edit.kind == "add" ? synth::more_accessory_words() : synth::more_object_words();
        DOCTEST_CHECK(std::find(list.begin(), list.end(), edit.target_word) != list.end());
        DOCTEST_CHECK(synth::held_out(edit.target));
        DOCTEST_CHECK(edit.prompt.find(edit.target_word) != std::string::npos);
        const auto applied = synth::apply_edit(
            edit.source, edit.prompt);  // the sentence alone leads from the source to the target
        DOCTEST_CHECK(applied.object == edit.target.object);
        DOCTEST_CHECK(applied.accessory == edit.target.accessory);
        DOCTEST_CHECK(applied.material == edit.target.material);
        words.insert(edit.target_word);
    }
    DOCTEST_CHECK(words.size() > 12);  // of 26
    DOCTEST_CHECK(make_suite(5, 4, {"recolour"}, true).front().prompt ==
                  make_suite(5, 4, {"recolour"}).front().prompt);
}

DOCTEST_TEST_CASE("another object of a held-out combination takes the place, as the sentence says") {
    std::size_t same_material = 0;
    std::set<std::string> pairs;
    for (const auto& edit : make_suite(3, 24, {"replace"})) {
        DOCTEST_CAPTURE(edit.prompt);
        DOCTEST_CHECK(synth::held_out(edit.target));
        DOCTEST_CHECK(edit.source.object != edit.target.object);
        DOCTEST_CHECK(edit.source.ground == edit.target.ground);
        DOCTEST_CHECK(edit.source.accessory.empty());
        DOCTEST_CHECK(edit.word == edit.source.object);
        DOCTEST_CHECK(edit.target_word == edit.target.object);
        DOCTEST_CHECK(edit.prompt.find(edit.target_word) != std::string::npos);
        DOCTEST_CHECK(synth::apply_edit(edit.source, edit.prompt).object == edit.target.object);
        DOCTEST_CHECK(synth::apply_edit(edit.source, edit.prompt).material == edit.target.material);
        same_material += edit.source.material == edit.target.material ? 1 : 0;
        pairs.insert(edit.source.object + edit.target.object);
    }
    DOCTEST_CHECK(same_material > 4);
    DOCTEST_CHECK(same_material < 20);
    DOCTEST_CHECK(pairs.size() > 12);
}

DOCTEST_TEST_CASE(
    "sharpness is 1 for the truth, less for a blurred one, and asks nothing of the surroundings") {
    constexpr int Side = 64, Blurred = 16;
    Random random(3);
    Image truth(Side, Side, 3);
    for (auto& value : truth.data) value = static_cast<float>(random.uniform());
    Mask outline(Side, Side);
    for (int y = 16; y < 48; ++y)
        for (int x = 16; x < 48; ++x) outline.at(x, y) = 1;
    const auto measured = [&](const Image& shown) {
        SharpnessFigures figures;
        figures.add(shown, truth, outline);
        figures.add(shown, truth, Mask(Side, Side));  // a view that does not show the thing
        return std::pair{figures.ssim(), figures.gradient_energy()};
    };
    const auto same = measured(truth);
    DOCTEST_CHECK(same.first == doctest::Approx(1));
    DOCTEST_CHECK(same.second == doctest::Approx(1));
    const auto blurred =
        measured(localize::resize_image(localize::resize_image(truth, Blurred, Blurred), Side, Side));
    DOCTEST_CHECK(blurred.first < 0.5);
    DOCTEST_CHECK(blurred.second < 0.2);
    Image elsewhere = truth;  // the window of SSIM reaches a few pixels beyond the outline
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < Side; ++x) elsewhere.at(x, y, 0) = 0;
    DOCTEST_CHECK(measured(elsewhere) == same);
    Image rim = truth;  // the outline itself is not the thing's detail
    for (int x = 16; x < 48; ++x) rim.at(x, 16, 1) = 1 - rim.at(x, 16, 1);
    DOCTEST_CHECK(measured(rim).second == same.second);
    DOCTEST_CHECK(SharpnessFigures().ssim() == 0);
    DOCTEST_CHECK(SharpnessFigures().gradient_energy() == 0);
}

DOCTEST_TEST_CASE("of a new thing the true scene is taken in the heading and size that the edit gave it") {
    const auto edit = make_suite(2, 1, {"replace"}).front();
    edit::EditRequest request;
    request.image_size = 48;
    request.views = 4;
    auto setting = make_setting(edit, request, 6);
    Painter painter(1);
    auto turned = edit.target;
    turned.heading = 3 * 2 * 3.14159265358979 / 8;
    turned.size = 0.85;
    const auto edited = synth::generate(turned);
    settle_pose(setting, edited.scene.gaussians, {painter});
    DOCTEST_CHECK(setting.target.spec.heading == doctest::Approx(turned.heading));
    DOCTEST_CHECK(setting.target.spec.size == doctest::Approx(turned.size));
    // The true result has the true outline and nothing of the old; the unedited scene has all of the old.
    edit::EditPlan plan;
    edit::EditResult result;
    result.set = edited.scene.gaussians;
    result.label = rows_of(edited, synth::Part::Object);
    result.hole_fill.assign(result.label.size(), 0);
    result.base_to_new.assign(setting.source.scene.gaussians.size(), -1);
    const auto perfect = edited_figures(setting, plan, result, {painter});
    DOCTEST_CHECK(perfect["silhouette_iou"].get<double>() == doctest::Approx(1));
    DOCTEST_CHECK(perfect["sharp_ssim"].get<double>() == doctest::Approx(1));
    DOCTEST_CHECK(perfect["gradient_energy"].get<double>() == doctest::Approx(1));
    DOCTEST_CHECK(perfect["old_left"].get<double>() == doctest::Approx(0));
    DOCTEST_CHECK(perfect["old_unchanged"].get<double>() == 0);
    DOCTEST_CHECK(perfect["old_shown"].get<double>() == 0);
    DOCTEST_CHECK(perfect["l1_reduction"].get<double>() == doctest::Approx(1).epsilon(1e-3));
    // Nobody who knows the sentence alone is that good, nor is the best guess as far off as no edit.
    DOCTEST_CHECK(perfect["mean_truth"]["l1_reduction"].get<double>() < 0.95);
    DOCTEST_CHECK(perfect["mean_truth"]["l1_reduction"].get<double>() > 0.2);
    DOCTEST_CHECK(perfect["mean_truth"]["old_left"].get<double>() < 0.5);
    const auto ground = rows_of(edited, synth::Part::Ground);  // what closes holes is no part of the thing
    for (std::size_t row = 0; row < ground.size(); ++row)
        result.label[row] |= ground[row], result.hole_fill[row] = ground[row];
    DOCTEST_CHECK(edited_figures(setting, plan, result, {painter})["silhouette_iou"].get<double>() ==
                  doctest::Approx(1));
    result.set = setting.source.scene.gaussians;
    result.label = rows_of(setting.source, synth::Part::Object);
    result.hole_fill.assign(result.label.size(), 0);
    std::iota(result.base_to_new.begin(), result.base_to_new.end(), std::int64_t{0});
    const auto nothing = edited_figures(setting, plan, result, {painter});
    DOCTEST_CHECK(nothing["silhouette_iou"].get<double>() < 0.9);
    DOCTEST_CHECK(nothing["sharp_ssim"].get<double>() < perfect["sharp_ssim"].get<double>());
    DOCTEST_CHECK(nothing["old_left"].get<double>() == doctest::Approx(1));
    DOCTEST_CHECK(nothing["old_unchanged"].get<double>() == doctest::Approx(1));
    DOCTEST_CHECK(nothing["old_shown"].get<double>() == doctest::Approx(1));
    DOCTEST_CHECK(nothing["l1_reduction"].get<double>() == doctest::Approx(0));
}

DOCTEST_TEST_CASE(
    "what replaces has figures of its own and leaves the others as they are; what is added has a line per "
    "thing") {
    const Json plain = report_of(Json::array({changed_edit(0, 0.9, 0.8, 40)}));
    Json replaced = changed_edit(1, 0.5, 0.25, 20);
    replaced["kind"] = "replace";
    replaced["silhouette_iou"] = 0.75;
    replaced["sharp_ssim"] = 0.625;
    replaced["gradient_energy"] = 0.5;
    replaced["old_left"] = 0.125;
    replaced["old_unchanged"] = 0.0625;
    replaced["old_shown"] = 0.03125;
    replaced["mean_truth"] = {{"l1_reduction", 0.75}, {"old_left", 0.0625}};
    Json hat = changed_edit(2, 0, 0.5, 40);
    hat["kind"] = "add";
    hat["target"] = "hat";
    hat["silhouette_iou"] = 0.5;
    hat["sharp_ssim"] = 0.5;
    hat["gradient_energy"] = 2.0;
    Json crown = hat, failed = hat;
    crown["gradient_energy"] = 1.0;
    crown["target"] = "crown";
    for (const char* key : {"silhouette_iou", "sharp_ssim", "gradient_energy"}) failed.erase(key);
    failed["error"] = "no place";
    const auto before = eval_summary(plain);
    const auto with = eval_summary(report_of(Json::array({changed_edit(0, 0.9, 0.8, 40), replaced})));
    for (const char* key :
         {"psnr_outside_db", "existing_weighted_iou", "change_l1_reduction", "mode_right", "leak_rate"})
        DOCTEST_CHECK(before[key] == with[key]);
    DOCTEST_CHECK(!before.contains("replace_silhouette_iou"));
    DOCTEST_CHECK(with["replace_silhouette_iou"]["value"] == doctest::Approx(0.75));
    DOCTEST_CHECK(with["replace_silhouette_iou"]["met"] == false);
    DOCTEST_CHECK(with["replace_l1_reduction"]["value"] == doctest::Approx(0.25));
    DOCTEST_CHECK(with["replace_old_left"]["value"] == doctest::Approx(0.125));
    DOCTEST_CHECK(with["replace_old_unchanged"]["value"] == doctest::Approx(0.0625));
    DOCTEST_CHECK(with["replace_old_shown"]["value"] == doctest::Approx(0.03125));
    DOCTEST_CHECK(with["replace_mean_truth_l1_reduction"]["value"] == doctest::Approx(0.75));
    DOCTEST_CHECK(with["replace_mean_truth_old_left"]["value"] == doctest::Approx(0.0625));
    DOCTEST_CHECK(with["replace_sharp_ssim"]["value"] == doctest::Approx(0.625));
    DOCTEST_CHECK(with["replace_gradient_energy"]["met"] == false);
    DOCTEST_CHECK(!with.contains("added_gradient_energy"));
    const auto added = eval_summary(report_of(Json::array({hat, crown, failed})));
    DOCTEST_CHECK(added["added_gradient_energy"]["value"] == doctest::Approx(1.5));  // a failed one has none
    const auto table = added["added_means"];
    DOCTEST_REQUIRE(table.size() == 2);
    DOCTEST_CHECK(table[1]["thing"] == "hat");
    DOCTEST_CHECK(table[1]["edits"] == 2);
    DOCTEST_CHECK(table[1]["failed"] == 1);
    DOCTEST_CHECK(table[1]["silhouette_iou"] == doctest::Approx(0.25));  // the failed one has no outline
    DOCTEST_CHECK(table[1]["leak_rate"] == doctest::Approx(0));
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

}  // namespace eval_test
