// Rows of one chunk of the scene -> records and sort keys: EWA projection, culling, colour.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"

layout(local_size_x = 64) in;
layout(constant_id = 0) const uint StoredCoefficients = 16;  // per channel, in memory
layout(constant_id = 1) const uint UsedCoefficients = 16;
layout(constant_id = 2) const uint Mode = 0;

layout(set = 1, binding = 0) uniform samplerBuffer geometry;
layout(set = 1, binding = 1) uniform samplerBuffer harmonics;
layout(set = 1, binding = 2) uniform samplerBuffer values;
layout(push_constant) uniform Push { uint first_row, row_count, has_values; } push;

// Largest reach of a Gaussian, at full opacity, in standard deviations squared.
const float LargestReach = 2.0 * (Log2Of255 * (1.0 + 1e-4) + 1e-4) / Log2E;
const float BallMargin = 1.01;                                               // far more than rounding

void fill_basis(vec3 d, out float b[16]) {
    const float x = d.x, y = d.y, z = d.z, xx = x * x, yy = y * y, zz = z * z;
    b[0] = 0.28209479177387814;
    b[1] = -0.4886025119029199 * y;
    b[2] = 0.4886025119029199 * z;
    b[3] = -0.4886025119029199 * x;
    b[4] = 1.0925484305920792 * x * y;
    b[5] = -1.0925484305920792 * y * z;
    b[6] = 0.31539156525252005 * (2.0 * zz - xx - yy);
    b[7] = -1.0925484305920792 * x * z;
    b[8] = 0.5462742152960396 * (xx - yy);
    b[9] = -0.5900435899266435 * y * (3.0 * xx - yy);
    b[10] = 2.890611442640554 * x * y * z;
    b[11] = -0.4570457994644658 * y * (4.0 * zz - xx - yy);
    b[12] = 0.3731763325901154 * z * (2.0 * zz - 3.0 * (xx + yy));
    b[13] = -0.4570457994644658 * x * (4.0 * zz - xx - yy);
    b[14] = 1.445305721320277 * z * (xx - yy);
    b[15] = -0.5900435899266435 * x * (xx - 3.0 * yy);
}

/// Coefficients lie one after the other, three channels each, four halfs a texel.
vec3 colour_of(int row, vec3 direction) {
    float basis[16];
    fill_basis(direction, basis);
    const int stored_texels = int((StoredCoefficients * 3 + 3) / 4);
    const int used_texels = int((UsedCoefficients * 3 + 3) / 4);
    float sum[3] = float[3](0.5, 0.5, 0.5);
    for (int texel = 0; texel < used_texels; ++texel) {
        const vec4 four = texelFetch(harmonics, row * stored_texels + texel);
        for (int i = 0; i < 4; ++i) {
            const int element = texel * 4 + i;
            if (element < int(UsedCoefficients) * 3) sum[element % 3] += basis[element / 3] * four[i];
        }
    }
    return vec3(sum[0], sum[1], sum[2]);
}

/// row of J W R diag(scale), no longer than the limit.
vec3 footprint(float focal_over_z, float ratio, vec3 row, mat3 axes, vec3 scale) {
    const vec3 v = focal_over_z * (row - ratio * frame.rotation[2].xyz);
    const vec3 f = (v * axes) * scale;
    const float size = length(f);
    return size > FootprintLimit ? f * (FootprintLimit / size) : f;
}

mat3 axes_of(vec4 q) {  // columns of the rotation matrix; q = w x y z
    const float w = q.x, x = q.y, y = q.z, z = q.w;
    return mat3(1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y),
                2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x),
                2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y));
}

