// Loaders of LoRAs between a model and what draws with it.
#include "engine/remote/workflow/workflow_loras.h"

#include <fmt/format.h>

#include "engine/base/error.h"

namespace gse::remote {
namespace {

constexpr int ModelOutput = 0, ClipOutput = 1;

/// Everything that is linked to one output is linked to another node's.
void relink(nlohmann::json& graph, const std::string& from, const std::string& to, int output) {
    const auto before = nlohmann::json::array({from, output});
    for (auto& node : graph)
        for (auto& value : node["inputs"])
            if (value == before) value[0] = to;
}

}  // namespace

void add_lora_loaders(Workflow& workflow, const std::vector<std::pair<std::string, double>>& loras) {
    if (loras.empty()) return;
    const auto* place = workflow.find(WorkflowRole::Model);
    if (place == nullptr)
        throw Error(ErrorCode::InvalidArgument, "the workflow has no single place for a LoRA",
                    "put a LoraLoader into it, and set it by --server-option LoraLoader.lora_name=NAME");
    // Loaders of checkpoints give the text encoder, too.
    const bool with_clip = place->input == "ckpt_name";
    std::string before = place->node;
    for (std::size_t i = 0; i < loras.size(); ++i) {
        const auto& [name, weight] = loras[i];
        const auto number = fmt::format("gse lora {}", i + 1);
        relink(workflow.graph, before, number, ModelOutput);
        if (with_clip) relink(workflow.graph, before, number, ClipOutput);
        nlohmann::json inputs{{"model", nlohmann::json::array({before, ModelOutput})},
                              {"lora_name", name},
                              {"strength_model", weight}};
        if (with_clip) {
            inputs["clip"] = nlohmann::json::array({before, ClipOutput});
            inputs["strength_clip"] = weight;
        }
        workflow.graph[number] = {{"class_type", with_clip ? "LoraLoader" : "LoraLoaderModelOnly"},
                                  {"inputs", std::move(inputs)}};
        before = number;
    }
}

}  // namespace gse::remote
