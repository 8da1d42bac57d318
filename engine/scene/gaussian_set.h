// The scene: an immutable structure of arrays. Each attribute is shared on its own, so that an edit copies
// only its changes.
#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "engine/math/sh.h"
#include "engine/math/vec.h"

namespace gse {

/// Plain mutable arrays of N Gaussians, for readers, generators and the edit loop. Raw (pre-activation)
/// values as in a 3DGS file.
struct GaussianData {
    int sh_degree = 0;
    std::vector<float> position;       // [N,3] world units
    std::vector<float> log_scale;      // [N,3] natural log of the standard deviation
    std::vector<float> rotation;       // [N,4] (w,x,y,z), not normalised
    std::vector<float> opacity_logit;  // [N]
    std::vector<float> sh;             // [N,(d+1)^2,3], coefficient-major, DC first

    std::size_t size() const { return opacity_logit.size(); }
    std::size_t sh_stride() const { return static_cast<std::size_t>(sh_coefficient_count(sh_degree)) * 3; }
    /// Sets every array to n rows (new rows are zero).
    void resize(std::size_t n);
    /// Appends row `row` of `other`, which must have this SH degree.
    void append_row(const GaussianData& other, std::size_t row);
};

/// Cached check of coefficients that never change: all are numbers of a size that gives every direction a
/// finite colour.
enum class ColoursKnown : signed char { NotYet, Finite, NotAll };
using ColourMemo = std::atomic<ColoursKnown>;

/// Read-only view of N Gaussians for the rasterizer. Its maker keeps the arrays alive.
struct GaussianSpans {
    std::size_t size = 0;
    int sh_degree = 0;
    std::span<const float> position, log_scale, rotation, opacity_logit, sh;
    ColourMemo* colours_known = nullptr;  // of `sh`; null where it may change
};

GaussianSpans spans(const GaussianData& data);

/// The shared arrays of a set.
struct GaussianBuffers {
    using Buffer = std::shared_ptr<const std::vector<float>>;
    int sh_degree = 0;
    Buffer position, log_scale, rotation, opacity_logit, sh;
};

/// Immutable set; copies share their arrays.
class GaussianSet {
public:
    using Buffer = GaussianBuffers::Buffer;

    GaussianSet();
    /// Takes the arrays over. Aborts if their lengths disagree.
    explicit GaussianSet(GaussianData data);
    /// Shares these arrays (none may be null). Aborts if their lengths disagree.
    explicit GaussianSet(GaussianBuffers buffers);

    std::size_t size() const { return opacity_logit_->size(); }
    bool empty() const { return size() == 0; }
    int sh_degree() const { return sh_degree_; }
    std::span<const float> position() const { return *position_; }
    std::span<const float> log_scale() const { return *log_scale_; }
    std::span<const float> rotation() const { return *rotation_; }
    std::span<const float> opacity_logit() const { return *opacity_logit_; }
    std::span<const float> sh() const { return *sh_; }

    GaussianSpans spans() const;
    GaussianBuffers buffers() const {
        return {sh_degree_, position_, log_scale_, rotation_, opacity_logit_, sh_};
    }
    /// True when both sets share all arrays. Equal values in other arrays do not count.
    bool shares_all_with(const GaussianSet& other) const {
        return sh_degree_ == other.sh_degree_ && position_ == other.position_ &&
               log_scale_ == other.log_scale_ && rotation_ == other.rotation_ &&
               opacity_logit_ == other.opacity_logit_ && sh_ == other.sh_;
    }
    /// Deep copy for changing.
    GaussianData to_data() const;
    /// Rows with keep[row] != 0, in order.
    GaussianSet filtered(std::span<const unsigned char> keep) const;
    /// Bytes of all attributes.
    std::size_t byte_size() const;

private:
    void check_lengths() const;

    int sh_degree_ = 0;
    Buffer position_, log_scale_, rotation_, opacity_logit_, sh_;
    std::shared_ptr<ColourMemo> colours_known_ = std::make_shared<ColourMemo>(ColoursKnown::NotYet);
};

}  // namespace gse
