// Kernel part 2: rows -> records: ellipses in double lanes, then extents, and the colours of what is left, in float lanes.

/// The drawn rows of a batch wait here for their colour.
struct alignas(64) ColourBatch {
    float direction[3][F::W];  // world, not normalised
    float coefficients[48][F::W];
    Record* record[F::W];
    const float* sh[F::W];
    int size;
};

/// Component-major results of one batch of rows, before they are scattered into records.
struct alignas(64) RecordBatch {
    float x[F::W], y[F::W], l1[F::W], l2[F::W], l3[F::W], log2_opacity[F::W], depth[F::W];
    float half_width[F::W], half_height[F::W], lean[F::W], direction[3][F::W];
    float dimming[F::W];  // of the opacity, by antialiasing
};

/// Ellipse of one half batch: centre and Cholesky factor; of its extent, what finish_records needs. Returns the lanes that have one.
GSE_INLINE MD project_records(const Viewpoint& view, const Geometry& g, int at, RecordBatch& out) {
    constexpr double longest = 1e36;  // px^2; squares beyond a float's range are as long as this
    if (view.antialiased) narrow(out.dimming + at, sqrt(g.raw_determinant / g.determinant));
    narrow(out.x + at, fma(setd(view.fx) * g.x, g.inverse_z, setd(view.cx)));
    narrow(out.y + at, fma(setd(view.fy) * g.y, g.inverse_z, setd(view.cy)));
    const D per_yy = setd(1.0) / g.yy, nought = setd(0.0);
    const D l1 = sqrt(setd(0.5 * Log2E) * g.yy / g.determinant);
    narrow(out.l1 + at, l1);
    narrow(out.l2 + at, nought - l1 * g.xy * per_yy);
    narrow(out.l3 + at, sqrt(setd(0.5 * Log2E) * per_yy));
    narrow(out.depth + at, g.z);
    narrow(out.half_width + at, min(g.xx, setd(longest)));
    narrow(out.half_height + at, min(g.yy, setd(longest)));
    narrow(out.lean + at, g.xy / g.xx);
    narrow(out.direction[0] + at, g.offset.x);
    narrow(out.direction[1] + at, g.offset.y);
    narrow(out.direction[2] + at, g.offset.z);
    return (g.z > setd(view.near_plane)) & (g.z < setd(view.far_plane)) & (g.determinant > setd(DeterminantCut));
}

/// Opacity and extent of the batch; returns the lanes that may show in the picture.
GSE_INLINE M finish_records(const Viewpoint& view, const Shape& shape, RecordBatch& out) {
    F opacity = load(shape.opacity);
    if (view.antialiased) opacity = opacity * load(out.dimming);
    const F log2_opacity = min(log2_lanes(max(opacity, set(1e-30f))), zero());
    // alpha >= 1/255 <=> u^2 + v^2 <= log2(255 o); a little more, so that rounding can never drop a pair.
    const F reach = fma(log2_opacity + set(static_cast<float>(Log2Of255)), set(1.0f + 1e-4f), set(1e-4f));
    const F squared = set(static_cast<float>(2 * Ln2)) * reach, x = load(out.x), y = load(out.y);
    const F half_width = sqrt(max(squared * load(out.half_width), zero()));
    const F half_height = sqrt(max(squared * load(out.half_height), zero()));
    store(out.log2_opacity, log2_opacity);
    store(out.lean, half_width * load(out.lean));
    store(out.half_width, half_width);
    store(out.half_height, half_height);
    const F right = set(static_cast<float>(view.width)), bottom = set(static_cast<float>(view.height));
    return (opacity >= set(static_cast<float>(AlphaCut))) & (x + half_width >= zero()) & (x - half_width <= right) &
           (y + half_height >= zero()) & (y - half_height <= bottom);
}

GSE_INLINE void write_record(const RecordBatch& from, int lane, std::uint32_t row, Record& to) {
    to.x = from.x[lane];
    to.y = from.y[lane];
    to.l1 = from.l1[lane];
    to.l2 = from.l2[lane];
    to.l3 = from.l3[lane];
    to.log2_opacity = from.log2_opacity[lane];
    to.depth = from.depth[lane];
    to.half_width = from.half_width[lane];
    to.half_height = from.half_height[lane];
    to.lean = from.lean[lane];
    to.row = row;
}

