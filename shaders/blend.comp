// Tiles of 8x8 pixels, front to back; one subgroup of 8 invocations a tile, a row of 8 pixels each. The
// subgroup fetches 8 splats at a time and hands them round, because loads are what costs on software devices.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_KHR_shader_subgroup_vote : require
#extension GL_KHR_shader_subgroup_ballot : require
#include "frame.glsl"

#define PIXELS 8
layout(local_size_x = 8) in;
#include "blend_head.glsl"

void main() {
    const uint lane = gl_SubgroupInvocationID;
    const uvec2 corner = gl_WorkGroupID.xy * 8 + uvec2(0, lane);
    const vec2 first = vec2(corner) + 0.5;
    start_light(corner);
    const uvec2 range = pairs_of(gl_WorkGroupID.y * frame.size.z + gl_WorkGroupID.x);
    for (uint at = range.x; at < range.y; at += 8) {
        const uint row = texelFetch(fetch_pairs, int(min(at + lane, range.y - 1))).x;
        const vec4 a = texelFetch(fetch_a, int(row));
        vec4 b = texelFetch(fetch_b, int(row));
        const vec4 colour = vec4(unpackHalf2x16(floatBitsToUint(b.z)), unpackHalf2x16(floatBitsToUint(b.w)));
        const float z = WithDepth != 0 ? uintBitsToFloat(texelFetch(fetch_keys, int(row)).x) : 0.0;
        if (at + lane >= range.y) b.y = -1e9;  // nothing
        [[unroll]] for (uint j = 0; j < 8; ++j)
            blend_splat(subgroupBroadcast(a, j), subgroupBroadcast(b.xy, j), subgroupBroadcast(colour, j),
                        WithDepth != 0 ? subgroupBroadcast(z, j) : 0.0, first);
        if (!subgroupAny(alive())) break;
    }
    store_light(corner);
}
