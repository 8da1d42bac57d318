// Kernels of the fast rasterizer for one instruction set: AVX2 and FMA; compiled with its own flags.
#include <immintrin.h>
#include "engine/raster/conventions.h"
#include "engine/raster/kernels.h"

namespace gse::raster {
namespace avx2 {
namespace {

// The register types first.
// clang-format off
#include "engine/raster/simd_avx2.h"
#include "engine/raster/kernels.inl"
// clang-format on

}  // namespace
}  // namespace avx2

const Kernels Avx2Kernels = {"avx2",         avx2::project,    avx2::bin,      avx2::blend,
                             avx2::backward, avx2::contribute, avx2::gradient, avx2::floor_loops};

}  // namespace gse::raster
