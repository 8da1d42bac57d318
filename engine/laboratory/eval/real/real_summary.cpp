// Groups of runs, candidates for silent failures, up axes, fronts.
#include "engine/laboratory/eval/real/real_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <vector>

namespace gse::bench {
namespace {

using Json = nlohmann::ordered_json;

/// A group of runs, and its goals; 0 = none.
struct Group {
    const char* name;
    const char* mode;
    int known_word;  // 1 known nouns, 0 others, -1 both
    double iou_goal, place_goal;
};
constexpr Group Groups[] = {
    {"by word, known nouns", "word", 1, 0.85, 0.8},   {"by word, unknown nouns", "word", 0, 0.85, 0.8},
    {"upright, known nouns", "upright", 1, 0, 0},     {"by box", "box", -1, 0.92, 0.88},
    {"by click, known nouns", "click", 1, 0.85, 0.8}, {"by click, unknown nouns", "click", 0, 0.85, 0.8}};
constexpr double FrontNear = 15, FrontFar = 90;  // degrees

double mean_of(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double median_of(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const auto middle = values.size() / 2;
    return values.size() % 2 == 1 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
}

/// "NAME_mean" and "NAME_median"; null without values.
void add_means(Json& entry, const std::string& name, const std::vector<double>& values) {
    entry[name + "_mean"] = values.empty() ? Json() : Json(mean_of(values));
    entry[name + "_median"] = values.empty() ? Json() : Json(median_of(values));
}

bool made(const Json& run) { return run["ending"] != "refused"; }

/// Share of the new splats in place; null where it says nothing.
Json place_of(const Json& task, const Json& run) {
    if (run.contains("place_share")) return run["place_share"];
    return made(run) && task["kind"] == "add" ? Json(0.0) : Json();
}

/// Low figures of a run that ended well and warns of nothing.
std::vector<std::string> silent_reasons(const Json& task, const Json& run) {
    std::vector<std::string> reasons;
    if (run["ending"] != "done" || run["level"] == "amber") return reasons;
    const auto add = [&](const char* name, const Json& value, double least) {
        if (value.is_number() && value.get<double>() < least)
            reasons.push_back(fmt::format("{} {:.2f}", name, value.get<double>()));
    };
    if (run.contains("opacity")) add("IoU", run["opacity"]["iou"], LeastIou);
    add("place", place_of(task, run), LeastPlace);
    // A taken-away thing changes as much as what is behind it differs.
    if (run.contains("seen_change_in_truth"))
        add("seen change", run["seen_change_in_truth"], LeastSeenChange);
    return reasons;
}

/// Counts and lists of a group.
struct Tally {
    int runs = 0, silent = 0, below = 0, below_sure = 0, place_below = 0;
    std::map<std::string, int> endings, causes;
    std::vector<double> ious, places, seconds;

    void add(const Json& task, const Json& run) {
        ++runs;
        ++endings[run["ending"].get<std::string>()];
        if (run.contains("cause")) ++causes[run["cause"].get<std::string>()];
        if (!silent_reasons(task, run).empty()) ++silent;
        if (made(run)) seconds.push_back(run["seconds"].get<double>());
        if (run.contains("opacity")) {
            ious.push_back(run["opacity"]["iou"].get<double>());
            const bool low = ious.back() < LeastIou;
            below += low ? 1 : 0;
            below_sure += low && run["ending"] == "done" && run["level"] != "amber" ? 1 : 0;
        }
        if (const Json place = place_of(task, run); place.is_number()) {
            places.push_back(place.get<double>());
            place_below += places.back() < LeastPlace ? 1 : 0;
        }
    }

    Json json(const Group& group) const {
        Json entry{{"name", group.name}, {"runs", runs}};
        for (const auto& [key, ending] :
             {std::pair{"done", "done"}, {"kept_out", "kept out"}, {"refused", "refused"}})
            entry[key] = endings.contains(ending) ? endings.at(ending) : 0;
        entry["causes"] = Json::object();
        for (const auto& [cause, count] : causes) entry["causes"][cause] = count;
        entry["labels"] = ious.size();
        add_means(entry, "iou", ious);
        entry["iou_goal"] = group.iou_goal > 0 ? Json(group.iou_goal) : Json();
        entry["iou_below_half"] = below;
        entry["iou_below_half_not_amber"] = below_sure;
        entry["places"] = places.size();
        add_means(entry, "place", places);
        entry["place_goal"] = group.place_goal > 0 ? Json(group.place_goal) : Json();
        entry["place_low"] = place_below;
        entry["silent"] = silent;
        add_means(entry, "seconds", seconds);
        return entry;
    }
};

Json groups_json(const Json& tasks) {
    Json list = Json::array();
    for (const auto& group : Groups) {
        Tally tally;
        for (const auto& task : tasks)
            if (task["runs"].contains(group.mode) &&
                (group.known_word < 0 || task["known_word"].get<bool>() == (group.known_word == 1)))
                tally.add(task, task["runs"][group.mode]);
        if (tally.runs > 0) list.push_back(tally.json(group));
    }
    return list;
}

Json silent_json(const Json& tasks) {
    Json list = Json::array();
    for (const auto& task : tasks)
        for (const auto& [mode, run] : task["runs"].items())
            if (const auto reasons = silent_reasons(task, run); !reasons.empty())
                list.push_back(
                    {{"task", task["task"]}, {"mode", mode}, {"low", reasons}, {"warned", run["warned"]}});
    return list;
}

Json up_json(const Json& scenes) {
    Json counts{{"right", 0}, {"wrong", 0}, {"asked", 0}};
    for (const auto& scene : scenes) {
        auto& count = counts[scene["up"]["result"].get<std::string>()];
        count = count.get<int>() + 1;
    }
    return counts;
}

/// Errors of fronts per mode: a box tells from where the artist looks.
Json front_json(const Json& tasks) {
    std::map<std::string, std::vector<double>> modes;
    for (const auto& task : tasks)
        for (const auto& [mode, run] : task["runs"].items())
            if (run.contains("front_error")) modes[mode].push_back(run["front_error"].get<double>());
    Json list = Json::object();
    for (const auto& [mode, errors] : modes) {
        const auto count = [&](auto&& test) { return std::count_if(errors.begin(), errors.end(), test); };
        list[mode] = {{"runs", errors.size()},
                      {"within_15", count([](double error) { return error <= FrontNear; })},
                      {"beyond_90", count([](double error) { return error > FrontFar; })}};
        add_means(list[mode], "error", errors);
    }
    return list;
}

std::string number(const Json& value, int digits = 2) {
    return value.is_number() ? fmt::format("{:.{}f}", value.get<double>(), digits) : "-";
}

std::string outcome_text(const Json& run) {
    const auto confidence = run["confidence"].is_number() ? fmt::format(" {} {}", number(run["confidence"]),
                                                                        run["level"].get<std::string>())
                                                          : std::string();
    if (run["ending"] == "refused")
        return fmt::format("refused, {}{}", run["cause"].get<std::string>(), confidence);
    return run["ending"].get<std::string>() + confidence + (run["warned"].get<bool>() ? ", warned" : "");
}

std::string run_line(const Json& task, const std::string& mode, const Json& run) {
    const auto part = [&](const char* of, const char* key) {
        return run.contains(of) ? run[of][key] : Json();
    };
    const auto plain = [&](const char* key) { return run.contains(key) ? run[key] : Json(); };
    return fmt::format("{:34} {:8} {:5.1f} {:38} {:>5} {:>5} {:>5} {:>6} {:>5} {:>5} {:>7} {:>6} {:>5}\n",
                       task["task"].get<std::string>(), mode, run["seconds"].get<double>(), outcome_text(run),
                       number(part("opacity", "iou")), number(part("opacity", "recall")),
                       number(part("opacity", "precision")), number(part("plain", "iou")),
                       number(part("seen", "iou")), number(place_of(task, run)),
                       number(plain("seen_change_in_truth")), number(plain("seen_spill")),
                       number(plain("front_error"), 0));
}

std::string group_lines(const Json& group) {
    std::string causes;
    for (const auto& [cause, count] : group["causes"].items())
        causes += fmt::format("{}{} {}", causes.empty() ? "" : ", ", count.get<int>(), cause);
    auto text =
        fmt::format("\n{}: {} runs, {} done, {} kept out, {} refused{}\n", group["name"].get<std::string>(),
                    group["runs"].get<int>(), group["done"].get<int>(), group["kept_out"].get<int>(),
                    group["refused"].get<int>(), causes.empty() ? "" : " (" + causes + ")");
    const auto goal = [&](const char* key) {
        return group[key].is_number() ? fmt::format(" (goal {})", number(group[key])) : std::string();
    };
    text += fmt::format(
        "  IoU of {} labels: mean {}{}, median {}; below {} {}, of them {} done and not amber\n",
        group["labels"].get<int>(), number(group["iou_mean"]), goal("iou_goal"), number(group["iou_median"]),
        LeastIou, group["iou_below_half"].get<int>(), group["iou_below_half_not_amber"].get<int>());
    text += fmt::format("  new splats in place, {} runs: mean {}{}, median {}; below {} {}\n",
                        group["places"].get<int>(), number(group["place_mean"]), goal("place_goal"),
                        number(group["place_median"]), LeastPlace, group["place_low"].get<int>());
    return text + fmt::format("  candidates for silent failures {}; {} s an edit (median)\n",
                              group["silent"].get<int>(), number(group["seconds_median"], 1));
}

/// Errors of the fronts that sentences alone led to, scene by scene.
std::string scene_fronts_text(const Json& report) {
    std::string text;
    for (const auto& scene : report["scenes"]) {
        std::string errors;
        for (const auto& task : report["tasks"])
            if (task["scene"] == scene["scene"])
                for (const auto& [mode, run] : task["runs"].items())
                    if (mode != "box" && mode != "click" && run.contains("front_error"))
                        errors += " " + number(run["front_error"], 0);
        if (!errors.empty()) text += fmt::format("  {}:{}\n", scene["scene"].get<std::string>(), errors);
    }
    return text;
}

std::string scenes_text(const Json& report) {
    const auto& up = report["summary"]["up"];
    auto text = fmt::format("\nup axis of {} scenes: {} right, {} wrong, {} asked\n", report["scenes"].size(),
                            up["right"].get<int>(), up["wrong"].get<int>(), up["asked"].get<int>());
    for (const auto& scene : report["scenes"])
        if (const auto& axis = scene["up"]; axis["result"] != "right")
            text += fmt::format("  {}: {} ({} guessed, {} is true)\n", scene["scene"].get<std::string>(),
                                axis["result"].get<std::string>(), axis["guess"].get<std::string>(),
                                axis["truth"].get<std::string>());
    text += "front, of runs about the true up axis in which it was read:\n";
    for (const auto& [mode, front] : report["summary"]["front"].items())
        text += fmt::format(
            "  by {}: {} runs, error mean {} degrees, median {}; {} within {:.0f}, {} beyond {:.0f}\n", mode,
            front["runs"].get<int>(), number(front["error_mean"], 0), number(front["error_median"], 0),
            front["within_15"].get<int>(), FrontNear, front["beyond_90"].get<int>(), FrontFar);
    return text + scene_fronts_text(report);
}

}  // namespace

Json real_summary(const Json& report) {
    const auto& tasks = report["tasks"];
    return {{"groups", groups_json(tasks)},
            {"silent", silent_json(tasks)},
            {"up", up_json(report["scenes"])},
            {"front", front_json(tasks)}};
}

std::string real_table(const Json& report) {
    auto text = fmt::format("{:34} {:8} {:>5} {:38} {:>5} {:>5} {:>5} {:>6} {:>5} {:>5} {:>7} {:>6} {:>5}\n",
                            "task", "mode", "s", "ending", "IoU", "rec", "prec", "plain", "seen", "place",
                            "changed", "spill", "front");
    for (const auto& task : report["tasks"])
        for (const auto& [mode, run] : task["runs"].items()) text += run_line(task, mode, run);
    text += "\n";
    for (const auto& task : report["tasks"])
        for (const auto& [mode, run] : task["runs"].items())
            if (run["ending"] != "done")
                text += fmt::format("{}, {}: {}\n", task["task"].get<std::string>(), mode,
                                    run.value("message", std::string()));
    for (const auto& group : report["summary"]["groups"]) text += group_lines(group);
    text += "\ncandidates for silent failures:\n";
    for (const auto& run : report["summary"]["silent"])
        text +=
            fmt::format("  {}, {}: {}{}\n", run["task"].get<std::string>(), run["mode"].get<std::string>(),
                        fmt::join(run["low"].get<std::vector<std::string>>(), ", "),
                        run["warned"].get<bool>() ? "; the pictures were said not to show it" : "");
    text += scenes_text(report) + "\nsheets: three sides before, then three of each mode\n";
    for (const auto& task : report["tasks"])
        text +=
            fmt::format("  {}, row {}: {}: {} > \"{}\" ({}); good: {}\n", task["sheet"].get<std::string>(),
                        task["row"].get<int>(), task["task"].get<std::string>(),
                        task["source"].get<std::string>(), task["prompt"].get<std::string>(),
                        task["kind"].get<std::string>(), task.value("accept", std::string()));
    return text;
}

}  // namespace gse::bench
