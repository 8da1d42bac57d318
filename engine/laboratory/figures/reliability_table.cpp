// Labels in bins of the confidence.
#include "engine/laboratory/figures/reliability_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "engine/laboratory/figures/figure_tables.h"

namespace gse::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr double RightIou = 0.8;
constexpr std::array<double, 6> Bounds{0, 0.2, 0.3, 0.5, 0.7, 1};  // of the bins

/// Label of a search.
struct Label {
    double confidence = 0, iou = 0;
};

void take(std::vector<Label>& labels, const Json& confidence, const Json& iou) {
    if (confidence.is_number() && iou.is_number())
        labels.push_back({confidence.get<double>(), iou.get<double>()});
}

std::vector<Label> drawn_labels(const std::vector<Json>& reports) {
    std::vector<Label> labels;
    for (const auto& report : reports)
        for (const auto& edit : report["edits"])
            if (edit.contains("confidence") && edit.contains("weighted_iou"))
                take(labels, edit["confidence"], edit["weighted_iou"]);
    return labels;
}

std::vector<Label> scanned_labels(const Json& report) {
    std::vector<Label> labels;
    if (report.is_null()) return labels;
    for (const auto& task : report["tasks"])
        if (const auto run = task["runs"].find("word"); run != task["runs"].end() && run->contains("opacity"))
            take(labels, (*run)["confidence"], (*run)["opacity"]["iou"]);
    return labels;
}

/// Number, mean IoU and share of right ones within a bin.
std::vector<std::string> cells_of(const std::vector<Label>& labels, double low, double high) {
    double count = 0, sum = 0, right = 0;
    for (const auto& label : labels) {
        if (label.confidence < low || (label.confidence >= high && high < Bounds.back())) continue;
        count += 1, sum += label.iou, right += label.iou >= RightIou ? 1 : 0;
    }
    if (count == 0) return {"0", "-", "-"};
    return {fmt::format("{:.0f}", count), fmt::format("{:.2f}", sum / count),
            fmt::format("{:.0f} %", 100 * right / count)};
}

}  // namespace

std::string reliability_table(const std::vector<Json>& drawn, const Json& scans) {
    const auto of_drawn = drawn_labels(drawn), of_scans = scanned_labels(scans);
    if (of_drawn.empty() && of_scans.empty()) return {};
    const auto right = fmt::format("IoU at least {}", RightIou);
    std::vector<std::vector<std::string>> rows{
        {"confidence", "drawn scenes: labels", "mean IoU", right, "scans: labels", "mean IoU", right}};
    for (std::size_t i = 0; i + 1 < Bounds.size(); ++i) {
        rows.push_back({fmt::format("{} to {}", Bounds[i], Bounds[i + 1])});
        for (const auto* labels : {&of_drawn, &of_scans})
            for (auto& cell : cells_of(*labels, Bounds[i], Bounds[i + 1]))
                rows.back().push_back(std::move(cell));
    }
    return markdown_table(rows);
}

}  // namespace gse::bench
