// Small controls of all panels: buttons that say why they are off, rows, badges, numbers in words.
#include "ui/widgets/controls.h"

#include <fmt/format.h>
#include <imgui_internal.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "ui/keys/keyboard.h"
#include "ui/model/glyphs.h"
#include "ui/widgets/tooltips.h"

namespace gse::ui {
namespace {

constexpr float TooltipDelay = 0.45f, TooltipForgets = 0.7f;  // seconds
constexpr float TooltipEm = 24;                               // widest line
constexpr float LabelShare = 0.42f;                           // of a row, for its label

void push_look(Look look) {
    const auto push = [](ImU32 normal, ImU32 hovered, ImU32 active) {
        ImGui::PushStyleColor(ImGuiCol_Button, normal);
        ImGui::PushStyleColor(ImGuiCol_ButtonHovered, hovered);
        ImGui::PushStyleColor(ImGuiCol_ButtonActive, active);
    };
    if (look == Look::Primary) push(palette::AccentDeep, IM_COL32(56, 112, 170, 255), palette::Accent);
    if (look == Look::Danger) push(IM_COL32(92, 45, 44, 255), IM_COL32(122, 54, 52, 255), palette::Bad);
    if (look == Look::Quiet) push(IM_COL32(0, 0, 0, 0), palette::Raised, palette::RaisedHover);
    if (look == Look::Normal) push(palette::Raised, palette::RaisedHover, palette::AccentDeep);
}

ImVec2 text_size(std::string_view text) {
    const Shown shown(text);
    return ImGui::CalcTextSize(shown.begin(), shown.end());
}

void put_text(std::string_view text) {
    const Shown shown(text);
    ImGui::TextUnformatted(shown.begin(), shown.end());
}

/// A field whose text may hold characters that ImGui has no room for.
bool edit_text(const char* id, const char* hint, std::string& text, ImGuiInputTextFlags flags) {
    const ForeignGlyphs* glyphs = foreign_glyphs();
    const Shown shown(text);
    if (shown.begin() == text.data() || glyphs == nullptr) {
        const bool changed = ImGui::InputTextWithHint(id, hint, &text, flags);
        if (glyphs != nullptr && ImGui::IsItemEdited()) text = glyphs->meant(text);
        return changed;
    }
    std::string edited(shown.text());
    const bool changed = ImGui::InputTextWithHint(id, hint, &edited, flags);
    if (edited != shown.text()) text = glyphs->meant(edited);
    return changed;
}

std::string identified(std::string_view text, std::string_view name) {
    return fmt::format("{}##{}", Shown(text).text(), name);
}

}  // namespace

void note_rect(Context& context, std::string_view name, ImVec2 low, ImVec2 high) {
    const ImGuiWindow& window = *ImGui::GetCurrentWindow();
    const ImVec2 middle((low.x + high.x) * 0.5f, (low.y + high.y) * 0.5f);
    // A dialog is measured before it is shown; it is not in its place yet.
    const bool visible = !window.Hidden && window.ClipRect.Contains(middle);
    Rect rect{low.x, low.y, high.x - low.x, high.y - low.y, visible, true, 0};
    const auto found = context.widgets.find(name);
    if (found != context.widgets.end()) {
        found->second = rect;
    } else {
        context.widgets.emplace(std::string(name), rect);
    }
}

void note(Context& context, std::string_view name, float text_width) {
    note_rect(context, name, ImGui::GetItemRectMin(), ImGui::GetItemRectMax());
    const auto noted = context.widgets.find(name);
    noted->second.text_width = text_width;
    noted->second.enabled = (ImGui::GetItemFlags() & ImGuiItemFlags_Disabled) == 0;
    note_stop(context, noted->first);
}

bool button(Context& context, const ButtonOptions& options) {
    const bool off = !options.why_off.empty();
    if (off) ImGui::BeginDisabled();
    push_look(options.look);
    const std::string label = identified(options.text, options.name);
    const float width = options.width < 0 ? ImGui::GetContentRegionAvail().x : options.width;
    const bool pressed = ImGui::Button(label.c_str(), {width, 0});
    ImGui::PopStyleColor(3);
    note(context, options.name, text_size(options.text).x);
    if (off) ImGui::EndDisabled();
    tooltip(off ? options.why_off : options.tooltip);
    return pressed;
}

float button_width(std::string_view text) { return text_size(text).x + ImGui::GetStyle().FramePadding.x * 2; }

void flow(float width, float row_width) {
    const float room = row_width > 0 ? ImGui::GetWindowContentRegionMin().x + row_width
                                     : ImGui::GetWindowContentRegionMax().x;
    const float right = ImGui::GetWindowPos().x + room;
    const float next = ImGui::GetItemRectMax().x + ImGui::GetStyle().ItemSpacing.x + width;
    if (next <= right) ImGui::SameLine();
}

void tooltip(std::string_view text) {
    if (text.empty() || !ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) return;
    const auto& io = ImGui::GetIO();
    if (ImGui::IsAnyMouseDown() || (ImGui::IsItemActive() && io.WantTextInput)) return;
    // Since when the mouse rests here is kept under the item's place; a pause in it starts anew.
    const ImVec2 place = ImGui::GetItemRectMin();
    ImGuiStorage* storage = ImGui::GetStateStorage();
    const ImGuiID since_id = ImHashData(&place, sizeof place, 1),
                  seen_id = ImHashData(&place, sizeof place, 2);
    const auto now = static_cast<float>(ImGui::GetTime());
    const bool rested = now - storage->GetFloat(seen_id, -10) < TooltipForgets;
    if (!rested) storage->SetFloat(since_id, now);
    storage->SetFloat(seen_id, now);
    if (now - storage->GetFloat(since_id, now) < TooltipDelay) return await_tooltip();
    const float width = ImGui::GetFontSize() * TooltipEm;
    const std::string lines = broken_at_spaces(text, width);
    const Shown shown(lines);
    begin_tooltip(ImGui::CalcTextSize(shown.begin(), shown.end(), false, width));
    ImGui::PushTextWrapPos(ImGui::GetCursorPosX() + width);
    put_text(lines);
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
}

void heading(Context& context, std::string_view text) {
    ImGui::Dummy({0, ImGui::GetStyle().ItemSpacing.y * 0.25f});
    if (context.fonts.bold != nullptr) ImGui::PushFont(context.fonts.bold);
    put_text(text);
    if (context.fonts.bold != nullptr) ImGui::PopFont();
}

namespace {

/// True for "1", "0.5", "(12": a digit at the end, and nothing else but digits and their marks.
bool is_number(std::string_view word) {
    return !word.empty() && std::isdigit(static_cast<unsigned char>(word.back())) != 0 &&
           word.find_first_not_of("0123456789.,+-~(") == std::string_view::npos;
}

/// True for what belongs to the number in front of it: its next three digits, or its unit.
bool belongs_to_number(std::string_view word) {
    constexpr std::array<std::string_view, 16> Units{"s",  "ms", "min", "h",  "%",  "B",  "kB",    "MB",
                                                     "GB", "TB", "px",  "mm", "cm", "km", "TFLOP", "degrees"};
    while (!word.empty() && std::string_view(".,;:)!?").find(word.back()) != std::string_view::npos)
        word.remove_suffix(1);
    const bool digits = word.size() == 3 && word.find_first_not_of("0123456789") == std::string_view::npos;
    return digits || std::find(Units.begin(), Units.end(), word) != Units.end();
}

/// End of the word at `at`, with what no line break may part from it.
std::size_t end_of_piece(std::string_view text, std::size_t at) {
    const auto end_of = [&](std::size_t from) {
        return std::min(text.find_first_of(" \n", from), text.size());
    };
    std::size_t end = end_of(at);
    while (end < text.size() && text[end] == ' ') {
        const std::size_t next = end_of(end + 1);
        if (!is_number(text.substr(at, end - at)) || !belongs_to_number(text.substr(end + 1, next - end - 1)))
            break;
        at = end + 1;
        end = next;
    }
    return end;
}

}  // namespace

std::string broken_at_spaces(std::string_view text, float width) {
    std::string lines;
    std::size_t begin = 0, at = 0;  // of the line, of the word
    while (at < text.size()) {
        const std::size_t end = end_of_piece(text, at);
        const bool breaks = at > begin && text_size(text.substr(begin, end - begin)).x > width;
        if (breaks) lines.back() = '\n', begin = at;
        lines += text.substr(at, end - at);
        if (end < text.size()) lines += text[end];
        at = end + 1;
        if (end < text.size() && text[end] == '\n') begin = at;
    }
    return lines;
}

void wrapped_text(std::string_view text) {
    ImGui::PushTextWrapPos(0);
    const float width = ImGui::GetContentRegionAvail().x;
    if (text_size(text).x <= width) put_text(text);
    else put_text(broken_at_spaces(text, width));  // ImGui breaks lines behind the point of a number, too
    ImGui::PopTextWrapPos();
}

void coloured_text(ImU32 colour, std::string_view text) {
    ImGui::PushStyleColor(ImGuiCol_Text, colour);
    wrapped_text(text);
    ImGui::PopStyleColor();
}

void dim_text(std::string_view text) { coloured_text(palette::TextDim, text); }

void badge(Context& context, std::string_view text, ImU32 colour) {
    const ImVec2 size = text_size(text);
    const float pad_x = context.em * 0.4f, pad_y = context.em * 0.1f;
    const ImVec2 low = ImGui::GetCursorScreenPos();
    const ImVec2 high(low.x + size.x + 2 * pad_x, low.y + size.y + 2 * pad_y);
    ImDrawList* list = ImGui::GetWindowDrawList();
    list->AddRectFilled(low, high, with_alpha(colour, 0.18f), context.em * 0.25f);
    const Shown shown(text);
    list->AddText({low.x + pad_x, low.y + pad_y}, colour, shown.begin(), shown.end());
    ImGui::Dummy({high.x - low.x, high.y - low.y});
}

void bullet_dot(ImU32 colour) {
    const float em = ImGui::GetFontSize();
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float base = ImGui::GetCurrentWindow()->DC.CurrLineTextBaseOffset;
    ImGui::GetWindowDrawList()->AddCircleFilled({at.x + em * 0.4f, at.y + base + em * 0.54f}, em * 0.24f,
                                                colour);
    ImGui::Dummy({em * 0.8f, em});
    ImGui::SameLine(0, em * 0.35f);
}

void property(Context& context, std::string_view label, std::string_view value) {
    const float start = ImGui::GetCursorPosX();
    const float width = ImGui::GetContentRegionAvail().x;
    ImGui::PushStyleColor(ImGuiCol_Text, palette::TextDim);
    put_text(label);
    ImGui::PopStyleColor();
    const float value_at = start + std::max(width * LabelShare, text_size(label).x + context.em * 0.6f);
    ImGui::SameLine(value_at);
    wrapped_text(value);
}

bool checkbox(Context& context, std::string_view name, std::string_view label, bool& value,
              std::string_view help) {
    const bool changed = ImGui::Checkbox(identified(label, name).c_str(), &value);
    note(context, name);
    tooltip(help);
    return changed;
}

namespace {

/// Padding with which all choices fit into one row. The usual one if they fit anyway, or would become too
/// narrow.
ImVec2 segment_padding(const Context& context, std::span<const char* const> choices) {
    const ImVec2 usual = ImGui::GetStyle().FramePadding;
    float room = ImGui::GetContentRegionAvail().x - static_cast<float>(choices.size());
    for (const char* text : choices) room -= ImGui::CalcTextSize(text).x;
    const float fitting = std::floor(room / (2 * static_cast<float>(choices.size())));
    return {fitting < context.em * 0.2f ? usual.x : std::min(usual.x, fitting), usual.y};
}

}  // namespace

bool segmented(Context& context, std::string_view name, std::span<const char* const> choices, int& chosen) {
    bool changed = false;
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, segment_padding(context, choices));
    const float left = ImGui::GetCursorScreenPos().x;  // also of a second row, where the first has no room
    ImGui::PushID(name.data(), name.data() + name.size());
    for (int index = 0; index < static_cast<int>(choices.size()); ++index) {
        const char* text = choices[static_cast<std::size_t>(index)];
        if (index > 0) {
            const float right = ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x;
            if (ImGui::GetItemRectMax().x + 1 + button_width(text) <= right) ImGui::SameLine(0, 1);
            else ImGui::SetCursorScreenPos({left, ImGui::GetCursorScreenPos().y});
        }
        push_look(index == chosen ? Look::Primary : Look::Normal);
        if (ImGui::Button(text) && index != chosen) {
            chosen = index;
            changed = true;
        }
        ImGui::PopStyleColor(3);
        note(context, fmt::format("{}.{}", name, text), text_size(text).x);
    }
    ImGui::PopStyleVar();
    ImGui::PopID();
    return changed;
}

