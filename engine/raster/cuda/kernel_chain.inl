// Kernels 4: the slots of a row, in order, -> gradients of its raw parameters, or its weights. One thread per
// row. The chain rule is that of kernel_gradient.inl, in double.

struct RowSums {
    float sums[SlotFloats];
};

GSE_DEVICE RowSums sum_slots(const float* slots, std::uint32_t begin, std::uint32_t count) {
    RowSums result = {};
    const float* slot = slots + static_cast<std::size_t>(begin) * SlotFloats;
    for (std::uint32_t i = 0; i < count; ++i, slot += SlotFloats)
        for (std::uint32_t k = 0; k < SlotFloats; ++k) result.sums[k] += slot[k];
    return result;
}

GSE_DEVICE void clear_floats(float* to, std::size_t count) {
    for (std::size_t k = 0; k < count; ++k) to[k] = 0.0f;
}

GSE_DEVICE void clear_row(const GradientArguments& args, std::size_t index) {
    clear_floats(args.out.position + index * 3, 3);
    clear_floats(args.out.log_scale + index * 3, 3);
    clear_floats(args.out.rotation + index * 4, 4);
    clear_floats(args.out.sh + index * args.source.sh_stride, args.source.sh_stride);
    args.out.opacity_logit[index] = 0.0f;
    args.out.mean2d_norm[index] = 0.0f;
    args.out.visible[index] = 0;
}

/// colour_gradient of kernel_gradient.inl for a number of coefficients that the compiler knows: gradients of
/// `sh`, and of the position through the direction.
template <int Count>
GSE_DEVICE void colour_chain(const Viewpoint& view, const float* sh, float* d_sh, GradientBatch& batch) {
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
    F basis[16], h[16];
    basis_lanes(x, y, z, Count, basis);
#pragma GCC unroll 16
    for (int k = 0; k < Count; ++k) {
        for (int channel = 0; channel < 3; ++channel)
            store(d_sh + k * 3 + channel, basis[k] * d_colour[channel]);
        h[k] = fma(load(sh + k * 3 + 2), d_colour[2],
                   fma(load(sh + k * 3 + 1), d_colour[1], load(sh + k * 3) * d_colour[0]));
    }
    F d[3] = {zero(), zero(), zero()};
    if (Count >= 4) {
        direction_slope(x, y, z, Count, h, d);
        const F radial = fma(x, d[0], fma(y, d[1], z * d[2]));
        d[0] = fnma(x, radial, d[0]) * inverse;
        d[1] = fnma(y, radial, d[1]) * inverse;
        d[2] = fnma(z, radial, d[2]) * inverse;
    }
    for (int k = 0; k < 3; ++k) store(batch.direction_gradient[k], d[k]);
}

GSE_DEVICE void colour_chain_of(const GradientArguments& args, std::uint32_t row, GradientBatch& batch) {
    const std::size_t stride = args.source.sh_stride;
    const float* sh = args.source.sh + row * stride;
    float* d_sh = args.out.sh + (row - args.first_row) * stride;
    if (args.view.sh_count >= 16) colour_chain<16>(args.view, sh, d_sh, batch);
    else if (args.view.sh_count >= 9) colour_chain<9>(args.view, sh, d_sh, batch);
    else if (args.view.sh_count >= 4) colour_chain<4>(args.view, sh, d_sh, batch);
    else colour_chain<1>(args.view, sh, d_sh, batch);
    const auto used = static_cast<std::size_t>(args.view.sh_count) * 3;
    clear_floats(d_sh + used, stride - used);
}

GSE_DEVICE void gradient_row(const Grid& grid, const GradientArguments& args) {
    GSE_THREADS(grid, t) {
        const std::uint32_t row = args.first_row + row_of(grid, t);
        if (row >= args.rows) continue;
        const std::size_t index = row - args.first_row;
        const RowSums found = sum_slots(args.slots, args.slot_begins[index], args.pair_counts[row]);
        if (!(found.sums[SumBlended] > 0.0f)) {
            clear_row(args, index);
            continue;
        }
        GradientBatch batch;
        load_row(args.source, row, 0, batch.raw);
        for (int k = 0; k < 9; ++k) batch.sums[k][0] = found.sums[k];
        for (int channel = 0; channel < 3; ++channel)
            batch.positive[channel][0] = args.records[row].colour[channel];
        compute_shape(batch.raw, batch.shape);
        keep_finite_sums(batch);
        Geometry g;
        compute_geometry(batch.raw, batch.shape, 0, args.view, g);
        narrow(batch.direction[0], g.offset.x);
        narrow(batch.direction[1], g.offset.y);
        narrow(batch.direction[2], g.offset.z);
        colour_chain_of(args, row, batch);
        half_batch(args.view, g, 0, batch);
        hold_limits(batch);
        for (std::size_t k = 0; k < 3; ++k) args.out.position[index * 3 + k] = batch.position[k][0];
        for (std::size_t k = 0; k < 3; ++k) args.out.log_scale[index * 3 + k] = batch.log_scale[k][0];
        for (std::size_t k = 0; k < 4; ++k) args.out.rotation[index * 4 + k] = batch.rotation[k][0];
        args.out.opacity_logit[index] = batch.opacity_logit[0];
        args.out.mean2d_norm[index] = batch.mean2d[0];
        args.out.visible[index] = 1;
    }
}

GSE_DEVICE void weigh_row(const Grid& grid, const WeightArguments& args) {
    GSE_THREADS(grid, t) {
        const std::uint32_t row = row_of(grid, t);
        if (row >= args.rows) continue;
        const float* slot = args.slots + static_cast<std::size_t>(args.slot_begins[row]) * WeightFloats;
        double total = 0, masked = 0;
        for (std::uint32_t i = 0; i < args.pair_counts[row]; ++i, slot += WeightFloats) {
            total += static_cast<double>(slot[SumWeight]);
            masked += static_cast<double>(slot[SumMasked]);
        }
        args.total[row] = total;
        args.masked[row] = masked;
    }
}
