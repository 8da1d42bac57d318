// LoRAs in a workflow: loaders behind the node that loads the model.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "engine/remote/workflow/workflow.h"

namespace gse::remote {

/// Adds a loader for each LoRA (name, weight), through which everything gets the model from then on. Throws
/// Error (InvalidArgument) where the workflow has no single place for a model.
void add_lora_loaders(Workflow& workflow, const std::vector<std::pair<std::string, double>>& loras);

}  // namespace gse::remote