bool combo(Context& context, std::string_view name, std::span<const char* const> choices, int& chosen,
           float width) {
    bool changed = false;
    ImGui::SetNextItemWidth(width > 0 ? width : ImGui::GetContentRegionAvail().x);
    const bool valid = chosen >= 0 && chosen < static_cast<int>(choices.size());
    const bool opened = ImGui::BeginCombo(identified("", name).c_str(),
                                          valid ? choices[static_cast<std::size_t>(chosen)] : "",
                                          ImGuiComboFlags_HeightLarge);
    note(context, name);
    if (!opened) return false;
    for (int index = 0; index < static_cast<int>(choices.size()); ++index) {
        if (ImGui::Selectable(choices[static_cast<std::size_t>(index)], index == chosen)) {
            changed = index != chosen;
            chosen = index;
        }
        note(context, fmt::format("{}.{}", name, choices[static_cast<std::size_t>(index)]));
    }
    ImGui::EndCombo();
    return changed;
}

bool text_input(Context& context, std::string_view name, std::string& text, std::string_view hint,
                ImGuiInputTextFlags flags) {
    ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x);
    const std::string hint_text(hint);
    ImGui::PushStyleColor(ImGuiCol_TextDisabled, palette::Hint);  // not to be taken for text that is there
    const bool changed = edit_text(identified("", name).c_str(), hint_text.c_str(), text, flags);
    ImGui::PopStyleColor();
    note(context, name);
    takes_letters(context);
    return changed;
}

