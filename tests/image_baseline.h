// Pictures of the window and of the preview held against pictures in tests/baselines, so that a change of
// looks is seen when it is made. GSE_WRITE_BASELINES=1 writes them anew: look at them before you commit them.
#pragma once

#include <string>

#include "engine/base/image.h"

namespace gse::test {

/// Difference that a baseline allows. Both pictures are first averaged over squares of `square` pixels.
struct BaselineTolerance {
    int square = 1;
    float level = 0;   // largest difference of a square's mean in a channel, 0..1
    double share = 0;  // of squares that may differ by more
};

/// Window pictures: a font of another version moves edges of letters by a pixel, which a square of 16 pixels
/// turns into less than `level`. A line of text that went or a button that moved by its height is above both.
constexpr BaselineTolerance WindowTolerance{16, 0.06f, 0.01};
/// Preview pictures: a driver rounds exp2 and halfs by one step of 8 bits, and a splat on a pixel's edge by
/// more.
constexpr BaselineTolerance PreviewTolerance{2, 4.0f / 255, 0.005};

/// Mean over squares of `square` pixels, [ceil(H/square), ceil(W/square), C]; the last ones may be smaller.
Image squares_of(const Image& picture, int square);

/// Share of squares whose means differ by more than the tolerance's level. 1 where sizes differ.
double changed_share(const Image& found, const Image& wanted, const BaselineTolerance& tolerance);

/// Checks `picture` against tests/baselines/NAME.png, which holds its means over `kept` by `kept` pixels. A
/// picture that differs is written to the build folder, baselines/NAME.png, beside nothing else.
void check_baseline(const std::string& name, const Image& picture, const BaselineTolerance& tolerance,
                    int kept);

}  // namespace gse::test
