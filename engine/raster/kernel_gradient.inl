// Kernel part 6: sums of the pixels -> gradients of the raw parameters, W Gaussians at a time. Derivative of
// kernel_geometry.inl; plain_projection.cpp is the plain twin.

struct alignas(64) GradientBatch {
    RawBatch raw;
    Shape shape;
    float sums[9][F::W];
    float positive[3][F::W];  // 1 where the colour is above its clamp
    const float* sh[F::W];
    // results, component-major
    float position[3][F::W], log_scale[3][F::W], rotation[4][F::W], opacity_logit[F::W], mean2d[F::W];
    float direction[3][F::W], direction_gradient[3][F::W];  // world; d_direction includes 1/distance
    float coefficients[48][F::W], coefficient_gradients[48][F::W];
};

/// Replaces sums that are not finite by zero. Only overflow can make them so.
GSE_INLINE void keep_finite_sums(GradientBatch& batch) {
    const F largest = set(3.40282346638528859812e38f);
    for (int k = 0; k <= SumGvv; ++k)
        store(batch.sums[k], only(absolute(load(batch.sums[k])) <= largest, load(batch.sums[k])));
}

/// Into the range of float; NaN becomes 0.
GSE_INLINE D into_float(D a) {
    constexpr double largest = 3.40282346638528859812e38;
    return min(max(select(a == a, a, setd(0.0)), setd(-largest)), setd(largest));
}

struct CovarianceD {
    D xx, xy, yy;
};

/// dL/dCov from the moments of the whitened offsets: sigma = ln 2 |w|^2, w = L d, so dL/dCov = 2 ln2^2 L^T
/// (sum g w w^T) L.
GSE_INLINE CovarianceD covariance_gradient(const GradientBatch& batch, int at, const Geometry& g,
                                           const Viewpoint& view, D* centre) {
    const D per_yy = setd(1.0) / g.yy;
    const D l1 = sqrt(setd(0.5 * Log2E) * g.yy / g.determinant), l2 = setd(0.0) - l1 * g.xy * per_yy;
    const D l3 = sqrt(setd(0.5 * Log2E) * per_yy);
    const D mu = widen(batch.sums[SumGu] + at), mv = widen(batch.sums[SumGv] + at);
    const D uu = widen(batch.sums[SumGuu] + at), uv = widen(batch.sums[SumGuv] + at),
            vv = widen(batch.sums[SumGvv] + at);
    centre[0] = setd(2 * Ln2) * l1 * mu;
    centre[1] = setd(2 * Ln2) * fma(l2, mu, l3 * mv);
    const D c = setd(2 * Ln2 * Ln2), cross = fma(l2, uu, l3 * uv);
    CovarianceD d = {c * l1 * l1 * uu, c * l1 * cross, c * fma(l2, cross, l3 * fma(l2, uv, l3 * vv))};
    if (view.antialiased) {
        const D half = setd(0.5) * widen(batch.sums[SumG] + at);
        const D raw = select(g.raw_determinant > setd(0.0), half / g.raw_determinant, setd(0.0));
        const D blurred = half / g.determinant;
        d.xx = d.xx + (raw * g.raw_yy - blurred * g.yy);
        d.xy = d.xy - (raw - blurred) * g.xy;
        d.yy = d.yy + (raw * g.raw_xx - blurred * g.xx);
    }
    return d;
}

/// dL/d(axes) -> log-scales and rotation matrix; columns of the axes are scale times columns of the rotation.
GSE_INLINE void axes_gradient(const Geometry& g, const Vec3D* d_footprint, int at, GradientBatch& batch,
                              Vec3D* d_rotation) {
    D d_scale[3] = {setd(0.0), setd(0.0), setd(0.0)};
    for (int r = 0; r < 3; ++r) {
        const D a = r == 0 ? g.to_pixels[0].x : r == 1 ? g.to_pixels[0].y : g.to_pixels[0].z;
        const D b = r == 0 ? g.to_pixels[1].x : r == 1 ? g.to_pixels[1].y : g.to_pixels[1].z;
        const Vec3D d = {fma(a, d_footprint[0].x, b * d_footprint[1].x),
                         fma(a, d_footprint[0].y, b * d_footprint[1].y),
                         fma(a, d_footprint[0].z, b * d_footprint[1].z)};
        d_rotation[r] = {d.x * g.scale[0], d.y * g.scale[1], d.z * g.scale[2]};
        d_scale[0] = fma(d.x, g.rotation[r].x, d_scale[0]);
        d_scale[1] = fma(d.y, g.rotation[r].y, d_scale[1]);
        d_scale[2] = fma(d.z, g.rotation[r].z, d_scale[2]);
    }
    for (int k = 0; k < 3; ++k) narrow(batch.log_scale[k] + at, into_float(d_scale[k] * g.scale[k]));
}

