// One pass of the stable radix sort by depth. Every invocation owns a stretch of the list and walks it alone,
// so the order within it is kept whatever the size of subgroups. COUNT: digits of each stretch; else: items
// to their places.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"

layout(local_size_x_id = 0) in;
layout(constant_id = 1) const uint Pass = 0;  // 0 reads the keys by row and leaves out what is culled
layout(constant_id = 2) const uint Bits = 11;

uvec2 item_at(uint i) {
    if (Pass == 0) return uvec2(texelFetch(fetch_keys, int(i)).x, i);
    if ((Pass & 1) == 1) return texelFetch(fetch_x, int(i)).xy;
    return texelFetch(fetch_y, int(i)).xy;
}

void main() {
    const uint part = gl_GlobalInvocationID.x, parts = frame.parts.x;
    if (part >= parts) return;
    const uint count = Pass == 0 ? frame.counts.x : control[ControlVisible];
    const uint share = (count + parts - 1) / parts;
    const uint begin = min(part * share, count), end = min(begin + share, count);
    for (uint i = begin; i < end; ++i) {
        const uvec2 item = item_at(i);
        if (Pass == 0 && item.x == CulledKey) continue;
        const uint digit = (item.x >> (Pass * Bits)) & ((1u << Bits) - 1u);
        const uint place = digit * parts + part;
#ifdef COUNT
        matrix[place] += 1;
#else
        const uint target = matrix[place];
        matrix[place] = target + 1;
        if ((Pass & 1) == 0)
            sorted_x[target] = item;
        else
            sorted_y[target] = item;
#endif
    }
}
