// Steps in plain words.
#include "engine/language/plan/plan_text.h"

#include <array>

namespace gse::language::plan {
namespace {

constexpr std::array<std::string_view, 15> Labels = {
    "colour", "material", "pattern",      "size or place", "pose",
    "look",   "ground",   "remove",       "replace",       "add",
    "copies", "style",    "surroundings", "nothing to do", "not understood"};

std::string said(const Thing& thing) {
    std::string text;
    if (!thing.count.empty()) text += thing.count + " ";
    for (const auto& attribute : thing.attributes) text += attribute + " ";
    return text + thing.noun;
}

std::string said(const Reference& reference) {
    if (reference.is_scene()) return "the whole scene";
    std::string text = reference.except ? "everything but " : "";
    for (std::size_t i = 0; i < reference.links.size(); ++i)
        text += (i > 0 ? " of " : "") + said(reference.links[i]);
    return text;
}

std::string said(const std::vector<Reference>& references) {
    std::string text;
    for (const auto& reference : references) text += (text.empty() ? "" : " and ") + said(reference);
    return text;
}

}  // namespace

std::string step_text(const Step& step) {
    const auto label = std::string(Labels[static_cast<std::size_t>(step.operation)]) + ": ";
    switch (step.operation) {
        case Operation::None: return label + step.text;
        case Operation::Refuse: return label + step.text + (step.text2.empty() ? "" : ", " + step.text2);
        case Operation::Remove: return label + said(step.subject);
        case Operation::Ground:
            return label + said(step.thing) + (step.text2 == "-" ? "" : " instead of " + step.text2);
        case Operation::Replace: return label + said(step.subject) + " by " + said(step.thing);
        case Operation::Add:
            return label + said(step.thing) + ", " + step.relation + " " + said(step.anchors);
        default: break;
    }
    auto text = label + said(step.subject) + ", " + step.text;
    if (!step.text2.empty()) text += ", " + step.text2;
    return step.anchors.empty() ? text : text + " " + said(step.anchors);
}

}  // namespace gse::language::plan
