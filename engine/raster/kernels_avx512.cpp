// Kernels of the fast rasterizer for one instruction set: AVX-512 F, DQ, BW, VL; compiled with its own flags.
#include <immintrin.h>
#include "engine/raster/conventions.h"
#include "engine/raster/kernels.h"

namespace gse::raster {
namespace avx512 {
namespace {

// The register types first.
// clang-format off
#include "engine/raster/simd_avx512.h"
#include "engine/raster/kernels.inl"
// clang-format on

}  // namespace
}  // namespace avx512

const Kernels Avx512Kernels = {"avx512",         avx512::project,    avx512::bin,      avx512::blend,
                               avx512::backward, avx512::contribute, avx512::gradient, avx512::floor_loops};

}  // namespace gse::raster
