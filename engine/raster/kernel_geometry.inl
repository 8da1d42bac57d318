// Kernel part 1: the geometry and colours of W Gaussians from their raw parameters. Scale and opacity are in
// float lanes, as exact as the parameters. Everything from there up to the projected covariance is in double
// lanes. Spherical harmonics are in float lanes. Included inside the namespace of an instruction set.

constexpr double Ln2 = 0.69314718055994530942;
constexpr double Log2E = 1.44269504088896340736;
constexpr double Log2Of255 = 7.99435343685885793770;

#ifndef GSE_SCALAR_MATH
/// exp for |a| < 85: 2^n times a minimax polynomial on [-ln 2 / 2, ln 2 / 2] (Cephes, expf). Relative error
/// 9e-8.
GSE_INLINE F exp_lanes(F a) {
    const F n = floor(fma(a, set(static_cast<float>(Log2E)), set(0.5f)));
    const F x = fnma(n, set(-2.12194440e-4f), fnma(n, set(0.693359375f), a));
    F p = set(1.9875691500e-4f);
    p = fma(p, x, set(1.3981999507e-3f));
    p = fma(p, x, set(8.3334519073e-3f));
    p = fma(p, x, set(4.1665795894e-2f));
    p = fma(p, x, set(1.6666665459e-1f));
    p = fma(p, x, set(5.0000001201e-1f));
    return scale_by_power(fma(p, x * x, x) + set(1.0f), n);
}

/// log2 of a positive normal number: exponent plus the atanh series of the mantissa. Absolute error 4e-7 on
/// [1/255, 1].
GSE_INLINE F log2_lanes(F a) {
    F exponent = exponent_of(a), mantissa = mantissa_of(a);
    const M high = mantissa > set(1.41421356f);
    exponent = exponent + only(high, set(1.0f));
    mantissa = mantissa * select(high, set(0.5f), set(1.0f));
    const F t = (mantissa - set(1.0f)) / (mantissa + set(1.0f)), tt = t * t;
    F p = set(1.0f / 9);
    p = fma(p, tt, set(1.0f / 7));
    p = fma(p, tt, set(1.0f / 5));
    p = fma(p, tt, set(1.0f / 3));
    p = fma(p, tt, set(1.0f));
    return fma(p * t, set(static_cast<float>(2 * Log2E)), exponent);
}
#endif

/// Asks for the cache lines of `count` floats, to be written if Write is 1.
template <int Write> GSE_INLINE void prefetch_floats(const float* from, int count) {
    for (int k = 0; k < count; k += 16) __builtin_prefetch(from + k, Write);
    __builtin_prefetch(from + count - 1, Write);
}

/// Raw parameters of F::W rows, component-major.
struct alignas(64) RawBatch {
    float position[3][F::W], log_scale[3][F::W], rotation[4][F::W], opacity_logit[F::W];
    std::uint32_t row[F::W];
    int size;
};

GSE_INLINE void load_row(const Source& source, std::size_t row, int lane, RawBatch& batch) {
    for (int k = 0; k < 3; ++k)
        batch.position[k][lane] = source.position[row * 3 + static_cast<std::size_t>(k)];
    for (int k = 0; k < 3; ++k)
        batch.log_scale[k][lane] = source.log_scale[row * 3 + static_cast<std::size_t>(k)];
    for (int k = 0; k < 4; ++k)
        batch.rotation[k][lane] = source.rotation[row * 4 + static_cast<std::size_t>(k)];
    batch.opacity_logit[lane] = source.opacity_logit[row];
    batch.row[lane] = static_cast<std::uint32_t>(row);
}

/// Repeats the last row in the unused lanes.
GSE_INLINE void fill_batch(const Source& source, RawBatch& batch) {
    for (int lane = batch.size; lane < F::W; ++lane) load_row(source, batch.row[batch.size - 1], lane, batch);
}

struct Vec3D {
    D x, y, z;
};

GSE_INLINE D dot3(const Vec3D& a, const Vec3D& b) { return fma(a.z, b.z, fma(a.y, b.y, a.x * b.x)); }

