// Plans and their notation.
#include "engine/language/plan/notation/plan.h"

#include <algorithm>
#include <array>

namespace gse::language::plan {
namespace {

constexpr std::array<std::string_view, 15> Names = {
    "recolour", "material", "pattern",   "transform", "pose",        "alter", "ground", "remove",
    "replace",  "add",      "duplicate", "style",     "environment", "none",  "refuse"};

std::string separated(const std::vector<std::string>& parts, std::string_view separator) {
    std::string text;
    for (const auto& part : parts) {
        if (!text.empty()) text += separator;
        text += part;
    }
    return text;
}

std::vector<std::string> arguments_of(const Step& step) {
    std::vector<std::string> arguments;
    switch (step.operation) {
        case Operation::Ground: return {step.text2, to_string(step.thing)};
        case Operation::Remove: return {to_string(step.subject)};
        case Operation::Replace: return {to_string(step.subject), to_string(step.thing)};
        case Operation::None: return {step.text};
        case Operation::Add: {
            std::vector<std::string> anchors;
            for (const auto& anchor : step.anchors) anchors.push_back(to_string(anchor));
            return {to_string(step.thing), step.relation, separated(anchors, " + ")};
        }
        case Operation::Refuse: arguments = {step.text}; break;
        default: arguments = {to_string(step.subject), step.text}; break;
    }
    if (!step.text2.empty()) arguments.push_back(step.text2);
    if (step.operation == Operation::Transform && !step.anchors.empty())
        arguments.push_back(to_string(step.anchors.front()));
    return arguments;
}

}  // namespace

std::string_view name_of(Operation operation) { return Names[static_cast<std::size_t>(operation)]; }

Reference scene_reference() { return {{{"scene", "", {}}}, false}; }

bool Plan::is_refusal() const {
    return std::all_of(steps.begin(), steps.end(), [](const Step& step) {
        return step.operation == Operation::Refuse || step.operation == Operation::None;
    });
}

Plan refusal(std::string_view reason, std::string_view word) {
    Step step;
    step.operation = Operation::Refuse;
    step.text = reason;
    step.text2 = word;
    return {{step}};
}

std::string to_string(const Thing& thing) {
    std::string text = thing.noun;
    if (!thing.count.empty()) text += "[" + thing.count + "]";
    if (!thing.attributes.empty()) text += "{" + separated(thing.attributes, ", ") + "}";
    return text;
}

std::string to_string(const Reference& reference) {
    std::vector<std::string> links;
    for (const auto& link : reference.links) links.push_back(to_string(link));
    return (reference.except ? "scene except " : "") + separated(links, " of ");
}

std::string to_string(const Step& step) {
    return std::string(name_of(step.operation)) + "(" + separated(arguments_of(step), ", ") + ")";
}

std::string to_string(const Plan& plan) {
    std::vector<std::string> steps;
    for (const auto& step : plan.steps) steps.push_back(to_string(step));
    return separated(steps, " ; ");
}

}  // namespace gse::language::plan