GSE_INLINE void rotation_gradient(const Geometry& g, const Vec3D* d, int at, GradientBatch& batch) {
    const D w = g.q[0], x = g.q[1], y = g.q[2], z = g.q[3], two = setd(2.0);
    const D a = d[2].y - d[1].z, b = d[0].z - d[2].x, c = d[1].x - d[0].y;  // antisymmetric part
    const D e = d[0].y + d[1].x, f = d[0].z + d[2].x, h = d[1].z + d[2].y;  // symmetric part
    D dq[4];
    dq[0] = two * fma(x, a, fma(y, b, z * c));
    dq[1] = two * (fma(y, e, fma(z, f, w * a)) - two * x * (d[1].y + d[2].z));
    dq[2] = two * (fma(x, e, fma(z, h, w * b)) - two * y * (d[0].x + d[2].z));
    dq[3] = two * (fma(x, f, fma(y, h, w * c)) - two * z * (d[0].x + d[1].y));
    const D radial = fma(w, dq[0], fma(x, dq[1], fma(y, dq[2], z * dq[3])));
    for (int k = 0; k < 4; ++k)
        narrow(batch.rotation[k] + at, into_float(fnma(g.q[k], radial, dq[k]) * g.inverse_norm));
}

/// Gradient of the position through the centre of the splat, its Jacobian, and the direction of its colour.
GSE_INLINE void position_gradient(const Geometry& g, const Viewpoint& view, const Vec3D* d_footprint,
                                  const D* centre, int at, GradientBatch& batch) {
    // dL/d(to_pixels) = dL/d(footprint) axes^T, then dL/dJ = that times W^T.
    D jx[3], jy[3];
    Vec3D world[2];
    for (int i = 0; i < 2; ++i) {
        const Vec3D v = {d_footprint[i].x * g.scale[0], d_footprint[i].y * g.scale[1],
                         d_footprint[i].z * g.scale[2]};
        world[i] = {dot3(v, g.rotation[0]), dot3(v, g.rotation[1]), dot3(v, g.rotation[2])};
    }
    const double* r = view.rotation;
    for (int k = 0; k < 3; ++k) {
        const Vec3D row = {setd(r[k * 3]), setd(r[k * 3 + 1]), setd(r[k * 3 + 2])};
        jx[k] = dot3(world[0], row);
        jy[k] = dot3(world[1], row);
    }
    const D fx = setd(view.fx) * g.inverse_z, fy = setd(view.fy) * g.inverse_z, nought = setd(0.0);
    const D ratio_x = select(g.inside_x, nought - fx * jx[2], nought);
    const D ratio_y = select(g.inside_y, nought - fy * jy[2], nought);
    const D x = g.x * g.inverse_z, y = g.y * g.inverse_z;
    const D px = fma(centre[0], fx, ratio_x * g.inverse_z), py = fma(centre[1], fy, ratio_y * g.inverse_z);
    // d/dz: everything above divides by z.
    const D through_jacobian = fma(fx, fnma(g.ratio_x, jx[2], jx[0]), fy * fnma(g.ratio_y, jy[2], jy[1]));
    const D pz = nought - fma(px, x, py * y) - through_jacobian * g.inverse_z;
    const D d_direction[3] = {widen(batch.direction_gradient[0] + at),
                              widen(batch.direction_gradient[1] + at),
                              widen(batch.direction_gradient[2] + at)};
    for (int k = 0; k < 3; ++k) {
        const D through_point = fma(setd(r[k]), px, fma(setd(r[3 + k]), py, setd(r[6 + k]) * pz));
        narrow(batch.position[k] + at, into_float(through_point + d_direction[k]));
    }
}

