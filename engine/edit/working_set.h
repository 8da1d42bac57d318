// The arrays an edit works on: unlabelled rows first and never written, labelled rows behind them with their Adam
// moments, anchors and generations.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/random.h"
#include "engine/edit/adam.h"
#include "engine/edit/common_colour.h"
#include "engine/edit/request.h"
#include "engine/raster/rasterizer.h"
#include "engine/scene/gaussian_set.h"

namespace gse::edit {

/// Anchor weights per generation (GSEditPro eq. 6; GaussianEditor's schedule, method 2.3).
class GenerationSchedule {
public:
    explicit GenerationSchedule(const EditRequest& request);
    /// Called once per densification; returns the generation number of the rows born in it.
    int advance();
    double weight(int generation) const { return weights_[static_cast<std::size_t>(generation)]; }
    int newest() const { return static_cast<int>(weights_.size()) - 1; }

private:
    double start_, growth_, cap_;
    std::vector<double> weights_;
};

/// How many rows a densification changed.
struct DensifyCount {
    std::size_t cloned = 0, split = 0, pruned = 0;
};

class WorkingSet {
public:
    /// `label` [N] bits of the base set; `seeds` (may be empty) are appended as labelled rows of generation 1 with
    /// origin -1: as if born in a densification, so free of anchors until the next (method A14).
    WorkingSet(const GaussianSet& base, std::span<const std::uint8_t> label, const GaussianData& seeds,
               const EditRequest& request, double extent);

    const GaussianData& rows() const { return rows_; }
    std::size_t first_row() const { return first_row_; }
    std::size_t labelled() const { return rows_.size() - first_row_; }

    /// Anchors, Adam on every attribute, clamps. Returns the anchor loss. Rows with a non-finite gradient are left as
    /// they are and counted.
    double step(const raster::Gradients& gradients, int iteration, const EditRequest& request);
    /// Adds the screen-space gradients of one iteration to the densification statistics.
    void collect(const raster::Gradients& gradients);
    /// Clone, split and prune (method 2.2); resets statistics and anchors.
    DensifyCount densify(const EditRequest& request, Random& random, bool may_grow);

    /// Drops rows that grew from seeds and whose `weight` [rows] is below `tau`, where `evidence` [rows] says that they were
    /// seen at all. Drops nothing when less than `least_left` of them would be left. Returns how many were dropped.
    std::size_t keep_added(std::span<const float> weight, std::span<const double> evidence, double tau, double least_left);

    /// Another label for the same base, in the middle of a run: rows that leave it become the base's again, rows that join it
    /// start as the base has them, with the change of colour that the label shares; rows that stay keep what they have
    /// become. Rows born in the run stay when the row they descend from does. Momentum and anchors begin anew.
    void relabel(const GaussianSet& base, std::span<const std::uint8_t> label, const EditRequest& request);

    std::size_t skipped_rows() const { return skipped_rows_; }
    const std::vector<std::int64_t>& origin() const { return origin_; }   // [labelled] base row or -1
    const std::vector<int>& generation() const { return generation_; }    // [labelled]
    const std::vector<std::uint32_t>& kept_rows() const { return unlabelled_; }   // base row of each unlabelled row

    /// The edited set in the base's row order: surviving rows in place, new ones at the end.
    struct Assembled {
        GaussianSet set;
        std::vector<std::int64_t> base_to_new;    // [N] row in `set` or -1
        std::vector<std::uint8_t> label;          // [rows of set]
        std::vector<int> generation;              // [rows of set]
    };
    Assembled assemble() const;

private:
    /// `origin`: the base row it is, -1 = born in the run; `ancestor`: the base row it descends from, -1 = a seed.
    void append(const GaussianData& from, std::size_t row, int generation, std::int64_t origin, std::int64_t ancestor);
    /// Replaces the infinities that are legal in a file (opacity 0 or 1, flat axes) by the guards' limits.
    void make_finite(std::size_t index);
    void keep_rows(const std::vector<std::uint8_t>& keep);
    void remember_anchor();
    /// Adds the anchor's gradient to gradient_; returns its loss.
    double add_anchor(std::span<const float> now, std::span<const float> anchor, double weight);
    std::span<const float> birth_sh_row(std::size_t index) const {
        return std::span<const float>(birth_sh_).subspan(index * rows_.sh_stride(), rows_.sh_stride());
    }
    std::span<float> tail(std::vector<float>& all, std::size_t stride) {
        return std::span<float>(all).subspan(first_row_ * stride);
    }
    void step_geometry(const raster::Gradients& gradients, int iteration, const EditRequest& request);
    void step_colour(const raster::Gradients& gradients, const EditRequest& request);
    void load_gradient(const std::vector<float>& gradient, std::size_t stride);
    void guard(const EditRequest& request);
    bool prunable(std::size_t index, const EditRequest& request) const;
    void find_bad_rows(const raster::Gradients& gradients);
    std::vector<std::size_t> densify_candidates(const EditRequest& request) const;
    void split(std::size_t index, int generation, Random& random);

    double extent_;
    std::size_t base_size_ = 0;
    std::size_t start_count_ = 0;
    bool adding_ = false;
    std::size_t first_row_ = 0;
    GaussianData rows_;
    std::vector<std::uint32_t> unlabelled_;
    std::vector<std::int64_t> origin_, ancestor_;
    std::vector<int> generation_;
    std::vector<float> birth_sh_;          // [labelled,K,3] colour when the row (or its ancestor) came to be
    std::vector<float> birth_scale_;       // [labelled] largest log-scale then
    GaussianData anchor_;                  // labelled rows at the last densification
    GenerationSchedule schedule_;
    AdamMoments position_, log_scale_, rotation_, opacity_, sh_;
    CommonColour common_;
    std::vector<double> gradient_sum_;
    std::vector<std::uint32_t> gradient_count_;
    std::size_t skipped_rows_ = 0;
    std::vector<std::uint8_t> bad_;
    std::vector<float> gradient_;          // scratch
    std::vector<float> row_factor_;        // [labelled]
    int steps_ = 0;
    double anchor_loss_ = 0;
};

}  // namespace gse::edit
