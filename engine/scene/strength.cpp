// Blends the rows of a delta with the rows they replace.
#include "engine/scene/strength.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "engine/base/check.h"
#include "engine/math/sh.h"
#include "engine/scene/transform/transformed.h"
#include "engine/scene/transform/turn_share.h"

namespace gse {
namespace {

constexpr float MostSh = 1;            // what every format holds of a coefficient above the base colour
constexpr double ClampedLogit = -100;  // of rows that are hardly there: finite in every format

double opacity_of(double logit) { return 1 / (1 + std::exp(-logit)); }

/// Logit of the opacity at `share` of the way from `from` to `to`. Opacity and transmittance are both mixed,
/// so that neither vanishes in rounding.
float mixed_logit(double from, double to, double share) {
    const double opaque = (1 - share) * opacity_of(from) + share * opacity_of(to);
    const double clear = (1 - share) * opacity_of(-from) + share * opacity_of(-to);
    const double logit = std::log(opaque) - std::log(clear);
    return static_cast<float>(std::clamp(logit, std::min(from, to), std::max(from, to)));
}

/// Logit of a share of the opacity.
float fainter(double logit, double share) {
    const double opaque = share * opacity_of(logit);
    return static_cast<float>(std::max(std::log(opaque) - std::log1p(-opaque), ClampedLogit));
}

float between(float from, float to, double share) {
    return from == to ? from : static_cast<float>(from + share * (static_cast<double>(to) - from));
}

/// Normalised mean of two rotations, the shorter way round.
void mix_rotation(const float* from, float* to, double share) {
    if (std::memcmp(from, to, 4 * sizeof(float)) == 0) return;
    std::array<double, 4> a{}, b{};
    double length_a = 0, length_b = 0, along = 0, length = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        length_a += static_cast<double>(from[i]) * from[i];
        length_b += static_cast<double>(to[i]) * to[i];
        along += static_cast<double>(from[i]) * to[i];
    }
    if (!(length_a > 0) || !(length_b > 0)) return;
    for (std::size_t i = 0; i < 4; ++i) {
        a[i] = from[i] / std::sqrt(length_a);
        b[i] = (along < 0 ? -to[i] : to[i]) / std::sqrt(length_b);
        b[i] = (1 - share) * a[i] + share * b[i];
        length += b[i] * b[i];
    }
    for (std::size_t i = 0; i < 4; ++i) to[i] = static_cast<float>(b[i] / std::sqrt(length));
}

/// Coefficient beyond `to`, seen from `from`, within [low,high]. One that lay beyond them already goes no
/// further.
float beyond(float from, float to, double strength, double low, double high) {
    if (from == to) return to;
    const double value = from + strength * (static_cast<double>(to) - from);
    return static_cast<float>(std::clamp(value, std::min<double>(low, to), std::max<double>(high, to)));
}

void mix_colour(const float* from, std::size_t from_stride, float* to, std::size_t stride, double strength) {
    const double black = sh_from_colour(0), white = sh_from_colour(1);
    for (std::size_t i = 0; i < stride; ++i) {
        const float start = i < from_stride ? from[i] : 0.0f;
        if (strength <= 1) to[i] = between(start, to[i], strength);
        else if (i < 3) to[i] = beyond(start, to[i], strength, black, white);
        else to[i] = beyond(start, to[i], strength, -MostSh, MostSh);
    }
}

/// The row of a set as data of (at least) its degree.
GaussianData row_of(const GaussianSpans& set, std::size_t row, int degree) {
    GaussianData data;
    data.sh_degree = degree;
    data.resize(1);
    const std::size_t stride = static_cast<std::size_t>(sh_coefficient_count(set.sh_degree)) * 3;
    std::copy_n(&set.position[row * 3], 3, data.position.begin());
    std::copy_n(&set.log_scale[row * 3], 3, data.log_scale.begin());
    std::copy_n(&set.rotation[row * 4], 4, data.rotation.begin());
    data.opacity_logit[0] = set.opacity_logit[row];
    std::copy_n(&set.sh[row * stride], stride, data.sh.begin());
    return data;
}

/// Sets `row`, the changed row, to its values at the strength.
void mix_row(const GaussianSpans& before, std::size_t from, GaussianData& row, double strength) {
    const std::size_t stride = static_cast<std::size_t>(sh_coefficient_count(before.sh_degree)) * 3;
    mix_colour(&before.sh[from * stride], stride, row.sh.data(), row.sh.size(), strength);
    if (strength > 1) return;
    for (std::size_t i = 0; i < 3; ++i) {
        row.position[i] = between(before.position[from * 3 + i], row.position[i], strength);
        row.log_scale[i] = between(before.log_scale[from * 3 + i], row.log_scale[i], strength);
    }
    mix_rotation(&before.rotation[from * 4], row.rotation.data(), strength);
    if (before.opacity_logit[from] != row.opacity_logit[0])
        row.opacity_logit[0] = mixed_logit(before.opacity_logit[from], row.opacity_logit[0], strength);
}

constexpr std::size_t Absent = std::numeric_limits<std::size_t>::max();

/// A row that the delta changes, or a removed one that comes back.
struct Entry {
    RowId id = 0;
    bool removed = false;
    std::size_t k = 0;         // of the delta
    std::size_t row = Absent;  // of the set before
};

/// The changed rows of the delta at a strength, where they turn as one; nothing where they do not. `entries`
/// are those rows in their order.
std::optional<GaussianData> turned_rows(const GaussianSpans& before, std::span<const Entry> entries,
                                        const SceneDelta& delta, double strength) {
    std::vector<std::size_t> from(delta.changed.size());
    for (std::size_t k = 0; k < from.size(); ++k) from[k] = entries[k].row;
    const auto turn = common_turn(before, from, delta.changed_rows);
    if (!turn || strength > 1) return turn ? std::optional(delta.changed_rows) : std::nullopt;
    GaussianData rows;
    rows.sh_degree = std::max(before.sh_degree, delta.changed_rows.sh_degree);
    for (std::size_t k = 0; k < from.size(); ++k)
        rows.append_row(from[k] == Absent ? row_of(spans(delta.changed_rows), k, rows.sh_degree)
                                          : row_of(before, from[k], rows.sh_degree),
                        0);
    return transformed(std::move(rows), share_of_turn(*turn, strength));
}

}  // namespace

