// A bar between two areas that is dragged to change their sizes.
#include "ui/widgets/splitter.h"

#include <imgui_internal.h>

#include <string>

namespace gse::ui {

float splitter(Context& context, std::string_view name, ImVec2 low, ImVec2 high) {
    const bool upright = high.y - low.y > high.x - low.x;
    ImGui::SetCursorScreenPos(low);
    ImGui::PushItemFlag(ImGuiItemFlags_NoNav, true);  // only a mouse drags it
    ImGui::InvisibleButton(std::string(name).c_str(),
                           {std::max(1.0f, high.x - low.x), std::max(1.0f, high.y - low.y)});
    note(context, name);
    ImGui::PopItemFlag();
    const bool hot = ImGui::IsItemActive() || ImGui::IsItemHovered();
    if (hot) {
        ImGui::SetMouseCursor(upright ? ImGuiMouseCursor_ResizeEW : ImGuiMouseCursor_ResizeNS);
        ImGui::GetWindowDrawList()->AddRectFilled(
            low, high, ImGui::IsItemActive() ? palette::Accent : palette::AccentDeep);
    }
    if (!ImGui::IsItemActive()) return 0;
    const ImVec2 delta = ImGui::GetIO().MouseDelta;
    return upright ? delta.x : delta.y;
}

}  // namespace gse::ui
