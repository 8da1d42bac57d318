// Workflows made for Krita's plug-in: its nodes become core nodes.
#pragma once

#include <vector>

#include "engine/remote/workflow/workflow.h"

namespace gse::remote {

/// Replaces canvas, selection and output by loaders and a preview, and parameters by their values. Gives the
/// places that follow. Throws Error (Unsupported) for other nodes of the plug-in.
std::vector<WorkflowPlace> replace_krita_nodes(nlohmann::json& graph);

}  // namespace gse::remote
