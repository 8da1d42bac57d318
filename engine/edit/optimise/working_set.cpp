// Optimiser steps on the labelled rows, corrected labels, and the state at one moment.
#include "engine/edit/optimise/working_set.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/check.h"

namespace gse::edit {
namespace {

constexpr float LargestLogit = 12.0f;     // METHOD.md, Optimiser
constexpr double SmallestScale = 1e-6;    // of the extent
constexpr double LargestScale = 0.5;      // of the extent
constexpr double CommonRate = 2;          // times the colour's rate: makes both kinds of change equally fast
constexpr float LargestGradient = 1e15f;  // larger ones overflow Adam's second moment

/// True when all values of the row are finite and of a size that can be worked with.
bool usable_row(std::span<const float> values, std::size_t row, std::size_t stride) {
    bool usable = true;
    for (std::size_t i = row * stride; i < (row + 1) * stride; ++i)
        usable &= std::abs(values[i]) <= LargestGradient;
    return usable;
}

/// False for rows that cannot be drawn (NaN, infinite place or colour): they are left as they are, like
/// unlabelled ones. Infinite opacity logits and flat axes are legal.
bool editable_row(const GaussianData& data, std::size_t row) {
    const auto legal_scale = [](float value) { return !std::isnan(value) && value < LargestGradient; };
    return usable_row(data.position, row, 3) && usable_row(data.rotation, row, 4) &&
           usable_row(data.sh, row, data.sh_stride()) && !std::isnan(data.opacity_logit[row]) &&
           legal_scale(data.log_scale[row * 3]) && legal_scale(data.log_scale[row * 3 + 1]) &&
           legal_scale(data.log_scale[row * 3 + 2]);
}

float largest(const std::vector<float>& values, std::size_t row) {
    return std::max({values[row * 3], values[row * 3 + 1], values[row * 3 + 2]});
}

}  // namespace

GenerationSchedule::GenerationSchedule(const LoopSettings& settings)
    : start_(settings.anchor_start), growth_(settings.anchor_growth),
      cap_(settings.anchor_cap), weights_{settings.anchor_first} {}

int GenerationSchedule::advance() {
    const int born = static_cast<int>(weights_.size());
    for (auto& weight : weights_) weight = std::min(cap_, weight * growth_);
    if (weights_.size() > 1) weights_.back() = start_;
    weights_.push_back(0);  // the newest generation is free
    return born;
}

WorkingSet::WorkingSet(const GaussianSet& base, const LoopSettings& settings, double extent)
    : extent_(extent), base_size_(base.size()), table_(base.sh_degree()), schedule_(settings) {}

WorkingSet::WorkingSet(const GaussianSet& base, std::span<const std::uint8_t> label,
                       const GaussianData& seeds, const LoopSettings& settings, double extent)
    : WorkingSet(base, settings, extent) {
    const GaussianData data = base.to_data();
    const auto editable = take_unlabelled(data, label);
    table_.reserve(static_cast<std::size_t>(std::count(editable.begin(), editable.end(), std::uint8_t{1})) +
                   seeds.size());
    for (std::size_t row = 0; row < base.size(); ++row)
        if (editable[row] != 0)
            append(data, row, 0, static_cast<std::int64_t>(row), static_cast<std::int64_t>(row));
    adding_ = seeds.size() > 0;
    const int seed_generation = adding_ ? schedule_.advance() : 0;
    for (std::size_t row = 0; row < seeds.size(); ++row) append(seeds, row, seed_generation, -1, OfSeed);
    start_count_ = labelled();
    common_ = CommonColour(table_.birth_sh, rows().sh_stride());
    remember_anchor();
}

std::vector<std::uint8_t> WorkingSet::take_unlabelled(const GaussianData& base,
                                                      std::span<const std::uint8_t> label) {
    GSE_CHECK_EQ(label.size(), base.size());
    std::vector<std::uint8_t> editable(base.size(), 0);
    visit_attributes([&](std::size_t stride, auto& array) { array.reserve(base.size() * stride); },
                     table_.rows);
    for (std::size_t row = 0; row < base.size(); ++row) {
        editable[row] = label[row] != 0 && editable_row(base, row) ? 1 : 0;
        if (editable[row] != 0) continue;
        table_.rows.append_row(base, row);
        unlabelled_.push_back(static_cast<std::uint32_t>(row));
    }
    table_.first_row = table_.rows.size();
    return editable;
}

void WorkingSet::append(const GaussianData& from, std::size_t row, int generation, std::int64_t origin,
                        std::int64_t ancestor) {
    table_.append_zero();
    const std::size_t index = labelled() - 1, sh = rows().sh_stride();
    set_attributes(index, from, row);
    table_.origin[index] = origin;
    table_.ancestor[index] = ancestor;
    table_.generation[index] = generation;
    std::copy_n(from.sh.begin() + static_cast<std::ptrdiff_t>(row * sh), sh,
                table_.birth_sh.begin() + static_cast<std::ptrdiff_t>(index * sh));
    table_.birth_scale[index] = largest(from.log_scale, row);
    make_finite(index);
}

void WorkingSet::append_child(std::size_t index, const GaussianData& row, int generation) {
    table_.append_carried(table_, index);
    const std::size_t child = labelled() - 1;
    set_attributes(child, row, 0);
    table_.origin[child] = -1;
    table_.generation[child] = generation;
    table_.birth_scale[child] = largest(row.log_scale, 0);
}

void WorkingSet::set_attributes(std::size_t index, const GaussianData& from, std::size_t row) {
    visit_attributes(
        [&](std::size_t stride, auto& to, const auto& values) {
            std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(row * stride), stride,
                        to.begin() + static_cast<std::ptrdiff_t>((first_row() + index) * stride));
        },
        table_.rows, from);
}

