// Error of the rasterizer's float kernels against the plain double version on a hostile scene.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "engine/base/thread_pool.h"
#include "engine/laboratory/bench/raster/hostile_scenes.h"
#include "engine/raster/rasterizer.h"

namespace gse::bench {

/// Truth by the double version: pictures, and gradients of a fixed noise.
class StabilityTruth {
public:
    explicit StabilityTruth(const HostileScene& scene);

    const HostileScene& scene() const { return scene_; }
    const Image& d_colour() const { return d_colour_; }  // 0 at the unclear pixels
    const Image& d_alpha() const { return d_alpha_; }
    /// Share of the pixels at which no pair is so near to a cut that float may decide it otherwise.
    double clear_share() const;

private:
    friend class KernelStability;
    const HostileScene& scene_;
    std::vector<double> colour_, alpha_, depth_;  // [H*W,3], [H*W], [H*W]
    std::vector<std::int32_t> blended_;
    std::vector<std::uint8_t> unclear_;             // [H*W]
    std::array<std::vector<double>, 6> gradients_;  // as GradientNames
    std::array<std::size_t, 6> strides_{};
    std::vector<double> turn_;  // [N] length of the quaternion, by which its gradient is multiplied
    double brightest_ = 1, deepest_ = 0;
    Image d_colour_, d_alpha_;
};

inline constexpr std::array<const char*, 6> GradientNames{"position", "scale",  "rotation",
                                                          "opacity",  "colour", "screen"};

/// Differences of one instruction set from the truth of one scene.
struct Disagreement {
    /// Largest difference at a clear pixel: of colour over max(1, the largest colour), of alpha, of depth
    /// over the largest.
    double picture = 0;
    double unclear_picture = 0;  // the same at the other pixels
    /// Largest relative difference (L2) of a tensor's gradient, over the clear pixels; of rotations as of
    /// unit quaternions.
    double gradient = 0;
    std::string tensor;  // the one it is of
    /// Error of a single row: over its own gradient, but at least a thousandth of the tensor's largest.
    double row = 0;
    std::size_t miscounted = 0;  // clear pixels with another number of blended splats
    bool finite = true;          // every number of pictures and gradients
    bool same_bits = true;       // of three threads and of the view session, of those of one thread
};

/// One instruction set, or CUDA, with one and three threads, kept from scene to scene.
class KernelStability {
public:
    /// Throws Error where the instruction set is unknown or not on this processor, or no CUDA device is
    /// usable.
    explicit KernelStability(const std::string& kernels);
    /// Error of another rasterizer: `make` gets the threads.
    KernelStability(std::string name,
                    const std::function<std::unique_ptr<raster::Rasterizer>(ThreadPool&)>& make);
    Disagreement measure(const StabilityTruth& truth);
    const std::string& kernels() const { return kernels_; }

private:
    void compare_gradients(const StabilityTruth& truth, Disagreement& result) const;
    bool same_in_session(const StabilityTruth& truth);

    std::string kernels_;
    ThreadPool one_{1}, three_{3};
    std::unique_ptr<raster::Rasterizer> single_, threaded_;
    raster::ForwardOutput picture_, other_picture_;
    raster::Gradients gradients_, other_gradients_;
};

}  // namespace gse::bench
