// Icons drawn with lines, so that they are sharp at every scale, and buttons that carry one.
#include "ui/widgets/icons.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <string>

#include "ui/widgets/controls.h"

namespace gse::ui {
namespace {

/// Draws in a square from -1 to 1 around its centre.
class Pen {
public:
    Pen(ImDrawList* list, ImVec2 centre, float size, ImU32 colour)
        : list_(list), centre_(centre), half_(size * 0.5f), colour_(colour),
          width_(std::max(1.0f, size / 11)) {}

    ImVec2 at(float x, float y) const { return {centre_.x + x * half_, centre_.y + y * half_}; }
    void path(std::initializer_list<std::array<float, 2>> points, bool closed = false) const {
        for (const auto& point : points) list_->PathLineTo(at(point[0], point[1]));
        list_->PathStroke(colour_, closed ? ImDrawFlags_Closed : ImDrawFlags_None, width_);
    }
    void fill(std::initializer_list<std::array<float, 2>> points) const {
        for (const auto& point : points) list_->PathLineTo(at(point[0], point[1]));
        list_->PathFillConvex(colour_);
    }
    void circle(float x, float y, float radius) const {
        list_->AddCircle(at(x, y), radius * half_, colour_, 0, width_);
    }
    void dot(float x, float y, float radius) const {
        list_->AddCircleFilled(at(x, y), radius * half_, colour_);
    }
    /// Angles in turns of the circle, clockwise from the right.
    void arc(float x, float y, float radius, float from, float to) const {
        constexpr float Turn = 6.2831853f;
        list_->PathArcTo(at(x, y), radius * half_, from * Turn, to * Turn);
        list_->PathStroke(colour_, ImDrawFlags_None, width_);
    }
    void ellipse(float x, float y, float rx, float ry) const {
        for (int step = 0; step < 28; ++step) {
            const float angle = 6.2831853f * static_cast<float>(step) / 28;
            list_->PathLineTo(at(x + rx * std::cos(angle), y + ry * std::sin(angle)));
        }
        list_->PathStroke(colour_, ImDrawFlags_Closed, width_);
    }

private:
    ImDrawList* list_;
    ImVec2 centre_;
    float half_;
    ImU32 colour_;
    float width_;
};

void draw_place(const Pen& pen, Icon icon) {
    switch (icon) {
        case Icon::FrontOnly:
            pen.path({{-0.8f, -0.5f}, {0.3f, -0.5f}, {0.3f, 0.6f}, {-0.8f, 0.6f}}, true);
            pen.fill({{-0.8f, -0.5f}, {0.3f, -0.5f}, {0.3f, 0.6f}, {-0.8f, 0.6f}});
            pen.path({{-0.2f, -0.8f}, {0.8f, -0.8f}, {0.8f, 0.3f}});
            break;
        case Icon::Through:
            pen.path({{-0.8f, -0.4f}, {0.3f, -0.4f}, {0.3f, 0.7f}, {-0.8f, 0.7f}}, true);
            pen.path({{-0.3f, -0.8f}, {0.8f, -0.8f}, {0.8f, 0.3f}, {-0.3f, 0.3f}}, true);
            break;
        case Icon::Frame:
            for (const float x : {-1.0f, 1.0f})
                for (const float y : {-1.0f, 1.0f})
                    pen.path({{x * 0.8f, y * 0.35f}, {x * 0.8f, y * 0.8f}, {x * 0.35f, y * 0.8f}});
            pen.dot(0, 0, 0.3f);
            break;
        case Icon::Home:
            pen.path({{-0.85f, 0.05f}, {0, -0.75f}, {0.85f, 0.05f}});
            pen.path({{-0.6f, -0.1f}, {-0.6f, 0.75f}, {0.6f, 0.75f}, {0.6f, -0.1f}});
            break;
        case Icon::Camera:
            pen.path({{-0.85f, -0.4f},
                      {-0.4f, -0.4f},
                      {-0.2f, -0.7f},
                      {0.2f, -0.7f},
                      {0.4f, -0.4f},
                      {0.85f, -0.4f},
                      {0.85f, 0.65f},
                      {-0.85f, 0.65f}},
                     true);
            pen.circle(0, 0.1f, 0.3f);
            break;
        default: break;
    }
}

void draw_tool(const Pen& pen, Icon icon) {
    switch (icon) {
        case Icon::Pointer:
            pen.fill({{-0.5f, -0.85f}, {-0.5f, 0.6f}, {-0.12f, 0.28f}, {0.6f, 0.22f}});
            pen.fill({{-0.16f, 0.2f}, {0.08f, 0.1f}, {0.38f, 0.78f}, {0.14f, 0.88f}});
            break;
        case Icon::Pencil:
            pen.path({{-0.75f, 0.75f}, {-0.6f, 0.2f}, {0.4f, -0.8f}, {0.8f, -0.4f}, {-0.2f, 0.6f}}, true);
            pen.path({{0.15f, -0.55f}, {0.55f, -0.15f}});
            break;
        case Icon::Brush:
            pen.path({{-0.2f, 0.15f}, {0.75f, -0.8f}});
            pen.path({{0.05f, 0.4f}, {0.9f, -0.65f}});
            pen.fill({{-0.75f, 0.8f}, {-0.45f, 0.2f}, {-0.1f, 0.05f}, {0.12f, 0.35f}, {-0.1f, 0.65f}});
            break;
        case Icon::Rectangle:
            for (const float side : {-0.7f, 0.7f})
                for (const float from : {-0.7f, -0.15f, 0.4f}) {
                    pen.path({{from, side}, {from + 0.3f, side}});
                    pen.path({{side, from}, {side, from + 0.3f}});
                }
            break;
        case Icon::Lasso:
            pen.ellipse(0.05f, -0.25f, 0.8f, 0.5f);
            pen.circle(-0.45f, 0.3f, 0.17f);
            pen.path({{-0.45f, 0.47f}, {-0.35f, 0.7f}, {-0.6f, 0.9f}});
            break;
        case Icon::CutOut:  // a thing between the corners of a box
            for (const float x : {-0.8f, 0.8f})
                for (const float y : {-0.8f, 0.8f}) pen.path({{x, y * 0.5f}, {x, y}, {x * 0.5f, y}});
            pen.dot(0, -0.2f, 0.24f);
            pen.ellipse(0, 0.3f, 0.42f, 0.26f);
            break;
        case Icon::Heal:  // a plaster
            pen.path({{-0.85f, 0.35f}, {0.35f, -0.85f}, {0.85f, -0.35f}, {-0.35f, 0.85f}}, true);
            pen.path({{-0.4f, -0.1f}, {0.1f, 0.4f}});
            pen.path({{-0.1f, -0.4f}, {0.4f, 0.1f}});
            break;
        case Icon::Place:  // arrows in four directions
            pen.path({{-0.85f, 0}, {0.85f, 0}});
            pen.path({{0, -0.85f}, {0, 0.85f}});
            for (const float end : {-0.85f, 0.85f}) {
                const float back = end * 0.7f;
                pen.path({{back, -0.25f}, {end, 0}, {back, 0.25f}});
                pen.path({{-0.25f, back}, {0, end}, {0.25f, back}});
            }
            break;
        default: draw_place(pen, icon);
    }
}

void draw_view(const Pen& pen, Icon icon) {
    switch (icon) {
        case Icon::Wipe:
            pen.path({{-0.8f, -0.6f}, {0.8f, -0.6f}, {0.8f, 0.6f}, {-0.8f, 0.6f}}, true);
            pen.fill({{-0.8f, -0.6f}, {0, -0.6f}, {0, 0.6f}, {-0.8f, 0.6f}});
            pen.path({{0, -0.9f}, {0, 0.9f}});
            break;
        case Icon::Flip:
            pen.path({{-0.8f, -0.3f}, {0.8f, -0.3f}, {0.45f, -0.65f}});
            pen.path({{0.8f, 0.3f}, {-0.8f, 0.3f}, {-0.45f, 0.65f}});
            break;
        case Icon::Eye:
        case Icon::EyeOff:
            pen.arc(0, 0.55f, 1.0f, 0.59f, 0.91f);
            pen.arc(0, -0.55f, 1.0f, 0.09f, 0.41f);
            pen.dot(0, 0, 0.25f);
            if (icon == Icon::EyeOff) pen.path({{-0.7f, 0.7f}, {0.7f, -0.7f}});
            break;
        case Icon::Tag:
            pen.path({{-0.8f, -0.7f}, {0.1f, -0.7f}, {0.85f, 0.05f}, {0.1f, 0.8f}, {-0.8f, -0.1f}}, true);
            pen.dot(-0.4f, -0.35f, 0.14f);
            break;
        case Icon::Axes:
            pen.path({{-0.4f, -0.85f}, {-0.4f, 0.4f}, {0.85f, 0.4f}});
            pen.path({{-0.4f, 0.4f}, {-0.85f, 0.85f}});
            break;
        case Icon::Box:
            pen.path({{-0.8f, -0.3f}, {0.2f, -0.3f}, {0.2f, 0.75f}, {-0.8f, 0.75f}}, true);
            pen.path({{-0.8f, -0.3f}, {-0.3f, -0.75f}, {0.75f, -0.75f}, {0.75f, 0.3f}, {0.2f, 0.75f}});
            pen.path({{0.2f, -0.3f}, {0.75f, -0.75f}});
            break;
        default: draw_tool(pen, icon);
    }
}

void draw_action(const Pen& pen, Icon icon) {
    switch (icon) {
        case Icon::Undo:
            pen.arc(0.05f, 0.2f, 0.6f, 0.5f, 1.15f);
            pen.fill({{-0.95f, 0.1f}, {-0.15f, 0.1f}, {-0.55f, 0.6f}});
            break;
        case Icon::Redo:
            pen.arc(-0.05f, 0.2f, 0.6f, 0.35f, 1.0f);
            pen.fill({{0.95f, 0.1f}, {0.15f, 0.1f}, {0.55f, 0.6f}});
            break;
        case Icon::Trash:
            pen.path({{-0.75f, -0.5f}, {0.75f, -0.5f}});
            pen.path({{-0.25f, -0.5f}, {-0.25f, -0.8f}, {0.25f, -0.8f}, {0.25f, -0.5f}});
            pen.path({{-0.55f, -0.5f}, {-0.45f, 0.8f}, {0.45f, 0.8f}, {0.55f, -0.5f}});
            break;
        case Icon::Repeat:
            pen.arc(0, 0, 0.65f, 0.55f, 1.2f);
            pen.arc(0, 0, 0.65f, 0.3f, 0.42f);
            pen.fill({{-1.0f, -0.05f}, {-0.3f, -0.05f}, {-0.65f, 0.45f}});
            break;
        case Icon::Up: pen.path({{-0.55f, 0.25f}, {0, -0.35f}, {0.55f, 0.25f}}); break;
        case Icon::Down: pen.path({{-0.55f, -0.25f}, {0, 0.35f}, {0.55f, -0.25f}}); break;
        case Icon::Plus:
            pen.path({{-0.65f, 0}, {0.65f, 0}});
            pen.path({{0, -0.65f}, {0, 0.65f}});
            break;
        case Icon::Close:
            pen.path({{-0.5f, -0.5f}, {0.5f, 0.5f}});
            pen.path({{-0.5f, 0.5f}, {0.5f, -0.5f}});
            break;
        case Icon::Check: pen.path({{-0.6f, 0.05f}, {-0.15f, 0.5f}, {0.65f, -0.5f}}); break;
        case Icon::Pause:
            pen.fill({{-0.55f, -0.65f}, {-0.15f, -0.65f}, {-0.15f, 0.65f}, {-0.55f, 0.65f}});
            pen.fill({{0.15f, -0.65f}, {0.55f, -0.65f}, {0.55f, 0.65f}, {0.15f, 0.65f}});
            break;
        case Icon::Play: pen.fill({{-0.45f, -0.7f}, {0.7f, 0}, {-0.45f, 0.7f}}); break;
        case Icon::Stop:
            pen.fill({{-0.55f, -0.55f}, {0.55f, -0.55f}, {0.55f, 0.55f}, {-0.55f, 0.55f}});
            break;
        default: draw_view(pen, icon);
    }
}

}  // namespace

void draw_icon(ImDrawList* list, Icon icon, ImVec2 centre, float size, ImU32 colour) {
    const Pen pen(list, centre, size, colour);
    switch (icon) {
        case Icon::Lock:
        case Icon::Unlock:
            pen.fill({{-0.6f, -0.05f}, {0.6f, -0.05f}, {0.6f, 0.8f}, {-0.6f, 0.8f}});
            pen.arc(icon == Icon::Lock ? 0.0f : 0.35f, -0.1f, 0.4f, 0.5f, 1.0f);
            break;
        case Icon::Dice:
            pen.path({{-0.7f, -0.7f}, {0.7f, -0.7f}, {0.7f, 0.7f}, {-0.7f, 0.7f}}, true);
            for (const float way : {-0.35f, 0.0f, 0.35f}) pen.dot(way, way, 0.14f);
            break;
        case Icon::Folder:
            pen.path({{-0.85f, 0.65f},
                      {-0.85f, -0.6f},
                      {-0.3f, -0.6f},
                      {-0.1f, -0.35f},
                      {0.85f, -0.35f},
                      {0.85f, 0.65f}},
                     true);
            break;
        case Icon::File:
            pen.path({{-0.55f, -0.8f}, {0.2f, -0.8f}, {0.6f, -0.4f}, {0.6f, 0.8f}, {-0.55f, 0.8f}}, true);
            pen.path({{0.2f, -0.8f}, {0.2f, -0.4f}, {0.6f, -0.4f}});
            break;
        case Icon::Warning:
            pen.path({{0, -0.75f}, {0.85f, 0.7f}, {-0.85f, 0.7f}}, true);
            pen.path({{0, -0.25f}, {0, 0.25f}});
            pen.dot(0, 0.47f, 0.1f);
            break;
        default: draw_action(pen, icon);
    }
}

bool icon_button(Context& context, const IconButton& options) {
    const bool off = !options.why_off.empty();
    const float size = std::round(context.em * options.size_em);
    if (off) ImGui::BeginDisabled();
    const ImVec2 low = ImGui::GetCursorScreenPos();
    const std::string id = "##" + std::string(options.name);
    const bool pressed = ImGui::InvisibleButton(id.c_str(), {size, size});
    const bool hovered = ImGui::IsItemHovered();
    ImDrawList* list = ImGui::GetWindowDrawList();
    const ImVec2 high(low.x + size, low.y + size);
    const ImU32 back = options.active ? palette::AccentDeep : hovered ? palette::RaisedHover : 0;
    if (back != 0) list->AddRectFilled(low, high, ImGui::GetColorU32(back), context.em * 0.22f);
    const ImU32 colour = ImGui::GetColorU32(options.active ? palette::OnAccent : palette::Text);
    draw_icon(list, options.icon, {(low.x + high.x) * 0.5f, (low.y + high.y) * 0.5f},
              std::round(size * 0.56f), off ? with_alpha(palette::Text, 0.3f) : colour);
    note(context, options.name);
    if (off) ImGui::EndDisabled();
    tooltip(off ? options.why_off : options.tooltip);
    return pressed;
}

}  // namespace gse::ui
