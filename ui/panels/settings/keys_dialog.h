// All keys in a window in the middle, where those of commands are chosen.
#pragma once

#include "ui/model/context.h"

namespace gse::ui {

/// Centres the next window, at most that large. A width of 0 = as large as its contents.
void centre_next(ImVec2 size);

/// While UiState::help_open.
void draw_keys_dialog(Context& context);

/// A row to choose a convention with; `name` is its place in the widget map.
void draw_key_preset(Context& context, const char* name);

}  // namespace gse::ui
