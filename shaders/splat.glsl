// alpha of a splat at a pixel, for every way of showing it. power = log2 alpha, before the limits.

float splat_alpha(float power, float log2_opacity, float own_reach) {
    if (Mode == ModeCentres) return power >= -Log2Of255 ? CentreAlpha : 0.0;
    if (Mode == ModeRings || Mode == ModeEllipsoids) {
        const float distance = log2_opacity - power;  // u^2 + v^2
        if (Mode == ModeEllipsoids) return distance <= own_reach ? AlphaLimit : 0.0;
        const float fill = RingFill * min(exp2(power), AlphaLimit);
        return distance > own_reach ? 0.0 : distance >= RingInner * own_reach ? RingAlpha : fill;
    }
    return power >= -Log2Of255 ? min(exp2(power), AlphaLimit) : 0.0;
}

/// How bright the splat's colour is there: ellipsoids have a dark rim.
float splat_shade(float power, float log2_opacity, float own_reach) {
    if (Mode != ModeEllipsoids) return 1.0;
    const float distance = (log2_opacity - power) / own_reach;
    return 1.0 - EllipsoidShade * distance * distance;
}

float splat_reach(float log2_opacity) { return min(log2_opacity + Log2Of255, RingReach); }
