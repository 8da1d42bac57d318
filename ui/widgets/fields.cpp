// Rows of controls generated from a parameter struct's list of fields.
#include "ui/widgets/fields.h"

#include <fmt/format.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cmath>

#include "ui/keys/keyboard.h"
#include "ui/widgets/controls.h"

namespace gse::ui {
namespace {

constexpr double SliderSpan = 4.0;  // ranges up to this wide get a slider, wider ones a number to drag

std::string identity(const FieldRow& row) { return fmt::format("##{}.{}", row.prefix, row.name); }

template <class T> std::string default_text(const FieldRow& row, const T& standard) {
    const char* whose = row.stated ? "Default of the model" : "Default";
    if constexpr (std::is_same_v<T, bool>)
        return fmt::format("{}\n{}: {}.", row.help, whose, standard ? "on" : "off");
    if constexpr (std::is_same_v<T, std::string>)
        return standard.empty() ? std::string(row.help)
                                : fmt::format("{}\n{}: {}.", row.help, whose, standard);
    if constexpr (std::is_same_v<T, Overridable>)
        return fmt::format("{}\n{}: {}, or what suits the edit. Right click: back to it.", row.help, whose,
                           static_cast<double>(standard));
    else return fmt::format("{}\n{}: {}. Right click: back to it.", row.help, whose, standard);
}

template <class T> std::string help_text(const FieldRow& row, const T& standard) {
    const std::string text = default_text(row, standard);
    return row.unused.empty() ? text : fmt::format("{}\n{}", row.unused, text);
}

/// Label of a row, and the reset by right click on the last control.
template <class T> bool finish(Context& context, const FieldRow& row, T& value, const T& standard) {
    note(context, fmt::format("{}.{}", row.prefix, row.name));
    tooltip(help_text(row, standard));
    if (!(value != standard) || !ImGui::IsItemClicked(ImGuiMouseButton_Right)) return false;
    value = standard;
    return true;
}

template <class T> void label_of(Context& context, const FieldRow& row, const T& value, const T& standard) {
    const bool changed = value != standard;
    const std::string label = fmt::format("{}{}", changed ? "* " : "", field_label(row.name));
    row_label(context, row.unused.empty() ? label : fmt::format("({})", label), help_text(row, standard));
}

const char* number_format(double size) {
    if (size != 0 && size < 1e-3) return "%.2e";
    return size < 1 ? "%.4g" : "%.6g";
}

/// The control alone: a slider or a number to drag.
template <class T> bool real_control(const FieldRow& row, T& value, const T& standard) {
    const T before = value;
    constexpr ImGuiDataType Type = std::is_same_v<T, float> ? ImGuiDataType_Float : ImGuiDataType_Double;
    const T low = row.range ? static_cast<T>(row.range->low) : static_cast<T>(0);
    const T high = row.range ? static_cast<T>(row.range->high) : static_cast<T>(0);
    const char* format = number_format(std::abs(static_cast<double>(value)));
    bool changed = false;
    // A slider can only show what its length resolves: defaults far below it are dragged.
    const bool slider = row.range && row.range->high - row.range->low <= SliderSpan &&
                        (standard == T{} ||
                         std::abs(static_cast<double>(standard)) > 0.02 * (row.range->high - row.range->low));
    if (slider) {
        changed = ImGui::SliderScalar(identity(row).c_str(), Type, &value, &low, &high, "%.3f");
    } else {
        const double size =
            std::max(std::abs(static_cast<double>(value)), std::abs(static_cast<double>(standard)));
        const auto speed = static_cast<float>(size > 0 ? size * 0.01 : 0.01);
        changed = ImGui::DragScalar(identity(row).c_str(), Type, &value, speed, row.range ? &low : nullptr,
                                    row.range ? &high : nullptr, format, ImGuiSliderFlags_AlwaysClamp);
    }
    if (!std::isfinite(value)) value = before;  // "1e999" was typed
    if (changed && row.range) value = std::clamp(value, low, high);
    return changed;
}

template <class T> bool real_row(Context& context, const FieldRow& row, T& value, const T& standard) {
    label_of(context, row, value, standard);
    const bool changed = real_control(row, value, standard);
    return finish(context, row, value, standard) || changed;
}

}  // namespace

std::string field_label(const char* name) {
    // Names that are known to files and commands, but say nothing to artists.
    for (const auto& [from, to] : {std::pair{"gate", "Show the model's idea first"},
                                   std::pair{"gate_guidance", "Change inside the mask only"}})
        if (std::string_view(name) == from) return to;
    std::string label(name);
    std::replace(label.begin(), label.end(), '_', ' ');
    for (const auto& [from, to] : {std::pair{" px", " (px)"}, std::pair{"sh degree", "SH degree"},
                                   std::pair{"show hud", "show HUD"}}) {
        const auto at = label.find(from);
        if (at != std::string::npos && at + std::string_view(from).size() == label.size())
            label.replace(at, std::string::npos, to);
    }
    for (const auto& [from, to] : {std::pair{"dbscan", "DBSCAN"}, std::pair{"ssim", "SSIM"}})
        if (label.starts_with(from)) label.replace(0, std::string_view(from).size(), to);
    if (!label.empty()) label[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(label[0])));
    return label;
}

bool field_row(Context& context, const FieldRow& row, bool& value, bool standard) {
    label_of(context, row, value, standard);
    const bool changed = ImGui::Checkbox(identity(row).c_str(), &value);
    return finish(context, row, value, standard) || changed;
}

bool field_row(Context& context, const FieldRow& row, int& value, int standard) {
    label_of(context, row, value, standard);
    const int low = row.range ? static_cast<int>(row.range->low) : 0;
    const int high = row.range ? static_cast<int>(row.range->high) : 0;
    bool changed = false;
    if (row.range && high - low <= 16) {
        changed =
            ImGui::SliderInt(identity(row).c_str(), &value, low, high, "%d", ImGuiSliderFlags_AlwaysClamp);
    } else {
        const float speed = std::max(0.2f, static_cast<float>(std::abs(value)) * 0.005f);
        changed = ImGui::DragInt(identity(row).c_str(), &value, speed, low, high, "%d",
                                 row.range ? ImGuiSliderFlags_AlwaysClamp : ImGuiSliderFlags_None);
    }
    return finish(context, row, value, standard) || changed;
}

bool field_row(Context& context, const FieldRow& row, std::uint64_t& value, std::uint64_t standard) {
    label_of(context, row, value, standard);
    const bool changed = ImGui::InputScalar(identity(row).c_str(), ImGuiDataType_U64, &value);
    return finish(context, row, value, standard) || changed;
}

bool field_row(Context& context, const FieldRow& row, float& value, float standard) {
    return real_row(context, row, value, standard);
}

bool field_row(Context& context, const FieldRow& row, double& value, double standard) {
    return real_row(context, row, value, standard);
}

bool field_row(Context& context, const FieldRow& row, Overridable& value, const Overridable& standard) {
    label_of(context, row, value, standard);
    double number = value;
    const bool changed = real_control<double>(row, number, standard);
    if (changed) value = number;
    return finish(context, row, value, standard) || changed;
}

bool field_row(Context& context, const FieldRow& row, std::string& value, const std::string& standard) {
    label_of(context, row, value, standard);
    const bool changed = ImGui::InputText(identity(row).c_str(), &value);
    const bool reset = finish(context, row, value, standard);
    takes_letters(context);
    return reset || changed;
}

}  // namespace gse::ui
