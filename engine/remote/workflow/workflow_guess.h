// Places of a workflow that no title names: taken where there is one candidate only.
#pragma once

#include "engine/remote/workflow/workflow.h"

namespace gse::remote {

/// Adds the places that are not there yet. Throws Error (InvalidArgument) for an image, a prompt or an output
/// that cannot be found, and for places with several candidates.
void guess_places(Workflow& workflow);

}  // namespace gse::remote
