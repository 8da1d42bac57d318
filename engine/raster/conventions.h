// Numbers of the image formation that every version of the rasterizer shares.
#pragma once

namespace gse::raster {

inline constexpr double AlphaLimit = 0.99;       // alpha is clamped here; no gradient through the clamp
inline constexpr double AlphaCut = 1.0 / 255.0;  // fainter pairs are not blended
// The pair that would bring T to this or below ends the pixel.
inline constexpr double TransmittanceCut = 1e-4;
inline constexpr double DeterminantCut = 1e-12;  // px^4; flatter projected covariances are not drawn
inline constexpr double FrustumMargin = 0.3;     // of half the field of view, for the Jacobian's clamp (EWA)
inline constexpr double SmallestNear = 1e-6;     // world units; what a given near plane is at least
inline constexpr double LogScaleLimit = 30.0;    // larger log-scales count as this and get no gradient
inline constexpr double QuaternionCut = 1e-24;   // |q|^2 below this: identity rotation, no gradient
inline constexpr double PositionLimit = 1e18;    // world units; farther rows are dropped like infinite ones

}  // namespace gse::raster
