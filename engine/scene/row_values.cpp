// Values per row, carried from one state to another.
#include "engine/scene/row_values.h"

#include <algorithm>
#include <cmath>

namespace gse {

std::vector<float> changed_values(const DocumentState& state) {
    const auto& now = state.current;
    const auto& base = state.base;
    std::vector<float> values(now.size(), 0.0f);
    const std::size_t stride_now = now.empty() ? 0 : now.sh().size() / now.size();
    const std::size_t stride_base = base.empty() ? 0 : base.sh().size() / base.size();
    for (std::size_t row = 0; row < now.size(); ++row) {
        const RowId id = (*state.row_ids)[row];
        if (id >= base.size()) {
            values[row] = 1;
            continue;
        }
        const auto old = static_cast<std::size_t>(id);
        double change = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            change += 0.5 * std::abs(now.sh()[row * stride_now + c] - base.sh()[old * stride_base + c]);
            const double size = std::exp(std::clamp<double>(base.log_scale()[old * 3 + c], -20, 20));
            change +=
                0.2 * std::min(1.0, std::abs(now.position()[row * 3 + c] - base.position()[old * 3 + c]) /
                                        (size + 1e-12));
            change += 0.2 * std::abs(now.log_scale()[row * 3 + c] - base.log_scale()[old * 3 + c]);
        }
        change += 0.1 * std::abs(now.opacity_logit()[row] - base.opacity_logit()[old]);
        values[row] = std::isfinite(change) ? static_cast<float>(std::min(change, 1.0)) : 1.0f;
    }
    return values;
}

std::vector<float> carried(const std::vector<float>& values, const std::vector<std::int64_t>& base_to_new,
                           std::size_t rows, float fresh) {
    std::vector<float> result(rows, fresh);
    for (std::size_t row = 0; row < base_to_new.size() && row < values.size(); ++row)
        if (base_to_new[row] >= 0) result[static_cast<std::size_t>(base_to_new[row])] = values[row];
    return result;
}

std::vector<std::int64_t> row_map(const std::vector<RowId>& before, const std::vector<RowId>& after) {
    std::vector<std::size_t> order(before.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(), [&](auto a, auto b) { return before[a] < before[b]; });
    std::vector<RowId> wanted;
    for (const auto row : order) wanted.push_back(before[row]);
    std::vector<std::int64_t> rows(before.size(), -1);
    locate_rows(after, wanted,
                [&](std::size_t row, std::size_t k) { rows[order[k]] = static_cast<std::int64_t>(row); });
    return rows;
}

std::vector<std::int64_t> chained(std::vector<std::int64_t> first, const std::vector<std::int64_t>& second) {
    for (auto& row : first)
        if (row >= 0) row = second[static_cast<std::size_t>(row)];
    return first;
}

}  // namespace gse