SceneDelta with_strength(const GaussianSet& before, std::span<const RowId> ids, const SceneDelta& delta,
                         double strength) {
    GSE_CHECK(strength >= 0 && strength <= MostStrength);
    if (strength == 1) return delta;
    SceneDelta mixed;
    const GaussianSpans rows = before.spans();
    const int degree = std::max(before.sh_degree(), delta.changed_rows.sh_degree);
    mixed.changed_rows.sh_degree = degree;
    mixed.added_rows.sh_degree = delta.added_rows.sh_degree;
    if (strength == 0) return mixed;
    std::vector<Entry> entries;
    for (std::size_t k = 0; k < delta.changed.size(); ++k)
        entries.push_back({delta.changed[k], false, k, Absent});
    locate_rows(ids, delta.changed, [&](std::size_t row, std::size_t k) { entries[k].row = row; });
    std::vector<std::size_t> back(delta.removed.size(), Absent);
    if (strength < 1) locate_rows(ids, delta.removed, [&](std::size_t row, std::size_t k) { back[k] = row; });
    for (std::size_t k = 0; k < delta.removed.size(); ++k) {
        if (back[k] == Absent) mixed.removed.push_back(delta.removed[k]);
        else entries.push_back({delta.removed[k], true, k, back[k]});
    }
    const auto turned = turned_rows(rows, entries, delta, strength);
    std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) { return a.id < b.id; });
    for (const Entry& entry : entries) {
        GaussianData row = entry.removed ? row_of(rows, entry.row, degree)
                                         : row_of(spans(delta.changed_rows), entry.k, degree);
        if (entry.removed) row.opacity_logit[0] = fainter(row.opacity_logit[0], 1 - strength);
        else if (turned) row = row_of(spans(*turned), entry.k, degree);
        else if (entry.row != Absent) mix_row(rows, entry.row, row, strength);
        mixed.changed.push_back(entry.id);
        mixed.changed_rows.append_row(row, 0);
    }
    mixed.added = delta.added;
    mixed.added_rows = delta.added_rows;
    for (auto& logit : mixed.added_rows.opacity_logit)
        if (strength < 1) logit = fainter(logit, strength);
    return mixed;
}

}  // namespace gse