bool folding(Context& context, std::string_view name, std::string_view text) {
    ImGui::PushStyleColor(ImGuiCol_Header, palette::Raised);
    ImGui::PushStyleColor(ImGuiCol_HeaderHovered, palette::RaisedHover);
    const bool open = ImGui::CollapsingHeader(fmt::format("{}###{}", text, name).c_str());
    ImGui::PopStyleColor(2);
    note(context, name);
    return open;
}

void row_label(Context& context, std::string_view label, std::string_view help) {
    const float start = ImGui::GetCursorPosX();
    const float width = ImGui::GetContentRegionAvail().x;
    ImGui::AlignTextToFramePadding();
    const std::string fitting = shortened(label, width * LabelShare - context.em * 0.4f);
    ImGui::PushStyleColor(ImGuiCol_Text, palette::TextDim);
    ImGui::TextUnformatted(fitting.c_str());
    ImGui::PopStyleColor();
    if (!help.empty()) tooltip(help);
    ImGui::SameLine(start + width * LabelShare);
    ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x);
}

void begin_notice(Context& context, std::string_view name, ImU32 colour) {
    ImGui::PushID(name.data(), name.data() + name.size());
    ImGui::GetWindowDrawList()->ChannelsSplit(2);
    ImGui::GetWindowDrawList()->ChannelsSetCurrent(1);
    ImGui::BeginGroup();
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, ImGui::GetStyle().ItemSpacing);
    ImGui::GetStateStorage()->SetInt(ImGui::GetID("colour"), static_cast<int>(colour));
    ImGui::Dummy({0, context.em * 0.1f});
    ImGui::Indent(context.em * 0.7f);
}

