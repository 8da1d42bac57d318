// Sums over steps.
#include "engine/laboratory/eval/eval_compound_summary.h"

#include <fmt/format.h>

#include <map>
#include <utility>

namespace gse::bench {
namespace {

using Json = nlohmann::ordered_json;

/// Running mean.
struct Average {
    double sum = 0;
    std::size_t count = 0;
    void add(double value) {
        sum += value;
        ++count;
    }
    Json value() const { return count > 0 ? Json(sum / static_cast<double>(count)) : Json(); }
};

bool is_done_compound(const Json& edit) { return edit["kind"] == "compound" && !edit.contains("error"); }

std::string kept_text(const Json& kept) {
    return fmt::format(
        "; kept {} of {} splats, {} met, colour error {:.3f} then {:.3f}",
        kept["rows"].get<std::size_t>() - kept["met"].get<std::size_t>() - kept["lost"].get<std::size_t>(),
        kept["rows"].get<std::size_t>(), kept["met"].get<std::size_t>(), kept["colour_error"].get<double>(),
        kept["colour_error_at_end"].get<double>());
}

}  // namespace

Json compound_summary(const Json& edits) {
    std::map<std::string, Average> reductions;
    Average outside, refused, then, finally;
    double rows = 0, met = 0, lost = 0;
    for (const auto& edit : edits) {
        if (!is_done_compound(edit)) continue;
        for (const auto& step : edit["steps"]) {
            reductions[step["kind"].get<std::string>()].add(step["l1_reduction"].get<double>());
            outside.add(step["psnr_outside_db"].get<double>());
            refused.add(step["judgement"]["passed"].get<bool>() ? 0 : 1);
        }
        for (const auto& kept : edit["kept"]) {
            rows += kept["rows"].get<double>();
            met += kept["met"].get<double>();
            lost += kept["lost"].get<double>();
            then.add(kept["colour_error"].get<double>());
            finally.add(kept["colour_error_at_end"].get<double>());
        }
    }
    Json summary;
    if (outside.count == 0) return summary;
    summary["compound_steps"] = outside.count;
    summary["compound_steps_refused"] = refused.value();
    for (const auto& [kind, reduction] : reductions)
        summary["compound_" + kind + "_l1_reduction"] = reduction.value();
    summary["compound_psnr_outside_db"] = outside.value();
    summary["compound_earlier_splats"] = rows;
    summary["compound_met_splats"] = met;
    summary["compound_lost_splats"] = lost;
    summary["compound_colour_error"] = then.value();
    summary["compound_colour_error_at_end"] = finally.value();
    return summary;
}

std::string compound_lines(const Json& edits) {
    std::string text;
    for (const auto& edit : edits) {
        if (!is_done_compound(edit)) continue;
        text +=
            fmt::format("\n{:>3} {}\n", edit["index"].get<std::size_t>(), edit["prompt"].get<std::string>());
        for (std::size_t i = 0; i < edit["steps"].size(); ++i) {
            const auto& step = edit["steps"][i];
            text += fmt::format("    {} {:<9} {:<10} L1 red. {:.2f}, PSNR out {:.1f}{}{}\n", i + 1,
                                step["kind"].get<std::string>(), step["target"].get<std::string>(),
                                step["l1_reduction"].get<double>(), step["psnr_outside_db"].get<double>(),
                                i < edit["kept"].size() ? kept_text(edit["kept"][i]) : "",
                                step["judgement"]["passed"].get<bool>()
                                    ? ""
                                    : "; REFUSED: " + step["judgement"]["reason"].get<std::string>());
        }
    }
    return text;
}

}  // namespace gse::bench
