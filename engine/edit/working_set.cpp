// Optimiser steps on the labelled rows, and their assembly into an edited set.
#include "engine/edit/working_set.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/check.h"

namespace gse::edit {
namespace {

constexpr float LargestLogit = 12.0f;            // method F17
constexpr double SmallestScale = 1e-6;           // of the extent
constexpr double LargestScale = 0.5;             // of the extent
constexpr double CommonRate = 2;                 // times the colour's rate: makes both kinds of change equally fast
constexpr float LargestGradient = 1e15f;         // larger ones overflow Adam's second moment

/// True when all values of the row are finite and of a size that can be worked with.
bool usable_row(const std::vector<float>& values, std::size_t row, std::size_t stride) {
    bool usable = true;
    for (std::size_t i = row * stride; i < (row + 1) * stride; ++i) usable &= std::abs(values[i]) <= LargestGradient;
    return usable;
}

/// False for rows that cannot be drawn (NaN, infinite place or colour): they are left as they are, like unlabelled ones.
/// Infinite opacity logits and flat axes are legal.
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

GaussianData reserve_like(const GaussianSet& base) {
    GaussianData data;
    data.sh_degree = base.sh_degree();
    data.position.reserve(base.position().size());
    data.log_scale.reserve(base.log_scale().size());
    data.rotation.reserve(base.rotation().size());
    data.opacity_logit.reserve(base.opacity_logit().size());
    data.sh.reserve(base.sh().size());
    return data;
}

}  // namespace

GenerationSchedule::GenerationSchedule(const EditRequest& request)
    : start_(request.anchor_start),
      growth_(request.anchor_growth),
      cap_(request.anchor_cap),
      weights_{request.anchor_first} {}

int GenerationSchedule::advance() {
    const int born = static_cast<int>(weights_.size());
    for (auto& weight : weights_) weight = std::min(cap_, weight * growth_);
    if (weights_.size() > 1) weights_.back() = start_;
    weights_.push_back(0);   // the newest generation is free
    return born;
}

WorkingSet::WorkingSet(const GaussianSet& base, std::span<const std::uint8_t> label, const GaussianData& seeds,
                       const EditRequest& request, double extent)
    : extent_(extent), base_size_(base.size()), rows_(reserve_like(base)), schedule_(request) {
    GSE_CHECK_EQ(label.size(), base.size());
    const GaussianData data = base.to_data();
    for (std::size_t row = 0; row < base.size(); ++row) {
        if (label[row] != 0 && editable_row(data, row)) continue;
        rows_.append_row(data, row);
        unlabelled_.push_back(static_cast<std::uint32_t>(row));
    }
    first_row_ = rows_.size();
    for (std::size_t row = 0; row < base.size(); ++row)
        if (label[row] != 0 && editable_row(data, row)) append(data, row, 0, static_cast<std::int64_t>(row), static_cast<std::int64_t>(row));
    adding_ = seeds.size() > 0;
    const int seed_generation = adding_ ? schedule_.advance() : 0;
    for (std::size_t row = 0; row < seeds.size(); ++row) append(seeds, row, seed_generation, -1, -1);
    start_count_ = labelled();
    common_ = CommonColour(birth_sh_, rows_.sh_stride());
    remember_anchor();
}

void WorkingSet::append(const GaussianData& from, std::size_t row, int generation, std::int64_t origin,
                        std::int64_t ancestor) {
    rows_.append_row(from, row);
    origin_.push_back(origin);
    ancestor_.push_back(ancestor);
    generation_.push_back(generation);
    const std::size_t stride = rows_.sh_stride();
    birth_sh_.insert(birth_sh_.end(), from.sh.begin() + static_cast<std::ptrdiff_t>(row * stride),
                     from.sh.begin() + static_cast<std::ptrdiff_t>((row + 1) * stride));
    birth_scale_.push_back(largest(from.log_scale, row));
    make_finite(origin_.size() - 1);
    gradient_sum_.push_back(0);
    gradient_count_.push_back(0);
}

void WorkingSet::make_finite(std::size_t index) {
    const std::size_t row = first_row_ + index;
    float& logit = rows_.opacity_logit[row];
    if (!std::isfinite(logit)) logit = logit > 0 ? LargestLogit : -LargestLogit;
    for (std::size_t i = row * 3; i < row * 3 + 3; ++i)
        if (!std::isfinite(rows_.log_scale[i])) rows_.log_scale[i] = static_cast<float>(std::log(SmallestScale * extent_));
}

void WorkingSet::remember_anchor() {
    const auto copy = [&](const std::vector<float>& all, std::size_t stride, std::vector<float>& to) {
        to.assign(all.begin() + static_cast<std::ptrdiff_t>(first_row_ * stride), all.end());
    };
    anchor_.sh_degree = rows_.sh_degree;
    copy(rows_.position, 3, anchor_.position);
    copy(rows_.log_scale, 3, anchor_.log_scale);
    copy(rows_.rotation, 4, anchor_.rotation);
    copy(rows_.opacity_logit, 1, anchor_.opacity_logit);
    copy(rows_.sh, rows_.sh_stride(), anchor_.sh);
    row_factor_.resize(labelled());
}

void WorkingSet::find_bad_rows(const raster::Gradients& gradients) {
    const std::size_t count = labelled();
    bad_.assign(count, 0);
    for (std::size_t i = 0; i < count; ++i) {
        const bool good = usable_row(gradients.position, i, 3) && usable_row(gradients.log_scale, i, 3) &&
                          usable_row(gradients.rotation, i, 4) && usable_row(gradients.opacity_logit, i, 1) &&
                          usable_row(gradients.sh, i, rows_.sh_stride());
        if (good) continue;
        bad_[i] = 1;
        ++skipped_rows_;
    }
}

void WorkingSet::load_gradient(const std::vector<float>& gradient, std::size_t stride) {
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
        const double factor = scale * schedule_.weight(generation_[row]);
        for (std::size_t i = row * stride; i < (row + 1) * stride; ++i) {
            const double difference = static_cast<double>(now[i]) - anchor[i];
            loss += factor * difference * difference;
            gradient_[i] += static_cast<float>(2 * factor * difference);
        }
    }
    return loss;
}

