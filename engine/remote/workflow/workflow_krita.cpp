// Nodes of Krita's plug-in: ETN_KritaCanvas (image, width, height, seed), ETN_KritaSelection (mask),
// ETN_Parameter (a value), ETN_KritaOutput.
#include "engine/remote/workflow/workflow_krita.h"

#include <map>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "engine/base/error.h"
#include "engine/base/printable.h"

namespace gse::remote {
namespace {

constexpr int CanvasImage = 0, CanvasWidth = 1, CanvasHeight = 2, CanvasSeed = 3;

std::string class_of(const nlohmann::json& node) { return node["class_type"].get<std::string>(); }

bool is_link(const nlohmann::json& value) {
    return value.is_array() && value.size() == 2 && value[0].is_string() && value[1].is_number_integer();
}

/// Calls `visit(node, input, output number)` for every link to `number`.
template <class F> void for_links_to(nlohmann::json& graph, const std::string& number, F&& visit) {
    for (auto& [other, node] : graph.items())
        for (auto& [input, value] : node["inputs"].items())
            if (is_link(value) && value[0] == number)
                visit(other, input, value, value[1].template get<int>());
}

Error unknown_krita_node(const std::string& kind) {
    return {ErrorCode::Unsupported, fmt::format("the workflow needs Krita ({})", printable(kind)),
            "use its canvas, selection, parameters and output only"};
}

void replace_canvas(nlohmann::json& graph, const std::string& number, std::vector<WorkflowPlace>& places) {
    for_links_to(graph, number, [&](const auto& node, const auto& input, nlohmann::json& value, int output) {
        if (output == CanvasImage) return;
        static const std::map<int, WorkflowRole> roles{{CanvasWidth, WorkflowRole::Width},
                                                       {CanvasHeight, WorkflowRole::Height},
                                                       {CanvasSeed, WorkflowRole::Seed}};
        const auto role = roles.find(output);
        if (role == roles.end()) throw unknown_krita_node("the canvas's transparency");
        value = 0;
        places.push_back({role->second, node, input});
    });
    graph[number] = {{"class_type", "LoadImage"}, {"inputs", {{"image", ""}}}};
    places.push_back({WorkflowRole::Image, number, "image"});
}

void replace_selection(nlohmann::json& graph, const std::string& number, std::vector<WorkflowPlace>& places) {
    for_links_to(graph, number, [&](const auto&, const auto&, nlohmann::json&, int output) {
        if (output != 0) throw unknown_krita_node("more than the selection's mask");
    });
    graph[number] = {{"class_type", "LoadImageMask"}, {"inputs", {{"image", ""}, {"channel", "red"}}}};
    places.push_back({WorkflowRole::Mask, number, "image"});
}

void replace_parameter(nlohmann::json& graph, const std::string& number, std::vector<WorkflowPlace>& places) {
    static const std::map<std::string, WorkflowRole> roles{{"prompt", WorkflowRole::Prompt},
                                                           {"Prompt", WorkflowRole::Prompt},
                                                           {"Negative Prompt", WorkflowRole::Negative},
                                                           {"Seed", WorkflowRole::Seed},
                                                           {"Strength", WorkflowRole::Strength},
                                                           {"Steps", WorkflowRole::Steps}};
    const auto inputs = graph[number]["inputs"];
    const auto name = inputs.contains("name") && inputs["name"].is_string()
                          ? inputs["name"].get<std::string>()
                          : std::string();
    const auto role = roles.find(name);
    for_links_to(graph, number, [&](const auto& node, const auto& input, nlohmann::json& value, int) {
        value = inputs.contains("default") ? inputs["default"] : nlohmann::json();
        if (role != roles.end()) places.push_back({role->second, node, input});
    });
    graph.erase(number);
}

}  // namespace

std::vector<WorkflowPlace> replace_krita_nodes(nlohmann::json& graph) {
    std::map<std::string, std::string> krita;
    for (const auto& [number, node] : graph.items())
        if (class_of(node).starts_with("ETN_")) krita.emplace(number, class_of(node));
    std::vector<WorkflowPlace> places;
    for (const auto& [number, kind] : krita) {
        if (kind == "ETN_KritaCanvas") replace_canvas(graph, number, places);
        else if (kind == "ETN_KritaSelection") replace_selection(graph, number, places);
        else if (kind == "ETN_Parameter") replace_parameter(graph, number, places);
        else if (kind == "ETN_KritaOutput") {
            graph[number]["class_type"] = "PreviewImage";
            places.push_back({WorkflowRole::Output, number, {}});
        } else if (kind.starts_with("ETN_Krita")) throw unknown_krita_node(kind);
    }
    return places;
}

}  // namespace gse::remote
