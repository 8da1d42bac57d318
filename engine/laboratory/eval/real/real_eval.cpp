// One task after the other, in every mode; a scene is read once for all of its tasks.
#include "engine/laboratory/eval/real/real_eval.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "engine/base/error.h"
#include "engine/base/log_quiet.h"
#include "engine/base/process_memory.h"
#include "engine/laboratory/eval/eval_sheet.h"
#include "engine/laboratory/eval/real/real_run.h"
#include "engine/laboratory/eval/real/real_summary.h"
#include "engine/laboratory/eval/real/truth_click.h"
#include "engine/pipeline/scene/scene_loading.h"

namespace gse::bench {
namespace {

using Json = nlohmann::ordered_json;
using Pictures = std::vector<Image>;

/// A task with its truth, as it is before any edit.
struct Setting {
    const RealTask& task;
    RealCameras cameras;
    Pictures before;
    TruthRows truth;               // empty where no label is measured
    std::vector<Mask> truth_seen;  // the same
};

std::string axis_name(const Vec3& up) {
    for (const char* name : {"x", "y", "z", "-x", "-y", "-z"})
        if (dot(pipeline::parse_up(name, {}), up) > 1 - 1e-6) return name;
    return fmt::format("{:.2f} {:.2f} {:.2f}", up.x, up.y, up.z);
}

/// Angle between two azimuths, degrees in [0,180].
double angle_between(double a, double b) { return std::abs(std::remainder(a - b, 360.0)); }

/// The guess of a scene's up axis against the truth. "asked": the program is not sure, and asks.
Json up_json(const SceneInfo& info, const std::string& truth) {
    const auto axis = axis_name(info.up);
    const char* result = info.up_unsure ? "asked" : axis == truth ? "right" : "wrong";
    return {{"truth", truth}, {"guess", axis}, {"result", result}};
}

class RealEvaluation {
public:
    RealEvaluation(const RealRun& run, const std::filesystem::path& folder, const JobControl& job)
        : run_(run), job_(job), modes_(parse_modes(run.parameters.real_modes)),
          suite_(read_real_suite(run.parameters.real, run.parameters.real_root)),
          sheets_(folder, "real", run.parameters.real_rows, RealPictureSide) {
        for (const auto& task : suite_.tasks)
            if (task.name.find(run.parameters.real_only) != std::string::npos) tasks_.push_back(&task);
        if (tasks_.empty())
            throw Error(ErrorCode::InvalidArgument,
                        fmt::format("no task of the suite has \"{}\" in its name", run.parameters.real_only),
                        "leave out --real-only", run.parameters.real);
        for (const auto* task : tasks_)
            if (const auto& path = suite_.scene_of(*task).path; !std::filesystem::exists(path))
                throw Error(ErrorCode::NotFound, "a scene of the suite is not there",
                            "name its folder with --real-root", path);
    }

    Json run() {
        Json report;
        report["suite"] = suite_.name;
        report["parameters"] = fields_to_json(run_.parameters);
        report["request"] = fields_to_json(run_.settings.request);
        report["guidance"] = fields_to_json(run_.settings.guidance);
        report["stopped"] = false;
        report["tasks"] = Json::array();
        try {
            for (std::size_t i = 0; i < tasks_.size(); ++i) {
                check_stop();
                job_.report(tasks_[i]->name, static_cast<int>(i), static_cast<int>(tasks_.size()));
                report["tasks"].push_back(evaluate(*tasks_[i]));
            }
        } catch (const Error& error) {  // what was reached is kept
            if (error.code() != ErrorCode::Cancelled) throw;
            report["stopped"] = true;
        }
        report["scenes"] = scenes_;
        report["sheets"] = sheets_.finish();
        note_sheets(report);
        report["summary"] = real_summary(report);
        report["peak_rss_mb"] = peak_rss_mb();
        return report;
    }

private:
    void check_stop() const {
        if (job_.stop_requested()) throw Error(ErrorCode::Cancelled, "the evaluation was stopped");
    }

    /// The scene of a task as it is before any edit. It stays read until another is asked for.
    const Scene& scene_of(const RealTask& task) {
        const auto& scene = suite_.scene_of(task);
        if (task.scene == loaded_) return scene_;
        const log::Quiet quiet;
        scene_ = pipeline::load_scene_with_cameras(scene.path).scene;
        loaded_ = task.scene;
        scenes_.push_back({{"scene", scene.name},
                           {"up", up_json(scene_.info, scene.up)},
                           {"front", scene.front ? Json(*scene.front) : Json()}});
        return scene_;
    }

    Setting setting_of(const RealTask& task) {
        const Scene& scene = scene_of(task);
        const auto& info = scene.info;
        Setting setting{task, {}, {}, {}, {}};
        if (!task.about.empty())
            setting.truth = truth_rows(suite_.thing_of(task), world_centres(scene.gaussians, info.offset));
        setting.cameras =
            real_cameras(suite_.scene_of(task), task, scene.gaussians, info.offset, setting.truth.thing);
        setting.before = pictures(scene.gaussians, info, setting.cameras);
        if (task.measures_label())
            setting.truth_seen = seen_rows(painter_, scene.gaussians, setting.truth.thing, setting.cameras);
        return setting;
    }

    Pictures pictures(const GaussianSet& set, const SceneInfo& info, const RealCameras& cameras) {
        Pictures list;
        for (const auto& camera : cameras.sides) list.push_back(real_picture(painter_, set, info, camera));
        return list;
    }

