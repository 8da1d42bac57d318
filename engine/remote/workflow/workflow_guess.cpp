// Guesses: the one loader, the text before a sampler, the values of the one sampler, the one output.
#include "engine/remote/workflow/workflow_guess.h"

#include <algorithm>
#include <functional>
#include <set>
#include <string>

#include <fmt/format.h>

#include "engine/base/error.h"
#include "engine/base/printable.h"

namespace gse::remote {
namespace {

using Places = std::vector<WorkflowPlace>;

const std::string& class_name(const nlohmann::json& node) {
    return node["class_type"].get_ref<const std::string&>();
}

bool links_to_node(const nlohmann::json& value, const nlohmann::json& graph) {
    return value.is_array() && value.size() == 2 && value[0].is_string() &&
           graph.contains(value[0].get<std::string>());
}

bool is_taken(const Workflow& workflow, const std::string& node) {
    return std::any_of(workflow.places.begin(), workflow.places.end(),
                       [&](const auto& place) { return place.node == node; });
}

/// Keeps the one candidate. Throws Error (InvalidArgument) for several, and for none where one `must` be.
void keep_only(Workflow& workflow, const Places& candidates, WorkflowRole role, bool must) {
    const auto name = workflow_role_name(role);
    if (candidates.empty() && must)
        throw Error(ErrorCode::InvalidArgument, fmt::format("the workflow has no place for the {}", name),
                    fmt::format("give its node the title \"gse {}\"", name));
    if (candidates.empty()) return;
    if (candidates.size() > 1) {
        std::string nodes;
        for (std::size_t i = 0; i < std::min<std::size_t>(candidates.size(), 5); ++i)
            nodes += (i > 0 ? ", " : "") + printable(candidates[i].node);
        throw Error(ErrorCode::InvalidArgument,
                    fmt::format("the {} could belong to several nodes of the workflow ({})", name, nodes),
                    fmt::format("give the right one the title \"gse {}\"", name));
    }
    workflow.places.push_back(candidates[0]);
}

/// Plain inputs of these names, in nodes whose class `fits`.
Places plain_inputs(const Workflow& workflow, WorkflowRole role, std::initializer_list<const char*> names,
                    const std::function<bool(const std::string&)>& fits) {
    Places found;
    for (const auto& [number, node] : workflow.graph.items()) {
        if (!fits(class_name(node))) continue;
        for (const char* name : names) {
            const auto input = node["inputs"].find(name);
            if (input != node["inputs"].end() && !input->is_structured())
                found.push_back({role, number, name});
        }
    }
    return found;
}

bool any_class(const std::string&) { return true; }

/// Texts that lead to an input `side` ("positive", "negative") of a sampler or guider.
class TextSearch {
public:
    TextSearch(const nlohmann::json& graph, WorkflowRole role)
        : graph_(graph), role_(role), side_(role == WorkflowRole::Prompt ? "positive" : "negative") {}

    Places run() {
        for (const auto& [number, node] : graph_.items()) {
            const bool sampler = class_name(node).find("Sampler") != std::string::npos ||
                                 class_name(node).find("Guider") != std::string::npos;
            if (sampler) follow_inputs(node, true);
        }
        return found_;
    }

private:
    void follow(const nlohmann::json& link) {
        if (!links_to_node(link, graph_)) return;
        const auto number = link[0].get<std::string>();
        if (!seen_.insert(number).second) return;
        const auto& node = graph_[number];
        for (const char* name : {"text", "prompt"}) {
            const auto text = node["inputs"].find(name);
            if (text == node["inputs"].end()) continue;
            if (text->is_string()) found_.push_back({role_, number, name});
            else follow_value(*text);
            return;
        }
        follow_inputs(node, false);
    }