void end_notice() {
    const float em = ImGui::GetFontSize();
    ImGui::Unindent(em * 0.7f);
    ImGui::Dummy({0, em * 0.1f});
    ImGui::PopStyleVar();
    ImGui::EndGroup();
    const auto colour = static_cast<ImU32>(ImGui::GetStateStorage()->GetInt(ImGui::GetID("colour")));
    ImDrawList* list = ImGui::GetWindowDrawList();
    const ImVec2 low = ImGui::GetItemRectMin();
    const float right = ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x;
    const ImVec2 high(right, ImGui::GetItemRectMax().y);
    list->ChannelsSetCurrent(0);
    list->AddRectFilled(low, high, with_alpha(colour, 0.12f), em * 0.2f);
    list->AddRectFilled(low, {low.x + em * 0.2f, high.y}, colour, em * 0.1f);
    list->ChannelsMerge();
    ImGui::PopID();
    ImGui::Spacing();
}

std::string count_text(std::size_t count) {
    std::string digits = std::to_string(count);
    for (int at = static_cast<int>(digits.size()) - 3; at > 0; at -= 3)
        digits.insert(static_cast<std::size_t>(at), 1, ' ');
    return digits;
}

std::string duration_text(double seconds) {
    if (!(seconds >= 0)) return "unknown";
    if (seconds < 9.95) return fmt::format("{:.1f} s", seconds);
    const auto whole = static_cast<long>(std::lround(seconds));
    if (whole < 60) return fmt::format("{} s", whole);
    if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
    return fmt::format("{} h {:02} min", whole / 3600, whole % 3600 / 60);
}

