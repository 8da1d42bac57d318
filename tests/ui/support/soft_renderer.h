// Draws what ImGui emits into an image on the processor, so that tests can look at the window without a
// device.
#pragma once

#include <imgui.h>

#include <functional>

#include "engine/base/image.h"

namespace gse::test {

/// The picture of a texture handle (as the panels pass it); null = white.
using TextureLookup = std::function<const Image*(ImTextureID)>;

/// [H,W,3] at the display's size. Triangles are filled without antialiasing beyond what ImGui puts into
/// vertex colours.
Image render_draw_data(const ImDrawData& data, const TextureLookup& textures);

/// The font atlas as [H,W,4].
Image font_picture(ImFontAtlas& atlas);

}  // namespace gse::test
