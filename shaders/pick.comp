// The splat that contributes most at one pixel of the picture whose lists are in memory.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"

layout(local_size_x = 1) in;
layout(constant_id = 0) const uint Mode = 0;
layout(constant_id = 1) const uint Tile = 8;
layout(push_constant) uniform Push { uint x, y; } push;
#include "splat.glsl"

void main() {
    const uint parts = frame.parts.y, tile = (push.y / Tile) * frame.size.z + push.x / Tile;
    const uint begin = tile == 0 ? 0 : min(matrix[tile * parts - 1], frame.counts.y);
    const uint end = min(matrix[tile * parts + parts - 1], frame.counts.y);
    float running = 1.0, most = 0.0;
    uint best = CulledKey;
    for (uint i = begin; i < end && running > TransmittanceCut; ++i) {
        const uint row = pairs[i];
        const vec4 a = records_a[row];
        const vec2 b = records_b[row].xy;
        const vec2 d = vec2(push.x, push.y) + 0.5 - a.xy;
        const float u = a.z * d.x + a.w * d.y, v = b.x * d.y;
        const float alpha =
            splat_alpha(b.y - u * u - v * v, b.y, splat_reach(b.y), splat_slope(a.z, a.w, b.x, u, v));
        const float weight = alpha * running;
        running -= weight;
        if (weight > most && running > TransmittanceCut) {
            most = weight;
            best = row;
        }
    }
    control[ControlPickedRow] = best;
    control[ControlPickedDepth] = best == CulledKey ? 0 : keys[best];
}