void WorkingSet::make_finite(std::size_t index) {
    const std::size_t row = first_row() + index;
    float& logit = table_.rows.opacity_logit[row];
    if (!std::isfinite(logit)) logit = logit > 0 ? LargestLogit : -LargestLogit;
    for (std::size_t i = row * 3; i < row * 3 + 3; ++i)
        if (!std::isfinite(table_.rows.log_scale[i]))
            table_.rows.log_scale[i] = static_cast<float>(std::log(SmallestScale * extent_));
}

void WorkingSet::remember_anchor() {
    visit_attributes(
        [&](std::size_t stride, const auto& all, auto& anchor) {
            anchor.assign(all.begin() + static_cast<std::ptrdiff_t>(first_row() * stride), all.end());
        },
        table_.rows, table_.anchor);
}

void WorkingSet::find_bad_rows(const raster::Gradients& gradients) {
    const std::size_t count = labelled();
    bad_.assign(count, 0);
    for (std::size_t i = 0; i < count; ++i) {
        const bool good = usable_row(gradients.position, i, 3) && usable_row(gradients.log_scale, i, 3) &&
                          usable_row(gradients.rotation, i, 4) && usable_row(gradients.opacity_logit, i, 1) &&
                          usable_row(gradients.sh, i, table_.rows.sh_stride());
        if (good) continue;
        bad_[i] = 1;
        ++skipped_rows_;
    }
}

void WorkingSet::load_gradient(std::span<const float> gradient, std::size_t stride) {
    gradient_.assign(gradient.begin(), gradient.end());
    for (std::size_t i = 0; i < bad_.size(); ++i)
        if (bad_[i] != 0)
            std::fill_n(gradient_.begin() + static_cast<std::ptrdiff_t>(i * stride), stride, 0.0f);
}

double WorkingSet::add_anchor(std::span<const float> now, std::span<const float> anchor, double weight) {
    if (weight == 0 || now.empty()) return 0;
    const std::size_t stride = now.size() / labelled();
    const double scale = weight / static_cast<double>(now.size());
    double loss = 0;
    for (std::size_t row = 0; row < labelled(); ++row) {
        const double factor = scale * schedule_.weight(table_.generation[row]);
        for (std::size_t i = row * stride; i < (row + 1) * stride; ++i) {
            const double difference = static_cast<double>(now[i]) - anchor[i];
            loss += factor * difference * difference;
            gradient_[i] += static_cast<float>(2 * factor * difference);
        }
    }
    return loss;
}

double WorkingSet::step(const raster::Gradients& gradients, int iteration, const LoopSettings& settings) {
    if (labelled() == 0) return 0;
    ++steps_;
    anchor_loss_ = 0;
    find_bad_rows(gradients);
    step_geometry(gradients, iteration, settings);
    step_colour(gradients, settings);
    guard(settings);
    return anchor_loss_;
}

