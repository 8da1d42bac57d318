// Nodes of a ComfyUI server, one class at a time: the whole list is tens of megabytes.
#include "engine/remote/protocols/comfy_nodes.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "engine/remote/protocols/server_error.h"

namespace gse::remote {
namespace {

constexpr std::size_t NodeBytes = std::size_t{4} << 20;

nlohmann::json node_facts(ServerLink& link, const std::string& kind, const JobControl& job) {
    Ask how;
    how.most_bytes = NodeBytes;
    const auto answer = link.ask_any_status(link.get("/object_info/" + percent_encoded(kind)), how, job);
    if (answer.status == 404) return nullptr;
    if (answer.status != 200) throw status_error(answer, link.url(), link.requests().has_secret());
    const auto json = link.json_of(answer);
    return value_of(json, kind.c_str());
}

/// Names of a combo: [["a", "b"], ...], or ["COMBO", {"options": [...]}] of newer servers.
std::vector<std::string> choices_of(const nlohmann::json& facts, const std::string& input) {
    for (const char* group : {"required", "optional"}) {
        const auto& kind = value_of(value_of(value_of(facts, "input"), group), input.c_str());
        if (!kind.is_array() || kind.empty()) continue;
        if (kind[0].is_array()) return texts_of(kind[0], nullptr);
        if (kind.size() > 1) return texts_of(value_of(kind[1], "options"), nullptr);
    }
    return {};
}

bool has(const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

Error unknown_model(const ServerLink& link, const std::string& name,
                    const std::vector<std::string>& choices) {
    if (choices.empty())
        return {ErrorCode::InvalidArgument, fmt::format("{} has no model", link.url().nickname()),
                "put one into its folder of models"};
    if (name.empty())
        return {ErrorCode::InvalidArgument,
                fmt::format("{} has {} models, and none is chosen", link.url().nickname(), choices.size()),
                "name one: " + listed(choices)};
    return {ErrorCode::InvalidArgument,
            fmt::format("{} does not have \"{}\"", link.url().nickname(), shown(name)),
            "it has: " + listed(choices)};
}

std::string chosen_model(const ServerLink& link, const std::string& in_workflow, const std::string& wanted,
                         const std::vector<std::string>& choices) {
    const auto& name = wanted.empty() ? in_workflow : wanted;
    if (choices.size() == 1 && name.empty()) return choices[0];
    if (!has(choices, name)) throw unknown_model(link, name, choices);
    return name;
}

class NodeCheck {
public:
    NodeCheck(ServerLink& link, const Workflow& workflow, const JobControl& job)
        : link_(link), workflow_(workflow), job_(job) {}

    void ask_classes() {
        std::vector<std::string> missing;
        for (const auto& node : workflow_.graph) {
            const auto kind = text_of(node, "class_type");
            if (facts_.contains(kind)) continue;
            facts_[kind] = node_facts(link_, kind, job_);
            if (facts_[kind].is_null()) missing.push_back(kind);
        }
        if (!missing.empty())
            throw Error(
                ErrorCode::InvalidArgument,
                fmt::format("{} lacks nodes of the workflow: {}", link_.url().nickname(), listed(missing)),
                "install them there, or use another workflow");
    }

    void refuse_paid() const {
        for (const auto& [kind, facts] : facts_)
            if (value_of(facts, "api_node") == true)
                throw Error(ErrorCode::InvalidArgument,
                            fmt::format("the workflow sends pictures on to a paid service ({})", shown(kind)),
                            "if you want that, allow it (--server-paid-nodes; in the window below Workflow)");
    }

    std::string model(const std::string& wanted) const {
        const auto* place = workflow_.find(WorkflowRole::Model);
        if (place == nullptr) {
            if (wanted.empty()) return {};
            throw Error(ErrorCode::InvalidArgument, "the workflow has no single place for a model",
                        "name the model inside the workflow");
        }
        const auto& node = workflow_.graph[place->node];
        const auto choices = choices_of(facts_.at(text_of(node, "class_type")), place->input);
        return chosen_model(link_, text_of(node["inputs"], place->input.c_str()), wanted, choices);
    }

    void check_choices() const {
        for (const auto& [number, node] : workflow_.graph.items())
            for (const auto& [input, value] : node["inputs"].items()) {
                if (!value.is_string() || workflow_.sets(number, input)) continue;
                const auto choices = choices_of(facts_.at(text_of(node, "class_type")), input);
                if (!choices.empty() && !has(choices, value.get<std::string>()))
                    throw unknown_model(link_, value.get<std::string>(), choices);
            }
    }

private:
    ServerLink& link_;
    const Workflow& workflow_;
    const JobControl& job_;
    std::map<std::string, nlohmann::json> facts_;
};

}  // namespace

std::vector<std::string> offered_names(ServerLink& link, const std::string& kind, const std::string& input,
                                       const JobControl& job) {
    return choices_of(node_facts(link, kind, job), input);
}

std::string check_nodes(ServerLink& link, const Workflow& workflow, const std::string& wanted,
                        bool allow_paid, const JobControl& job) {
    NodeCheck check(link, workflow, job);
    check.ask_classes();
    if (!allow_paid) check.refuse_paid();
    auto model = check.model(wanted);
    check.check_choices();
    return model;
}

std::string node_errors(const nlohmann::json& answer) {
    std::string words;
    const auto& nodes = value_of(answer, "node_errors");
    if (!nodes.is_object()) return words;
    for (const auto& [number, facts] : nodes.items()) {
        const auto& errors = value_of(facts, "errors");
        for (const auto& error : errors.is_array() ? errors : nlohmann::json::array()) {
            const auto details = text_of(error, "details");
            words += fmt::format("{}node {} {}: {}{}", words.empty() ? "" : "; ", number,
                                 text_of(facts, "class_type"), text_of(error, "message"),
                                 details.empty() ? "" : " (" + details + ")");
        }
    }
    return shown(words);
}

}  // namespace gse::remote
