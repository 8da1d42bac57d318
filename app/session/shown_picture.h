// The viewport's picture by the own rasterizer: for the window, screenshots, and the colour of a pixel.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "app/engine_names.h"
#include "app/session/preview_host.h"
#include "engine/pipeline/scene/scene_tools.h"
#include "engine/preview/resolve.h"

namespace gse::app {

struct NativePicture {
    std::vector<std::uint8_t> rgba;  // [height,width,4]
    int width = 0, height = 0;
    Camera camera;  // at the size of the request, not of the picture
    Image depth;    // [height,width,1] alpha-normalised, 0 = nothing
    double milliseconds = 0;
    bool full = false;  // at the size asked for
};

/// Settings of the request in the preview's terms. Throws nothing: a colour that cannot be read is black.
preview::Display display_of(const PictureRequest& request);

/// One picture on the calling thread. Keeps its scratch between calls.
class NativePainter {
public:
    explicit NativePainter(unsigned threads = 0) : painter_(threads) {}
    /// At width x height; comparisons are put together from the columns of both sides.
    void paint(const PictureRequest& request, int width, int height, NativePicture& picture);
    std::string name() { return painter_.rasterizer().name(); }

private:
    void paint_part(const PictureRequest& request, bool original, const Camera& camera, int first_column,
                    NativePicture& picture);
    Painter painter_;
    Image values_;
    std::vector<std::uint8_t> part_;
};

/// The picture of a request at its camera's size: [H,W,3] in [0,1], or [H,W,4] with straight alpha where it
/// is transparent.
Image shown_picture(const PictureRequest& request);

/// Colour that the request's picture has at a pixel of its camera, in [0,1], without tints and maps.
std::array<float, 3> seen_colour(PictureRequest request, int x, int y);

}  // namespace gse::app