void WorkingSet::step_geometry(const raster::Gradients& gradients, int iteration,
                               const LoopSettings& settings) {
    for (std::size_t i = 0; i < labelled(); ++i)
        table_.row_factor[i] =
            !adding_ && table_.origin[i] >= 0 ? static_cast<float>(settings.geometry_share) : 1.0f;
    const double progress =
        settings.iterations > 1 ? static_cast<double>(iteration) / (settings.iterations - 1) : 0;
    const double from = std::max(settings.rate_position, 1e-12),
                 to = std::max(settings.rate_position_end, 1e-12);
    const double position_rate =
        extent_ * std::exp(std::log(from) * (1 - progress) + std::log(to) * progress);
    const auto update = [&](std::vector<float>& all, std::span<const float> gradient, std::size_t stride,
                            const std::vector<float>& anchor, double anchor_weight, AdamMoments& moments,
                            double rate) {
        load_gradient(gradient, stride);
        const auto now = tail(all, stride);
        anchor_loss_ += add_anchor(now, anchor, anchor_weight);
        const std::array<double, 4> rates{rate, rate, rate, rate};
        adam_step(now, gradient_, moments, {std::span(rates).first(stride), table_.row_factor, steps_});
    };
    update(table_.rows.position, gradients.position, 3, table_.anchor.position, settings.anchor_position,
           table_.position, position_rate);
    update(table_.rows.log_scale, gradients.log_scale, 3, table_.anchor.log_scale, settings.anchor_scale,
           table_.log_scale, settings.rate_scale);
    update(table_.rows.rotation, gradients.rotation, 4, table_.anchor.rotation, settings.anchor_rotation,
           table_.rotation, settings.rate_rotation);
    update(table_.rows.opacity_logit, gradients.opacity_logit, 1, table_.anchor.opacity_logit,
           settings.anchor_opacity, table_.opacity, settings.rate_opacity);
}

void WorkingSet::step_colour(const raster::Gradients& gradients, const LoopSettings& settings) {
    const std::size_t stride = table_.rows.sh_stride();
    load_gradient(gradients.sh, stride);
    const auto now = tail(table_.rows.sh, stride);
    anchor_loss_ += add_anchor(now, table_.anchor.sh, settings.anchor_colour);
    if (settings.colour_coupling > 0)
        common_.step(gradient_, table_.birth_sh, now,
                     CommonRate * settings.rate_colour * settings.colour_coupling);
    const double own = 1 - settings.colour_coupling;
    std::array<double, 48> rates{};
    for (std::size_t i = 0; i < stride; ++i)
        rates[i] = own * (i < 3 ? settings.rate_colour : settings.rate_sh);
    adam_step(now, gradient_, table_.sh, {std::span(rates).first(stride), {}, steps_});
}

void WorkingSet::guard(const LoopSettings& settings) {
    const auto low = static_cast<float>(std::log(SmallestScale * extent_));
    const auto high = static_cast<float>(std::log(LargestScale * extent_));
    const auto aspect = static_cast<float>(std::log(settings.max_aspect));
    const auto scales = tail(table_.rows.log_scale, 3);
    const auto logits = tail(table_.rows.opacity_logit, 1);
    const std::size_t stride = table_.rows.sh_stride();
    const auto colours = tail(table_.rows.sh, stride);
    const auto black = static_cast<float>(sh_from_colour(0.0));
    for (std::size_t i = 0; i < labelled(); ++i) {
        for (std::size_t c = 0; c < 3;
             ++c)  // darker than black does not show, and would have to come all the way back
            colours[i * stride + c] =
                std::max(colours[i * stride + c], std::min(black, table_.birth_sh[i * stride + c]));
        logits[i] = std::clamp(logits[i], -LargestLogit, LargestLogit);
        float top = low;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            scales[i * 3 + axis] =
                std::clamp(scales[i * 3 + axis], low, std::max(high, table_.birth_scale[i]));
            top = std::max(top, scales[i * 3 + axis]);
        }
        if (table_.origin[i] >= 0 && table_.generation[i] == 0) continue;
        for (std::size_t axis = 0; axis < 3; ++axis)
            scales[i * 3 + axis] = std::max(scales[i * 3 + axis], top - aspect);
    }
}

