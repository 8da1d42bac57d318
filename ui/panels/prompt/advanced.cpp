// All settings of an edit, in groups that fold, or by a word of their name.
#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <string>

#include "engine/edit/request/edit_method.h"
#include "ui/panels/prompt/parts.h"
#include "ui/state/state.h"
#include "ui/widgets/controls.h"
#include "ui/widgets/fields.h"

namespace gse::ui {
namespace {

/// First field of each group of the advanced settings; what comes before the first is on the panel itself.
struct Group {
    const char* first_field;
    const char* title;
};
constexpr std::array<Group, 8> Groups{{{"views", "Views"},
                                       {"competing_words", "Localization"},
                                       {"method", "Optimisation"},
                                       {"anchor_first", "Anchors"},
                                       {"rate_position", "Learning rates"},
                                       {"densify_from", "Growth"},
                                       {"seed_splats", "Adding"},
                                       {"snapshot_every", "Running"}}};

void back_to_defaults(Context& context) {
    edit::EditRequest fresh = context.model.request_defaults;
    fresh.source = context.request.source, fresh.prompt = context.request.prompt,
    fresh.target = context.request.target;
    fresh.mode = context.request.mode, fresh.seed = context.request.seed;
    context.request = fresh;
    context.request_changed = true;
    context.model_settings = context.model.model_settings_defaults;
    context.model_settings_changed = true;
}

void nothing_before(const char*, bool&) {}

/// Settings that count for nothing with the method that the edit is led by.
UnusedField unused_by_method(const Context& context) {
    return [&method = edit::method_of(context.request)](unsigned uses) {
        return edit::why_unused(method, uses);
    };
}

/// Fields of the request under the headers of their groups.
void draw_request_groups(Context& context) {
    bool in_groups = false, tree_open = false;
    const auto before = [&](const char* name, bool& shown) {
        for (const auto& group : Groups) {
            if (std::string_view(group.first_field) != name) continue;
            if (tree_open) ImGui::TreePop();
            tree_open = ImGui::TreeNodeEx(group.title, ImGuiTreeNodeFlags_SpanAvailWidth);
            note(context, fmt::format("prompt.group.{}", group.title));
            in_groups = true;
        }
        shown = in_groups && tree_open;
    };
    const auto all = [](const char*, const char*) { return true; };
    context.request_changed |= field_rows(context, "request", context.request, all, before,
                                          context.model.request_defaults, unused_by_method(context));
    if (tree_open) ImGui::TreePop();
}

/// Fields of the model's settings that `wanted` lets through, with the prefix they have in a recipe.
template <class P, class Wanted>
void model_rows(Context& context, const char* prefix, P& part, const P& standard, Wanted&& wanted) {
    context.model_settings_changed |=
        field_rows(context, prefix, part, wanted, nothing_before, standard, unused_by_method(context));
}

template <class Wanted> void draw_model_groups(Context& context, bool grouped, Wanted&& wanted) {
    auto& settings = context.model_settings;
    const auto& standard = context.model.model_settings_defaults;
    const auto group = [&](const char* title, auto&& rows) {
        if (!grouped) return rows();
        const bool open = ImGui::TreeNodeEx(title, ImGuiTreeNodeFlags_SpanAvailWidth);
        note(context, fmt::format("prompt.group.{}", title));
        if (!open) return;
        rows();
        ImGui::TreePop();
    };
    group("Model", [&] { model_rows(context, "model_settings", settings, standard, wanted); });
    group("Guidance", [&] { model_rows(context, "guidance", settings.guidance, standard.guidance, wanted); });
    group("Attention",
          [&] { model_rows(context, "attention", settings.attention, standard.attention, wanted); });
    group("Learning the scene",
          [&] { model_rows(context, "learning", settings.learning, standard.learning, wanted); });
}

bool contains_text(std::string_view text, const std::string& wanted) {
    const auto same = [](char a, char b) {
        return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
    };
    return std::search(text.begin(), text.end(), wanted.begin(), wanted.end(), same) != text.end();
}

/// Settings whose name or explanation contains what was typed, without their groups.
void draw_found_settings(Context& context, const std::string& wanted) {
    bool any = false;
    const auto matches = [&](const char* name, const char* help) {
        const bool match = contains_text(field_label(name), wanted) || contains_text(help, wanted);
        any |= match;
        return match;
    };
    context.request_changed |= field_rows(context, "request", context.request, matches, nothing_before,
                                          context.model.request_defaults, unused_by_method(context));
    draw_model_groups(context, false, matches);
    if (!any) dim_text("No setting is called so.");
}

}  // namespace

void draw_advanced(Context& context) {
    if (!folding(context, "prompt.advanced", "All settings")) return;
    auto& wanted = context.state.prompt.settings_filter;
    ImGui::SetNextItemWidth(-1);
    text_input(context, "prompt.filter", wanted, "find a setting");
    if (button(context, {.name = "prompt.defaults",
                         .text = "Back to the defaults",
                         .tooltip = "All settings below; words and seed stay"}))
        back_to_defaults(context);
    dim_text(fmt::format("In brackets: no effect while the edit is led by {}.",
                         edit::method_of(context.request).leader()));
    if (!wanted.empty()) return draw_found_settings(context, wanted);
    draw_request_groups(context);
    draw_model_groups(context, true, [](const char*, const char*) { return true; });
}

}  // namespace gse::ui
