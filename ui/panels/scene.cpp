// Scene: the open file, its statistics, oddities and remedies, and the up direction.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ui/commands/guarded.h"
#include "ui/panels/panels.h"
#include "ui/state/state.h"
#include "ui/widgets/controls.h"

namespace gse::ui {
namespace {

constexpr std::array<const char*, 6> UpNames{"y", "-y", "z", "-z", "x", "-x"};

std::string vector_text(const Vec3& v) { return fmt::format("{:.3g}, {:.3g}, {:.3g}", v.x, v.y, v.z); }

std::string up_text(const Vec3& up) {
    for (int axis = 0; axis < 3; ++axis)
        if (std::abs(std::abs(up[axis]) - length(up)) < 1e-6)
            return fmt::format("{}{}", up[axis] < 0 ? "-" : "", "xyz"[axis]);
    return vector_text(up);
}

/// One finding: a count in words; nothing when the count is zero.
bool finding(ImU32 colour, std::size_t count, const char* what) {
    if (count == 0) return false;
    bullet_dot(colour);
    wrapped_text(fmt::format("{} {}", count_text(count), what));
    return true;
}

void draw_findings(Context& context) {
    const auto& statistics = context.model.statistics;
    heading(context, "Findings");
    bool any = false, broken = false;
    broken |= finding(palette::Bad, statistics.nan_rows,
                      "splats hold values that are not numbers; they are not drawn");
    broken |=
        finding(palette::Bad, statistics.infinite_rows, "splats hold infinite values; they are not drawn");
    any |= finding(palette::Warning, statistics.zero_quaternion_rows,
                   "splats have no rotation; they are drawn unrotated");
    any |= finding(palette::Warning, statistics.giant_rows, "splats are larger than the scene");
    any |= finding(palette::TextDim, statistics.invisible_rows, "splats are too faint to be seen");
    any |= finding(palette::TextDim, statistics.haze_rows,
                   "splats are haze far around the scene; pictures frame it without them");
    any |= finding(palette::TextDim, statistics.sky_rows,
                   "splats are sky around the scene; pictures frame it without them");
    for (const auto& warning : context.document().info.warnings) {
        bullet_dot(palette::Warning);
        wrapped_text(warning);
        any = true;
    }
    if (broken &&
        button(context,
               {.name = "scene.repair", .text = "Drop what cannot be drawn", .tooltip = "Can be undone"}))
        context.emit(command::RepairScene{});
    if (!any && !broken) {
        bullet_dot(palette::Good);
        wrapped_text("Nothing odd was found.");
    }
}

void draw_up(Context& context) {
    heading(context, "Up axis");
    const auto& info = context.document().info;
    property(context, "Up is", up_text(info.up));
    if (!info.up_known)
        coloured_text(palette::Warning,
                      info.up_unsure
                          ? "Neither the file nor the scene says it surely. Choose:"
                          : "The file does not say; this is a guess. If the scene lies on its side, choose:");
    const auto at = std::find(UpNames.begin(), UpNames.end(), up_text(info.up));
    int chosen = info.up_known && at != UpNames.end() ? static_cast<int>(at - UpNames.begin())
                                                      : -1;  // a guess can be confirmed
    if (segmented(context, "scene.up", UpNames, chosen))
        context.emit(command::SetUpAxis{UpNames[static_cast<std::size_t>(chosen)]});
}

void draw_layers(Context& context) {
    const auto& state = context.document();
    heading(context, "Layers");
    property(context, "Original", fmt::format("{} splats", count_text(state.base.size())));
    for (const auto& edit : state.stack) {
        bool enabled = edit.enabled;
        ImGui::PushID(static_cast<int>(edit.id));
        if (checkbox(context, fmt::format("scene.layer.{}", edit.id),
                     shortened(edit.name, ImGui::GetContentRegionAvail().x - context.em * 2), enabled))
            context.emit(command::SetEditEnabled{edit.id, enabled});
        ImGui::PopID();
    }
    property(context, "Shown", fmt::format("{} splats", count_text(state.current.size())));
}

}  // namespace

void draw_scene_panel(Context& context) {
    if (!context.scene_open()) {
        dim_text("Nothing is open.");
        if (button(context, {.name = "scene.open", .text = "Open...", .look = Look::Primary}))
            ask_open(context);
        return;
    }
    const auto& state = context.document();
    const auto& statistics = context.model.statistics;
    const auto path = path_of(context.model.scene_path);
    property(context, "File", context.model.scene_path.empty() ? "not saved" : utf8_of(path.filename()));
    tooltip(context.model.scene_path);
    property(context, "Format", state.info.format);
    property(context, "Splats", count_text(statistics.count));
    property(context, "SH degree", std::to_string(state.current.sh_degree()));
    property(context, "In memory", bytes_text(static_cast<double>(state.current.byte_size())));
    property(context, "Mean opacity", percent_text(statistics.mean_opacity));
    const Vec3 size = statistics.robust_high - statistics.robust_low;
    property(context, "Size", fmt::format("{:.3g} x {:.3g} x {:.3g}", size.x, size.y, size.z));
    tooltip("Box of what is visible, without the outermost 2 % on each side");
    property(context, "Views", views_text(context));
    if (state.info.antialiased) property(context, "Trained", "with opacity compensation");
    draw_findings(context);
    draw_up(context);
    draw_layers(context);
}

}  // namespace gse::ui