    Json evaluate(const RealTask& task) {
        const auto& scene = suite_.scene_of(task);
        Json entry{{"task", task.name},     {"scene", scene.name},   {"source", task.source},
                   {"prompt", task.prompt}, {"kind", task.kind},     {"known_word", task.known_word},
                   {"accept", task.accept}, {"runs", Json::object()}};
        const Setting setting = setting_of(task);
        std::map<RealMode, Pictures> after;
        for (const auto mode : modes_) {
            if (!has_mode(scene, task, mode)) continue;
            check_stop();
            const auto recipe = recipe_of(setting, mode);
            if (!recipe) continue;
            const auto edit = run_real_task(*recipe, {{}, job_.stop});
            check_stop();
            entry["runs"][mode_name(mode)] = figures(setting, edit, after[mode]);
        }
        Pictures row = setting.before;
        for (const auto mode : modes_) {
            auto& shown = after[mode];
            shown.resize(setting.before.size());
            row.insert(row.end(), shown.begin(), shown.end());
        }
        sheets_.add(row, fmt::format("{}: {} > \"{}\"", task.name, task.source, task.prompt));
        return entry;
    }

    /// None for a click on a thing that its picture does not show.
    std::optional<pipeline::EditRecipe> recipe_of(const Setting& setting, RealMode mode) {
        const auto& scene = suite_.scene_of(setting.task);
        auto recipe = real_recipe(scene, setting.task, mode, run_.settings);
        if (mode != RealMode::Click) return recipe;
        const auto click = truth_click(painter_, scene, setting.task, scene_, setting.truth.thing);
        if (!click) return std::nullopt;
        recipe.job.at = *click;
        return recipe;
    }

    /// Figures of a run. `after` gets the pictures of what was made.
    Json figures(const Setting& setting, const RealOutcome& edit, Pictures& after) {
        Json entry = outcome(setting, edit);
        if (edit.ending == RealEnding::Refused) return entry;
        const auto& set = edit.before.gaussians;
        const auto& info = edit.before.info;
        entry["edit_mode"] = edit.edit_mode;
        entry["steps"] = edit.steps;
        entry["labelled"] = std::count(edit.label.begin(), edit.label.end(), std::uint8_t{1});
        after = pictures(edit.after, info, setting.cameras);
        if (setting.task.measures_label()) add_label(setting, edit, entry);
        const Rows added = new_rows(edit.after, set);
        entry["new_rows"] = std::count(added.begin(), added.end(), std::uint8_t{1});
        if (setting.task.place)
            if (const auto share = place_share(*setting.task.place, edit.after, added, info.offset)) {
                entry["place_share"] = share->opacity;
                entry["place_share_plain"] = share->plain;
            }
        if (setting.task.measures_label()) {
            const auto change = seen_change(setting.before, after, setting.truth_seen);
            entry["seen_change_in_truth"] = change.in_truth;
            entry["seen_spill"] = change.spill;
        }
        entry["judgement"] = edit.judgement;
        return entry;
    }

    /// Ending, confidence, up axis and front of a run.
    Json outcome(const Setting& setting, const RealOutcome& edit) {
        const auto& scene = suite_.scene_of(setting.task);
        Json entry{{"ending", ending_name(edit.ending)}, {"seconds", edit.seconds}};
        if (!edit.cause.empty()) entry["cause"] = edit.cause;
        if (!edit.message.empty()) entry["message"] = edit.message;
        if (!edit.remedy.empty()) entry["remedy"] = edit.remedy;
        entry["confidence"] = edit.confidence ? Json(*edit.confidence) : Json();
        entry["level"] = level_name(edit.level);
        entry["warned"] = edit.warned;
        if (edit.score) entry["score"] = *edit.score;
        if (!edit.up) return entry;
        entry["up"] = axis_name(*edit.up);
        if (!edit.front_read) return entry;
        entry["front_read"] = *edit.front_read;
        if (scene.front && axis_name(*edit.up) == scene.up)
            entry["front_error"] = angle_between(*edit.front_read, *scene.front);
        return entry;
    }

    void add_label(const Setting& setting, const RealOutcome& edit, Json& entry) {
        const auto& set = edit.before.gaussians;
        entry["opacity"] = row_overlap(edit.label, setting.truth, opacities(set)).json();
        entry["plain"] = row_overlap(edit.label, setting.truth, std::vector<double>(set.size(), 1)).json();
        Rows shown = edit.label;  // what counts neither way is as the truth has it
        for (std::size_t row = 0; row < shown.size(); ++row)
            if (setting.truth.either[row] != 0) shown[row] = setting.truth.thing[row];
        entry["seen"] =
            seen_overlap(seen_rows(painter_, set, shown, setting.cameras), setting.truth_seen).json();
    }

    /// Sheet and row of every task, counted from 1.
    void note_sheets(Json& report) const {
        const auto rows = static_cast<std::size_t>(run_.parameters.real_rows);
        for (std::size_t i = 0; i < report["tasks"].size(); ++i) {
            report["tasks"][i]["sheet"] = report["sheets"][i / rows];
            report["tasks"][i]["row"] = i % rows + 1;
        }
    }

    const RealRun& run_;
    const JobControl& job_;
    std::vector<RealMode> modes_;
    RealSuite suite_;
    ContactSheets sheets_;
    std::vector<const RealTask*> tasks_;
    pipeline::Painter painter_;
    std::optional<std::size_t> loaded_;  // index of the scene that scene_ is
    Scene scene_;
    Json scenes_ = Json::array();
};

}  // namespace

Json run_real(const RealRun& run, const std::filesystem::path& folder, const JobControl& job) {
    return RealEvaluation(run, folder, job).run();
}

}  // namespace gse::bench