/// The chain from raw parameters to the blurred covariance (in words: plain_projection.cpp).
struct Geometry {
    Vec3D offset;  // position - eye, world
    D x, y, z;     // camera frame
    D inverse_z;
    D ratio_x, ratio_y;
    MD inside_x, inside_y;
    D q[4], inverse_norm;  // unit quaternion; inverse_norm is 0 where the identity was used
    Vec3D rotation[3];     // rows
    D scale[3];
    Vec3D to_pixels[2];
    Vec3D footprint[2];
    D raw_xx, xy, raw_yy, xx, yy, raw_determinant, determinant;
};

GSE_INLINE F absolute(F a) { return max(a, zero() - a); }

/// Lanes whose numbers have a meaning. Log-scale -inf and logit +-inf do.
GSE_INLINE M usable_lanes(const RawBatch& raw) {
    const F largest = set(3.40282346638528859812e38f), farthest = set(static_cast<float>(PositionLimit));
    M good = absolute(load(raw.position[0])) <= farthest;
    for (int k = 1; k < 3; ++k) good = good & (absolute(load(raw.position[k])) <= farthest);
    for (int k = 0; k < 3; ++k) good = good & (load(raw.log_scale[k]) <= largest);
    for (int k = 0; k < 4; ++k) good = good & (absolute(load(raw.rotation[k])) <= largest);
    const F logit = load(raw.opacity_logit);
    return good & (logit <= logit);
}

/// Scale and opacity of a batch, as exact as the parameters.
struct alignas(64) Shape {
    float scale[3][F::W];
    float opacity[F::W];       // sigmoid only
    float transparency[F::W];  // 1 - opacity
};

GSE_INLINE void compute_shape(const RawBatch& raw, Shape& shape) {
    for (int k = 0; k < 3; ++k)  // e^-80 is nothing
        store(
            shape.scale[k],
            exp_lanes(max(min(load(raw.log_scale[k]), set(static_cast<float>(LogScaleLimit))), set(-80.0f))));
    const F logit = min(max(load(raw.opacity_logit), set(-80.0f)), set(80.0f));
    const F rest = exp_lanes(zero() - logit), opacity = set(1.0f) / (set(1.0f) + rest);
    store(shape.opacity, opacity);
    store(shape.transparency, rest * opacity);
}

GSE_INLINE void place(const RawBatch& raw, int at, const Viewpoint& view, Geometry& g) {
    const D px = widen(raw.position[0] + at), py = widen(raw.position[1] + at),
            pz = widen(raw.position[2] + at);
    const double* r = view.rotation;
    // Not fused and in the order of Mat3 * Vec3 + Vec3: the sort key must equal the plain version's bit for
    // bit.
    g.x = setd(r[0]) * px + setd(r[1]) * py + setd(r[2]) * pz + setd(view.translation[0]);
    g.y = setd(r[3]) * px + setd(r[4]) * py + setd(r[5]) * pz + setd(view.translation[1]);
    g.z = setd(r[6]) * px + setd(r[7]) * py + setd(r[8]) * pz + setd(view.translation[2]);
    g.offset = {px - setd(view.eye[0]), py - setd(view.eye[1]), pz - setd(view.eye[2])};
    g.inverse_z = setd(1.0) / g.z;
}

/// Rotation in double: at the ends of a needle, a float's rounding of the angle is some of its width.
GSE_INLINE void orient(const RawBatch& raw, const Shape& shape, int at, Geometry& g) {
    for (int k = 0; k < 4; ++k) g.q[k] = widen(raw.rotation[k] + at);
    const D squared = fma(g.q[3], g.q[3], fma(g.q[2], g.q[2], fma(g.q[1], g.q[1], g.q[0] * g.q[0])));
    const MD proper = squared >= setd(QuaternionCut);
    g.inverse_norm = select(proper, setd(1.0) / sqrt(squared), setd(0.0));
    g.q[0] = select(proper, g.q[0] * g.inverse_norm, setd(1.0));
    for (int k = 1; k < 4; ++k) g.q[k] = g.q[k] * g.inverse_norm;
    const D w = g.q[0], x = g.q[1], y = g.q[2], z = g.q[3], one = setd(1.0), two = setd(2.0);
    g.rotation[0] = {fnma(two, fma(y, y, z * z), one), two * fnma(w, z, x * y), two * fma(w, y, x * z)};
    g.rotation[1] = {two * fma(w, z, x * y), fnma(two, fma(x, x, z * z), one), two * fnma(w, x, y * z)};
    g.rotation[2] = {two * fnma(w, y, x * z), two * fma(w, x, y * z), fnma(two, fma(x, x, y * y), one)};
    for (int k = 0; k < 3; ++k) g.scale[k] = widen(shape.scale[k] + at);
}