double WorkingSet::step(const raster::Gradients& gradients, int iteration, const EditRequest& request) {
    if (labelled() == 0) return 0;
    ++steps_;
    anchor_loss_ = 0;
    find_bad_rows(gradients);
    step_geometry(gradients, iteration, request);
    step_colour(gradients, request);
    guard(request);
    return anchor_loss_;
}

void WorkingSet::step_geometry(const raster::Gradients& gradients, int iteration, const EditRequest& request) {
    for (std::size_t i = 0; i < labelled(); ++i)
        row_factor_[i] = !adding_ && origin_[i] >= 0 ? static_cast<float>(request.geometry_share) : 1.0f;
    const double progress = request.iterations > 1 ? static_cast<double>(iteration) / (request.iterations - 1) : 0;
    const double from = std::max(request.rate_position, 1e-12), to = std::max(request.rate_position_end, 1e-12);
    const double position_rate = extent_ * std::exp(std::log(from) * (1 - progress) + std::log(to) * progress);
    const auto update = [&](std::vector<float>& all, const std::vector<float>& gradient, std::size_t stride,
                            const std::vector<float>& anchor, double anchor_weight, AdamMoments& moments, double rate) {
        load_gradient(gradient, stride);
        const auto now = tail(all, stride);
        anchor_loss_ += add_anchor(now, anchor, anchor_weight);
        const std::array<double, 4> rates{rate, rate, rate, rate};
        adam_step(now, gradient_, moments, {std::span(rates).first(stride), row_factor_, steps_});
    };
    update(rows_.position, gradients.position, 3, anchor_.position, request.anchor_position, position_, position_rate);
    update(rows_.log_scale, gradients.log_scale, 3, anchor_.log_scale, request.anchor_scale, log_scale_,
           request.rate_scale);
    update(rows_.rotation, gradients.rotation, 4, anchor_.rotation, request.anchor_rotation, rotation_,
           request.rate_rotation);
    update(rows_.opacity_logit, gradients.opacity_logit, 1, anchor_.opacity_logit, request.anchor_opacity, opacity_,
           request.rate_opacity);
}

void WorkingSet::step_colour(const raster::Gradients& gradients, const EditRequest& request) {
    const std::size_t stride = rows_.sh_stride();
    load_gradient(gradients.sh, stride);
    const auto now = tail(rows_.sh, stride);
    anchor_loss_ += add_anchor(now, anchor_.sh, request.anchor_colour);
    if (request.colour_coupling > 0)
        common_.step(gradient_, birth_sh_, now, CommonRate * request.rate_colour * request.colour_coupling);
    const double own = 1 - request.colour_coupling;
    std::array<double, 48> rates{};
    for (std::size_t i = 0; i < stride; ++i) rates[i] = own * (i < 3 ? request.rate_colour : request.rate_sh);
    adam_step(now, gradient_, sh_, {std::span(rates).first(stride), {}, steps_});
}

void WorkingSet::guard(const EditRequest& request) {
    const auto low = static_cast<float>(std::log(SmallestScale * extent_));
    const auto high = static_cast<float>(std::log(LargestScale * extent_));
    const auto aspect = static_cast<float>(std::log(request.max_aspect));
    const auto scales = tail(rows_.log_scale, 3);
    const auto logits = tail(rows_.opacity_logit, 1);
    const std::size_t stride = rows_.sh_stride();
    const auto colours = tail(rows_.sh, stride);
    const auto black = static_cast<float>(sh_from_colour(0.0));
    for (std::size_t i = 0; i < labelled(); ++i) {
        for (std::size_t c = 0; c < 3; ++c)   // darker than black does not show, and would have to come all the way back
            colours[i * stride + c] = std::max(colours[i * stride + c], std::min(black, birth_sh_[i * stride + c]));
        logits[i] = std::clamp(logits[i], -LargestLogit, LargestLogit);
        float top = low;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            scales[i * 3 + axis] = std::clamp(scales[i * 3 + axis], low, std::max(high, birth_scale_[i]));
            top = std::max(top, scales[i * 3 + axis]);
        }
        if (origin_[i] >= 0 && generation_[i] == 0) continue;
        for (std::size_t axis = 0; axis < 3; ++axis)
            scales[i * 3 + axis] = std::max(scales[i * 3 + axis], top - aspect);
    }
}