void main() {
    if (gl_GlobalInvocationID.x >= push.row_count) return;
    const int local = int(gl_GlobalInvocationID.x), texel = local * int(GeometryTexels);
    const uint row = push.first_row + gl_GlobalInvocationID.x;
    const vec4 placed = texelFetch(geometry, texel);
    // Rounded eye first: the difference of two near numbers is exact, so far worlds keep their detail.
    precise vec3 offset = placed.xyz - vec3(frame.rotation[0].w, frame.rotation[1].w, frame.rotation[2].w);
    offset -= frame.eye_rest.xyz;
    const vec3 p = vec3(dot(frame.rotation[0].xyz, offset), dot(frame.rotation[1].xyz, offset),
                        dot(frame.rotation[2].xyz, offset));
    float opacity = placed.w;
    bool drawn = p.z > frame.eye_rest.w && p.z < frame.optics.y && opacity >= AlphaCut;
    keys[row] = CulledKey;
    if (!drawn) return;

    const vec3 scale = texelFetch(geometry, texel + 2).xyz;
    const float inverse_z = 1.0 / p.z;
    const vec2 ratio = clamp(p.xy * inverse_z, frame.ratio.xz, frame.ratio.yw);
    const vec2 centre = frame.lens.xy * p.xy * inverse_z + frame.lens.zw;
    const vec2 size = vec2(frame.size.xy);
    // Beside the picture whatever its direction and opacity: no axis of the footprint is longer than that of
    // a ball of the largest scale. What is not a number stays.
    const vec2 ball = frame.lens.xy * (inverse_z * max(scale.x, max(scale.y, scale.z)));
    const vec2 variance = ball * ball * (1.0 + ratio * ratio) + frame.optics.x;
    const vec2 bound = max(BallMargin * sqrt(LargestReach * variance), frame.optics.z);
    if (any(lessThan(centre + bound, vec2(0.0))) || any(greaterThan(centre - bound, size))) return;

    const mat3 axes = axes_of(texelFetch(geometry, texel + 1));
    const vec3 a = footprint(frame.lens.x * inverse_z, ratio.x, frame.rotation[0].xyz, axes, scale);
    const vec3 b = footprint(frame.lens.y * inverse_z, ratio.y, frame.rotation[1].xyz, axes, scale);
    const float blur = frame.optics.x;
    const float raw_xx = dot(a, a), xy = dot(a, b), raw_yy = dot(b, b);
    const vec3 area = cross(a, b);
    const float raw_determinant = dot(area, area);
    const float determinant = raw_determinant + blur * (raw_xx + raw_yy) + blur * blur;
    const float xx = raw_xx + blur, yy = raw_yy + blur;
    if (frame.counts.z != 0) opacity *= sqrt(raw_determinant / determinant);
    drawn = determinant > DeterminantCut && opacity >= AlphaCut;
    float log2_opacity = min(log2(opacity), 0.0);
    float l1 = sqrt(0.5 * Log2E * yy / determinant), l2 = -l1 * xy / yy, l3 = sqrt(0.5 * Log2E / yy);
    const float reach = (log2_opacity + Log2Of255) * (1.0 + 1e-4) + 1e-4;
    vec2 extent = sqrt(max(reach / (0.5 * Log2E) * vec2(xx, yy), 0.0));
    if (Mode == ModeCentres) {
        log2_opacity = 0.0;
        l1 = l3 = sqrt(Log2Of255) / frame.optics.z;
        l2 = 0.0;
        extent = vec2(frame.optics.z);
    }
    drawn = drawn && all(greaterThanEqual(centre + extent, vec2(0.0))) &&
            all(lessThanEqual(centre - extent, size));
    if (!drawn) return;

    vec3 colour = colour_of(local, normalize(offset));
    if (any(isnan(colour))) return;  // how the upload marks rows whose coefficients are not finite
    colour = max(colour, 0.0);
    const float value = push.has_values != 0 ? texelFetch(values, local).x : 0.0;
    keys[row] = floatBitsToUint(p.z);
    records_a[row] = vec4(centre, l1, l2);
    records_b[row] = vec4(l3, log2_opacity, uintBitsToFloat(packHalf2x16(min(colour.rg, 65504.0))),
                          uintBitsToFloat(packHalf2x16(vec2(min(colour.b, 65504.0), value))));
}
