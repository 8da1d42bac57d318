// Differentiable Gaussian rasterizer: the 3DGS image formation (Kerbl et al. 2023, EWA splatting), forward,
// backward and per-Gaussian contributions. A double-precision reference and fast float versions share one
// interface.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/base/aligned.h"
#include "engine/base/image.h"
#include "engine/base/thread_pool.h"
#include "engine/math/camera.h"
#include "engine/scene/gaussian_set.h"

namespace gse::raster {

/// Image formation settings. The defaults are the program's.
struct Settings {
    float near_plane = 0;                // along the view; 0 = follows scene and camera (scene/depth_range.h)
    float far_plane = 0;                 // 0 = nothing is too far
    float blur_px2 = 0.3f;               // added to the diagonal of the projected covariance
    bool antialiased = false;            // opacity compensation sqrt(det / det_blurred)
    int sh_degree = 3;                   // highest degree used; the scene's own if lower
    float negative_colour_slope = 0.0f;  // gradient of the clamp at 0 below 0 (0 = exact; 0.01 in training)
    std::array<float, 3> background{0, 0, 0};

    bool operator==(const Settings&) const = default;
};

/// Settings with both planes given. Planes that follow scene and camera take their values for these.
Settings with_depth_range(const Settings& settings, const GaussianSpans& gaussians, const Camera& camera);

struct ForwardOutput {
    Image colour;                       // [H,W,3]
    Image alpha;                        // [H,W,1] 1 - final transmittance
    Image depth;                        // [H,W,1] sum of alpha T z, not normalised
    std::vector<std::int32_t> blended;  // [H*W] Gaussians blended in the pixel
    // Work, not result; the last two by the fast version in full pictures only.
    std::size_t pairs = 0;          // tile-Gaussian pairs looked at
    std::size_t pairs_reached = 0;  // of them, those in front of where the light of their tile ends
    // Pairs of 4x4 block and Gaussian blended, in front of where the light of the block ends.
    std::size_t block_pairs = 0;
    std::size_t dropped_rows = 0;  // not drawn because a value is NaN or infinite where that means nothing
};

/// Gradients of the rows [first_row, N): index 0 of every array belongs to first_row.
struct Gradients {
    LineFloats position;       // [M,3]
    LineFloats log_scale;      // [M,3]
    LineFloats rotation;       // [M,4] through the normalisation
    LineFloats opacity_logit;  // [M]
    LineFloats sh;             // [M,K,3]
    LineFloats mean2d_norm;  // [M] |dL/d(mean2d)| in NDC units (pixel gradient x W/2, H/2), for densification
    std::vector<std::uint8_t> visible;  // [M] 1 where the row was blended into at least one pixel
};

class ViewSession;

/// A rasterizer keeps its scratch memory between calls. Use one object per thread; nothing is allocated once
/// warm. Results are bit-identical for every number of threads and from call to call. Those of two
/// instruction sets differ in the last digits (`gseditpro-lab bench stability`, tests/stress/stability).
class Rasterizer {
public:
    virtual ~Rasterizer() = default;

    /// Renders. Keeps the inputs of backward(): `gaussians` must stay alive and unchanged until then.
    virtual void forward(const GaussianSpans& gaussians, const Camera& camera, const Settings& settings,
                         ForwardOutput& output) = 0;

    /// Gradient of sum(colour * d_colour) + sum(alpha * d_alpha) of the last forward(), for rows >=
    /// first_row. d_alpha may be empty. Rows that were not drawn get exact zeros.
    virtual void backward(const Image& d_colour, const Image& d_alpha, std::size_t first_row,
                          Gradients& output) = 0;

    /// Adds to masked[i] the sum over pixels of alpha T mask, to total[i] the sum of alpha T, for one view.
    /// Both are double accumulators of length N. `mask` is [H,W,1]. For back-projection (METHOD.md, Label
    /// voting).
    virtual void contributions(const GaussianSpans& gaussians, const Camera& camera, const Settings& settings,
                               const Image& mask, std::span<double> masked, std::span<double> total) = 0;

    /// Composites one value per Gaussian instead of its colour: [H,W,1], the sum of alpha T value. For label
    /// and part renders.
    virtual void forward_values(const GaussianSpans& gaussians, const Camera& camera,
                                const Settings& settings, std::span<const float> values, Image& output) = 0;

    /// A session of `views` views (view_session.h) that keeps up to `budget_bytes` of their fixed parts.
    /// Views beyond that are rendered in full. The rasterizer must outlive it. backward() of one does not
    /// follow forward() of the other.
    virtual std::unique_ptr<ViewSession> view_session(std::size_t views, std::size_t budget_bytes);

    /// Name: "plain", "scalar", "avx2", "avx512" or "cuda".
    virtual std::string name() const = 0;
};

/// Reference rasterizer: double precision, one thread, no tiles.
std::unique_ptr<Rasterizer> make_plain_rasterizer();

/// Fast rasterizer: tiles, SIMD chosen at run time (forced by GSE_CPU=scalar|avx2|avx512), threads from
/// `pool`. The pool is kept by reference and must outlive the rasterizer.
std::unique_ptr<Rasterizer> make_fast_rasterizer(ThreadPool& pool);
/// Fast rasterizer with the instruction set of that name. Throws Error for an unknown one, or one that this
/// processor lacks.
std::unique_ptr<Rasterizer> make_fast_rasterizer(ThreadPool& pool, const std::string& kernels);

/// CUDA rasterizer on the first device of NVIDIA's driver (compute capability 6.0 or newer), with the kernels
/// of engine/raster/cuda. The device must first draw and differentiate a small scene as the plain version
/// does. Results are bit-identical from call to call. Throws Error without kernels in this build, without
/// driver or device, or for a device that fails the check.
std::unique_ptr<Rasterizer> make_cuda_rasterizer();

/// True when make_cuda_rasterizer() gives one. Otherwise `why` (may be null) gets the sentence.
bool cuda_usable(std::string* why = nullptr);

/// Fast rasterizer with the instruction set of that name, or the best one for an empty name. "cuda" gives the
/// CUDA one. Throws Error.
std::unique_ptr<Rasterizer> make_rasterizer_of(const std::string& kernels, ThreadPool& pool);

/// Rasterizer by a user's choice: "cpu" is the fast one, "cuda" the CUDA one. "auto" is "cpu": no CUDA device
/// has been measured to be worth its copies. Throws Error for other names and for one that is not available.
std::unique_ptr<Rasterizer> make_rasterizer(const std::string& choice, ThreadPool& pool);
/// Throws the errors of make_chosen_rasterizer().
void require_rasterizer(const std::string& choice);

/// Instruction sets that run here, the fastest first.
std::vector<std::string> usable_kernels();

}  // namespace gse::raster