GSE_INLINE void half_batch(const Viewpoint& view, const Geometry& g, int at, GradientBatch& batch) {
    D centre[2];
    const CovarianceD d = covariance_gradient(batch, at, g, view, centre);
    const D two = setd(2.0);
    Vec3D d_footprint[2];
    const Vec3D &a = g.footprint[0], &b = g.footprint[1];
    d_footprint[0] = {two * fma(d.xx, a.x, d.xy * b.x), two * fma(d.xx, a.y, d.xy * b.y),
                      two * fma(d.xx, a.z, d.xy * b.z)};
    d_footprint[1] = {two * fma(d.xy, a.x, d.yy * b.x), two * fma(d.xy, a.y, d.yy * b.y),
                      two * fma(d.xy, a.z, d.yy * b.z)};
    Vec3D d_rotation[3];
    axes_gradient(g, d_footprint, at, batch, d_rotation);
    rotation_gradient(g, d_rotation, at, batch);
    position_gradient(g, view, d_footprint, centre, at, batch);
    const D sum = widen(batch.sums[SumG] + at);
    narrow(batch.opacity_logit + at, sum * widen(batch.shape.transparency + at));
    const D nx = centre[0] * setd(0.5 * view.width), ny = centre[1] * setd(0.5 * view.height);
    narrow(batch.mean2d + at, into_float(sqrt(fma(nx, nx, ny * ny))));
}

/// No gradient of log-scales that count as their limit.
GSE_INLINE void hold_limits(GradientBatch& batch) {
    const F limit = set(static_cast<float>(LogScaleLimit));
    for (int k = 0; k < 3; ++k)
        store(batch.log_scale[k], only(load(batch.raw.log_scale[k]) <= limit, load(batch.log_scale[k])));
}

/// Derivative of the colour's polynomial with respect to the unit direction; h[k] = sum over channels of
/// coefficient times colour gradient.
GSE_INLINE void direction_slope(F x, F y, F z, int count, const F* h, F* d) {
    const F c1 = set(0.4886025119029199f), nought = zero(), two = set(2.0f);
    d[0] = nought - c1 * h[3];
    d[1] = nought - c1 * h[1];
    d[2] = c1 * h[2];
    if (count < 9) return;
    const F h4 = set(1.0925484305920792f) * h[4], h5 = set(-1.0925484305920792f) * h[5];
    const F h6 = set(2 * 0.31539156525252005f) * h[6], h7 = set(-1.0925484305920792f) * h[7];
    const F h8 = set(2 * 0.5462742152960396f) * h[8];
    d[0] = d[0] + fma(h4, y, fma(h7, z, x * (h8 - h6)));
    d[1] = d[1] + fma(h4, x, fnma(h8 + h6, y, h5 * z));
    d[2] = d[2] + fma(h5, y, fma(h7, x, two * h6 * z));
    if (count < 16) return;
    const F xx = x * x, yy = y * y, zz = z * z, xy = x * y, yz = y * z, xz = x * z, three = set(3.0f);
    const F h9 = set(-0.5900435899266435f) * h[9], h10 = set(2.890611442640554f) * h[10];
    const F h11 = set(-0.4570457994644658f) * h[11], h12 = set(0.3731763325901154f) * h[12];
    const F h13 = set(-0.4570457994644658f) * h[13], h14 = set(1.445305721320277f) * h[14];
    const F h15 = set(-0.5900435899266435f) * h[15];
    const F six = set(6.0f), eight = set(8.0f), four_zz = set(4.0f) * zz;
    const F xx_yy = three * (xx - yy);
    d[0] = d[0] + (six * xy * h9 + yz * h10 - two * xy * h11 - six * xz * h12 +
                   (four_zz - three * xx - yy) * h13 + two * xz * h14 + xx_yy * h15);
    d[1] = d[1] + (xx_yy * h9 + xz * h10 + (four_zz - xx - three * yy) * h11 - six * yz * h12 -
                   two * xy * h13 - two * yz * h14 - six * xy * h15);
    d[2] = d[2] + (xy * h10 + eight * yz * h11 + (six * zz - three * (xx + yy)) * h12 + eight * xz * h13 +
                   (xx - yy) * h14);
}

