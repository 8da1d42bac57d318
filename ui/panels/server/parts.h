// Parts of the Models panel about the image server.
#pragma once

#include "ui/model/context.h"

namespace gse::ui {

/// Settings of what an image server draws, folded, once it was asked what it is: numbers, LoRAs, options,
/// files.
void draw_drawing_settings(Context& context);

}  // namespace gse::ui