void WorkingSet::collect(const raster::Gradients& gradients) {
    for (std::size_t i = 0; i < labelled(); ++i) {
        if (gradients.visible[i] == 0 || !std::isfinite(gradients.mean2d_norm[i])) continue;
        gradient_sum_[i] += gradients.mean2d_norm[i];
        ++gradient_count_[i];
    }
}

void WorkingSet::relabel(const GaussianSet& base, std::span<const std::uint8_t> label, const EditRequest& request) {
    WorkingSet fresh(base, label, {}, request, extent_);
    std::vector<std::int64_t> old_index(base_size_, -1);
    std::vector<std::uint8_t> was_labelled(base_size_, 1);
    for (const auto row : unlabelled_) was_labelled[row] = 0;
    for (std::size_t i = 0; i < origin_.size(); ++i)
        if (origin_[i] >= 0) old_index[static_cast<std::size_t>(origin_[i])] = static_cast<std::int64_t>(i);
    // Rows that the run has removed stay removed while their label stays.
    std::vector<std::uint8_t> keep(fresh.labelled(), 1);
    for (std::size_t i = 0; i < keep.size(); ++i) {
        const auto row = static_cast<std::size_t>(fresh.origin_[i]);
        keep[i] = was_labelled[row] == 0 || old_index[row] >= 0 ? 1 : 0;
    }
    fresh.keep_rows(keep);
    const std::size_t sh = rows_.sh_stride();
    for (std::size_t i = 0; i < fresh.labelled(); ++i) {
        const auto old = old_index[static_cast<std::size_t>(fresh.origin_[i])];
        if (old < 0) {   // what joins takes on what the others have learned
            if (!adding_) common_.apply(fresh.birth_sh_row(i), fresh.tail(fresh.rows_.sh, sh).subspan(i * sh, sh));
            continue;
        }
        const std::size_t from = first_row_ + static_cast<std::size_t>(old), to = fresh.first_row_ + i;
        std::copy_n(&rows_.position[from * 3], 3, &fresh.rows_.position[to * 3]);
        std::copy_n(&rows_.log_scale[from * 3], 3, &fresh.rows_.log_scale[to * 3]);
        std::copy_n(&rows_.rotation[from * 4], 4, &fresh.rows_.rotation[to * 4]);
        fresh.rows_.opacity_logit[to] = rows_.opacity_logit[from];
        std::copy_n(&rows_.sh[from * sh], sh, &fresh.rows_.sh[to * sh]);
        fresh.generation_[i] = generation_[static_cast<std::size_t>(old)];
    }
    for (std::size_t i = 0; i < origin_.size(); ++i) {
        const bool stays = ancestor_[i] < 0 || label[static_cast<std::size_t>(ancestor_[i])] != 0;
        if (origin_[i] < 0 && stays) fresh.append(rows_, first_row_ + i, generation_[i], -1, ancestor_[i]);
    }
    fresh.schedule_ = schedule_;
    fresh.common_ = std::move(common_);
    fresh.adding_ = adding_;
    fresh.start_count_ = std::max(start_count_, fresh.labelled());
    fresh.skipped_rows_ = skipped_rows_;
    fresh.remember_anchor();
    *this = std::move(fresh);
}

WorkingSet::Assembled WorkingSet::assemble() const {
    Assembled result;
    std::vector<std::int64_t> base_to_work(base_size_, -1);
    for (std::size_t i = 0; i < unlabelled_.size(); ++i) base_to_work[unlabelled_[i]] = static_cast<std::int64_t>(i);
    for (std::size_t i = 0; i < origin_.size(); ++i)
        if (origin_[i] >= 0) base_to_work[static_cast<std::size_t>(origin_[i])] = static_cast<std::int64_t>(first_row_ + i);
    GaussianData data;
    data.sh_degree = rows_.sh_degree;
    const auto add = [&](std::size_t work_row) {
        data.append_row(rows_, work_row);
        const bool labelled_row = work_row >= first_row_;
        result.label.push_back(labelled_row ? 1 : 0);
        result.generation.push_back(labelled_row ? generation_[work_row - first_row_] : 0);
    };
    result.base_to_new.assign(base_size_, -1);
    for (std::size_t row = 0; row < base_size_; ++row) {
        if (base_to_work[row] < 0) continue;
        result.base_to_new[row] = static_cast<std::int64_t>(data.size());
        add(static_cast<std::size_t>(base_to_work[row]));
    }
    for (std::size_t i = 0; i < origin_.size(); ++i)
        if (origin_[i] < 0) add(first_row_ + i);
    result.set = GaussianSet(std::move(data));
    return result;
}

}  // namespace gse::edit
