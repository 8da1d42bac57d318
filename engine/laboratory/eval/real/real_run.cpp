// Sentence -> steps -> jobs, as on the command line.
#include "engine/laboratory/eval/real/real_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <memory>
#include <numeric>
#include <utility>

#include "engine/base/clock.h"
#include "engine/base/error.h"
#include "engine/language/words.h"
#include "engine/pipeline/run/edit_job.h"
#include "engine/pipeline/steps/edit_steps.h"
#include "engine/pipeline/steps/step_judgement.h"

namespace gse::bench {
namespace {

constexpr std::array Modes{RealMode::Word, RealMode::Upright, RealMode::Box, RealMode::Click};

/// A run, and how rows came to be what they are by now.
class Run {
public:
    Run(const pipeline::EditRecipe& recipe, const JobControl& control) : recipe_(recipe), control_(control) {}

    RealOutcome take() {
        const double begin = wall_seconds();
        try {
            run();
        } catch (const Error& error) {
            if (error.code() == ErrorCode::Cancelled) throw;
            refuse(error);
        }
        edit_.seconds = wall_seconds() - begin;
        return std::move(edit_);
    }

private:
    void run() {
        pipeline::EditSteps steps;
        if (!pipeline::take_named_label(recipe_)) pipeline::take_known_words(recipe_);
        if (pipeline::has_steps(recipe_)) {
            const auto labels = pipeline::names_in_scene(recipe_);
            steps = pipeline::steps_of_sentence(
                recipe_, pipeline::words_of_scene(recipe_, {}, labels, control_, nullptr), false, labels);
        }
        if (steps.nothing_to_change)
            throw Error(ErrorCode::InvalidArgument,
                        "the sentence asks for nothing that is not there already");
        if (steps.steps.size() > 1) return run_steps({recipe_, steps});
        if (!steps.steps.empty()) recipe_ = pipeline::recipe_of_step(recipe_, steps.steps.front());
        pipeline::EditJob job(pipeline::with_words(recipe_), control_, nullptr);
        keep(job, make(job));
    }

    void run_steps(pipeline::StepSequence sequence) {
        edit_.steps = sequence.size();
        std::string reason;  // why the first step that is missing was not done
        const auto leave_out = [&](std::size_t i, const std::string& why) {
            if (reason.empty()) reason = why;
            sequence.leave_out(i);
        };
        for (std::size_t i = 0; i < sequence.size(); ++i) try {
                if (!sequence.step(i).words) {
                    leave_out(i, sequence.step(i).problem.reason);
                    continue;
                }
                run_step(sequence, i, leave_out);
            } catch (const Error& error) {
                if (error.code() == ErrorCode::Cancelled || sequence.taken() == i) throw;
                leave_out(i, error.message());
            }
        if (reason.empty()) return;
        if (edit_.label.empty()) throw Error(ErrorCode::InvalidArgument, reason);
        edit_.ending = RealEnding::KeptOut;
        edit_.message = reason;
    }

    void run_step(pipeline::StepSequence& sequence, std::size_t i,
                  const std::function<void(std::size_t, const std::string&)>& leave_out) {
        const auto first = [&](pipeline::EditRecipe recipe) {
            return std::make_unique<pipeline::EditJob>(std::move(recipe), control_, nullptr);
        };
        auto job = sequence.job_of(i, first, control_);
        const auto judgement = make(*job);
        // A failed first step is measured all the same: nothing else is there.
        if (judgement.passed() || sequence.taken() == 0) keep(*job, judgement);
        if (!judgement.passed()) return leave_out(i, judgement.reason);
        follow(*job);
        sequence.take(i, std::move(job));
    }

    /// Searches and edits. Throws Error for a search that came to nothing and an edit without an end.
    pipeline::StepJudgement make(pipeline::EditJob& job) {
        job.locate();
        note_search(job);
        if (!job.found()) throw Error(ErrorCode::NotFound, job.located().message, job.located().remedy);
        job.run();
        const auto& result = job.result();
        if (result.stopped) throw Error(ErrorCode::Cancelled, "the edit was stopped");
        if (result.failure) throw *result.failure;
        if (result.shortage) throw *result.shortage;
        if (const auto& verdict = job.edited().verdict) {
            edit_.score = verdict->score;
            edit_.warned = edit_.warned || verdict->warns;
        }
        return result.iterations == 0 ? pipeline::StepJudgement{} : pipeline::judge_step(job);
    }

    void note_search(const pipeline::EditJob& job) {
        const auto& located = job.located();
        edit_.edit_mode = edit::mode_name(located.mode);
        edit_.up = pipeline::parse_up(job.recipe().job.up, job.scene().info);
        if (job.front_read()) edit_.front_read = *job.front_read() / pipeline::Degree;
        problem_ = located.problem;
        if (!job.label_doubt().empty()) edit_.level = SureLevel::Amber;
        if (located.confidence.value < 0) return;
        const double value = located.confidence.value;
        edit_.confidence = edit_.confidence ? std::min(*edit_.confidence, value) : value;
        const bool sure = located.problem == edit::SearchProblem::None && edit_.level != SureLevel::Amber;
        edit_.level = sure ? SureLevel::Green : SureLevel::Amber;
    }

