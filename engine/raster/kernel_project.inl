// Kernel part 2: rows -> records. Ellipses are in double lanes, extents and the colours of visible rows in
// float lanes.

/// Fields of W records, one after the other.
struct alignas(64) RecordColumns {
    float x[F::W], y[F::W], l1[F::W], l2[F::W], l3[F::W], log2_opacity[F::W], colour[3][F::W], depth[F::W];
    float half_width[F::W], half_height[F::W], lean[F::W];
    std::uint32_t row[F::W];
    float rest[2][F::W];
};
static_assert(sizeof(RecordColumns) == F::W * sizeof(Record));
constexpr int RecordFloats = sizeof(Record) / sizeof(float);

/// Rows on their way to records.
struct alignas(64) RecordBatch {
    RecordColumns columns;
    float direction[3][F::W];  // world, not normalised
    float dimming[F::W];       // of the opacity, by antialiasing
    const float* sh[F::W];
    float* record[F::W];  // where each goes
    int size;
};

/// Ellipse of one half batch: centre, Cholesky factor, and the part of its extent that finish_records needs.
/// Returns the lanes that have one.
GSE_INLINE MD project_records(const Viewpoint& view, const Geometry& g, int at, RecordBatch& out) {
    constexpr double longest = 1e36;  // px^2; squares beyond a float's range are as long as this
    if (view.antialiased) narrow(out.dimming + at, sqrt(g.raw_determinant / g.determinant));
    narrow(out.columns.x + at, fma(setd(view.fx) * g.x, g.inverse_z, setd(view.cx)));
    narrow(out.columns.y + at, fma(setd(view.fy) * g.y, g.inverse_z, setd(view.cy)));
    const D per_yy = setd(1.0) / g.yy, nought = setd(0.0);
    const D l1 = sqrt(setd(0.5 * Log2E) * g.yy / g.determinant);
    narrow(out.columns.l1 + at, l1);
    narrow(out.columns.l2 + at, nought - l1 * g.xy * per_yy);
    narrow(out.columns.l3 + at, sqrt(setd(0.5 * Log2E) * per_yy));
    narrow(out.columns.depth + at, g.z);
    narrow(out.columns.half_width + at, min(g.xx, setd(longest)));
    narrow(out.columns.half_height + at, min(g.yy, setd(longest)));
    narrow(out.columns.lean + at, g.xy / g.xx);
    narrow(out.direction[0] + at, g.offset.x);
    narrow(out.direction[1] + at, g.offset.y);
    narrow(out.direction[2] + at, g.offset.z);
    return (g.z > setd(view.near_plane)) & (g.z < setd(view.far_plane)) &
           (g.determinant > setd(DeterminantCut));
}

/// Opacity and extent of the batch. Returns the lanes that may show in the picture.
GSE_INLINE M finish_records(const Viewpoint& view, const Shape& shape, RecordBatch& out) {
    F opacity = load(shape.opacity);
    if (view.antialiased) opacity = opacity * load(out.dimming);
    const F log2_opacity = min(log2_lanes(max(opacity, set(1e-30f))), zero());
    // alpha >= 1/255 <=> u^2 + v^2 <= log2(255 o); a little more, so that rounding can never drop a pair.
    const F reach = fma(log2_opacity + set(static_cast<float>(Log2Of255)), set(1.0f + 1e-4f), set(1e-4f));
    const F squared = set(static_cast<float>(2 * Ln2)) * reach, x = load(out.columns.x),
            y = load(out.columns.y);
    const F half_width = sqrt(max(squared * load(out.columns.half_width), zero()));
    const F half_height = sqrt(max(squared * load(out.columns.half_height), zero()));
    store(out.columns.log2_opacity, log2_opacity);
    store(out.columns.lean, half_width * load(out.columns.lean));
    store(out.columns.half_width, half_width);
    store(out.columns.half_height, half_height);
    const F right = set(static_cast<float>(view.width)), bottom = set(static_cast<float>(view.height));
    return (opacity >= set(static_cast<float>(AlphaCut))) & (x + half_width >= zero()) &
           (x - half_width <= right) & (y + half_height >= zero()) & (y - half_height <= bottom);
}

constexpr float UnusableMark = 1.0f;  // as log2(opacity), which is never positive

/// Colours of the batch, clamped at 0. Lanes without a finite one are marked and counted. The drawn Gaussians
/// then do not depend on compositing colours or values.
static void colour_batch(const ProjectJob& job, RecordBatch& batch) {
    const int sh_count = job.view->sh_count;
    alignas(64) float coefficients[48][F::W];
    load_columns(batch.sh, sh_count * 3, coefficients[0]);
    const F x = load(batch.direction[0]), y = load(batch.direction[1]), z = load(batch.direction[2]);
    const F scale = set(1.0f) / sqrt(fma(z, z, fma(y, y, x * x)));
    F basis[16], colour[3];
    basis_lanes(x * scale, y * scale, z * scale, sh_count, basis);
    for (F& channel : colour) channel = set(0.5f);
    for (int k = 0; k < sh_count; ++k)
        for (int channel = 0; channel < 3; ++channel)
            colour[channel] = fma(basis[k], load(coefficients[k * 3 + channel]), colour[channel]);
    const F largest = set(3.40282346638528859812e38f);
    const M finite = (absolute(colour[0]) <= largest) & (absolute(colour[1]) <= largest) &
                     (absolute(colour[2]) <= largest);
    store(batch.columns.log2_opacity, select(finite, load(batch.columns.log2_opacity), set(UnusableMark)));
    for (int channel = 0; channel < 3; ++channel)
        store(batch.columns.colour[channel], max(colour[channel], zero()));
}

