// Exclusive prefix sum of the matrix in three steps. STEP 0: sums of blocks; 1: prefix of those, by one
// group; 2: back into the matrix.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"

#if STEP == 1
layout(local_size_x = 256) in;
shared uint partial[256];
#else
layout(local_size_x_id = 0) in;
#endif
layout(push_constant) uniform Push { uint entries, total_place; } push;

void main() {
    const uint id = gl_GlobalInvocationID.x;
    const uint block_count = (push.entries + ScanBlock - 1) / ScanBlock;
#if STEP == 1
    const uint share = (block_count + ScanSpine - 1) / ScanSpine;
    const uint begin = min(id * share, block_count), end = min(begin + share, block_count);
    uint sum = 0;
    for (uint i = begin; i < end; ++i) sum += blocks[i];
    partial[id] = sum;
    barrier();
    for (uint step = 1; step < ScanSpine; step *= 2) {
        const uint other = id >= step ? partial[id - step] : 0;
        barrier();
        partial[id] += other;
        barrier();
    }
    uint running = partial[id] - sum;
    for (uint i = begin; i < end; ++i) {
        const uint one = blocks[i];
        blocks[i] = running;
        running += one;
    }
    if (id == ScanSpine - 1) control[push.total_place] = partial[id];
#else
    if (id >= block_count) return;
    const uint begin = id * ScanBlock, end = min(begin + ScanBlock, push.entries);
#if STEP == 0
    uint sum = 0;
    for (uint i = begin; i < end; ++i) sum += texelFetch(fetch_matrix, int(i)).x;
    blocks[id] = sum;
#else
    uint running = blocks[id];
    for (uint i = begin; i < end; ++i) {
        const uint one = texelFetch(fetch_matrix, int(i)).x;
        matrix[i] = running;
        running += one;
    }
#endif
#endif
}
