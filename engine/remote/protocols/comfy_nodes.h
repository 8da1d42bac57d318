// Check of a workflow against the nodes and models that a ComfyUI server has.
#pragma once

#include <string>

#include "engine/remote/protocols/server_link.h"
#include "engine/remote/workflow/workflow.h"

namespace gse::remote {

/// Asks about each class of node. Throws Error (InvalidArgument) for classes that are missing, for nodes that
/// cost money unless they are allowed, and for names (of models) that the server does not offer. Gives the
/// model to draw with: `wanted`, else the workflow's, else the server's only one.
std::string check_nodes(ServerLink& link, const Workflow& workflow, const std::string& wanted,
                        bool allow_paid, const JobControl& job);

/// Names that the server offers for an input of a class of node; empty where it offers none.
std::vector<std::string> offered_names(ServerLink& link, const std::string& kind, const std::string& input,
                                       const JobControl& job);

/// "node 12 KSampler: message" for every node that a refusal names; empty without any.
std::string node_errors(const nlohmann::json& answer);

}  // namespace gse::remote
