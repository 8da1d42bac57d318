// Groups, scenes and tasks of an evaluation on scans.
#include "engine/laboratory/figures/real_tables.h"

#include <fmt/format.h>

#include <array>
#include <functional>
#include <map>
#include <vector>

#include "engine/base/error.h"
#include "engine/laboratory/eval/real/real_summary.h"
#include "engine/laboratory/figures/figure_tables.h"

namespace gse::bench {
namespace {

using Json = nlohmann::ordered_json;
using Cells = std::vector<std::string>;

std::string ratio(const Json& value) {
    return value.is_number() ? fmt::format("{:.2f}", value.get<double>()) : "-";
}

std::string count(const Json& value) { return std::to_string(value.get<int>()); }

std::string with_goal(const Json& value, const Json& goal) {
    return ratio(value) + (goal.is_number() ? fmt::format(" (goal {})", ratio(goal)) : "");
}

std::string causes_text(const Json& causes) {
    std::string text;
    for (const auto& [cause, number] : causes.items())
        text += fmt::format("{}{} {}", text.empty() ? "" : ", ", number.get<int>(), cause);
    return text;
}

std::string groups_table(const Json& groups) {
    const std::vector<std::pair<std::string, std::function<std::string(const Json&)>>> figures{
        {"edits", [](const Json& group) { return count(group["runs"]); }},
        {"done", [](const Json& group) { return count(group["done"]); }},
        {"judged to have failed, kept out", [](const Json& group) { return count(group["kept_out"]); }},
        {"refused", [](const Json& group) { return count(group["refused"]); }},
        {"why", [](const Json& group) { return causes_text(group["causes"]); }},
        {"IoU of labels, mean",
         [](const Json& group) { return with_goal(group["iou_mean"], group["iou_goal"]); }},
        {"median", [](const Json& group) { return ratio(group["iou_median"]); }},
        {fmt::format("below {}, done and not amber", LeastIou),
         [](const Json& group) { return count(group["iou_below_half_not_amber"]); }},
        {"new splats in place, mean",
         [](const Json& group) { return with_goal(group["place_mean"], group["place_goal"]); }},
        {"median", [](const Json& group) { return ratio(group["place_median"]); }},
        {"candidates for silent failures", [](const Json& group) { return count(group["silent"]); }}};
    std::vector<Cells> rows{{""}};
    for (const auto& group : groups) rows.front().push_back(group["name"].get<std::string>());
    for (const auto& [title, text] : figures) {
        rows.push_back({title});
        for (const auto& group : groups) rows.back().push_back(text(group));
    }
    return markdown_table(rows);
}

std::string scenes_text(const Json& summary) {
    const auto& up = summary["up"];
    auto text = fmt::format("\nUp axis: {} right, {} wrong, {} asked.", up["right"].get<int>(),
                            up["wrong"].get<int>(), up["asked"].get<int>());
    for (const auto& [mode, front] : summary["front"].items())
        text += fmt::format("\nFront, by {}: {} of {} within 15 degrees, {} beyond 90.", mode,
                            front["within_15"].get<int>(), front["runs"].get<int>(),
                            front["beyond_90"].get<int>());
    return text + "\n\n";
}

/// Ending of a run, with IoU or place where they were measured.
std::string run_text(const Json& task, const char* mode) {
    if (!task["runs"].contains(mode)) return "";
    const auto& run = task["runs"][mode];
    auto text = run["ending"].get<std::string>();
    if (run.contains("cause")) text += ": " + run["cause"].get<std::string>();
    if (run["confidence"].is_number()) text += ", " + ratio(run["confidence"]) + " sure";
    if (run.contains("opacity")) text += ", IoU " + ratio(run["opacity"]["iou"]);
    if (run.contains("place_share")) text += ", in place " + ratio(run["place_share"]);
    return text;
}

constexpr std::array Modes{"word", "box", "click"};

/// Verdict on a run; empty where there is none.
std::string verdict_of(const Json& verdicts, const Json& task, const char* mode) {
    const auto found = verdicts.find(task["task"].get<std::string>());
    if (found == verdicts.end()) return {};
    if (!found->is_object()) throw Error(ErrorCode::Malformed, "a verdict is no object of ways to label");
    return found->value(mode, std::string());
}

/// How often each verdict was given, by way to label; empty without verdicts.
std::string counted_verdicts(const Json& report, const Json& verdicts) {
    std::map<std::string, std::array<int, Modes.size()>> counts;
    for (const auto& task : report["tasks"])
        for (std::size_t mode = 0; mode < Modes.size(); ++mode)
            if (const auto verdict = verdict_of(verdicts, task, Modes[mode]); !verdict.empty())
                ++counts[verdict.substr(0, verdict.find(':'))][mode];
    if (counts.empty()) return {};
    std::vector<Cells> rows{{"by eye", "by word", "by box", "by click"}};
    for (const auto& [verdict, numbers] : counts) {
        rows.push_back({verdict});
        for (const int number : numbers) rows.back().push_back(std::to_string(number));
    }
    return markdown_table(rows) + "\n";
}

/// A line per task; empty without verdicts.
std::string verdicts_table(const Json& report, const Json& verdicts) {
    std::vector<Cells> rows{{"task", "by word, by eye", "by box, by eye", "by click, by eye"}};
    for (const auto& task : report["tasks"]) {
        if (!verdicts.contains(task["task"].get<std::string>())) continue;
        rows.push_back({task["task"].get<std::string>()});
        for (const auto* mode : Modes) rows.back().push_back(verdict_of(verdicts, task, mode));
    }
    return rows.size() > 1 ? "\n" + markdown_table(rows) : std::string();
}

}  // namespace

std::string real_tables(const Json& report, const Json& verdicts) {
    if (!verdicts.is_object()) throw Error(ErrorCode::Malformed, "the verdicts are no object of tasks");
    const auto& summary = report["summary"];
    std::vector<Cells> rows{{"task", "source", "sentence", "by word", "by box", "by click"}};
    for (const auto& task : report["tasks"])
        rows.push_back({task["task"].get<std::string>(), task["source"].get<std::string>(),
                        task["prompt"].get<std::string>(), run_text(task, "word"), run_text(task, "box"),
                        run_text(task, "click")});
    return groups_table(summary["groups"]) + scenes_text(summary) + counted_verdicts(report, verdicts) +
           markdown_table(rows) + verdicts_table(report, verdicts);
}

}  // namespace gse::bench