void WorkingSet::collect(const raster::Gradients& gradients) {
    for (std::size_t i = 0; i < labelled(); ++i) {
        if (gradients.visible[i] == 0 || !std::isfinite(gradients.mean2d_norm[i])) continue;
        table_.gradient_sum[i] += gradients.mean2d_norm[i];
        ++table_.gradient_count[i];
    }
}

GaussianSpans WorkingSet::unlabelled() const {
    GaussianSpans rows = spans(table_.rows);
    rows.size = first_row();
    rows.position = rows.position.first(first_row() * 3);
    rows.log_scale = rows.log_scale.first(first_row() * 3);
    rows.rotation = rows.rotation.first(first_row() * 4);
    rows.opacity_logit = rows.opacity_logit.first(first_row());
    rows.sh = rows.sh.first(first_row() * table_.rows.sh_stride());
    return rows;
}

void WorkingSet::plant(const GaussianData& seeds, const GaussianData& hole_fill, double logit) {
    most_opaque_ = static_cast<float>(logit);
    std::vector<std::uint8_t> keep(labelled(), 1);
    for (std::size_t i = 0; i < keep.size(); ++i) keep[i] = table_.ancestor[i] >= 0 ? 1 : 0;
    table_.keep(keep);
    for (auto& value : tail(table_.rows.opacity_logit, 1)) value = std::min(value, most_opaque_);
    table_.reserve(seeds.size() + hole_fill.size());
    const int generation = schedule_.advance();
    for (std::size_t row = 0; row < seeds.size(); ++row) append(seeds, row, generation, -1, OfSeed);
    for (std::size_t row = 0; row < hole_fill.size(); ++row)
        append(hole_fill, row, generation, -1, OfHoleFill);
    for (auto* moments : {&table_.position, &table_.log_scale, &table_.rotation, &table_.opacity, &table_.sh})
        *moments = {};
    steps_ = 0;
    start_count_ = labelled();
    common_ = CommonColour(table_.birth_sh, rows().sh_stride());
    table_.clear_working();
    remember_anchor();
}

void WorkingSet::relabel(const GaussianSet& base, std::span<const std::uint8_t> label,
                         const LoopSettings& settings) {
    constexpr std::int64_t Unlabelled = -2, Removed = -1;
    std::vector<std::int64_t> index_now(base_size_, Removed);
    for (const auto row : unlabelled_) index_now[row] = Unlabelled;
    for (std::size_t i = 0; i < labelled(); ++i)
        if (table_.origin[i] >= 0)
            index_now[static_cast<std::size_t>(table_.origin[i])] = static_cast<std::int64_t>(i);
    WorkingSet fresh(base, settings, extent_);
    const GaussianData data = base.to_data();
    const auto editable = fresh.take_unlabelled(data, label);
    const std::size_t sh = rows().sh_stride();
    for (std::size_t row = 0; row < base_size_; ++row) {
        if (editable[row] == 0 || index_now[row] == Removed)
            continue;  // what the run has removed stays removed
        if (index_now[row] >= 0) {
            fresh.table_.append_carried(table_, static_cast<std::size_t>(index_now[row]));
            continue;
        }
        fresh.append(data, row, 0, static_cast<std::int64_t>(row), static_cast<std::int64_t>(row));
        const std::size_t joined = fresh.labelled() - 1;  // takes on what the others have learned
        float& logit = fresh.table_.rows.opacity_logit[fresh.first_row() + joined];
        logit = std::min(logit, most_opaque_);
        const auto birth = std::span<const float>(fresh.table_.birth_sh).subspan(joined * sh, sh);
        if (!adding_) common_.apply(birth, fresh.tail(fresh.table_.rows.sh, sh).subspan(joined * sh, sh));
    }
    for (std::size_t i = 0; i < labelled(); ++i) {
        const std::int64_t ancestor = table_.ancestor[i];
        const bool stays = ancestor < 0 || label[static_cast<std::size_t>(ancestor)] != 0;
        if (table_.origin[i] < 0 && stays) fresh.table_.append_carried(table_, i);
    }
    fresh.schedule_ = schedule_;
    fresh.common_ = std::move(common_);
    fresh.adding_ = adding_;
    fresh.most_opaque_ = most_opaque_;
    fresh.start_count_ = std::max(start_count_, fresh.labelled());
    fresh.skipped_rows_ = skipped_rows_;
    fresh.remember_anchor();
    *this = std::move(fresh);
}

