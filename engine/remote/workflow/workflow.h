// Workflow of ComfyUI in API format: which of its inputs are ours to set.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

namespace gse::remote {

/// Meaning of an input that is set for every picture.
enum class WorkflowRole {
    Image,
    Mask,
    Reference,
    Prompt,
    Negative,
    Seed,
    Strength,
    Steps,
    Guidance,
    DistilledGuidance,
    Width,
    Height,
    Model,
    Output,
};

std::string_view workflow_role_name(WorkflowRole role);

/// An input of a node, or for Output the node itself.
struct WorkflowPlace {
    WorkflowRole role = WorkflowRole::Image;
    std::string node = {}, input = {};
};

struct Workflow {
    nlohmann::json graph = {};  // number of a node -> {class_type, inputs, _meta}
    std::vector<WorkflowPlace> places = {};
    bool mask_in_alpha = false;  // the mask rides in the alpha channel of the picture

    std::size_t count(WorkflowRole role) const;
    /// The first place of a role; null without one.
    const WorkflowPlace* find(WorkflowRole role) const;
    /// True for an input that is set for every picture.
    bool sets(std::string_view node, std::string_view input) const;
    /// "image: node 4 (LoadImage), image": one line per place, for people.
    std::vector<std::string> table() const;
};

/// Reads a workflow and finds its places: by titles ("gse image", "gse seed, steps"), by the nodes of Krita's
/// plug-in, and by what is the only candidate. Throws Error (Malformed) for the other format of ComfyUI, for
/// more than 2,000 nodes or 1 MiB; (InvalidArgument) where a place is missing or could be one of several.
Workflow read_workflow(std::string_view text);

/// Values for one picture. Pictures are named as a loader takes them.
struct WorkflowValues {
    std::string image = {}, mask = {};
    std::vector<std::string> references = {};
    std::string prompt = {}, negative_prompt = {};
    std::uint32_t seed = 0;
    double strength = 1;
    int steps = 20;
    double guidance_scale = 7, distilled_guidance = 0;
    int width = 0, height = 0;
    std::string model = {};  // empty = as it is in the workflow
};

/// The graph with the values in their places.
nlohmann::json filled_workflow(const Workflow& workflow, const WorkflowValues& values);

}  // namespace gse::remote
