// Mixed precision of a training step.
#pragma once

#include <ATen/autocast_mode.h>

namespace gse::training {

/// Scope in which convolutions and matrix products of this thread compute in bfloat16 (mixed precision,
/// Micikevicius et al. 2018). Losses need no scaling: bfloat16 has the range of float. Weights and their
/// gradients stay in float.
class MixedPrecision {
public:
    explicit MixedPrecision(bool on, bool cuda) : on_(on), cuda_(cuda) { set(on_); }
    ~MixedPrecision() {
        set(false);
        if (on_) at::autocast::clear_cache();
    }
    MixedPrecision(const MixedPrecision&) = delete;
    MixedPrecision& operator=(const MixedPrecision&) = delete;

private:
    void set(bool value) const {
        if (!on_) return;
        if (cuda_) {
            at::autocast::set_autocast_gpu_dtype(at::kBFloat16);
            at::autocast::set_enabled(value);
        } else {
            at::autocast::set_autocast_cpu_dtype(at::kBFloat16);
            at::autocast::set_cpu_enabled(value);
        }
    }
    bool on_, cuda_;
};

}  // namespace gse::training