void WorkingSet::resume(const GaussianSet& base, const EditSnapshot& start) {
    GSE_CHECK_EQ(start.base.size(), base_size_);
    GSE_CHECK_EQ(start.base.sh_degree(), base.sh_degree());
    constexpr std::int64_t Untouched = -2, Removed = -1;
    const SnapshotRows& reached = *start.rows;
    std::vector<std::int64_t> index_then(base_size_, Untouched);
    for (const auto row : reached.removed) index_then[row] = Removed;
    for (std::size_t i = 0; i < reached.kept.size(); ++i)
        index_then[reached.kept[i]] = static_cast<std::int64_t>(i);
    std::vector<std::uint8_t> keep(labelled(), 0);
    for (std::size_t i = 0; i < keep.size(); ++i) {
        if (table_.origin[i] < 0) continue;  // a seed's present state is among the born rows
        const std::int64_t then = index_then[static_cast<std::size_t>(table_.origin[i])];
        keep[i] = then == Removed ? 0 : 1;
        if (then < 0) continue;
        set_attributes(i, reached.rows, static_cast<std::size_t>(then));
        table_.generation[i] = reached.generation[static_cast<std::size_t>(then)];
        make_finite(i);
    }
    std::vector<std::uint8_t> may_change(base_size_, 1);
    for (const auto row : unlabelled_) may_change[row] = 0;
    table_.keep(keep);
    const std::size_t sh = rows().sh_stride();
    for (std::size_t i = 0; i < reached.ancestor.size(); ++i) {
        const std::int64_t ancestor = reached.ancestor[i];
        if (ancestor >= 0 && may_change[static_cast<std::size_t>(ancestor)] == 0) continue;
        const std::size_t row = reached.kept.size() + i;
        append(reached.rows, row, reached.generation[row], -1, ancestor);
        if (ancestor >= 0)
            std::copy_n(&base.sh()[static_cast<std::size_t>(ancestor) * sh], sh,
                        &table_.birth_sh[table_.birth_sh.size() - sh]);
    }
    for (const int generation : table_.generation)
        while (schedule_.newest() < generation) schedule_.advance();
    if (adding_) common_ = CommonColour(table_.birth_sh, sh);
    remember_anchor();
}

void WorkingSet::end_steps() {
    const int degree = rows().sh_degree;
    table_.anchor = {};
    table_.anchor.sh_degree = degree;
    for (AdamMoments* moments :
         {&table_.position, &table_.log_scale, &table_.rotation, &table_.opacity, &table_.sh})
        *moments = {};
    for (std::vector<float>* array : {&table_.birth_sh, &gradient_}) *array = {};
}

EditSnapshot WorkingSet::snapshot(const GaussianSet& base, int iteration) const {
    GSE_CHECK_EQ(base.size(), base_size_);
    SnapshotRows now;
    now.rows.sh_degree = rows().sh_degree;
    visit_attributes(
        [&](std::size_t stride, const auto& all, auto& to) {
            to.assign(all.begin() + static_cast<std::ptrdiff_t>(first_row() * stride), all.end());
        },
        rows(), now.rows);
    const auto born =
        std::find_if(table_.origin.begin(), table_.origin.end(), [](auto row) { return row < 0; });
    now.kept.assign(table_.origin.begin(), born);
    now.ancestor.assign(table_.ancestor.begin() + (born - table_.origin.begin()), table_.ancestor.end());
    now.generation = table_.generation;
    // Rows are only ever added at the end, those of the base before any that are born.
    GSE_CHECK(std::is_sorted(now.kept.begin(), now.kept.end()));
    GSE_CHECK(std::all_of(born, table_.origin.end(), [](auto row) { return row < 0; }));
    std::vector<std::uint8_t> gone(base_size_, 1);
    for (const auto row : unlabelled_) gone[row] = 0;
    for (const auto row : now.kept) gone[row] = 0;
    for (std::size_t row = 0; row < base_size_; ++row)
        if (gone[row] != 0) now.removed.push_back(static_cast<std::uint32_t>(row));
    now.removed.shrink_to_fit();
    return {base, std::make_shared<const SnapshotRows>(std::move(now)), iteration};
}

}  // namespace gse::edit
