// Rows, formats and medians.
#include "engine/laboratory/figures/figure_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <map>

#include "engine/base/check.h"

namespace gse::bench {
namespace {

using Json = nlohmann::ordered_json;
using Cells = std::vector<std::string>;
using Edits = std::vector<const Json*>;

enum class Format { Ratio, Percent, Decibel, Count };

std::string text_of(double value, Format format) {
    switch (format) {
        case Format::Ratio: return fmt::format("{:.2f}", value);
        case Format::Percent: return fmt::format("{:.1f} %", 100 * value);
        case Format::Decibel: return fmt::format("{:.0f} dB", value);
        case Format::Count: return fmt::format("{:.0f}", value);
    }
    return {};
}

std::string text_of(const Json& value, Format format) {
    return value.is_number() ? text_of(value.get<double>(), format) : "-";
}

/// A figure of eval_summary() and its title.
struct Row {
    const char* title;
    const char* key;
    Format format;
};

constexpr Row SuiteRows[] = {
    {"edits that failed", "failed", Format::Count},
    {"mode chosen as the sentence needs", "mode_right", Format::Percent},
    {"things that are there: contribution-weighted IoU of the label", "existing_weighted_iou", Format::Ratio},
    {"added: recall of the place", "added_place_recall", Format::Ratio},
    {"added: precision of the place", "added_place_precision", Format::Ratio},
    {"added: outline IoU", "added_silhouette_iou", Format::Ratio},
    {"added: error removed", "add_l1_reduction", Format::Percent},
    {"added: SSIM at 256 pixels", "added_sharp_ssim", Format::Ratio},
    {"added: gradient energy at 256 pixels (truth: 1)", "added_gradient_energy", Format::Ratio},
    {"added: shows (direction above 0.25)", "added_visible", Format::Percent},
    {"recoloured, other material: error removed", "change_l1_reduction", Format::Percent},
    {"the same, pooled", "change_l1_reduction_pooled", Format::Percent},
    {"recoloured, other material: direction above 0.25", "change_success", Format::Percent},
    {"ground: error removed", "ground_l1_reduction", Format::Percent},
    {"PSNR outside", "psnr_outside_db", Format::Decibel},
    {"pixels outside that changed visibly", "leak_rate", Format::Percent},
    {"splats outside the label that changed", "drift", Format::Count},
    {"becomes another: outline IoU", "replace_silhouette_iou", Format::Ratio},
    {"becomes another: error removed", "replace_l1_reduction", Format::Percent},
    {"becomes another: SSIM at 256 pixels", "replace_sharp_ssim", Format::Ratio},
    {"becomes another: gradient energy at 256 pixels (truth: 1)", "replace_gradient_energy", Format::Ratio},
    {"becomes another: pixels of the old thing that are left", "replace_old_left", Format::Percent},
    {"becomes another: pixels of it that have not clearly changed", "replace_old_unchanged", Format::Percent},
    {"becomes another: pixels that mainly show its splats", "replace_old_shown", Format::Percent},
    {"another true scene of the sentence: outline IoU", "replace_another_truth_silhouette_iou",
     Format::Ratio},
    {"another true scene: error removed", "replace_another_truth_l1_reduction", Format::Percent},
    {"another true scene: old thing left", "replace_another_truth_old_left", Format::Percent},
    {"mean of sixteen true scenes: error removed", "replace_mean_truth_l1_reduction", Format::Percent},
    {"mean of sixteen true scenes: old thing left", "replace_mean_truth_old_left", Format::Percent},
    {"becomes another: direction above 0.25", "replace_success", Format::Percent},
    {"becomes another: PSNR outside", "replace_psnr_outside_db", Format::Decibel},
    {"becomes another: pixels outside that changed visibly", "replace_leak_rate", Format::Percent},
    {"successes that the verdict warned of", "gate_warned_of_successes", Format::Percent}};

/// ">= 0.8" in the row's own format.
std::string goal_text(const std::string& goal, Format format) {
    const auto space = goal.find(' ');
    return goal.substr(0, space + 1) + text_of(std::stod(goal.substr(space + 1)), format);
}

std::string seed_of(const Json& report) {
    return std::to_string(report["parameters"]["seed"].get<std::uint64_t>());
}

Cells row_of(const Row& row, const std::vector<Json>& reports) {
    Cells cells{row.title};
    std::string goal;
    bool any = false;
    for (const auto& report : reports) {
        const auto& summary = report["summary"];
        const bool there = summary.contains(row.key) && summary[row.key]["value"].is_number();
        cells.push_back(there ? text_of(summary[row.key]["value"], row.format) : "-");
        any |= there;
        if (there && summary[row.key]["goal"].is_string())
            goal = goal_text(summary[row.key]["goal"].get<std::string>(), row.format);
    }
    cells.push_back(goal);
    return any ? cells : Cells{};
}

Edits finished_edits(const std::vector<Json>& reports) {
    Edits edits;
    for (const auto& report : reports)
        for (const auto& edit : report["edits"])
            if (!edit.contains("error")) edits.push_back(&edit);
    return edits;
}

using Value = std::function<Json(const Json& edit)>;

Value value_named(const char* key) {
    return [key](const Json& edit) { return edit.contains(key) ? edit[key] : Json(); };
}

Json passes_of_edit(const Json& edit) { return edit["networks"]["total"]["unet"]; }

Json passes_of_search(const Json& edit) {
    const auto& networks = edit["networks"];
    const auto all = networks["total"]["unet"].get<std::int64_t>();
    return all - (networks.contains("edit") ? networks["edit"]["unet"].get<std::int64_t>() : 0);
}

std::vector<double> sorted_values(const Edits& edits, const Value& value) {
    std::vector<double> values;
    for (const auto* edit : edits)
        if (const Json found = value(*edit); found.is_number()) values.push_back(found.get<double>());
    std::sort(values.begin(), values.end());
    return values;
}

/// The middle of an odd number, the mean of both of an even one.
std::string median(const Edits& edits, const Value& value, Format format) {
    const auto values = sorted_values(edits, value);
    if (values.empty()) return "-";
    const auto half = values.size() / 2;
    return text_of(values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2, format);
}

std::string range(const Edits& edits, const Value& value) {
    const auto values = sorted_values(edits, value);
    if (values.empty()) return "-";
    return fmt::format("{:.0f} to {:.0f}, median {}", values.front(), values.back(),
                       median(edits, value, Format::Count));
}

/// The edits of every value of a text, in the order of their first ones.
std::vector<std::pair<std::string, Edits>> grouped(const Edits& edits, const char* key) {
    std::vector<std::pair<std::string, Edits>> groups;
    for (const auto* edit : edits) {
        const auto name = (*edit)[key].get<std::string>();
        const auto found = std::find_if(groups.begin(), groups.end(),
                                        [&](const auto& group) { return group.first == name; });
        if (found == groups.end()) groups.push_back({name, {edit}});
        else found->second.push_back(edit);
    }
    return groups;
}

std::string groups_table(const Edits& edits, const char* key, const char* title) {
    std::vector<Cells> rows{{title, "edits", "error removed", "outline IoU", "PSNR outside"}};
    for (const auto& [name, group] : grouped(edits, key))
        rows.push_back({name, std::to_string(group.size()),
                        median(group, value_named("l1_reduction"), Format::Percent),
                        median(group, value_named("silhouette_iou"), Format::Ratio),
                        median(group, value_named("psnr_outside_db"), Format::Decibel)});
    return markdown_table(rows);
}

}  // namespace

std::string markdown_table(const std::vector<Cells>& rows) {
    GSE_CHECK(!rows.empty());
    std::string text;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        GSE_CHECK_EQ(rows[i].size(), rows.front().size());
        text += "|";
        for (const auto& cell : rows[i]) text += " " + cell + " |";
        text += "\n";
        if (i > 0) continue;
        text += "|";
        for (std::size_t column = 0; column < rows[i].size(); ++column) text += "---|";
        text += "\n";
    }
    return text;
}

