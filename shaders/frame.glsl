// Bindings that all passes over a frame share.
#include "shared.h"

layout(set = 0, binding = 0) uniform Frame { FrameData frame; };
layout(set = 0, binding = 1) buffer RecordsA { vec4 records_a[]; };  // x, y, l1, l2
// l3, log2 opacity, half red green, half blue value
layout(set = 0, binding = 2) buffer RecordsB { vec4 records_b[]; };
layout(set = 0, binding = 3) buffer Keys { uint keys[]; };           // bits of the depth by row
layout(set = 0, binding = 4) buffer SortedX { uvec2 sorted_x[]; };   // key, row
layout(set = 0, binding = 5) buffer SortedY { uvec2 sorted_y[]; };
layout(set = 0, binding = 6) buffer Matrix { uint matrix[]; };       // counts, then places
layout(set = 0, binding = 7) buffer Blocks { uint blocks[]; };       // sums of a scan
layout(set = 0, binding = 8) buffer Control { uint control[]; };
layout(set = 0, binding = 9) buffer Pairs { uint pairs[]; };         // rows, tile after tile, front to back
layout(set = 0, binding = 10) buffer Depths { float depths[]; };     // normalised depth by pixel
// red, green, blue, alpha, depth, value by pixel
layout(set = 0, binding = 11) buffer Light { float light[]; };
layout(set = 0, binding = 12, rgba8) uniform writeonly image2D picture;
// The same memory once more: texel fetches cost a fraction of storage-buffer loads on software devices.
layout(set = 0, binding = 13) uniform samplerBuffer fetch_a;
layout(set = 0, binding = 14) uniform samplerBuffer fetch_b;
layout(set = 0, binding = 15) uniform usamplerBuffer fetch_keys;
layout(set = 0, binding = 16) uniform usamplerBuffer fetch_x;
layout(set = 0, binding = 17) uniform usamplerBuffer fetch_y;
layout(set = 0, binding = 18) uniform usamplerBuffer fetch_matrix;
layout(set = 0, binding = 19) uniform usamplerBuffer fetch_pairs;