/// Gradients of the coefficients, and of the position through the direction.
static void colour_gradient(const Viewpoint& view, GradientBatch& batch) {
    const int count = view.sh_count;
    F d_colour[3];
    for (int channel = 0; channel < 3; ++channel) {
        const F slope = select(load(batch.positive[channel]) > zero(), set(1.0f), set(view.negative_slope));
        const F sum = load(batch.sums[SumRed + channel]) * slope;
        const F largest = set(3.40282346638528859812e38f);
        d_colour[channel] = only((sum <= largest) & (sum >= zero() - largest), sum);
    }
    const F x0 = load(batch.direction[0]), y0 = load(batch.direction[1]), z0 = load(batch.direction[2]);
    const F inverse = set(1.0f) / sqrt(fma(z0, z0, fma(y0, y0, x0 * x0)));
    const F x = x0 * inverse, y = y0 * inverse, z = z0 * inverse;
    F basis[16];
    basis_lanes(x, y, z, count, basis);
    for (int k = 0; k < count; ++k)
        for (int channel = 0; channel < 3; ++channel)
            store(batch.coefficient_gradients[k * 3 + channel], basis[k] * d_colour[channel]);
    F d[3] = {zero(), zero(), zero()};
    if (count >= 4) {
        load_columns(batch.sh, count * 3, batch.coefficients[0]);
        F h[16];
        for (int k = 1; k < count; ++k)
            h[k] = fma(load(batch.coefficients[k * 3 + 2]), d_colour[2],
                       fma(load(batch.coefficients[k * 3 + 1]), d_colour[1],
                           load(batch.coefficients[k * 3]) * d_colour[0]));
        direction_slope(x, y, z, count, h, d);
        const F radial = fma(x, d[0], fma(y, d[1], z * d[2]));
        d[0] = fnma(x, radial, d[0]) * inverse;
        d[1] = fnma(y, radial, d[1]) * inverse;
        d[2] = fnma(z, radial, d[2]) * inverse;
    }
    for (int k = 0; k < 3; ++k) store(batch.direction_gradient[k], d[k]);
}

static void write_gradients(const GradientJob& job, GradientBatch& batch) {
    float* sh[F::W];
    for (int lane = 0; lane < batch.raw.size; ++lane) {
        const std::size_t row = batch.raw.row[lane] - job.out_row;
        for (std::size_t k = 0; k < 3; ++k) job.out.position[row * 3 + k] = batch.position[k][lane];
        for (std::size_t k = 0; k < 3; ++k) job.out.log_scale[row * 3 + k] = batch.log_scale[k][lane];
        for (std::size_t k = 0; k < 4; ++k) job.out.rotation[row * 4 + k] = batch.rotation[k][lane];
        job.out.opacity_logit[row] = batch.opacity_logit[lane];
        job.out.mean2d_norm[row] = batch.mean2d[lane];
        job.out.visible[row] = 1;
        sh[lane] = job.out.sh + row * job.source.sh_stride;
        for (auto k = static_cast<std::size_t>(job.view->sh_count) * 3; k < job.source.sh_stride; ++k)
            sh[lane][k] = 0.0f;
    }
    if (HasStreams && job.past_caches)
        return stream_columns(batch.coefficient_gradients[0], job.view->sh_count * 3, sh, batch.raw.size);
    store_columns(batch.coefficient_gradients[0], job.view->sh_count * 3, sh, batch.raw.size);
}

/// Zeros for rows [begin, end), few at a time.
static void clear_rows(const GradientJob& job, std::size_t begin, std::size_t end) {
    if (begin >= end) return;
    const std::size_t stride = job.source.sh_stride;
    for (std::size_t row = begin - job.out_row; row < end - job.out_row; ++row) {
        for (std::size_t k = 0; k < 3; ++k) job.out.position[row * 3 + k] = 0.0f;
        for (std::size_t k = 0; k < 3; ++k) job.out.log_scale[row * 3 + k] = 0.0f;
        for (std::size_t k = 0; k < 4; ++k) job.out.rotation[row * 4 + k] = 0.0f;
        job.out.opacity_logit[row] = 0.0f;
        job.out.mean2d_norm[row] = 0.0f;
        job.out.visible[row] = 0;
    }
    if (HasStreams && job.past_caches)
        return stream_zeros(job.out.sh + (begin - job.out_row) * stride, (end - begin) * stride);
    __builtin_memset(job.out.sh + (begin - job.out_row) * stride, 0, (end - begin) * stride * sizeof(float));
}

