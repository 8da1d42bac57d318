// The page of measurements: tables of hand-made results, and what the command refuses.
#include "engine/laboratory/figures/figure_tables.h"

#include <doctest/doctest.h>

#include <filesystem>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/laboratory/eval/real/real_summary.h"
#include "engine/laboratory/figures/figures.h"
#include "engine/laboratory/figures/real_tables.h"
#include "engine/laboratory/figures/reliability_table.h"
#include "tests/test_paths.h"

namespace gse::bench {
namespace {

using Json = nlohmann::ordered_json;

Json edit(const char* kind, const char* target, double removed, int unet) {
    return {{"kind", kind},
            {"target", target},
            {"mode", "modify"},
            {"l1_reduction", removed},
            {"psnr_outside_db", 60.4},
            {"networks", {{"edit", {{"unet", 10}}}, {"total", {{"unet", unet}}}}}};
}

/// A suite of one task, which is refused by word and done by box.
Json scans() {
    const Json refused{{"ending", "refused"}, {"cause", "unsure"}, {"confidence", 0.125},
                       {"seconds", 1.0},      {"level", "amber"},  {"warned", false}};
    const Json done{{"ending", "done"}, {"confidence", nullptr},
                    {"seconds", 1.0},   {"level", ""},
                    {"warned", false},  {"opacity", {{"iou", 0.75}, {"recall", 1.0}, {"precision", 0.75}}}};
    Json report{{"parameters", {{"real_only", ""}, {"real_modes", "word box click"}}},
                {"tasks",
                 {{{"task", "bear.blue"},
                   {"scene", "bear"},
                   {"source", "bear"},
                   {"prompt", "a blue bear"},
                   {"kind", "recolour"},
                   {"known_word", true},
                   {"runs", {{"word", refused}, {"box", done}}}}}},
                {"scenes", {{{"scene", "bear"}, {"up", {{"result", "wrong"}}}}}}};
    report["summary"] = real_summary(report);
    return report;
}

Json report(std::uint64_t seed) {
    return {{"parameters", {{"seed", seed}}},
            {"summary",
             {{"add_l1_reduction", {{"value", 0.5}, {"goal", ">= 0.4"}, {"met", true}}},
              {"drift", {{"value", 0}, {"goal", nullptr}, {"met", nullptr}}}}},
            {"edits",
             {edit("recolour", "pink", 0.5, 40),
              edit("recolour", "brown", 0.7, 60),
              {{"kind", "recolour"}, {"target", "pink"}, {"error", "failed"}}}}};
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

DOCTEST_TEST_CASE("labels are counted by the confidence of their searches, in drawn scenes and in scans") {
    Json drawn = report(1);
    drawn["edits"] = {{{"kind", "recolour"}, {"confidence", 0.75}, {"weighted_iou", 1.0}},
                      {{"kind", "recolour"}, {"confidence", 1.0}, {"weighted_iou", 0.5}},
                      {{"kind", "add"}, {"confidence", 0.75}},
                      {{"kind", "recolour"}, {"error", "failed"}}};
    Json real = scans();
    DOCTEST_CHECK(reliability_table({}, nullptr).empty());
    DOCTEST_CHECK(reliability_table({}, real).empty());  // a refused search has no label, a box no confidence
    real["tasks"][0]["runs"]["word"] = {{"ending", "done"}, {"confidence", 0.2}, {"opacity", {{"iou", 0.9}}}};
    const auto table = reliability_table({drawn}, real);
    DOCTEST_CHECK(table.find("| 0.7 to 1 | 2 | 0.75 | 50 % | 0 | - | - |") != std::string::npos);
    DOCTEST_CHECK(table.find("| 0.2 to 0.3 | 0 | - | - | 1 | 0.90 | 100 % |") != std::string::npos);
    DOCTEST_CHECK(table.find("| 0 to 0.2 | 0 | - | - | 0 | - | - |") != std::string::npos);
}

DOCTEST_TEST_CASE("A Markdown table has a head, a rule and as many cells in every row") {
    DOCTEST_CHECK(markdown_table({{"a", "b"}, {"1", "2"}}) == "| a | b |\n|---|---|\n| 1 | 2 |\n");
}

DOCTEST_TEST_CASE("Figures of a suite stand in a column per seed, with their goal") {
    const auto table = edits_table({report(1), report(7)});
    DOCTEST_CHECK(has(table, "|  | seed 1 | seed 7 | goal |"));
    DOCTEST_CHECK(has(table, "| added: error removed | 50.0 % | 50.0 % | >= 40.0 % |"));
    DOCTEST_CHECK(has(table, "| splats outside the label that changed | 0 | 0 |  |"));
    DOCTEST_CHECK_FALSE(has(table, "becomes another"));  // nothing was measured of it
}

DOCTEST_TEST_CASE("Groups of scans stand in columns, and every task has a line") {
    const auto tables = real_tables(scans());
    DOCTEST_CHECK(has(tables, "|  | by word, known nouns | by box |"));
    DOCTEST_CHECK(has(tables, "| why | 1 unsure |  |"));
    DOCTEST_CHECK(has(tables, "| IoU of labels, mean | - (goal 0.85) | 0.75 (goal 0.92) |"));
    DOCTEST_CHECK(has(tables, "Up axis: 0 right, 1 wrong, 0 asked."));
    DOCTEST_CHECK(
        has(tables, "| bear.blue | bear | a blue bear | refused: unsure, 0.12 sure | done, IoU 0.75 |"));
}

DOCTEST_TEST_CASE("Verdicts by eye are counted, and stand in a table of their own") {
    DOCTEST_CHECK_FALSE(has(real_tables(scans()), "by eye"));
    const Json verdicts{{"bear.blue", {{"word", "refused"}, {"box", "partly: an ear is left out"}}},
                        {"bear.unknown", {{"box", "success"}}}};
    const auto tables = real_tables(scans(), verdicts);
    DOCTEST_CHECK(has(tables, "| partly | 0 | 1 | 0 |\n| refused | 1 | 0 | 0 |\n"));
    DOCTEST_CHECK(has(tables, "| bear.blue | refused | partly: an ear is left out |  |"));
    DOCTEST_CHECK_THROWS_AS(real_tables(scans(), Json::array()), Error);
    DOCTEST_CHECK_THROWS_AS(real_tables(scans(), {{"bear.blue", "success"}}), Error);
}

DOCTEST_TEST_CASE("Medians leave out failed edits") {
    DOCTEST_CHECK(has(kinds_table({report(1)}), "| recolour | 2 | 60.0 % | - | 60 dB |"));
    DOCTEST_CHECK(has(words_table({report(1), report(2)}), "| pink | 2 | 50.0 % | - | 60 dB |"));
    DOCTEST_CHECK(
        has(passes_table({report(1)}), "| modify | 2 | 30 to 50, median 40 | 40 to 60, median 50 |"));
}

DOCTEST_TEST_CASE("Searches are counted as refused below the threshold, and as right above half an overlap") {
    const Json searches{{"searches",
                         {{{"kind", "object"}, {"confidence", 0.5}, {"present", true}, {"overlap", 0.8}},
                          {{"kind", "object"}, {"confidence", 0.1}, {"present", true}, {"overlap", 0.9}},
                          {{"kind", "unknown"}, {"confidence", 0.0}, {"present", false}, {"overlap", 0.0}}}}};
    const auto table = searches_table(searches, 0.2);
    DOCTEST_CHECK(has(table, "| object | 2 | 1 | 1 |"));
    DOCTEST_CHECK(has(table, "| unknown | 1 | 1 |  |"));
}

DOCTEST_TEST_CASE("Ways of a server's views have a line each, also on the page") {
    const Json rows{{{"agreement", "warp, second round"},
                     {"disagreement", 0.02504},
                     {"psnr_db", 22.61},
                     {"rejected", 0.0},
                     {"requests", 16.5},
                     {"megapixels", 0.61},
                     {"seconds", 12.34}}};
    const auto* line = "| warp, second round | 0.0250 | 22.6 | 0.0 | 16.5 | 0.61 |";
    DOCTEST_CHECK(has(servers_table(rows), line));
    const test::ScratchFolder scratch;
    FiguresRun run;
    run.results = scratch.path();
    run.parameters.suites = "";
    DOCTEST_CHECK(has(figures_page(run, {}), "`gseditpro-lab bench server --side 192`\n\nNot measured yet."));
    write_file(run.results / "server.json", rows.dump());
    DOCTEST_CHECK(has(figures_page(run, {}), line));
}

DOCTEST_TEST_CASE(
    "The page takes results that are there, says what was not measured, and refuses other settings") {
    const test::ScratchFolder scratch;
    const std::filesystem::path folder = scratch.path();
    FiguresRun run;
    run.results = folder;
    run.parameters.suites = "";
    run.parameters.seeds = "1";
    write_file(folder / "search.json",
               R"({"searches":[{"kind":"object","confidence":0.5,"present":true,"overlap":0.8}]})");
    const auto page = figures_page(run, {});
    DOCTEST_CHECK(has(page, "## Searches\n\n`gseditpro-lab bench search --scenes 8 --seed 62`\n\n| word |"));
    DOCTEST_CHECK(has(page, "## Speed\n\n`gseditpro-lab bench speed`\n\nNot measured yet."));
    DOCTEST_CHECK(has(page, "`gseditpro-lab eval --real SUITE`\n\nNot measured yet."));
    std::filesystem::create_directories(folder / "real");
    auto measured = scans();
    write_file(folder / "real/eval.json", measured.dump());
    DOCTEST_CHECK(has(figures_page(run, {}), "| bear.blue | bear | a blue bear | refused"));
    measured["parameters"]["real_only"] = "bear";
    write_file(folder / "real/eval.json", measured.dump());
    DOCTEST_CHECK_THROWS_AS(figures_page(run, {}), Error);
    std::filesystem::remove_all(folder / "real");
    std::filesystem::create_directories(folder / "eval_1");
    write_file(folder / "eval_1/eval.json", R"({"parameters":{"seed":2}})");
    DOCTEST_CHECK_THROWS_AS(figures_page(run, {}), Error);
    run.parameters.suites = "edit";
    DOCTEST_CHECK_THROWS_AS(figures_page(run, {}), Error);
}

}  // namespace gse::bench