/// Writes the first `size` lanes, with their colours, into their records.
static void write_records(const ProjectJob& job, RecordBatch& batch) {
    if (batch.size == 0) return;
    for (int lane = batch.size; lane < F::W; ++lane) {
        batch.sh[lane] = batch.sh[0];
        batch.columns.row[lane] = batch.columns.row[0];
        for (auto& component : batch.direction) component[lane] = component[0];
    }
    if (job.colours) colour_batch(job, batch);
    for (int lane = 0; lane < F::W && job.values != nullptr; ++lane) {
        batch.columns.colour[0][lane] = job.values[batch.columns.row[lane]];
        batch.columns.colour[1][lane] = batch.columns.colour[2][lane] = 0.0f;
    }
    store_columns(batch.columns.x, RecordFloats, batch.record, batch.size);
    batch.size = 0;
}

/// Takes out marked records and writes the keys of the rest.
static void finish_keys(ProjectJob& job) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < job.drawn; ++i) {
        const Record& record = job.records[i];
        if (record.log2_opacity == UnusableMark) {
            ++job.unusable;
            continue;
        }
        union {
            float depth;
            std::uint32_t key;
        } pun = {record.depth};
        if (kept != i) job.records[kept] = record;
        job.keys[kept++] = pun.key;
    }
    job.drawn = kept;
}

/// Adds a lane of one batch to another.
GSE_INLINE void append_lane(const RecordBatch& from, int lane, RecordBatch& to) {
    const RecordColumns& source = from.columns;
    RecordColumns& columns = to.columns;
    const int at = to.size++;
    columns.x[at] = source.x[lane];
    columns.y[at] = source.y[lane];
    columns.l1[at] = source.l1[lane];
    columns.l2[at] = source.l2[lane];
    columns.l3[at] = source.l3[lane];
    columns.log2_opacity[at] = source.log2_opacity[lane];
    columns.depth[at] = source.depth[lane];
    columns.half_width[at] = source.half_width[lane];
    columns.half_height[at] = source.half_height[lane];
    columns.lean[at] = source.lean[lane];
    columns.row[at] = source.row[lane];
    for (int k = 0; k < 3; ++k) to.direction[k][at] = from.direction[k][lane];
    to.sh[at] = from.sh[lane];
    to.record[at] = from.record[lane];
}

/// Records of the drawn lanes. A batch that is mostly drawn is written as it is; lanes of others are
/// collected.
GSE_INLINE void keep_drawn(ProjectJob& job, unsigned drawn, RecordBatch& found, RecordBatch& waiting) {
    const bool direct = 2 * __builtin_popcount(drawn) > F::W;
    const float* any_sh = job.source.sh + found.columns.row[__builtin_ctz(drawn)] * job.source.sh_stride;
    Record nowhere;
    for (int lane = 0; lane < F::W; ++lane) {
        const bool is_drawn = (drawn >> lane & 1u) != 0;
        found.sh[lane] = is_drawn ? job.source.sh + found.columns.row[lane] * job.source.sh_stride : any_sh;
        found.record[lane] = is_drawn ? &job.records[job.drawn].x : &nowhere.x;
        job.drawn += is_drawn ? 1 : 0;
    }
    if (direct) {
        found.size = F::W;
        return write_records(job, found);
    }
    for (; drawn != 0; drawn &= drawn - 1) {
        append_lane(found, __builtin_ctz(drawn), waiting);
        if (waiting.size == F::W) write_records(job, waiting);
    }
}

/// Prefetches the coefficients of the next batch, most of which is drawn.
GSE_INLINE void prefetch_coefficients(const ProjectJob& job, std::size_t row, std::size_t count) {
    const std::size_t end = !job.colours ? row : row + count < job.end ? row + count : job.end;
    for (; row < end; ++row)
        prefetch_floats<0>(job.source.sh + row * job.source.sh_stride, job.view->sh_count * 3);
}

/// Columns without a destination. Colours have none when nobody wants them.
GSE_INLINE void clear_unset(RecordColumns& columns) {
    for (auto& column : columns.rest) store(column, zero());
    for (auto& channel : columns.colour) store(channel, zero());
}

static void project(ProjectJob& job) {
    RawBatch raw;
    Shape shape;
    RecordBatch found, waiting;
    clear_unset(found.columns);
    clear_unset(waiting.columns);
    waiting.size = 0;
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
        const unsigned valid = (2u << (raw.size - 1)) - 1u, usable = bits(usable_lanes(raw));
        drawn &= valid & usable & bits(finish_records(*job.view, shape, found));
        job.unusable += static_cast<std::size_t>(__builtin_popcount(valid & ~usable));
        if (drawn == 0) continue;
        for (int lane = 0; lane < F::W; ++lane) found.columns.row[lane] = raw.row[lane];
        keep_drawn(job, drawn, found, waiting);
    }
    write_records(job, waiting);
    finish_keys(job);
}
