// Options of an artist in a workflow: inputs of nodes, named by title, class or number.
#pragma once

#include <vector>

#include "engine/remote/api/server_option.h"
#include "engine/remote/workflow/workflow.h"

namespace gse::remote {

/// Sets inputs "NODE.input", where NODE is a title, a class or a number. Throws Error (InvalidArgument):
/// - no node is meant, or several;
/// - the node has no such input and it is not forced, it is a link, or it is set for every picture;
/// - the value is of another kind than the workflow's.
void set_inputs(Workflow& workflow, const std::vector<ServerOption>& options);

}  // namespace gse::remote