/// row i of J W: focal/z (row i of W) - focal ratio/z (row 2 of W).
GSE_INLINE Vec3D pixel_row(D focal_over_z, D ratio, const double* row, const double* third) {
    return {focal_over_z * fnma(ratio, setd(third[0]), setd(row[0])),
            focal_over_z * fnma(ratio, setd(third[1]), setd(row[1])),
            focal_over_z * fnma(ratio, setd(third[2]), setd(row[2]))};
}

/// (v R) diag(scale).
GSE_INLINE Vec3D project_axes(const Vec3D& v, const Geometry& g) {
    const Vec3D* r = g.rotation;
    return {g.scale[0] * fma(v.z, r[2].x, fma(v.y, r[1].x, v.x * r[0].x)),
            g.scale[1] * fma(v.z, r[2].y, fma(v.y, r[1].y, v.x * r[0].y)),
            g.scale[2] * fma(v.z, r[2].z, fma(v.y, r[1].z, v.x * r[0].z))};
}

GSE_INLINE void flatten(const Viewpoint& view, Geometry& g) {
    const D x = g.x * g.inverse_z, y = g.y * g.inverse_z;
    g.ratio_x = min(max(x, setd(view.ratio_low[0])), setd(view.ratio_high[0]));
    g.ratio_y = min(max(y, setd(view.ratio_low[1])), setd(view.ratio_high[1]));
    g.inside_x = g.ratio_x == x;
    g.inside_y = g.ratio_y == y;
    const double* r = view.rotation;
    g.to_pixels[0] = pixel_row(setd(view.fx) * g.inverse_z, g.ratio_x, r, r + 6);
    g.to_pixels[1] = pixel_row(setd(view.fy) * g.inverse_z, g.ratio_y, r + 3, r + 6);
    g.footprint[0] = project_axes(g.to_pixels[0], g);
    g.footprint[1] = project_axes(g.to_pixels[1], g);
    const Vec3D &a = g.footprint[0], &b = g.footprint[1];
    g.raw_xx = dot3(a, a);
    g.xy = dot3(a, b);
    g.raw_yy = dot3(b, b);
    const D blur = setd(view.blur);
    g.xx = g.raw_xx + blur;
    g.yy = g.raw_yy + blur;
    const Vec3D area = {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    g.raw_determinant = dot3(area, area);
    g.determinant = fma(blur, g.raw_xx + g.raw_yy, fma(blur, blur, g.raw_determinant));
}

GSE_INLINE void compute_geometry(const RawBatch& raw, const Shape& shape, int at, const Viewpoint& view,
                                 Geometry& g) {
    place(raw, at, view, g);
    orient(raw, shape, at, g);
    flatten(view, g);
}

/// Basis of the spherical harmonics for unit directions (spherical_harmonics.cpp is the plain twin).
GSE_INLINE void basis_lanes(F x, F y, F z, int count, F* b) {
    b[0] = set(0.28209479177387814f);
    if (count < 4) return;
    const F c1 = set(0.4886025119029199f), minus_c1 = set(-0.4886025119029199f);
    b[1] = minus_c1 * y;
    b[2] = c1 * z;
    b[3] = minus_c1 * x;
    if (count < 9) return;
    const F xx = x * x, yy = y * y, zz = z * z;
    b[4] = set(1.0925484305920792f) * x * y;
    b[5] = set(-1.0925484305920792f) * y * z;
    b[6] = set(0.31539156525252005f) * (zz + zz - xx - yy);
    b[7] = set(-1.0925484305920792f) * x * z;
    b[8] = set(0.5462742152960396f) * (xx - yy);
    if (count < 16) return;
    const F four_zz = set(4.0f) * zz - xx - yy, three = set(3.0f);
    b[9] = set(-0.5900435899266435f) * y * (three * xx - yy);
    b[10] = set(2.890611442640554f) * x * y * z;
    b[11] = set(-0.4570457994644658f) * y * four_zz;
    b[12] = set(0.3731763325901154f) * z * (zz + zz - three * (xx + yy));
    b[13] = set(-0.4570457994644658f) * x * four_zz;
    b[14] = set(1.445305721320277f) * z * (xx - yy);
    b[15] = set(-0.5900435899266435f) * x * (xx - three * yy);
}
