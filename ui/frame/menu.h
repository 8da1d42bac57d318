// Menu bar, tool bar and job bar: the frame around the panels.
#pragma once

#include "ui/model/context.h"

namespace gse::ui {

void draw_menu_bar(Context& context);
void draw_tool_bar(Context& context);
void draw_job_bar(Context& context);
/// Help with all keys, about, and the question that waits for an answer.
void draw_dialogs(Context& context);
/// The fixed set of keys.
void handle_keys(Context& context);

}  // namespace gse::ui
