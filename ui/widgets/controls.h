// Small controls of all panels: buttons that say why they are off, rows, badges, numbers in words.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "ui/model/context.h"

namespace gse::ui {

enum class Look { Normal, Primary, Danger, Quiet };

/// A button. `why_off` not empty = disabled, and the tooltip says it.
struct ButtonOptions {
    std::string_view name;  // for the widget map, and the ImGui identity
    std::string_view text;
    std::string_view why_off = {};
    std::string_view tooltip = {};
    Look look = Look::Normal;
    float width = 0;  // pixels; 0 = as the text needs, negative = all there is
};

bool button(Context& context, const ButtonOptions& options);

/// Keeps the next item on this line when `width` pixels are left of it, else starts a new one. `row_width` is
/// the width of a whole line in pixels, for windows that fit their contents. 0 = that of the window.
void flow(float width, float row_width = 0);
/// Width a button with this text takes.
float button_width(std::string_view text);

/// Tooltip of the last item, also when it is disabled; wrapped. Empty text shows nothing.
void tooltip(std::string_view text);

void heading(Context& context, std::string_view text);
void dim_text(std::string_view text);  // wrapped, grey
void wrapped_text(std::string_view text);
/// The text with a line break for the space before every word that would reach beyond `width` pixels. A
/// number stays whole, and with its unit.
std::string broken_at_spaces(std::string_view text, float width);
void plain_text(std::string_view text);                   // as ImGui::TextUnformatted
void coloured_text(ImU32 colour, std::string_view text);  // wrapped
void badge(Context& context, std::string_view text, ImU32 colour);
void bullet_dot(ImU32 colour);  // a status dot before a line, then stays on the line

/// "name    value" with the values of all rows below each other.
void property(Context& context, std::string_view label, std::string_view value);

bool checkbox(Context& context, std::string_view name, std::string_view label, bool& value,
              std::string_view help = {});

/// One of a few, as joined buttons. Wraps when the line is too short. True when another one was chosen.
bool segmented(Context& context, std::string_view name, std::span<const char* const> choices, int& chosen);

/// A list to drop down; `width` pixels, 0 = all there is.
bool combo(Context& context, std::string_view name, std::span<const char* const> choices, int& chosen,
           float width = 0);

/// One line of text. True while it changes.
bool text_input(Context& context, std::string_view name, std::string& text, std::string_view hint = {},
                ImGuiInputTextFlags flags = 0);

/// Group that folds. True while it is open.
bool folding(Context& context, std::string_view name, std::string_view text);

/// Label on the left of a row; the control takes the rest. Call it before the control.
void row_label(Context& context, std::string_view label, std::string_view help = {});

/// Box with a coloured edge and wrapped text, for news that wait for an answer.
void begin_notice(Context& context, std::string_view name, ImU32 colour);
void end_notice();

// Numbers in words
std::string count_text(std::size_t count);                     // "1 234 567"
std::string duration_text(double seconds);                     // "7 min 05 s"
std::string bytes_text(double bytes);                          // "1.7 GB"
std::string tflop_text(double tflop);                          // "0.17 TFLOP", "240 TFLOP"
std::string percent_text(double share);                        // "43 %"
std::string shortened(std::string_view text, float width_px);  // middle replaced by ... to fit

}  // namespace gse::ui
