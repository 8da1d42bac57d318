// Sentences about the last job and its result. One clock: every place tells one time for one job.
#pragma once

#include <string>

#include "ui/model/view_model.h"

namespace gse::ui {

/// "done in 24 s", "stopped", "failed"; empty while the job runs.
std::string outcome_text(const JobStatus& job);
/// Line about the last job, and what it waits for.
std::string job_line(const ViewModel& model);
/// "Edit done in 24 s", "Stopped at step 3 of 30, after 2.0 s": of the result that waits.
std::string result_line(const ViewModel& model);
/// "The edit is done." or "The edit was stopped."
std::string result_sentence(const ResultVerdict& verdict);

}  // namespace gse::ui
