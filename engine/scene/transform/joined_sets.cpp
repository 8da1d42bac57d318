// Arrays appended, spherical harmonics widened.
#include "engine/scene/transform/joined_sets.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "engine/base/memory.h"

namespace gse {
namespace {

void append_padded(std::span<const float> from, std::size_t from_stride, std::vector<float>& to,
                   std::size_t to_stride) {
    for (std::size_t i = 0; i < from.size(); i += from_stride) {
        to.insert(to.end(), from.begin() + static_cast<std::ptrdiff_t>(i),
                  from.begin() + static_cast<std::ptrdiff_t>(i + from_stride));
        to.insert(to.end(), to_stride - from_stride, 0.0f);
    }
}

std::size_t colour_stride(int degree) { return static_cast<std::size_t>(sh_coefficient_count(degree)) * 3; }

}  // namespace

GaussianSet joined(std::span<const GaussianSet> parts) {
    if (parts.size() == 1) return parts.front();
    GaussianData all;
    std::size_t rows = 0;
    for (const GaussianSet& part : parts) {
        all.sh_degree = std::max(all.sh_degree, part.sh_degree());
        rows += part.size();
    }
    constexpr std::size_t ShapeFloats = 11;  // beside the colours
    require_memory(std::uint64_t{rows} * (ShapeFloats + all.sh_stride()) * sizeof(float),
                   "the scene of several parts");
    all.position.reserve(rows * 3), all.log_scale.reserve(rows * 3), all.rotation.reserve(rows * 4);
    all.opacity_logit.reserve(rows), all.sh.reserve(rows * all.sh_stride());
    for (const GaussianSet& part : parts) {
        append_padded(part.position(), 3, all.position, 3);
        append_padded(part.log_scale(), 3, all.log_scale, 3);
        append_padded(part.rotation(), 4, all.rotation, 4);
        append_padded(part.opacity_logit(), 1, all.opacity_logit, 1);
        append_padded(part.sh(), colour_stride(part.sh_degree()), all.sh, all.sh_stride());
    }
    return GaussianSet(std::move(all));
}

}  // namespace gse
