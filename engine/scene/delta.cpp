// Differences of Gaussian sets by row identity. Arrays that an edit does not touch stay shared.
#include "engine/scene/delta.h"

#include <array>
#include <cstring>

#include "engine/base/check.h"

namespace gse {
namespace {

constexpr std::size_t ColumnCount = 5;
constexpr std::size_t ShColumn = 4;

std::size_t sh_stride(int degree) { return static_cast<std::size_t>(sh_coefficient_count(degree)) * 3; }

std::array<std::size_t, ColumnCount> strides(int degree) { return {3, 3, 4, 1, sh_stride(degree)}; }

std::array<std::span<const float>, ColumnCount> columns_of(const GaussianSpans& set) {
    return {set.position, set.log_scale, set.rotation, set.opacity_logit, set.sh};
}

std::array<std::vector<float>*, ColumnCount> columns_of(GaussianData& data) {
    return {&data.position, &data.log_scale, &data.rotation, &data.opacity_logit, &data.sh};
}

/// True when `a`[a_stride] and `b`[b_stride] agree bit for bit as far as both reach, and the longer one goes
/// on with zeros.
bool same_widened(const float* a, std::size_t a_stride, const float* b, std::size_t b_stride) {
    const std::size_t common = std::min(a_stride, b_stride);
    if (std::memcmp(a, b, common * sizeof(float)) != 0) return false;
    const float* rest = a_stride > b_stride ? a : b;
    for (std::size_t i = common; i < std::max(a_stride, b_stride); ++i)
        if (std::memcmp(&rest[i], "\0\0\0", sizeof(float)) != 0) return false;
    return true;
}

GaussianData gather(const GaussianSpans& set, std::span<const std::size_t> rows) {
    GaussianData data;
    data.sh_degree = set.sh_degree;
    const auto from = columns_of(set);
    const auto to = columns_of(data);
    const auto stride = strides(set.sh_degree);
    for (std::size_t c = 0; c < ColumnCount; ++c) {
        to[c]->resize(rows.size() * stride[c]);
        for (std::size_t i = 0; i < rows.size(); ++i)
            std::memcpy(to[c]->data() + i * stride[c], from[c].data() + rows[i] * stride[c],
                        stride[c] * sizeof(float));
    }
    return data;
}

/// One attribute of a set that changes: shared until the first change.
struct Column {
    GaussianSet::Buffer shared;
    std::vector<float> own;
    std::size_t stride = 1;

    std::span<const float> values() const {
        return shared != nullptr ? std::span<const float>(*shared) : own;
    }
    float* writable() {
        if (shared != nullptr) {
            own.assign(shared->begin(), shared->end());
            shared = nullptr;
        }
        return own.data();
    }
    GaussianSet::Buffer finish() {
        return shared != nullptr ? shared : std::make_shared<const std::vector<float>>(std::move(own));
    }
};

/// Set to which deltas are applied one after the other.
class ChangingSet {
public:
    ChangingSet(const GaussianSet& set, std::span<const RowId> ids)
        : degree_(set.sh_degree()), ids_(ids.begin(), ids.end()) {
        GSE_CHECK_EQ(ids.size(), set.size());
        const GaussianBuffers buffers = set.buffers();
        const GaussianSet::Buffer* all[] = {&buffers.position, &buffers.log_scale, &buffers.rotation,
                                            &buffers.opacity_logit, &buffers.sh};
        for (std::size_t c = 0; c < ColumnCount; ++c) columns_[c] = {*all[c], {}, strides(degree_)[c]};
    }

    void apply(const SceneDelta& delta) {
        GSE_CHECK_EQ(delta.changed.size(), delta.changed_rows.size());
        GSE_CHECK_EQ(delta.added.size(), delta.added_rows.size());
        if (!delta.changed.empty()) widen(delta.changed_rows.sh_degree);
        if (!delta.added.empty()) widen(delta.added_rows.sh_degree);
        std::vector<std::size_t> removed;
        locate_rows(ids_, delta.removed, [&](std::size_t row, std::size_t) { removed.push_back(row); });
        if (!removed.empty() || !delta.added.empty()) rebuild(removed, delta);
        overwrite(delta);
    }

