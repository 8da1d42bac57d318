// The arrays an edit works on: unlabelled rows first and never written, labelled rows behind them with their
// Adam moments, anchors and generations.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "engine/base/random.h"
#include "engine/edit/interfaces/snapshot.h"
#include "engine/edit/optimise/common_colour.h"
#include "engine/edit/optimise/row_table.h"
#include "engine/edit/request/request.h"
#include "engine/raster/rasterizer.h"
#include "engine/scene/gaussian_set.h"

namespace gse::edit {

/// Anchor weights per generation (GSEditPro eq. 6; GaussianEditor's schedule; METHOD.md, Anchors).
class GenerationSchedule {
public:
    explicit GenerationSchedule(const LoopSettings& settings);
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
    /// Working set of `label` [N], bits of the base set. `seeds` (may be empty) are appended as labelled rows
    /// of generation 1 with origin -1. Like rows born in a densification, they are free of anchors until the
    /// next.
    WorkingSet(const GaussianSet& base, std::span<const std::uint8_t> label, const GaussianData& seeds,
               const LoopSettings& settings, double extent);

    const RowTable& table() const { return table_; }
    const GaussianData& rows() const { return table_.rows; }
    /// The rows that never change, alone.
    GaussianSpans unlabelled() const;
    std::size_t first_row() const { return table_.first_row; }
    std::size_t labelled() const { return table_.labelled(); }

    /// Anchors, Adam on every attribute, clamps. Returns the anchor loss. Rows with a non-finite gradient get
    /// none in this step, like rows that no pixel shows, and are counted.
    double step(const raster::Gradients& gradients, int iteration, const LoopSettings& settings);
    /// Adds the screen-space gradients of one iteration to the densification statistics.
    void collect(const raster::Gradients& gradients);
    /// Clone, split and prune (METHOD.md, Densification). Resets statistics and anchors.
    DensifyCount densify(const LoopSettings& settings, Random& random, bool may_grow);

    /// Drops rows that grew from seeds and whose `weight` [rows] is below `least_weight`, where `evidence`
    /// [rows] says that they were seen at all. Drops nothing when less than `least_left` of them would be
    /// left. Returns how many were dropped.
    std::size_t keep_added(std::span<const float> weight, std::span<const double> evidence,
                           double least_weight, double least_left);

    /// Begins an object of another shape. Rows of the base fade to `logit` where they are more opaque, and so
    /// do those that a later label brings. Rows that grew from seeds go. `seeds`, and `hole_fill` for
    /// surfaces that the old object hid, take their place. Momentum, statistics and anchors begin anew.
    void plant(const GaussianData& seeds, const GaussianData& hole_fill, double logit);

    /// Takes another label for this base, in the middle of a run. Rows that leave it become the base's again.
    /// Rows that join it start as in the base, with the change of colour that the label shares. Rows that
    /// stay keep their values. Rows born in the run stay when the row they descend from does. Momentum and
    /// anchors begin anew.
    void relabel(const GaussianSet& base, std::span<const std::uint8_t> label, const LoopSettings& settings);

    /// Takes up a state that an earlier run over the same base has reached, for the rows of this set's label.
    /// Momentum and anchors begin there.
    void resume(const GaussianSet& base, const EditSnapshot& start);

    /// No step() follows: anchors, moments and scratch go. What the rows are stays.
    void end_steps();

    std::size_t skipped_rows() const { return skipped_rows_; }

    /// The state now. Rows outside the label are those of `base`, which may hold what cannot be drawn (see
    /// drawable).
    EditSnapshot snapshot(const GaussianSet& base, int iteration) const;

private:
    /// Without any row.
    WorkingSet(const GaussianSet& base, const LoopSettings& settings, double extent);
    /// Appends the rows of `base` that may not change: those without a label, and those that cannot be drawn.
    /// Returns 1 for each of the others.
    std::vector<std::uint8_t> take_unlabelled(const GaussianData& base, std::span<const std::uint8_t> label);
    /// Appends a labelled row. `origin`: the base row it is, -1 = born in the run; `ancestor`: the base row
    /// it descends from, -1 = a seed.
    void append(const GaussianData& from, std::size_t row, int generation, std::int64_t origin,
                std::int64_t ancestor);
    /// Appends `row` (one row) as born of labelled row `index`.
    void append_child(std::size_t index, const GaussianData& row, int generation);
    /// Gives labelled row `index` the attributes of row `row` of `from`.
    void set_attributes(std::size_t index, const GaussianData& from, std::size_t row);
    /// Replaces the infinities that are legal in a file (opacity 0 or 1, flat axes) by the guards' limits.
    void make_finite(std::size_t index);
    void remember_anchor();
    /// Adds the anchor's gradient to gradient_; returns its loss.
    double add_anchor(std::span<const float> now, std::span<const float> anchor, double weight);
    std::span<float> tail(std::vector<float>& all, std::size_t stride) {
        return std::span<float>(all).subspan(table_.first_row * stride);
    }
    void step_geometry(const raster::Gradients& gradients, int iteration, const LoopSettings& settings);
    void step_colour(const raster::Gradients& gradients, const LoopSettings& settings);
    void load_gradient(std::span<const float> gradient, std::size_t stride);
    void guard(const LoopSettings& settings);
    /// Size of the labelled row, as a logarithm.
    float largest_scale(std::size_t index) const;
    bool prunable(std::size_t index, const LoopSettings& settings) const;
    void find_bad_rows(const raster::Gradients& gradients);
    std::vector<std::size_t> densify_candidates(const LoopSettings& settings) const;
    void split(std::size_t index, int generation, Random& random);

    double extent_;
    std::size_t base_size_ = 0;
    std::size_t start_count_ = 0;
    bool adding_ = false;
    // Logit that rows of the base have at most when they join.
    float most_opaque_ = std::numeric_limits<float>::infinity();
    RowTable table_;
    std::vector<std::uint32_t> unlabelled_;  // base row of each unlabelled row, ascending
    GenerationSchedule schedule_;
    CommonColour common_;
    std::size_t skipped_rows_ = 0;
    std::vector<std::uint8_t> bad_;  // scratch
    std::vector<float> gradient_;    // scratch
    int steps_ = 0;
    double anchor_loss_ = 0;
};

}  // namespace gse::edit
