// Light of a pixel -> the colour shown. engine/preview/resolve.cpp is the same in C++.

/// Dark blue, violet, orange, pale yellow: lightness grows with t.
vec3 map_colour(float t) {
    const vec3 stops[5] = vec3[5](vec3(0.05, 0.04, 0.20), vec3(0.36, 0.10, 0.48), vec3(0.78, 0.24, 0.36),
                                  vec3(0.97, 0.58, 0.20), vec3(0.98, 0.95, 0.62));
    const float place = clamp(t, 0.0, 1.0) * 4.0;
    const float stop = min(floor(place), 3.0);
    return mix(stops[int(stop)], stops[int(stop) + 1], place - stop);
}

/// Tint over a colour: the frame's, or its complement where the colour has the same hue.
vec3 tint_over(vec3 solid) {
    const vec3 tint = frame.tint.rgb;
    const vec3 hue = solid - vec3((solid.r + solid.g + solid.b) / 3.0);
    const vec3 own = tint - vec3((tint.r + tint.g + tint.b) / 3.0);
    const float chroma = length(hue);
    const float cosine = dot(hue, own) / max(chroma * length(own), 1e-6);
    const float alike = smoothstep(OtherHue, OwnHue, cosine) * smoothstep(LeastChroma, ClearChroma, chroma);
    return mix(tint, vec3(1.0) - tint, alike);
}

/// rgb with alpha, not premultiplied; alpha is 1 unless the background is transparent.
vec4 resolve(vec3 rgb, float alpha, float depth, float value, uint mode) {
    const vec3 background = frame.background.rgb;
    const bool transparent = frame.background.w > 0.5;
    const float inverse = alpha > 0.0 ? 1.0 / alpha : 0.0;
    const vec3 solid = rgb * inverse;  // colour of what covers the pixel, without the background
    const float share = clamp(value * inverse, 0.0, 1.0);
    vec3 shown = solid;
    float cover = alpha;
    if (mode == ModeDepth) {
        const float z = depth * inverse;
        const float scale = frame.optics.w;
        shown = map_colour(scale * scale / (scale * scale + z * z));
    } else if (mode == ModeOpacity) {
        shown = vec3(alpha);
        cover = 1.0;
    } else if (mode >= ModeLabelWeight) {
        const float grey = dot(solid, vec3(0.299, 0.587, 0.114)) * DimmedBeauty;
        shown = mix(vec3(grey), map_colour(share), MapCoverage * (0.25 + 0.75 * share));
    } else {
        shown = mix(solid, tint_over(solid), share * frame.tint.w);
    }
    if (transparent) return vec4(shown, cover);
    return vec4(shown * cover + background * (1.0 - cover), 1.0);
}