/// Prefetches the coefficients of a row, and the gradients of this and earlier rows from `asked` on.
GSE_INLINE void prefetch_gradients(const GradientJob& job, std::size_t row, std::size_t& asked) {
    const std::size_t stride = job.source.sh_stride;
    prefetch_floats<0>(job.source.sh + row * stride, job.view->sh_count * 3);
    if (HasStreams && job.past_caches) return;  // nothing is fetched to be overwritten
    for (; asked <= row; ++asked)
        prefetch_floats<1>(job.out.sh + (asked - job.out_row) * stride, static_cast<int>(stride));
}

static void finish_batch(const GradientJob& job, GradientBatch& batch) {
    if (batch.raw.size == 0) return;
    for (int lane = batch.raw.size; lane < F::W; ++lane) {
        batch.sh[lane] = batch.sh[0];
        for (auto& sum : batch.sums) sum[lane] = 0.0f;
        for (auto& channel : batch.positive) channel[lane] = 0.0f;
    }
    fill_batch(job.source, batch.raw);
    compute_shape(batch.raw, batch.shape);
    keep_finite_sums(batch);
    Geometry g[F::W / D::W];
    for (int at = 0, half = 0; at < F::W; at += D::W, ++half) {
        compute_geometry(batch.raw, batch.shape, at, *job.view, g[half]);
        narrow(batch.direction[0] + at, g[half].offset.x);
        narrow(batch.direction[1] + at, g[half].offset.y);
        narrow(batch.direction[2] + at, g[half].offset.z);
    }
    colour_gradient(*job.view, batch);
    for (int at = 0, half = 0; at < F::W; at += D::W, ++half) half_batch(*job.view, g[half], at, batch);
    hold_limits(batch);
    write_gradients(job, batch);
    batch.raw.size = 0;
}

static void gradient(const GradientJob& job) {
    GradientBatch batch;
    batch.raw.size = 0;
    constexpr std::ptrdiff_t ahead = 24;
    const PairRange* range = job.ranges;
    std::size_t next = job.first_row, asked = job.first_row;
    for (const Record* record = job.begin; record < job.end; ++record, ++range) {
        if (job.end - record > 2 * ahead) {
            __builtin_prefetch(record + 2 * ahead);
            __builtin_prefetch(range + 2 * ahead);
        }
        if (job.end - record > ahead) prefetch_gradients(job, record[ahead].row, asked);
        alignas(64) float sums[PartialStride];
        F total[PartialStride / F::W];
        for (F& part : total) part = zero();
        const float* slot =
            job.partials + static_cast<std::size_t>(range->begin + job.slot_shift) * PartialStride;
        for (std::uint32_t pair = 0; pair < range->count; ++pair, slot += PartialStride) {
            __builtin_prefetch(slot + 24 * PartialStride);
            for (int k = 0; k < PartialStride / F::W; ++k) total[k] = total[k] + load(slot + k * F::W);
        }
        for (int k = 0; k < PartialStride / F::W; ++k) store(sums + k * F::W, total[k]);
        if (!(sums[SumBlended] > 0.0f)) continue;
        clear_rows(job, next, record->row);
        next = record->row + std::size_t{1};
        const int lane = batch.raw.size++;
        load_row(job.source, record->row, lane, batch.raw);
        for (int k = 0; k < 9; ++k) batch.sums[k][lane] = sums[k];
        for (int k = 0; k < 3; ++k) batch.positive[k][lane] = record->colour[k];
        batch.sh[lane] = job.source.sh + static_cast<std::size_t>(record->row) * job.source.sh_stride;
        if (batch.raw.size == F::W) finish_batch(job, batch);
    }
    clear_rows(job, next, job.end_row);
    finish_batch(job, batch);
    if (HasStreams && job.past_caches) end_streams();
}
