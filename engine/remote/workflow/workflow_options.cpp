// Nodes by title, class or number, and values of the kind that an input has.
#include "engine/remote/workflow/workflow_options.h"

#include <algorithm>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "engine/base/error.h"
#include "engine/base/printable.h"

namespace gse::remote {
namespace {

constexpr std::size_t MostInputs = 12;

std::string node_title(const nlohmann::json& node) {
    const auto meta = node.find("_meta");
    if (meta == node.end() || !meta->is_object()) return {};
    const auto title = meta->find("title");
    return title != meta->end() && title->is_string() ? title->get<std::string>() : std::string();
}

std::string node_class(const nlohmann::json& node) { return node["class_type"].get<std::string>(); }

/// Numbers of the nodes of a title; without one, of a class; without one, of that number.
std::vector<std::string> nodes_named(const nlohmann::json& graph, const std::string& name) {
    std::vector<std::string> titled, classed;
    if (name.empty()) return titled;  // many nodes have no title
    for (const auto& [number, node] : graph.items()) {
        if (node_title(node) == name) titled.push_back(number);
        if (node_class(node) == name) classed.push_back(number);
    }
    if (!titled.empty()) return titled;
    if (!classed.empty()) return classed;
    return graph.contains(name) ? std::vector<std::string>{name} : std::vector<std::string>{};
}

/// Plain inputs of a workflow that an artist may set, as options name them; a few.
std::vector<std::string> free_inputs(const Workflow& workflow) {
    std::vector<std::string> names;
    for (const auto& [number, node] : workflow.graph.items())
        for (const auto& [input, value] : node["inputs"].items()) {
            if (value.is_structured() || workflow.sets(number, input) || names.size() == MostInputs) continue;
            names.push_back(printable(node_class(node) + "." + input));
        }
    return names;
}

Error bad_input(const ServerOption& option, const std::string& why, const std::string& hint) {
    return {ErrorCode::InvalidArgument, fmt::format("\"{}\" {}", printable(option.name), why), hint};
}

/// The value as the input's kind wants it.
nlohmann::json value_like(const nlohmann::json& before, const ServerOption& option) {
    if (before.is_string()) return option.value;
    auto value = json_value(option);
    const bool same = before.is_boolean()  ? value.is_boolean()
                      : before.is_number() ? value.is_number()
                                           : !value.is_structured();
    if (!same)
        throw bad_input(option, "takes no such value",
                        fmt::format("write it as the workflow has it, such as {}", before.dump()));
    return value;
}

void set_one_input(Workflow& workflow, const ServerOption& option) {
    const auto dot = option.name.rfind('.');
    const auto named = dot == std::string::npos ? std::string() : option.name.substr(0, dot);
    const auto input = option.name.substr(dot == std::string::npos ? 0 : dot + 1);
    const auto nodes = nodes_named(workflow.graph, named);
    if (nodes.size() > 1)
        throw bad_input(option, "belongs to several nodes of the workflow",
                        fmt::format("name one by its title or number: {}", fmt::join(nodes, ", ")));
    const bool there = !nodes.empty() && workflow.graph[nodes[0]]["inputs"].contains(input);
    if (nodes.empty() || !(there || (option.forced && !input.empty())))
        throw bad_input(option, "is no input of the workflow",
                        fmt::format("name one as NODE.input; it has {}; force:NODE.input=VALUE gives a node "
                                    "an input that the workflow leaves out",
                                    fmt::join(free_inputs(workflow), ", ")));
    auto& value = workflow.graph[nodes[0]]["inputs"][input];
    if (value.is_structured())
        throw bad_input(option, "is linked to another node", "set an input of that node");
    if (workflow.sets(nodes[0], input))
        throw bad_input(option, "is set by the program for every picture", "leave it out");
    value = value_like(value, option);
}

}  // namespace

void set_inputs(Workflow& workflow, const std::vector<ServerOption>& options) {
    for (const auto& option : options) set_one_input(workflow, option);
}

}  // namespace gse::remote
