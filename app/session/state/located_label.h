// What a search found as a label of the document.
#pragma once

#include "app/cli/engine_names.h"
#include "engine/pipeline/run/edit_job.h"
#include "engine/scene/document.h"

namespace gse::app {

/// The state with the label of what a job found active: that of the same word, whatever it is called now,
/// else a new one. Where the search is no new one (`fresh` = false: another threshold, or views left out),
/// what was corrected by hand stays, and so does how sure is sure enough. The job must be of the state's
/// splats.
DocumentState with_located_label(DocumentState state, const EditJob& job, bool fresh);

}  // namespace gse::app
