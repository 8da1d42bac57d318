// Compares rows bit by bit.
#include "engine/edit/optimise/edit_checks.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace gse::edit {
namespace {

bool same_row(std::span<const float> a, std::size_t row_a, std::span<const float> b, std::size_t row_b,
              std::size_t stride) {
    return std::memcmp(a.data() + row_a * stride, b.data() + row_b * stride, stride * sizeof(float)) == 0;
}

}  // namespace

std::size_t count_changed_outside(const GaussianSet& base, const std::vector<std::uint8_t>& label,
                                  const EditResult& result) {
    const auto sh = static_cast<std::size_t>(sh_coefficient_count(base.sh_degree())) * 3;
    std::size_t changed = 0;
    for (std::size_t row = 0; row < base.size(); ++row) {
        if (label[row] != 0) continue;
        const std::int64_t now = result.base_to_new[row];
        const auto to = static_cast<std::size_t>(now);
        const bool same = now >= 0 && same_row(base.position(), row, result.set.position(), to, 3) &&
                          same_row(base.log_scale(), row, result.set.log_scale(), to, 3) &&
                          same_row(base.rotation(), row, result.set.rotation(), to, 4) &&
                          same_row(base.opacity_logit(), row, result.set.opacity_logit(), to, 1) &&
                          same_row(base.sh(), row, result.set.sh(), to, sh);
        changed += same ? 0 : 1;
    }
    return changed;
}

std::size_t count_nonfinite(const EditResult& result) {
    const auto sh = static_cast<std::size_t>(sh_coefficient_count(result.set.sh_degree())) * 3;
    const auto bad = [](std::span<const float> values, std::size_t row, std::size_t stride) {
        return std::any_of(values.begin() + static_cast<std::ptrdiff_t>(row * stride),
                           values.begin() + static_cast<std::ptrdiff_t>((row + 1) * stride),
                           [](float value) { return !std::isfinite(value); });
    };
    std::size_t count = 0;
    for (std::size_t row = 0; row < result.set.size(); ++row)
        if (result.label[row] != 0 &&
            (bad(result.set.position(), row, 3) || bad(result.set.log_scale(), row, 3) ||
             bad(result.set.rotation(), row, 4) || bad(result.set.opacity_logit(), row, 1) ||
             bad(result.set.sh(), row, sh)))
            ++count;
    return count;
}

}  // namespace gse::edit