std::string edits_table(const std::vector<Json>& reports) {
    Cells head{""};
    for (const auto& report : reports) head.push_back("seed " + seed_of(report));
    head.push_back("goal");
    std::vector<Cells> rows{head};
    for (const auto& row : SuiteRows)
        if (auto cells = row_of(row, reports); !cells.empty()) rows.push_back(std::move(cells));
    return markdown_table(rows);
}

std::string kinds_table(const std::vector<Json>& reports) {
    return groups_table(finished_edits(reports), "kind", "medians of");
}

std::string words_table(const std::vector<Json>& reports) {
    return groups_table(finished_edits(reports), "target", "medians of");
}

std::string passes_table(const std::vector<Json>& reports) {
    std::vector<Cells> rows{{"mode", "edits", "search", "whole edit"}};
    for (const auto& [name, group] : grouped(finished_edits(reports), "mode"))
        rows.push_back({name, std::to_string(group.size()), range(group, passes_of_search),
                        range(group, passes_of_edit)});
    return markdown_table(rows);
}

std::string searches_table(const Json& searches, double least_confidence) {
    std::map<std::string, std::array<int, 3>> kinds;  // refused, labelled right, all
    constexpr double right = 0.5;                     // of an overlap
    for (const auto& search : searches["searches"]) {
        auto& counts = kinds[search["kind"].get<std::string>()];
        const bool refused = search["confidence"].get<double>() < least_confidence;
        counts[0] += refused ? 1 : 0;
        counts[1] += !refused && search["present"].get<bool>() && search["overlap"].get<double>() >= right;
        ++counts[2];
    }
    std::vector<Cells> rows{{"word", "searches", "refused", "labelled right"}};
    for (const auto& [kind, counts] : kinds)
        rows.push_back({kind, std::to_string(counts[2]), std::to_string(counts[0]),
                        kind.starts_with("absent") || kind == "unknown" ? "" : std::to_string(counts[1])});
    return markdown_table(rows);
}