    std::pair<GaussianSet, std::vector<RowId>> finish() {
        GaussianBuffers buffers{degree_,
                                columns_[0].finish(),
                                columns_[1].finish(),
                                columns_[2].finish(),
                                columns_[3].finish(),
                                columns_[4].finish()};
        return {GaussianSet(std::move(buffers)), std::move(ids_)};
    }

private:
    void widen(int degree) {
        if (degree <= degree_) return;
        Column& sh = columns_[ShColumn];
        const std::size_t stride = sh_stride(degree);
        std::vector<float> wide(ids_.size() * stride);
        const auto values = sh.values();
        for (std::size_t row = 0; row < ids_.size(); ++row)
            std::memcpy(&wide[row * stride], &values[row * sh.stride], sh.stride * sizeof(float));
        sh = {nullptr, std::move(wide), stride};
        degree_ = degree;
    }

    /// Leaves out `removed` (ascending rows) and appends the added rows.
    void rebuild(std::span<const std::size_t> removed, const SceneDelta& delta) {
        const std::size_t kept = ids_.size() - removed.size();
        const auto added = columns_of(spans(delta.added_rows));
        const auto added_strides = strides(delta.added_rows.sh_degree);
        for (std::size_t c = 0; c < ColumnCount; ++c) {
            Column& column = columns_[c];
            std::vector<float> values;
            values.reserve((kept + delta.added.size()) * column.stride);
            append_kept(values, column.values(), removed, column.stride);
            if (added_strides[c] == column.stride) {
                values.insert(values.end(), added[c].begin(), added[c].end());
            } else {
                for (std::size_t row = 0; row < delta.added.size(); ++row) {
                    const float* from = added[c].data() + row * added_strides[c];
                    values.insert(values.end(), from, from + added_strides[c]);
                    values.resize(values.size() + column.stride - added_strides[c]);
                }
            }
            column = {nullptr, std::move(values), column.stride};
        }
        std::vector<RowId> ids;
        ids.reserve(kept + delta.added.size());
        append_kept(ids, std::span<const RowId>(ids_), removed, 1);
        ids.insert(ids.end(), delta.added.begin(), delta.added.end());
        ids_ = std::move(ids);
    }

    template <class T>
    static void append_kept(std::vector<T>& to, std::span<const T> from, std::span<const std::size_t> removed,
                            std::size_t stride) {
        std::size_t begin = 0;
        for (const std::size_t row : removed) {
            to.insert(to.end(), from.data() + begin, from.data() + row * stride);
            begin = (row + 1) * stride;
        }
        to.insert(to.end(), from.data() + begin, from.data() + from.size());
    }

    void overwrite(const SceneDelta& delta) {
        std::vector<std::pair<std::size_t, std::size_t>> rows;  // of the set, of the delta
        rows.reserve(delta.changed.size());
        locate_rows(ids_, delta.changed, [&](std::size_t row, std::size_t k) { rows.emplace_back(row, k); });
        const auto changed = columns_of(spans(delta.changed_rows));
        const auto changed_strides = strides(delta.changed_rows.sh_degree);
        for (std::size_t c = 0; c < ColumnCount; ++c) {
            Column& column = columns_[c];
            const std::size_t stride = column.stride, given = changed_strides[c];
            const auto values = column.values();
            const bool differs = std::any_of(rows.begin(), rows.end(), [&](const auto& pair) {
                return !same_widened(values.data() + pair.first * stride, stride,
                                     changed[c].data() + pair.second * given, given);
            });
            if (!differs) continue;
            float* to = column.writable();
            for (const auto& [row, k] : rows) {
                std::memcpy(to + row * stride, changed[c].data() + k * given, given * sizeof(float));
                std::fill(to + row * stride + given, to + (row + 1) * stride, 0.0f);
            }
        }
    }

