// Splats in depth order -> lists of the tiles their ellipses touch, exactly: per band of a tile's height the
// ellipse's largest extent in x, on pixel centres. Every invocation owns a stretch of the depth order, so
// lists stay in order. COUNT: pairs per tile and stretch; else: rows to their places. LIMITED: for llvmpipe,
// which silently leaves every loop of an invocation once 65,535 turns have been made in all; what is left is
// done in further rounds.
#version 450
#extension GL_GOOGLE_include_directive : require
#ifdef LIMITED
#extension GL_KHR_shader_subgroup_arithmetic : require
#endif
#include "frame.glsl"

layout(local_size_x_id = 0) in;
layout(constant_id = 1) const uint Tile = 8;      // pixels a side
layout(constant_id = 2) const uint SortedInX = 1;
layout(constant_id = 3) const uint Mode = 0;

layout(push_constant) uniform Push { uint round, rounds; } push;

const uint Budget = 32000;  // turns of all loops; one splat takes at most a quarter of the tiles more
const float Margin = 0.01;  // pixels, so that rounding can never drop a pair

void emit(uint tile, uint part, uint row) {
    const uint place = tile * frame.parts.y + part;
#ifdef COUNT
    matrix[place] += 1;
#else
    const uint target = matrix[place];
    matrix[place] = target + 1;
    if (target < frame.counts.y) pairs[target] = row;
#endif
}

void main() {
    const uint part = gl_GlobalInvocationID.x, parts = frame.parts.y;
    if (part >= parts) return;
    const uint count = control[ControlVisible];
    const uint share = (count + parts - 1) / parts;
    uint begin = min(part * share, count);
    const uint end = min(begin + share, count);
#ifdef LIMITED
    uint spent = 0;
    if (push.round > 0) begin = blocks[part];
#endif
    const int columns = int(frame.size.z), rows = int(frame.size.w);
    const float tile_size = float(Tile);
    for (uint i = begin; i < end; ++i) {
#ifdef LIMITED
        if (spent > Budget) {
            blocks[part] = i;
            if (push.round + 1 == push.rounds) atomicAdd(control[ControlUnfinished], end - i);
            return;
        }
        ++spent;
#endif
        const uint row = SortedInX != 0 ? texelFetch(fetch_x, int(i)).y : texelFetch(fetch_y, int(i)).y;
        const vec4 a = texelFetch(fetch_a, int(row));
        const vec2 b = texelFetch(fetch_b, int(row)).xy;
        float reach = (b.y + Log2Of255) * (1.0 + 1e-4) + 1e-4;
        if (Mode == ModeRings || Mode == ModeEllipsoids) reach = min(reach, RingReach * (1.0 + 1e-4));
        const float inverse_l1 = 1.0 / a.z, slope = -a.w * inverse_l1, skew = a.w / b.x;
        const float half_height = sqrt(reach) / b.x + Margin;
        const float lean = -skew * sqrt(reach / (1.0 + skew * skew)) / b.x;  // dy of the rightmost point
        const float pixel_rows = float(frame.size.y) - 1.0;
        const int last_band = int(clamp(a.y + half_height - 0.5, -1.0, pixel_rows) + 1.0) - 1;
        int band = int(clamp(a.y - half_height - 0.5, 0.0, pixel_rows + 1.0)) / int(Tile) - 1;
        const int end_band = last_band < 0 ? -1 : last_band / int(Tile);
        int column = 1, last_column = 0;
        uint turns = 1;
        for (;; ++turns) {
            if (column > last_column) {
                if (++band > end_band) break;
                const float low = float(band) * tile_size + 0.5 - a.y;
                const float from = max(low, -half_height), to = min(low + tile_size - 1.0, half_height);
                // The right edge is a concave function of dy with its top at `lean`; the left edge is its
                // mirror image.
                const float right = min(max(lean, from), to), left = min(max(-lean, from), to);
                const float right_v = right * b.x, left_v = left * b.x;
                const float x_right =
                    a.x + right * slope + sqrt(max(reach - right_v * right_v, 0.0)) * inverse_l1 + Margin;
                const float half_left = sqrt(max(reach - left_v * left_v, 0.0)) * inverse_l1;
                const float x_left = a.x + left * slope - half_left - Margin;
                column = int(clamp(ceil((x_left - tile_size + 0.5) / tile_size), 0.0, float(columns)));
                last_column = int(clamp(floor((x_right - 0.5) / tile_size), -1.0, float(columns - 1)));
                if (from > to) last_column = -1;
            }
            const uint first_tile = uint(band * columns + column);
            for (int k = 0; k < 4; ++k)
                if (column + k <= last_column) emit(first_tile + k, part, row);
            column += 4;
        }
#ifdef LIMITED
        spent += subgroupMax(turns);
#endif
    }
#ifdef LIMITED
    blocks[part] = end;
#endif
}
