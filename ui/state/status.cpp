// Sentences about the last job and its result.
#include "ui/state/status.h"

#include <fmt/format.h>

#include "ui/widgets/controls.h"

namespace gse::ui {

std::string outcome_text(const JobStatus& job) {
    return job.outcome == "done" ? fmt::format("done in {}", duration_text(job.seconds)) : job.outcome;
}

std::string job_line(const ViewModel& model) {
    const auto& job = model.job;
    const bool waits = model.result_waiting;
    if (waits && model.verdict.changes.size() > 1 && job.outcome == "done" && job.title.starts_with("Edit"))
        return fmt::format("{}. Apply or discard it",
                           result_line(model));  // the job was the last change alone
    if (!job.title.empty() && !job.outcome.empty())
        return fmt::format("{}: {}{}", job.title, outcome_text(job), waits ? ". Apply or discard it" : "");
    if (!waits) return "Ready";
    return model.verdict.stopped_at >= 0 ? "The edit was stopped: apply or discard what it came to"
                                         : "The edit is done: apply or discard it";
}

std::string result_line(const ViewModel& model) {
    const auto took = duration_text(model.result_seconds);
    const auto& verdict = model.verdict;
    return verdict.stopped_at < 0
               ? fmt::format("Edit done in {}", took)
               : fmt::format("Stopped at step {} of {}, after {}", verdict.stopped_at, verdict.steps, took);
}

std::string result_sentence(const ResultVerdict& verdict) {
    if (verdict.stopped_at >= 0) return "The edit was stopped.";
    const std::size_t made = std::max<std::size_t>(1, verdict.changes.size());
    return made < verdict.asked ? fmt::format("{} of {} changes made.", made, verdict.asked)
                                : "The edit is done.";
}

}  // namespace gse::ui