std::string bytes_text(double bytes) {
    if (bytes < 1e3) return fmt::format("{:.0f} B", bytes);
    if (bytes < 1e6) return fmt::format("{:.0f} kB", bytes / 1e3);
    if (bytes < 1e9) return fmt::format("{:.0f} MB", bytes / 1e6);
    return fmt::format("{:.1f} GB", bytes / 1e9);
}

std::string tflop_text(double tflop) {
    return fmt::format("{:.{}f} TFLOP", tflop, tflop < 0.1 ? 3 : tflop < 1 ? 2 : tflop < 100 ? 1 : 0);
}

std::string percent_text(double share) { return fmt::format("{:.0f} %", share * 100); }

void plain_text(std::string_view text) { put_text(text); }

std::string shortened(std::string_view whole, float width_px) {
    const Shown shown(whole);
    const std::string_view text = shown.text();
    if (text_size(text).x <= width_px) return std::string(text);
    constexpr std::string_view Dots = "...";
    // Cut at code points: a byte of the form 10xxxxxx continues one.
    const auto continues = [&text](std::size_t at) { return at < text.size() && (text[at] & 0xC0) == 0x80; };
    std::size_t kept = text.size();
    while (kept > 4) {
        kept -= std::max<std::size_t>(1, kept / 16);
        std::size_t head = kept / 3, tail = text.size() - (kept - kept / 3);
        while (head > 0 && continues(head)) --head;
        while (continues(tail)) ++tail;
        std::string result = fmt::format("{}{}{}", text.substr(0, head), Dots, text.substr(tail));
        if (text_size(result).x <= width_px) return result;
    }
    return std::string(Dots);
}

}  // namespace gse::ui