static void colour_batch(ColourBatch& batch, int sh_count) {
    if (batch.size == 0) return;
    for (int lane = batch.size; lane < F::W; ++lane) {
        batch.sh[lane] = batch.sh[0];
        for (int k = 0; k < 3; ++k) batch.direction[k][lane] = batch.direction[k][0];
    }
    load_columns(batch.sh, sh_count * 3, batch.coefficients[0]);
    const F x = load(batch.direction[0]), y = load(batch.direction[1]), z = load(batch.direction[2]);
    const F scale = set(1.0f) / sqrt(fma(z, z, fma(y, y, x * x)));
    F basis[16];
    basis_lanes(x * scale, y * scale, z * scale, sh_count, basis);
    alignas(64) float colour[3][F::W];
    for (int channel = 0; channel < 3; ++channel) {
        F sum = set(0.5f);
        for (int k = 0; k < sh_count; ++k)
            sum = fma(basis[k], load(batch.coefficients[k * 3 + channel]), sum);
        store(colour[channel], sum);
    }
    for (int lane = 0; lane < batch.size; ++lane)
        for (int channel = 0; channel < 3; ++channel)
            batch.record[lane]->colour[channel] = colour[channel][lane];
    batch.size = 0;
}

/// Clamps the colours at 0 and takes out the records whose colour is not finite (so that what is drawn is the
/// same whether colours or values are composited).
static void check_colours(ProjectJob& job) {
    constexpr float largest = 3.40282346638528859812e38f;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < job.drawn; ++i) {
        Record& record = job.records[i];
        bool finite = true;
        for (float& channel : record.colour) {
            finite = finite && channel >= -largest && channel <= largest;
            channel = channel > 0.0f ? channel : 0.0f;
        }
        if (!finite) {
            ++job.unusable;
            continue;
        }
        if (job.values != nullptr) {
            record.colour[0] = job.values[record.row];
            record.colour[1] = record.colour[2] = 0.0f;
        }
        if (kept != i) job.records[kept] = record;
        union {
            float depth;
            std::uint32_t key;
        } pun = {record.depth};
        job.keys[kept++] = pun.key;
    }
    job.drawn = kept;
}

/// Asks for the coefficients of the next batch, of which most are drawn.
GSE_INLINE void prefetch_coefficients(const ProjectJob& job, std::size_t row, std::size_t count) {
    const std::size_t end = row + count < job.end ? row + count : job.end;
    for (; row < end; ++row) prefetch_floats<0>(job.source.sh + row * job.source.sh_stride, job.view->sh_count * 3);
}

static void project(ProjectJob& job) {
    RawBatch raw;
    Shape shape;
    RecordBatch found;
    ColourBatch colours;
    colours.size = 0;
    job.drawn = 0;
    job.unusable = 0;
    for (std::size_t row = job.begin; row < job.end; row += F::W) {
        const std::size_t left = job.end - row;
        raw.size = left < F::W ? static_cast<int>(left) : F::W;
        for (int lane = 0; lane < raw.size; ++lane)
            load_row(job.source, row + static_cast<std::size_t>(lane), lane, raw);
        fill_batch(job.source, raw);
        compute_shape(raw, shape);
        unsigned drawn = 0;
        for (int at = 0; at < F::W; at += D::W) {
            Geometry g;
            const std::size_t asked = row + static_cast<std::size_t>(F::W + at);
            prefetch_coefficients(job, asked, (D::W + 1) / 2);
            compute_geometry(raw, shape, at, *job.view, g);
            prefetch_coefficients(job, asked + (D::W + 1) / 2, D::W / 2);
            drawn |= bits(project_records(*job.view, g, at, found)) << at;
        }
        const unsigned usable = bits(usable_lanes(raw));
        drawn &= usable & bits(finish_records(*job.view, shape, found));
        const unsigned valid = (2u << (raw.size - 1)) - 1u;
        drawn &= valid;
        job.unusable += static_cast<std::size_t>(__builtin_popcount(valid & ~usable));
        for (; drawn != 0; drawn &= drawn - 1) {
            const int lane = __builtin_ctz(drawn);
            const std::size_t source_row = raw.row[lane];
            Record& record = job.records[job.drawn++];
            write_record(found, lane, raw.row[lane], record);
            for (int k = 0; k < 3; ++k) colours.direction[k][colours.size] = found.direction[k][lane];
            colours.sh[colours.size] = job.source.sh + source_row * job.source.sh_stride;
            colours.record[colours.size] = &record;
            if (++colours.size == F::W) colour_batch(colours, job.view->sh_count);
        }
    }
    colour_batch(colours, job.view->sh_count);
    check_colours(job);
}
