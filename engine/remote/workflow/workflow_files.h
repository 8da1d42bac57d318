// Workflows that come with the program, and those of the artist.
#pragma once

#include <filesystem>

#include "engine/remote/api/image_server.h"
#include "engine/remote/workflow/workflow.h"

namespace gse::remote {

/// The bundled one of that name, or the file. Throws Error with the path.
Workflow load_workflow(const std::filesystem::path& name);

/// Name of the bundled workflow that fits an order. `wanted` is "edit" or empty.
std::string bundled_workflow_for(const RedrawOrder& order, const std::string& wanted);

}  // namespace gse::remote
