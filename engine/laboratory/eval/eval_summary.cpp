// Means, goals, tables.
#include "engine/laboratory/eval/eval_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <vector>

#include "engine/laboratory/eval/eval_compound_summary.h"
#include "engine/laboratory/eval/eval_rearranged_summary.h"

namespace gse::bench {
namespace {

using Json = nlohmann::ordered_json;

/// Goal of a figure.
struct Goal {
    const char* relation = nullptr;  // ">=", "<=", "==" or none
    double limit = 0;
    bool met(double value) const {
        const std::string text = relation;
        return text == ">=" ? value >= limit : text == "<=" ? value <= limit : value == limit;
    }
};

Json figure(const Json& value, const Goal& goal) {
    Json entry{{"value", value}, {"goal", nullptr}, {"met", nullptr}};
    if (goal.relation == nullptr) return entry;
    entry["goal"] = fmt::format("{} {:g}", goal.relation, goal.limit);
    if (!value.is_null()) entry["met"] = goal.met(value.get<double>());
    return entry;
}

bool failed(const Json& edit) { return edit.contains("error"); }

/// The value under `key`; of a failed edit zero where asked for.
double value_of(const Json& edit, const char* key, double otherwise) {
    return edit.contains(key) && edit[key].is_number() ? edit[key].get<double>() : otherwise;
}

using Edits = std::vector<const Json*>;

Edits of_kinds(const Json& edits, const std::vector<std::string>& kinds) {
    Edits list;
    for (const auto& edit : edits)
        if (kinds.empty() ||
            std::find(kinds.begin(), kinds.end(), edit["kind"].get<std::string>()) != kinds.end())
            list.push_back(&edit);
    return list;
}

Edits finished(const Edits& edits) {
    Edits list;
    for (const auto* edit : edits)
        if (!failed(*edit)) list.push_back(edit);
    return list;
}

/// Mean over the edits, a missing value counted as zero; null without edits.
Json mean(const Edits& edits, const char* key) {
    if (edits.empty()) return nullptr;
    double sum = 0;
    for (const auto* edit : edits) sum += value_of(*edit, key, 0);
    return sum / static_cast<double>(edits.size());
}

/// Median over the edits that have the figure; null without any.
Json median(const Edits& edits, const char* key) {
    std::vector<double> values;
    for (const auto* edit : edits)
        if (edit->contains(key) && (*edit)[key].is_number()) values.push_back((*edit)[key].get<double>());
    if (values.empty()) return nullptr;
    std::sort(values.begin(), values.end());
    const auto half = values.size() / 2;
    return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

Json lowest(const Edits& edits, const char* key) {
    if (edits.empty()) return nullptr;
    double least = value_of(*edits.front(), key, 0);
    for (const auto* edit : edits) least = std::min(least, value_of(*edit, key, 0));
    return least;
}

Json total(const Edits& edits, const char* key) {
    double sum = 0;
    for (const auto* edit : edits) sum += value_of(*edit, key, 0);
    return sum;
}

/// PSNR of the mean squared error over the edits: one bad edit is not outweighed by many perfect ones.
Json pooled_psnr(const Edits& edits, const char* key) {
    if (edits.empty()) return nullptr;
    double error = 0;
    for (const auto* edit : edits) error += std::pow(10, -value_of(*edit, key, 0) / 10);
    return -10 * std::log10(error / static_cast<double>(edits.size()));
}

/// 1 - sum of errors after / sum of errors before.
Json pooled_reduction(const Edits& edits) {
    double before = 0, after = 0;
    for (const auto* edit : edits) {
        before += value_of(*edit, "l1_before", 0);
        after += value_of(*edit, "l1_after", 0);
    }
    return before > 0 ? Json(1 - after / before) : Json(nullptr);
}

/// Share of edits whose direction exceeds the limit; null when there is no encoder. A failed edit is no
/// success.
Json success_share(const Edits& edits, const Json& report) {
    if (edits.empty() || !report["text_image_score"].get<bool>()) return nullptr;
    const double limit = report["parameters"]["success_direction"].get<double>();
    const auto count = std::count_if(edits.begin(), edits.end(), [&](const Json* edit) {
        return edit->contains("direction") && (*edit)["direction"].is_number() &&
               value_of(*edit, "direction", 0) > limit;
    });
    return static_cast<double>(count) / static_cast<double>(edits.size());
}

/// Kinds whose figures have been published as means over all of them; what replaces has figures of its own.
const std::vector<std::string> OfWhatStays{"recolour", "material", "add", "ground"};

void add_localization(const Json& edits, Json& summary) {
    const Edits existing = of_kinds(edits, {"recolour", "material", "ground"}),
                added = of_kinds(edits, {"add"});
    summary["existing_weighted_iou"] = figure(mean(existing, "weighted_iou"), {">=", 0.85});
    for (const char* key : {"iou", "mask_iou", "mask_boundary_f", "label_iou", "label_boundary_f"})
        summary[std::string("existing_") + key] = figure(mean(existing, key), {});
    summary["added_place_recall"] = figure(mean(added, "place_recall"), {">=", 0.7});
    summary["added_place_precision"] = figure(mean(added, "place_precision"), {">=", 0.4});
    summary["added_place_boundary_f"] = figure(mean(added, "place_boundary_f"), {});
    summary["mode_right"] = figure(mean(of_kinds(edits, OfWhatStays), "mode_right_number"), {});
}

void add_edits(const Json& report, const Json& edits, Json& summary) {
    const Edits changed = of_kinds(edits, {"recolour", "material"}), added = of_kinds(edits, {"add"});
    summary["change_l1_reduction"] = figure(mean(changed, "l1_reduction"), {">=", 0.6});
    summary["change_l1_reduction_pooled"] = figure(pooled_reduction(changed), {});
    for (const char* kind : {"recolour", "material", "add", "ground", "dye"}) {
        const Edits list = of_kinds(edits, {kind});
        if (!list.empty())
            summary[std::string(kind) + "_l1_reduction"] = figure(mean(list, "l1_reduction"), {});
    }
    summary["change_colour_error_reduction"] = figure(mean(changed, "colour_error_reduction"), {});
    summary["change_psnr_inside_db"] = figure(mean(finished(changed), "psnr_inside_db"), {});
    summary["change_ssim_inside"] = figure(mean(finished(changed), "ssim_inside"), {});
    summary["added_changed_recall"] = figure(mean(added, "changed_recall"), {});
    summary["added_changed_precision"] = figure(mean(added, "changed_precision"), {});
    summary["change_success"] = figure(success_share(changed, report), {">=", 0.8});
    summary["added_visible"] = figure(success_share(added, report), {">=", 0.6});
    summary["added_silhouette_iou"] = figure(mean(added, "silhouette_iou"), {});
}

void add_preservation(const Json& edits, Json& summary) {
    const Edits all = finished(of_kinds(edits, OfWhatStays)), every = finished(of_kinds(edits, {}));
    summary["psnr_outside_db"] = figure(mean(all, "psnr_outside_db"), {">=", 38});
    summary["psnr_outside_pooled_db"] = figure(pooled_psnr(all, "psnr_outside_db"), {});
    summary["psnr_outside_lowest_db"] = figure(lowest(all, "psnr_outside_db"), {});
    summary["ssim_outside"] = figure(mean(all, "ssim_outside"), {});
    summary["leak_rate"] = figure(mean(all, "leak_rate"), {"<=", 0.01});
    summary["own_psnr_outside_db"] = figure(mean(all, "own_psnr_outside_db"), {});
    summary["own_leak_rate"] = figure(mean(all, "own_leak_rate"), {});
    summary["drift"] = figure(total(every, "drift"), {"==", 0});
    summary["nonfinite"] = figure(total(every, "nonfinite"), {"==", 0});
    summary["inconsistency"] = figure(mean(all, "inconsistency"), {});
    summary["inconsistency_of_truth"] = figure(mean(all, "inconsistency_of_truth"), {});
}

/// Summary of other true scenes of each sentence ("another_truth": one, "mean_truth": the mean of several).
Json mean_of_truths(const Edits& edits, const char* which, const char* key) {
    double sum = 0;
    std::size_t count = 0;
    for (const Json* edit : edits) {
        if (!edit->contains(which)) continue;
        sum += (*edit)[which][key].get<double>();
        ++count;
    }
    return count > 0 ? Json(sum / static_cast<double>(count)) : Json();
}

/// Summary of the objects that others replaced.
void add_replacements(const Json& report, const Json& edits, Json& summary) {
    const Edits replaced = of_kinds(edits, {"replace"}), done = finished(replaced);
    if (replaced.empty()) return;
    summary["replace_silhouette_iou"] = figure(mean(replaced, "silhouette_iou"), {">=", 0.8});
    summary["replace_l1_reduction"] = figure(mean(replaced, "l1_reduction"), {">=", 0.5});
    summary["replace_old_left"] = figure(mean(done, "old_left"), {"<=", 0.05});
    summary["replace_old_unchanged"] = figure(mean(done, "old_unchanged"), {});
    summary["replace_old_shown"] = figure(mean(done, "old_shown"), {});
    for (const char* key : {"silhouette_iou", "l1_reduction", "old_left"})
        summary[std::string("replace_another_truth_") + key] =
            figure(mean_of_truths(done, "another_truth", key), {});
    for (const char* key : {"l1_reduction", "old_left"})
        summary[std::string("replace_mean_truth_") + key] =
            figure(mean_of_truths(done, "mean_truth", key), {});
    summary["replace_success"] = figure(success_share(replaced, report), {">=", 0.8});
    summary["replace_psnr_outside_db"] = figure(mean(done, "psnr_outside_db"), {">=", 38});
    summary["replace_leak_rate"] = figure(mean(done, "leak_rate"), {});
    summary["replace_mode_right"] = figure(mean(replaced, "mode_right_number"), {});
    summary["replace_weighted_iou"] = figure(mean(replaced, "weighted_iou"), {});
}

/// Sharpness of what is new. Medians, as a thing of one plain colour hardly has gradients to compare with.
void add_sharpness_of(const std::string& name, const Edits& edits, Json& summary) {
    const Edits done = finished(edits);
    if (median(done, "sharp_ssim").is_null()) return;
    summary[name + "_sharp_ssim"] = figure(median(done, "sharp_ssim"), {});
    summary[name + "_gradient_energy"] = figure(median(done, "gradient_energy"), {">=", 0.6});
}

/// Rate of warnings by the verdict on the redrawn views: for edits that bring the scene no nearer to the
/// truth, and for the others.
void add_verdicts(const Json& edits, Json& summary) {
    std::size_t judged[2] = {0, 0}, warned[2] = {0, 0};
    for (const auto& edit : edits) {
        if (!edit.contains("gate") || !edit["gate"]["score"].is_number() || failed(edit)) continue;
        const std::size_t worked = value_of(edit, "l1_reduction", 0) > 0 ? 1 : 0;
        ++judged[worked];
        if (edit["gate"]["warns"].get<bool>()) ++warned[worked];
    }
    const char* const names[2] = {"gate_warned_of_failures", "gate_warned_of_successes"};
    for (std::size_t i = 0; i < 2; ++i)
        if (judged[i] > 0)
            summary[names[i]] = figure(static_cast<double>(warned[i]) / static_cast<double>(judged[i]), {});
}

/// Means over the edits that add the same thing, a line per thing.
Json added_means(const Json& edits) {
    Json table = Json::array();
    const Edits added = of_kinds(edits, {"add"});
    std::set<std::string> things;
    for (const auto* edit : added) things.insert((*edit)["target"].get<std::string>());
    for (const auto& thing : things) {
        Edits same;
        for (const auto* edit : added)
            if ((*edit)["target"] == thing) same.push_back(edit);
        const Edits done = finished(same);
        Json entry{{"thing", thing}, {"edits", same.size()}, {"failed", same.size() - done.size()}};
        for (const char* key : {"silhouette_iou", "l1_reduction", "place_recall", "place_precision"})
            entry[key] = mean(same, key);
        for (const char* key : {"direction", "psnr_outside_db", "leak_rate"}) entry[key] = mean(done, key);
        table.push_back(std::move(entry));
    }
    return table;
}

/// Means of the whole method ("full", on the same edits) and of every ablation.
Json ablation_means(const Json& report) {
    Json table = Json::array();
    const auto line = [&](const std::string& name, const Edits& edits) {
        const Edits done = finished(edits);
        Json entry{{"name", name}, {"edits", edits.size()}, {"failed", edits.size() - done.size()}};
        for (const char* key :
             {"l1_reduction", "psnr_outside_db", "ssim_outside", "leak_rate", "inconsistency"})
            entry[key] = mean(done, key);
        entry["psnr_outside_pooled_db"] = pooled_psnr(done, "psnr_outside_db");
        entry["drift"] = total(done, "drift");
        table.push_back(std::move(entry));
    };
    const Json& ablations = report["ablations"];
    if (ablations.empty()) return table;
    Edits full;
    for (const auto& edit : ablations[0]["edits"])
        for (const auto& other : report["edits"])
            if (other["index"] == edit["index"]) full.push_back(&other);
    line("full", full);
    for (const auto& ablation : ablations)
        line(ablation["name"].get<std::string>(), of_kinds(ablation["edits"], {}));
    return table;
}

const Json* named(const Json& table, const std::string& name) {
    for (const auto& entry : table)
        if (entry["name"] == name) return &entry;
    return nullptr;
}

/// Order of the paper, as 1 or 0: both ablations keep the rest less well.
void add_order(const Json& table, Json& summary) {
    const Json* full = named(table, "full");
    for (const char* name : {"no_localization", "no_pseudo_gt"}) {
        const Json* other = named(table, name);
        const auto known = [](const Json* entry) {
            return entry != nullptr && (*entry)["psnr_outside_pooled_db"].is_number();
        };
        const bool measured = known(full) && known(other);
        const bool worse = measured &&
                           (*other)["psnr_outside_pooled_db"] < (*full)["psnr_outside_pooled_db"] &&
                           (*other)["leak_rate"] > (*full)["leak_rate"];
        summary[std::string(name) + "_worse"] =
            figure(measured ? Json(worse ? 1 : 0) : Json(nullptr), {"==", 1});
    }
}

std::string number(const Json& entry, const char* key, int digits) {
    if (!entry.contains(key) || !entry[key].is_number()) return "-";
    return fmt::format("{:.{}f}", entry[key].get<double>(), digits);
}

std::string edit_line(const Json& edit) {
    const bool added = edit["kind"] == "add";
    std::string line =
        fmt::format("{:>3} {:<9}", edit["index"].get<std::size_t>(), edit["kind"].get<std::string>());
    if (failed(edit)) {
        line += " FAILED: " + edit["error"].get<std::string>();
    } else {
        line += fmt::format("{:>6}{:>6}{:>6}{:>6}", number(edit, added ? "place_recall" : "weighted_iou", 2),
                            number(edit, added ? "place_precision" : "iou", 2),
                            number(edit, added ? "place_iou" : "mask_iou", 2),
                            number(edit, added ? "place_boundary_f" : "mask_boundary_f", 2));
        line += fmt::format("{:>8}{:>8}{:>8}{:>8}{:>7}{:>7}{:>6}", number(edit, "l1_reduction", 2),
                            number(edit, "psnr_inside_db", 1), number(edit, "psnr_outside_db", 1),
                            number(edit, "leak_rate", 4), number(edit, "drift", 0),
                            number(edit, "direction", 2), number(edit["seconds"], "total", 1));
        if (edit.contains("silhouette_iou")) line += "  outline " + number(edit, "silhouette_iou", 2);
        if (edit.contains("sharp_ssim"))
            line += fmt::format(", at 256 px SSIM {}, gradients {}", number(edit, "sharp_ssim", 2),
                                number(edit, "gradient_energy", 2));
        if (edit.contains("old_left")) line += ", old left " + number(edit, "old_left", 2);
    }
    return fmt::format("{}  {}  [{} -> {}]\n", line, edit["prompt"].get<std::string>(),
                       edit["word"].get<std::string>(), edit["target"].get<std::string>());
}

std::string ablation_lines(const Json& table) {
    if (table.empty()) return {};
    std::string text = fmt::format("\n{:<16}{:>6}{:>8}{:>9}{:>9}{:>9}{:>9}{:>8}\n", "ablation", "edits",
                                   "L1 red.", "PSNR out", "pooled", "SSIM out", "leak", "drift");
    for (const auto& entry : table)
        text += fmt::format("{:<16}{:>6}{:>8}{:>9}{:>9}{:>9}{:>9}{:>8}\n", entry["name"].get<std::string>(),
                            entry["edits"].get<std::size_t>(), number(entry, "l1_reduction", 3),
                            number(entry, "psnr_outside_db", 1), number(entry, "psnr_outside_pooled_db", 1),
                            number(entry, "ssim_outside", 4), number(entry, "leak_rate", 4),
                            number(entry, "drift", 0));
    return text;
}

std::string added_lines(const Json& table) {
    if (table.empty()) return {};
    std::string text = fmt::format("\n{:<12}{:>6}{:>9}{:>9}{:>8}{:>8}{:>7}{:>9}{:>9}\n", "added", "edits",
                                   "outline", "L1 red.", "recall", "prec.", "CLIP", "PSNR out", "leak");
    for (const auto& entry : table)
        text +=
            fmt::format("{:<12}{:>6}{:>9}{:>9}{:>8}{:>8}{:>7}{:>9}{:>9}\n", entry["thing"].get<std::string>(),
                        entry["edits"].get<std::size_t>(), number(entry, "silhouette_iou", 2),
                        number(entry, "l1_reduction", 2), number(entry, "place_recall", 2),
                        number(entry, "place_precision", 2), number(entry, "direction", 2),
                        number(entry, "psnr_outside_db", 1), number(entry, "leak_rate", 4));
    return text;
}

std::string scene_lines(const Json& scenes) {
    if (scenes.empty()) return {};
    std::string text = fmt::format("\n{:>9}{:>9}{:>9}{:>9}{:>8}{:>8}  real scene\n", "labelled", "PSNR out",
                                   "SSIM out", "leak", "drift", "s");
    for (const auto& scene : scenes) {
        const auto name = scene["scene"].get<std::string>() + ": " + scene["prompt"].get<std::string>();
        if (failed(scene)) text += "FAILED: " + scene["error"].get<std::string>() + "  " + name + "\n";
        else
            text += fmt::format("{:>9}{:>9}{:>9}{:>9}{:>8}{:>8}  {}\n", number(scene, "labelled", 0),
                                number(scene, "psnr_outside_db", 1), number(scene, "ssim_outside", 4),
                                number(scene, "leak_rate", 4), number(scene, "drift", 0),
                                number(scene["seconds"], "total", 1), name);
    }
    return text;
}

std::string summary_lines(const Json& summary) {
    std::string text = "\n";
    for (const auto& [name, entry] : summary.items()) {
        if (!entry.is_object() || !entry.contains("value")) continue;
        text += fmt::format("{:<30}{:>10}", name, number(entry, "value", 4));
        if (entry["goal"].is_string())
            text += fmt::format("   goal {:<8} {}", entry["goal"].get<std::string>(),
                                entry["met"].is_null()     ? "not measured"
                                : entry["met"].get<bool>() ? "met"
                                                           : "MISSED");
        text += "\n";
    }
    return text;
}

}  // namespace

Json eval_summary(const Json& report) {
    Json edits = report["edits"];
    std::size_t failures = 0;
    for (auto& edit : edits) {
        failures += failed(edit) ? 1 : 0;
        edit["mode_right_number"] = edit.contains("mode_right") && edit["mode_right"].get<bool>() ? 1 : 0;
    }
    Json summary;
    summary["edits"] = figure(edits.size(), {});
    summary["failed"] = figure(failures, {"==", 0});
    add_localization(edits, summary);
    add_edits(report, edits, summary);
    add_preservation(edits, summary);
    add_replacements(report, edits, summary);
    add_sharpness_of("added", of_kinds(edits, {"add"}), summary);
    add_sharpness_of("replace", of_kinds(edits, {"replace"}), summary);
    add_verdicts(edits, summary);
    const Json compounds = compound_summary(edits);
    for (const auto& [name, value] : compounds.items())
        summary[name] = figure(value, name == "compound_lost_splats" ? Goal{"==", 0} : Goal{});
    const Json rearranged = rearranged_summary(edits);
    for (const auto& [name, value] : rearranged.items())
        summary[name] = figure(value, name.ends_with("_rows_changed_outside") ? Goal{"==", 0} : Goal{});
    summary["added_means"] = added_means(edits);
    const Json table = ablation_means(report);
    if (!table.empty()) add_order(table, summary);
    summary["ablation_means"] = table;
    return summary;
}

std::string eval_table(const Json& report) {
    std::string text = fmt::format(
        "{:>3} {:<9}{:>6}{:>6}{:>6}{:>6}{:>8}{:>8}{:>8}{:>8}{:>7}{:>7}{:>6}  (add: recall, precision, IoU, "
        "outline F of the place)\n",
        "#", "kind", "wIoU", "IoU", "mIoU", "mF", "L1 red.", "PSNR in", "out", "leak", "drift", "CLIP", "s");
    for (const auto& edit : report["edits"]) text += edit_line(edit);
    text += compound_lines(report["edits"]);
    text += rearranged_lines(report["edits"]);
    text += added_lines(report["summary"]["added_means"]);
    text += ablation_lines(report["summary"]["ablation_means"]);
    text += scene_lines(report["scenes"]);
    return text + summary_lines(report["summary"]);
}

}  // namespace gse::bench
