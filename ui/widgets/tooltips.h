// Places of tooltips: beside what they explain, and over no control.
#pragma once

#include <imgui.h>

#include <memory>
#include <span>
#include <string_view>

#include "ui/model/context.h"

namespace gse::ui {

/// Upper left corner of a tooltip of that size: the nearest place to the item at which it covers none of the
/// controls. All in pixels of the screen. Where there is no such place, below the item.
ImVec2 tooltip_place(ImVec2 size, const Rect& item, std::span<const Rect> controls, ImVec2 screen);

/// Keeps the controls of the frame that was drawn last, for the tooltips of the next one. Call it before the
/// stops and the widget map are cleared.
void keep_controls(Context& context);

/// The mouse rests where a tooltip will come up: frames are to be drawn until then.
void await_tooltip();
bool awaits_tooltip();

/// Begins a tooltip of the last item in a free place. `contents`: its size in pixels, without padding.
void begin_tooltip(ImVec2 contents);

/// Tooltip of the last item: its picture, large enough to judge, with a line of text below.
void large_picture(Context& context, const std::shared_ptr<const Image>& picture, std::string_view text);

}  // namespace gse::ui