    /// A text that another node holds.
    void follow_value(const nlohmann::json& link) {
        if (!links_to_node(link, graph_)) return;
        const auto number = link[0].get<std::string>();
        for (const char* name : {"value", "string", "text"}) {
            const auto text = graph_[number]["inputs"].find(name);
            if (text == graph_[number]["inputs"].end() || !text->is_string()) continue;
            found_.push_back({role_, number, name});
            return;
        }
    }

    void follow_inputs(const nlohmann::json& node, bool from_sampler) {
        const auto& inputs = node["inputs"];
        if (inputs.contains(side_)) return follow(inputs[side_]);
        if (from_sampler && role_ == WorkflowRole::Negative) return;  // a guider without a negative side
        for (const auto& [name, value] : inputs.items())
            if (name.starts_with("conditioning")) follow(value);
    }

    const nlohmann::json& graph_;
    const WorkflowRole role_;
    const std::string side_;
    std::set<std::string> seen_;
    Places found_;
};

void guess_image(Workflow& workflow) {
    if (workflow.find(WorkflowRole::Image)) return;
    auto loaders = plain_inputs(workflow, WorkflowRole::Image, {"image"},
                                [](const auto& kind) { return kind == "LoadImage"; });
    std::erase_if(loaders, [&](const auto& place) { return is_taken(workflow, place.node); });
    keep_only(workflow, loaders, WorkflowRole::Image, true);
}

/// A loader of masks, else the transparency of the image.
void guess_mask(Workflow& workflow) {
    if (workflow.find(WorkflowRole::Mask)) return;
    keep_only(workflow,
              plain_inputs(workflow, WorkflowRole::Mask, {"image"},
                           [](const auto& kind) { return kind == "LoadImageMask"; }),
              WorkflowRole::Mask, false);
    if (workflow.find(WorkflowRole::Mask)) return;
    const auto& image = workflow.find(WorkflowRole::Image)->node;
    for (const auto& node : workflow.graph)
        for (const auto& value : node["inputs"])
            if (links_to_node(value, workflow.graph) && value[0] == image && value[1] == 1)
                workflow.mask_in_alpha = true;
}

void guess_text(Workflow& workflow, WorkflowRole role) {
    if (workflow.find(role)) return;
    auto texts = TextSearch(workflow.graph, role).run();
    const auto* prompt = workflow.find(WorkflowRole::Prompt);
    if (role == WorkflowRole::Negative && prompt)  // one text for both sides stays the prompt's
        std::erase_if(texts, [&](const auto& place) { return place.node == prompt->node; });
    keep_only(workflow, texts, role, role == WorkflowRole::Prompt);
}

void guess_output(Workflow& workflow) {
    if (workflow.find(WorkflowRole::Output)) return;
    Places outputs;
    for (const auto& [number, node] : workflow.graph.items())
        if (class_name(node) == "SaveImage" || class_name(node) == "PreviewImage")
            outputs.push_back({WorkflowRole::Output, number, {}});
    keep_only(workflow, outputs, WorkflowRole::Output, true);
}

void guess_values(Workflow& workflow) {
    const auto guess = [&](WorkflowRole role, std::initializer_list<const char*> names) {
        if (!workflow.find(role))
            keep_only(workflow, plain_inputs(workflow, role, names, any_class), role, false);
    };
    guess(WorkflowRole::Seed, {"seed", "noise_seed"});
    guess(WorkflowRole::Steps, {"steps"});
    guess(WorkflowRole::Strength, {"denoise"});
    if (workflow.find(WorkflowRole::Model)) return;
    const auto models = plain_inputs(workflow, WorkflowRole::Model, {"ckpt_name", "unet_name"}, any_class);
    if (models.size() == 1) workflow.places.push_back(models[0]);
}

}  // namespace

void guess_places(Workflow& workflow) {
    guess_image(workflow);
    guess_mask(workflow);
    guess_text(workflow, WorkflowRole::Prompt);
    guess_text(workflow, WorkflowRole::Negative);
    guess_values(workflow);
    guess_output(workflow);
}

}  // namespace gse::remote