    int degree_;
    std::array<Column, ColumnCount> columns_;
    std::vector<RowId> ids_;
};

std::size_t data_bytes(const GaussianData& data) {
    return sizeof(float) * (data.position.size() + data.log_scale.size() + data.rotation.size() +
                            data.opacity_logit.size() + data.sh.size());
}

}  // namespace

bool same_row(const GaussianSpans& a, std::size_t a_row, const GaussianSpans& b, std::size_t b_row) {
    const auto a_strides = strides(a.sh_degree), b_strides = strides(b.sh_degree);
    const auto a_columns = columns_of(a), b_columns = columns_of(b);
    for (std::size_t c = 0; c < ColumnCount; ++c)
        if (!same_widened(a_columns[c].data() + a_row * a_strides[c], a_strides[c],
                          b_columns[c].data() + b_row * b_strides[c], b_strides[c]))
            return false;
    return true;
}

std::size_t SceneDelta::byte_size() const {
    return sizeof(RowId) * (changed.size() + removed.size() + added.size()) + data_bytes(changed_rows) +
           data_bytes(added_rows);
}

SceneDelta make_delta(const GaussianSet& before, std::span<const RowId> before_ids, const GaussianSet& after,
                      std::span<const std::int64_t> base_to_new, std::uint64_t edit_id) {
    GSE_CHECK_EQ(before_ids.size(), before.size());
    GSE_CHECK_EQ(base_to_new.size(), before.size());
    GSE_CHECK(edit_id > 0 && edit_id < (std::uint64_t{1} << EditIdShift));
    const GaussianSpans old_rows = before.spans(), new_rows = after.spans();
    const bool same_arrays = before.shares_all_with(after);
    SceneDelta delta;
    std::vector<std::pair<RowId, std::size_t>> changed;  // identity, row of `after`
    std::vector<std::uint8_t> has_origin(after.size(), 0);
    for (std::size_t row = 0; row < before.size(); ++row) {
        if (base_to_new[row] < 0) {
            delta.removed.push_back(before_ids[row]);
            continue;
        }
        const auto to = static_cast<std::size_t>(base_to_new[row]);
        GSE_CHECK(to < after.size() && has_origin[to] == 0);
        has_origin[to] = 1;
        if (same_arrays && row == to) continue;
        if (!same_row(old_rows, row, new_rows, to)) changed.emplace_back(before_ids[row], to);
    }
    std::sort(delta.removed.begin(), delta.removed.end());
    std::sort(changed.begin(), changed.end());
    std::vector<std::size_t> rows;
    for (const auto& [id, row] : changed) {
        delta.changed.push_back(id);
        rows.push_back(row);
    }
    delta.changed_rows = gather(new_rows, rows);
    rows.clear();
    for (std::size_t row = 0; row < after.size(); ++row)
        if (has_origin[row] == 0) rows.push_back(row);
    for (std::size_t i = 0; i < rows.size(); ++i) delta.added.push_back((edit_id << EditIdShift) | i);
    delta.added_rows = gather(new_rows, rows);
    return delta;
}

std::pair<GaussianSet, std::vector<RowId>> apply_delta(const GaussianSet& set, std::span<const RowId> ids,
                                                       const SceneDelta& delta) {
    const SceneDelta* one = &delta;
    return apply_deltas(set, ids, {&one, 1});
}

std::pair<GaussianSet, std::vector<RowId>> apply_deltas(const GaussianSet& set, std::span<const RowId> ids,
                                                        std::span<const SceneDelta* const> deltas) {
    ChangingSet changing(set, ids);
    for (const SceneDelta* delta : deltas) changing.apply(*delta);
    return changing.finish();
}

}  // namespace gse
