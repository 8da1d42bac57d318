// One table for removals, one for the rest.
#include "engine/laboratory/eval/eval_rearranged_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <vector>

#include "engine/laboratory/eval/eval_suite.h"

namespace gse::bench {
namespace {

using Json = nlohmann::ordered_json;

struct Column {
    const char *key, *title, *format;
    bool largest = false;  // over the edits of a kind, in place of the mean
};

const std::vector<Column>& removal_columns() {
    static const std::vector<Column> list{{"label_iou", "IoU", "{:.2f}"},
                                          {"hole_share", "hole", "{:.3f}"},
                                          {"psnr_hole_db", "PSNR", "{:.1f}"},
                                          {"psnr_hole_deleted_db", "deleted", "{:.1f}"},
                                          {"psnr_hole_mean_db", "mean", "{:.1f}"},
                                          {"ssim_hole", "SSIM", "{:.3f}"},
                                          {"ssim_hole_deleted", "deleted", "{:.3f}"},
                                          {"ssim_hole_mean", "mean", "{:.3f}"},
                                          {"thing_left", "left", "{:.3f}"},
                                          {"psnr_outside_truth_db", "outside", "{:.1f}"},
                                          {"rows_added", "added", "{:.0f}"},
                                          {"rows_removed_lit", "lit", "{:.0f}"},
                                          {"rows_removed_far", "far", "{:.0f}", true},
                                          {"rows_changed_outside", "changed", "{:.0f}", true}};
    return list;
}

const std::vector<Column>& place_columns() {
    static const std::vector<Column> list{{"label_iou", "IoU", "{:.2f}"},
                                          {"front_error_degrees", "front", "{:.0f}"},
                                          {"place_error", "place", "{:.3f}"},
                                          {"position_error", "position", "{:.1e}", true},
                                          {"covariance_error", "covar.", "{:.1e}", true},
                                          {"colour_error", "SH", "{:.1e}", true},
                                          {"copies_apart", "apart", "{:.2f}"},
                                          {"psnr_thing_db", "thing", "{:.1f}"},
                                          {"psnr_scene_db", "scene", "{:.1f}"},
                                          {"psnr_scene_before_db", "before", "{:.1f}"},
                                          {"rows_removed_far", "far", "{:.0f}", true},
                                          {"rows_changed_outside", "changed", "{:.0f}", true}};
    return list;
}

const std::vector<Column>& columns_of(const std::string& kind) {
    return kind == "remove" ? removal_columns() : place_columns();
}

std::vector<const Json*> done(const Json& edits, const std::string& kind) {
    std::vector<const Json*> list;
    for (const auto& edit : edits)
        if (edit["kind"] == kind && edit.contains("rearranged") && !edit.contains("error"))
            list.push_back(&edit);
    return list;
}

/// Mean or largest value of a column; null where no edit has it.
Json value_of(const std::vector<const Json*>& edits, const Column& column) {
    double sum = 0, largest = 0;
    std::size_t count = 0;
    for (const auto* edit : edits) {
        const Json& figures = (*edit)["rearranged"];
        if (!figures.contains(column.key) || !figures[column.key].is_number()) continue;
        const double value = figures[column.key].get<double>();
        sum += value;
        largest = std::max(largest, value);
        ++count;
    }
    if (count == 0) return nullptr;
    return column.largest ? largest : sum / static_cast<double>(count);
}

std::string text_of(const Json& value, const Column& column) {
    return fmt::format("{:>9}", value.is_number()
                                    ? fmt::format(fmt::runtime(column.format), value.get<double>())
                                    : std::string("-"));
}

std::string head(const std::string& kind) {
    std::string text = fmt::format("\n{:<14}", kind);
    for (const auto& column : columns_of(kind)) text += fmt::format("{:>9}", column.title);
    return text + "  judgement\n";
}

std::string line_of(const Json& edit) {
    std::string text = fmt::format("{:>3}{:<11}", edit["index"].get<std::size_t>(),
                                   edit["scanned"].get<bool>() ? "  scanned" : "");
    for (const auto& column : columns_of(edit["kind"].get<std::string>()))
        text += text_of(value_of({&edit}, column), column);
    const Json& judgement = edit["judgement"];
    return text + "  " +
           (judgement["passed"].get<bool>() ? "passed"
                                            : "REFUSED: " + judgement["reason"].get<std::string>()) +
           "  (" + edit["prompt"].get<std::string>() + ")\n";
}

}  // namespace

Json rearranged_summary(const Json& edits) {
    Json summary;
    for (const auto& kind : rearranged_kinds()) {
        const auto list = done(edits, kind);
        if (list.empty()) continue;
        double refused = 0;
        for (const auto* edit : list) refused += (*edit)["judgement"]["passed"].get<bool>() ? 0 : 1;
        summary[kind + "_edits"] = list.size();
        summary[kind + "_refused"] = refused;
        for (const auto& column : columns_of(kind))
            if (const Json value = value_of(list, column); !value.is_null())
                summary[kind + "_" + column.key] = value;
    }
    return summary;
}

std::string rearranged_lines(const Json& edits) {
    std::string text;
    for (const auto& kind : rearranged_kinds()) {
        const auto list = done(edits, kind);
        if (list.empty()) continue;
        text += head(kind);
        for (const auto* edit : list) text += line_of(*edit);
        text += fmt::format("{:<14}", "all");
        for (const auto& column : columns_of(kind)) text += text_of(value_of(list, column), column);
        text += "\n";
    }
    return text;
}

}  // namespace gse::bench