    /// Notes what a job came to.
    void keep(pipeline::EditJob& job, const pipeline::StepJudgement& judgement) {
        edit_.ending = judgement.passed() ? RealEnding::Done : RealEnding::KeptOut;
        edit_.message = judgement.reason;
        edit_.remedy = judgement.remedy;
        edit_.judgement = pipeline::judgement_to_json(judgement);
        if (!followed_) {
            edit_.before = job.scene();
            edit_.label.assign(job.scene().gaussians.size(), 0);
            origin_.resize(edit_.label.size());
            std::iota(origin_.begin(), origin_.end(), std::int64_t{0});
        }
        const auto& bits = *job.located().label.bits;
        for (std::size_t row = 0; row < bits.size(); ++row)
            if (bits[row] != 0 && origin_[row] >= 0) edit_.label[static_cast<std::size_t>(origin_[row])] = 1;
        edit_.after = job.result().set;
    }

    /// Goes on from what a job came to.
    void follow(const pipeline::EditJob& job) {
        const auto& result = job.result();
        std::vector<std::int64_t> moved(result.set.size(), -1);
        for (std::size_t row = 0; row < result.base_to_new.size(); ++row)
            if (const auto now = result.base_to_new[row]; now >= 0)
                moved[static_cast<std::size_t>(now)] = origin_[row];
        origin_ = std::move(moved);
        followed_ = true;
    }

    void refuse(const Error& error) {
        edit_.ending = RealEnding::Refused;
        edit_.message = error.message();
        edit_.remedy = error.hint();
        edit_.cause = problem_ == edit::SearchProblem::Unsure    ? "unsure"
                      : problem_ == edit::SearchProblem::NoPlace ? "no place"
                      : problem_ != edit::SearchProblem::None    ? "not found"
                                                                 : refusal_cause(error.message());
    }

    pipeline::EditRecipe recipe_;
    const JobControl& control_;
    RealOutcome edit_;
    edit::SearchProblem problem_ = edit::SearchProblem::None;
    std::vector<std::int64_t> origin_;  // [rows] row of the first scene that each row was; -1 = new
    bool followed_ = false;             // by a step
};

}  // namespace

std::string mode_name(RealMode mode) {
    switch (mode) {
        case RealMode::Word: return "word";
        case RealMode::Upright: return "upright";
        case RealMode::Box: return "box";
        case RealMode::Click: return "click";
    }
    return {};
}

std::string ending_name(RealEnding ending) {
    return ending == RealEnding::Refused ? "refused" : ending == RealEnding::KeptOut ? "kept out" : "done";
}

std::string level_name(SureLevel level) {
    return level == SureLevel::None ? "" : level == SureLevel::Green ? "green" : "amber";
}

std::vector<RealMode> parse_modes(const std::string& text) {
    std::vector<RealMode> modes;
    for (const auto& word : language::words_of(text)) {
        const auto mode =
            std::find_if(Modes.begin(), Modes.end(), [&](RealMode one) { return mode_name(one) == word; });
        if (mode == Modes.end())
            throw Error(ErrorCode::InvalidArgument, fmt::format("the mode \"{}\" is not known", word),
                        "use some of word, upright, box, click");
        modes.push_back(*mode);
    }
    if (modes.empty())
        throw Error(ErrorCode::InvalidArgument, "no mode is named", "use some of word, upright, box, click");
    return modes;
}

bool has_mode(const RealScene& scene, const RealTask& task, RealMode mode) {
    if (mode == RealMode::Box) return !task.cut_out.empty();
    if (mode == RealMode::Click) return !task.about.empty();
    return mode == RealMode::Word || (!scene.auto_up_right && task.known_word);
}

pipeline::EditRecipe real_recipe(const RealScene& scene, const RealTask& task, RealMode mode,
                                 pipeline::EditRecipe settings) {
    settings.job.scene = scene.path.string();
    settings.request.source = task.source;
    settings.request.prompt = task.prompt;
    settings.request.target.clear();
    settings.request.mode = "auto";
    if (mode != RealMode::Word) settings.job.up = scene.up;
    if (mode == RealMode::Box) settings.job.cut_out = task.cut_out;
    return settings;
}

std::string refusal_cause(const std::string& message) {
    const auto has = [&](const char* words) { return message.find(words) != std::string::npos; };
    if (has("does not know the word") || has("but not find it")) return "word not known";
    if (has("model drew")) return "not drawn";
    if (has("sure")) return "unsure";
    return "other";
}

RealOutcome run_real_task(const pipeline::EditRecipe& recipe, const JobControl& control) {
    return Run(recipe, control).take();
}

}  // namespace gse::bench
