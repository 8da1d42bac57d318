// A bar between two areas that is dragged to change their sizes.
#pragma once

#include <string_view>

#include "ui/model/context.h"

namespace gse::ui {

/// Draws and handles the bar in this rectangle; returns the drag of this frame in pixels (across the bar).
float splitter(Context& context, std::string_view name, ImVec2 low, ImVec2 high);

}  // namespace gse::ui
