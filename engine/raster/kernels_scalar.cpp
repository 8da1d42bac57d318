// Kernels of the fast rasterizer for one instruction set: portable, no special flags.

#include "engine/raster/conventions.h"
#include "engine/raster/kernels.h"

namespace gse::raster {
namespace scalar {
namespace {

// The register types first.
// clang-format off
#include "engine/raster/simd_scalar.h"
#include "engine/raster/kernels.inl"
// clang-format on

}  // namespace
}  // namespace scalar

const Kernels ScalarKernels = {"scalar",         scalar::project,    scalar::bin,      scalar::blend,
                               scalar::backward, scalar::contribute, scalar::gradient, scalar::floor_loops};

}  // namespace gse::raster
