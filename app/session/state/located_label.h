// Result of a search as a label of the document.
#pragma once

#include "app/engine_names.h"
#include "engine/pipeline/run/edit_job.h"
#include "engine/scene/document.h"

namespace gse::app {

/// Label of a job's search, over the rows of its scene, without corrections by hand. What was labelled by
/// hand for the job is taken for found.
NamedLabel located_label(const EditJob& job);

/// The state with that label active, in place of the one found for the same word.
DocumentState with_found_label(DocumentState state, NamedLabel label);

/// The state with the label of a job's search active: that of its word, under any name, else a new one. For a
/// search that is not new (`fresh` = false: another threshold, or other excluded views), corrections by hand
/// stay, and so does the threshold. The job must be of the state's splats.
DocumentState with_located_label(DocumentState state, const EditJob& job, bool fresh);

/// The label at another threshold, as a search with that threshold makes it of the same votes; corrections by
/// hand stay. `set` has the label's rows. A label without a field compares its weights with the threshold.
NamedLabel at_threshold(NamedLabel label, const GaussianSet& set, double threshold,
                        ThreadPool* threads = nullptr);

}  // namespace gse::app
