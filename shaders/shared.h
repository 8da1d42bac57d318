// Shared by shaders and C++: numbers of the image formation and of the passes, and the data of a frame.
#ifndef GSE_SHADERS_SHARED_H
#define GSE_SHADERS_SHARED_H

#ifdef __cplusplus
#include <cstdint>
namespace gse::shaders {
#define GSE_CONSTANT(type, name, value) inline constexpr type name = value
using uint = std::uint32_t;
struct alignas(16) vec4 {
    float x, y, z, w;
};
struct alignas(16) uvec4 {
    uint x, y, z, w;
};
#else
#define GSE_CONSTANT(type, name, value) const type name = value
#endif

// Image formation (the same numbers as engine/raster/conventions.h).
GSE_CONSTANT(float, AlphaLimit, 0.99f);
GSE_CONSTANT(float, AlphaCut, 1.0f / 255.0f);
GSE_CONSTANT(float, Log2Of255, 7.99435343685885793770f);  // log2 alpha below minus this is too faint
GSE_CONSTANT(float, TransmittanceCut, 1e-4f);
GSE_CONSTANT(float, DeterminantCut, 1e-12f);  // px^4
GSE_CONSTANT(float, Log2E, 1.44269504088896340736f);
GSE_CONSTANT(float, FootprintLimit,
             1e7f);  // px; longer axes are as good as endless, and float could overflow
GSE_CONSTANT(uint, CulledKey, 0xFFFFFFFFu);

// Scene arrays: texels of 4 floats, and of 4 halfs for the spherical harmonics.
GSE_CONSTANT(uint, GeometryTexels, 3u);  // position, opacity | unit quaternion w x y z | scale, unused

// Passes.
GSE_CONSTANT(uint, ScanBlock, 128u);  // entries one invocation sums up
GSE_CONSTANT(uint, ScanSpine, 256u);  // invocations of the single group in the middle of a scan
GSE_CONSTANT(uint, ProjectGroup, 64u);

// Places in the control buffer.
GSE_CONSTANT(uint, ControlVisible, 0u);
GSE_CONSTANT(uint, ControlPairs, 1u);
GSE_CONSTANT(uint, ControlPickedRow, 2u);
GSE_CONSTANT(uint, ControlPickedDepth, 3u);
GSE_CONSTANT(uint, ControlUnfinished, 4u);  // splats that no round got to
GSE_CONSTANT(uint, ControlWords, 8u);

// How splats are shown; the order is that of the menu.
GSE_CONSTANT(uint, ModeBeauty, 0u);
GSE_CONSTANT(uint, ModeCentres, 1u);
GSE_CONSTANT(uint, ModeRings, 2u);
GSE_CONSTANT(uint, ModeEllipsoids, 3u);
GSE_CONSTANT(uint, ModeDepth, 4u);
GSE_CONSTANT(uint, ModeOpacity, 5u);
GSE_CONSTANT(uint, ModeLabels, 6u);
GSE_CONSTANT(uint, ModeLabelWeight, 7u);
GSE_CONSTANT(uint, ModeAttention, 8u);
GSE_CONSTANT(uint, ModeChanged, 9u);

// Look of the modes.
GSE_CONSTANT(float, RingReach, 2.8853900817779268f);  // u^2 + v^2 at two standard deviations, log2 units
GSE_CONSTANT(float, RingWidthPx, 1.3f);
GSE_CONSTANT(float, RingAlpha, 0.85f);
GSE_CONSTANT(float, RingFill, 0.12f);  // of the splat's own alpha inside its ring
GSE_CONSTANT(float, CentreAlpha, 0.9f);
GSE_CONSTANT(float, EllipsoidShade, 0.55f);  // how much darker the rim is than the middle
GSE_CONSTANT(float, DimmedBeauty, 0.35f);    // brightness of the picture under a colour map
GSE_CONSTANT(float, LeastSolid, 0.3f);       // alpha of a pixel to have a depth that can be picked
GSE_CONSTANT(float, MapCoverage, 0.85f);     // how much of the map shows where the value is 1
// A surface of the tint's own hue (red under orange) is hatched in the complementary colour.
GSE_CONSTANT(uint, HatchPeriod, 10u);     // px, of the hatching's diagonal lines
GSE_CONSTANT(uint, HatchWidth, 4u);       // px
GSE_CONSTANT(float, OtherHue, 0.75f);     // cosine between the hues, up to which they are told apart,
GSE_CONSTANT(float, OwnHue, 0.9f);        // and from which they are not
GSE_CONSTANT(float, LeastChroma, 0.15f);  // distance from grey, up to which a colour has no hue,
GSE_CONSTANT(float, ClearChroma, 0.35f);  // and from which it has

struct FrameData {
    vec4 rotation[3];  // rows, world -> camera; w: eye, rounded to float
    vec4 eye_rest;     // what the rounding of the eye lost; w: near plane
    vec4 lens;         // fx fy cx cy, pixels
    vec4 ratio;        // limits of x/z (low, high) and y/z in the Jacobian
    vec4 optics;       // blur px^2, far plane, centre radius px, depth in the middle of the colour scale
    vec4 background;   // rgb; w: 1 = transparent
    vec4 tint;         // rgb, strength
    uvec4 size;        // width, height, tile columns, tile rows
    uvec4 counts;      // rows, pair capacity, antialiased, mode
    uvec4 parts;       // of the sort, of the binning, digit bits of the sort, unused
};

#ifdef __cplusplus
}  // namespace gse::shaders
#endif
#endif