std::string encoder_table(const Json& clip) {
    std::vector<Cells> rows{{"", "share"}};
    const auto& fronts = clip["fronts"];
    for (const double limit : {15.0, 45.0}) {
        const auto within = std::count_if(fronts.begin(), fronts.end(), [&](const Json& front) {
            return front["off_degrees"].get<double>() <= limit;
        });
        rows.push_back({fmt::format("front right within {:.0f} degrees", limit),
                        fmt::format("{} of {}", within, fronts.size())});
    }
    for (const auto& [kind, tally] : clip["retrieval"].items())
        if (!kind.starts_with("front"))
            rows.push_back(
                {"true word of a picture ranks first: " + kind, text_of(tally["right"], Format::Percent)});
    return markdown_table(rows);
}

std::string methods_table(const Json& edit) {
    std::vector<Cells> rows{{"method", "setting", "error removed", "UNet passes", "TFLOP", "seconds"}};
    for (const auto& curve : edit["curves"])
        for (const auto& point : curve["points"])
            rows.push_back(
                {curve["method"].get<std::string>(),
                 point["name"].get<std::string>() + (point["default"].get<bool>() ? " (default)" : ""),
                 text_of(point["error_removed"], Format::Percent), text_of(point["unet"], Format::Count),
                 text_of(point["tflop"], Format::Ratio),
                 point["seconds"].is_number() ? fmt::format("{:.1f}", point["seconds"].get<double>()) : "-"});
    return markdown_table(rows);
}

std::string servers_table(const Json& rows) {
    std::vector<Cells> cells{{"agreement", "disagreement", "PSNR, dB", "rejected", "requests", "megapixels"}};
    const auto number = [](const Json& value, int digits) {
        return fmt::format("{:.{}f}", value.get<double>(), digits);
    };
    for (const auto& row : rows)
        cells.push_back({row["agreement"].get<std::string>(), number(row["disagreement"], 4),
                         number(row["psnr_db"], 1), number(row["rejected"], 1), number(row["requests"], 1),
                         number(row["megapixels"], 2)});
    return markdown_table(cells);
}

std::string stability_table(const Json& stability) {
    std::vector<Cells> rows{{"cause", "scenes", "picture: median", "worst", "gradient: median", "worst",
                             "not finite", "other bits"}};
    const auto number = [](const Json& value) { return fmt::format("{:.0e}", value.get<double>()); };
    for (const auto& cause : stability["causes"])
        rows.push_back({cause["cause"].get<std::string>(), std::to_string(cause["scenes"].get<std::size_t>()),
                        number(cause["picture"]["median"]), number(cause["picture"]["worst"]),
                        number(cause["gradient"]["median"]), number(cause["gradient"]["worst"]),
                        std::to_string(cause["not_finite"].get<std::size_t>()),
                        std::to_string(cause["other_bits"].get<std::size_t>())});
    return markdown_table(rows);
}

}  // namespace gse::bench
