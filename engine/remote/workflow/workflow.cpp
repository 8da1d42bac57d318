// Workflow of ComfyUI: reading, titles, and values in their places. Values are set in the parsed JSON.
#include "engine/remote/workflow/workflow.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "engine/base/json.h"
#include "engine/base/printable.h"
#include "engine/remote/workflow/workflow_guess.h"
#include "engine/remote/workflow/workflow_krita.h"

namespace gse::remote {
namespace {

constexpr std::size_t MostNodes = 2000, MostBytes = std::size_t{1} << 20;
constexpr std::string_view TitleStart = "gse ";

constexpr std::array<std::pair<WorkflowRole, std::string_view>, 14> RoleNames{{
    {WorkflowRole::Image, "image"},
    {WorkflowRole::Mask, "mask"},
    {WorkflowRole::Reference, "reference"},
    {WorkflowRole::Prompt, "prompt"},
    {WorkflowRole::Negative, "negative"},
    {WorkflowRole::Seed, "seed"},
    {WorkflowRole::Strength, "strength"},
    {WorkflowRole::Steps, "steps"},
    {WorkflowRole::Guidance, "guidance"},
    {WorkflowRole::DistilledGuidance, "distilled guidance"},
    {WorkflowRole::Width, "width"},
    {WorkflowRole::Height, "height"},
    {WorkflowRole::Model, "model"},
    {WorkflowRole::Output, "output"},
}};

/// Names of inputs that a role may be set in, best first.
std::vector<const char*> inputs_of(WorkflowRole role) {
    switch (role) {
        case WorkflowRole::Image:
        case WorkflowRole::Mask:
        case WorkflowRole::Reference: return {"image"};
        case WorkflowRole::Prompt:
        case WorkflowRole::Negative: return {"text", "prompt", "string", "value"};
        case WorkflowRole::Seed: return {"seed", "noise_seed", "value"};
        case WorkflowRole::Strength: return {"denoise", "strength", "value"};
        case WorkflowRole::Steps: return {"steps", "value"};
        case WorkflowRole::Guidance: return {"cfg", "guidance", "value"};
        case WorkflowRole::DistilledGuidance: return {"guidance", "value"};
        case WorkflowRole::Width: return {"width", "value"};
        case WorkflowRole::Height: return {"height", "value"};
        case WorkflowRole::Model: return {"ckpt_name", "unet_name", "value"};
        case WorkflowRole::Output: return {};
    }
    return {};
}

std::string trimmed_lower(std::string_view text) {
    while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
    while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
    std::string lower(text);
    for (char& c : lower)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return lower;
}

/// "reference 2" is a reference.
std::string without_number(std::string name) {
    while (!name.empty() && name.back() >= '0' && name.back() <= '9') name.pop_back();
    return trimmed_lower(name);
}

std::optional<WorkflowRole> role_named(const std::string& name) {
    for (const auto& [role, known] : RoleNames)
        if (name == known) return role;
    return std::nullopt;
}

std::string title_of(const nlohmann::json& node) {
    const auto meta = node.find("_meta");
    if (meta == node.end() || !meta->is_object()) return {};
    const auto title = meta->find("title");
    return title != meta->end() && title->is_string() ? title->get<std::string>() : std::string();
}

WorkflowPlace titled_place(const std::string& number, const nlohmann::json& node, WorkflowRole role) {
    if (role == WorkflowRole::Output) return {role, number, {}};
    for (const char* input : inputs_of(role)) {
        const auto found = node["inputs"].find(input);
        if (found != node["inputs"].end() && !found->is_array()) return {role, number, input};
    }
    throw Error(ErrorCode::InvalidArgument,
                fmt::format("node {} of the workflow is titled \"{}\", but has no such value to set",
                            printable(number), printable(title_of(node))),
                "give the title to a node that holds the value itself");
}

/// Places of nodes titled "gse ...", sorted by title, so that references keep their order.
std::vector<WorkflowPlace> titled_places(const nlohmann::json& graph) {
    std::vector<std::pair<std::string, WorkflowPlace>> found;
    for (const auto& [number, node] : graph.items()) {
        std::string title = trimmed_lower(title_of(node));
        if (!title.starts_with(TitleStart)) continue;
        title.erase(0, TitleStart.size());
        for (std::size_t begin = 0; begin <= title.size();) {
            const auto end = std::min(title.find(',', begin), title.size());
            const auto name = trimmed_lower(title.substr(begin, end - begin));
            begin = end + 1;
            const auto role = role_named(without_number(name));
            if (!role)
                throw Error(
                    ErrorCode::InvalidArgument,
                    fmt::format("a node of the workflow is titled \"gse {}\", which is not known",
                                printable(name)),
                    "known are image, mask, reference, prompt, negative, seed, strength, steps, output");
            found.emplace_back(name, titled_place(number, node, *role));
        }
    }
    std::stable_sort(found.begin(), found.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<WorkflowPlace> places;
    for (auto& [name, place] : found) places.push_back(std::move(place));
    return places;
}

void check_single(const std::vector<WorkflowPlace>& places) {
    for (const auto& [role, name] : RoleNames) {
        const bool several = role == WorkflowRole::Reference || role == WorkflowRole::Seed ||
                             role == WorkflowRole::Width || role == WorkflowRole::Height;
        const auto count = std::count_if(places.begin(), places.end(),
                                         [role = role](const auto& place) { return place.role == role; });
        if (count > 1 && !several)
            throw Error(ErrorCode::InvalidArgument,
                        fmt::format("{} nodes of the workflow are titled \"gse {}\"", count, name),
                        "give each title once");
    }
}

nlohmann::json graph_of(std::string_view text) {
    if (text.size() > MostBytes)
        throw Error(ErrorCode::Malformed, "the workflow is larger than 1 MiB",
                    "name a workflow in API format");
    auto json = parse_json(text, "the workflow");
    if (json.is_object() && json.contains("nodes") && json.contains("links"))
        throw Error(ErrorCode::Malformed, "the workflow is in the format of ComfyUI's window",
                    "save it by Workflow > Export (API)");
    if (json.is_object() && json.contains("prompt") && json["prompt"].is_object()) json = json["prompt"];
    if (!json.is_object() || json.empty() || json.size() > MostNodes)
        throw Error(ErrorCode::Malformed, "the workflow has no nodes, or more than 2,000",
                    "name a workflow in API format");
    for (const auto& node : json)
        if (!node.is_object() || !node.contains("class_type") || !node["class_type"].is_string() ||
            !node.contains("inputs") || !node["inputs"].is_object())
            throw Error(ErrorCode::Malformed, "the workflow holds something that is no node",
                        "name a workflow in API format");
    return json;
}

nlohmann::json value_for(WorkflowRole role, const WorkflowValues& values) {
    switch (role) {
        case WorkflowRole::Image: return values.image;
        case WorkflowRole::Mask: return values.mask;
        case WorkflowRole::Prompt: return values.prompt;
        case WorkflowRole::Negative: return values.negative_prompt;
        case WorkflowRole::Seed: return values.seed;
        case WorkflowRole::Strength: return values.strength;
        case WorkflowRole::Steps: return values.steps;
        case WorkflowRole::Guidance: return values.guidance_scale;
        case WorkflowRole::DistilledGuidance:
            return values.distilled_guidance > 0 ? nlohmann::json(values.distilled_guidance)
                                                 : nlohmann::json();
        case WorkflowRole::Width: return values.width;
        case WorkflowRole::Height: return values.height;
        case WorkflowRole::Model:
            return values.model.empty() ? nlohmann::json() : nlohmann::json(values.model);
        case WorkflowRole::Reference:
        case WorkflowRole::Output: break;
    }
    return nullptr;
}

}  // namespace

std::string_view workflow_role_name(WorkflowRole role) {
    for (const auto& [known, name] : RoleNames)
        if (known == role) return name;
    return {};
}

std::size_t Workflow::count(WorkflowRole role) const {
    return static_cast<std::size_t>(
        std::count_if(places.begin(), places.end(), [&](const auto& place) { return place.role == role; }));
}

const WorkflowPlace* Workflow::find(WorkflowRole role) const {
    for (const auto& place : places)
        if (place.role == role) return &place;
    return nullptr;
}

bool Workflow::sets(std::string_view node, std::string_view input) const {
    return std::any_of(places.begin(), places.end(),
                       [&](const auto& place) { return place.node == node && place.input == input; });
}

std::vector<std::string> Workflow::table() const {
    std::vector<std::string> lines;
    for (const auto& place : places)
        lines.push_back(printable(fmt::format("{}: node {} ({}){}", workflow_role_name(place.role),
                                              place.node, graph[place.node]["class_type"].get<std::string>(),
                                              place.input.empty() ? "" : ", " + place.input)));
    if (mask_in_alpha) lines.push_back("mask: alpha channel of the image");
    return lines;
}

Workflow read_workflow(std::string_view text) {
    Workflow workflow;
    workflow.graph = graph_of(text);
    workflow.places = replace_krita_nodes(workflow.graph);
    auto titled = titled_places(workflow.graph);
    workflow.places.insert(workflow.places.end(), titled.begin(), titled.end());
    check_single(workflow.places);
    guess_places(workflow);
    auto& output = workflow.graph[workflow.find(WorkflowRole::Output)->node];
    output["class_type"] = "PreviewImage";  // whose files do not stay
    output["inputs"] = {{"images", output["inputs"]["images"]}};
    return workflow;
}

nlohmann::json filled_workflow(const Workflow& workflow, const WorkflowValues& values) {
    auto graph = workflow.graph;
    std::size_t references = 0;
    for (const auto& place : workflow.places) {
        auto value = value_for(place.role, values);
        if (place.role == WorkflowRole::Reference && references < values.references.size())
            value = values.references[references++];
        if (!value.is_null()) graph[place.node]["inputs"][place.input] = std::move(value);
    }
    return graph;
}

}  // namespace gse::remote
