// Tiles of 16x16 pixels, front to back; 64 invocations a tile, 4 pixels of a row each, splats fetched
// together into shared memory. Works with any subgroup size.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"

#define PIXELS 4
layout(local_size_x = 64) in;
#include "blend_head.glsl"

shared vec4 shared_a[64], shared_b[64], shared_colour[64];
shared uint any_alive;

void main() {
    const uint lane = gl_LocalInvocationID.x;
    const uvec2 corner = gl_WorkGroupID.xy * 16 + uvec2(lane % 4 * 4, lane / 4);
    const vec2 first = vec2(corner) + 0.5;
    start_light(corner);
    const uvec2 range = pairs_of(gl_WorkGroupID.y * frame.size.z + gl_WorkGroupID.x);
    for (uint at = range.x; at < range.y; at += 64) {
        if (lane == 0) any_alive = 0;
        if (at + lane < range.y) {
            const int row = int(texelFetch(fetch_pairs, int(at + lane)).x);
            const vec4 b = texelFetch(fetch_b, row);
            shared_a[lane] = texelFetch(fetch_a, row);
            const float depth = WithDepth != 0 ? uintBitsToFloat(texelFetch(fetch_keys, row).x) : 0.0;
            shared_b[lane] = vec4(b.xy, depth, 0.0);
            shared_colour[lane] =
                vec4(unpackHalf2x16(floatBitsToUint(b.z)), unpackHalf2x16(floatBitsToUint(b.w)));
        }
        barrier();
        const uint count = min(range.y - at, 64);
        for (uint j = 0; j < count; ++j)
            blend_splat(shared_a[j], shared_b[j].xy, shared_colour[j], shared_b[j].z, first);
        if (alive()) atomicOr(any_alive, 1);
        barrier();
        const bool done = any_alive == 0;
        barrier();
        if (done) break;
    }
    store_light(corner);
}
