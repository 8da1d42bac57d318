// The sums of PIXELS neighbouring pixels of a row, held by one invocation. Needs Mode and the With...
// constants.

float running[PIXELS], covered[PIXELS], depth[PIXELS], value[PIXELS];
float red[PIXELS], green[PIXELS], blue[PIXELS];

void start_light(uvec2 corner) {
    for (int k = 0; k < PIXELS; ++k) {
        running[k] = corner.y < frame.size.y && corner.x + k < frame.size.x ? 1.0 : 0.0;
        covered[k] = red[k] = green[k] = blue[k] = depth[k] = value[k] = 0.0;
    }
}

/// a, b: the record; colour.w is the value; first: centre of the first pixel.
void blend_splat(vec4 a, vec2 b, vec4 colour, float z, vec2 first) {
    const float dy = first.y - a.y;
    const float v = b.x * dy, base = b.y - v * v;
    const float u0 = a.w * dy + a.z * (first.x - a.x);
    const float own_reach = splat_reach(b.y);
    for (int k = 0; k < PIXELS; ++k) {
        const float u = u0 + a.z * float(k);
        const float power = base - u * u;
        const float alpha = splat_alpha(power, b.y, own_reach, splat_slope(a.z, a.w, b.x, u, v));
        // `running` goes on shrinking behind the cut; it is monotone, so a finished pixel stays finished.
        const float light = alpha * running[k];
        running[k] -= light;
        float weight = running[k] > TransmittanceCut ? light : 0.0;
        covered[k] += weight;
        if (WithDepth != 0) depth[k] += weight * z;
        if (WithValue != 0) value[k] += weight * colour.w;
        weight *= splat_shade(power, b.y, own_reach);
        red[k] += weight * colour.x;
        green[k] += weight * colour.y;
        blue[k] += weight * colour.z;
    }
}

bool alive() {
    float most = running[0];
    for (int k = 1; k < PIXELS; ++k) most = max(most, running[k]);
    return most > TransmittanceCut;
}

void store_light(uvec2 corner) {
    for (int k = 0; k < PIXELS; ++k) {
        if (corner.y >= frame.size.y || corner.x + k >= frame.size.x) continue;
        const uint pixel = corner.y * frame.size.x + corner.x + k;
        const vec3 rgb = vec3(red[k], green[k], blue[k]);
        const vec4 shown = resolve(rgb, covered[k], depth[k], value[k], Mode,
                                   uvec2(corner.x + k, corner.y));
        imageStore(picture, ivec2(corner.x + k, corner.y), shown);
        if (StoreDepth != 0) depths[pixel] = covered[k] > LeastSolid ? depth[k] / covered[k] : 0.0;
        if (StoreLight != 0) {
            light[pixel * 6] = rgb.x;
            light[pixel * 6 + 1] = rgb.y;
            light[pixel * 6 + 2] = rgb.z;
            light[pixel * 6 + 3] = covered[k];
            light[pixel * 6 + 4] = depth[k];
            light[pixel * 6 + 5] = value[k];
        }
    }
}

/// The pairs of a tile: [x, y).
uvec2 pairs_of(uint tile) {
    const uint parts = frame.parts.y;
    const uint begin = tile == 0 ? 0 : matrix[tile * parts - 1];
    return min(uvec2(begin, matrix[tile * parts + parts - 1]), uvec2(frame.counts.y));
}
