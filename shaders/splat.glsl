// alpha of a splat at a pixel, for every way of showing it. power = log2 alpha, before the limits.

/// 2^p for p in [-8, 0], relative error 3e-7; shorter than the general function on software devices. Other p:
/// anything.
float power_of_two(float p) {
    const float n = roundEven(p), f = p - n;
    float sum = 0.0013333558;
    sum = sum * f + 0.0096181291;
    sum = sum * f + 0.0555041087;
    sum = sum * f + 0.2402265070;
    sum = sum * f + 0.6931471806;
    sum = sum * f + 1.0;
    return uintBitsToFloat(floatBitsToUint(sum) + (int(n) << 23));
}

float splat_alpha(float power, float log2_opacity, float own_reach, float slope) {
    if (Mode == ModeCentres) return power >= -Log2Of255 ? CentreAlpha : 0.0;
    if (Mode == ModeRings || Mode == ModeEllipsoids) {
        const float distance = log2_opacity - power;  // u^2 + v^2
        if (distance > own_reach) return 0.0;
        if (Mode == ModeEllipsoids) return AlphaLimit;
        const bool rim = sqrt(own_reach) - sqrt(distance) <= RingWidthPx * slope;
        return rim ? RingAlpha : RingFill * min(exp2(power), AlphaLimit);
    }
    return power >= -Log2Of255 ? min(power_of_two(power), AlphaLimit) : 0.0;
}

/// Change of sqrt(u^2 + v^2) per pixel, for rings of one width everywhere.
float splat_slope(float l1, float l2, float l3, float u, float v) {
    if (Mode != ModeRings) return 0.0;
    return length(vec2(l1 * u, l2 * u + l3 * v)) * inversesqrt(max(u * u + v * v, 1e-12));
}

/// How bright the splat's colour is there: ellipsoids have a dark rim.
float splat_shade(float power, float log2_opacity, float own_reach) {
    if (Mode != ModeEllipsoids) return 1.0;
    const float distance = (log2_opacity - power) / own_reach;
    return 1.0 - EllipsoidShade * distance * distance;
}

float splat_reach(float log2_opacity) { return min(log2_opacity + Log2Of255, RingReach); }
