// Deltas of rows under maps.
#include "engine/scene/transform/transform_edits.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "engine/base/check.h"
#include "engine/base/error.h"
#include "engine/scene/transform/transformed.h"

namespace gse {
namespace {

void append(GaussianData& to, const GaussianSet& from) {
    const auto add = [](std::vector<float>& values, std::span<const float> more) {
        values.insert(values.end(), more.begin(), more.end());
    };
    add(to.position, from.position());
    add(to.log_scale, from.log_scale());
    add(to.rotation, from.rotation());
    add(to.opacity_logit, from.opacity_logit());
    add(to.sh, from.sh());
}

}  // namespace

EditNode transform_of(const DocumentState& state, std::span<const PlacedRows> parts, std::uint64_t id) {
    std::vector<std::uint8_t> all(state.current.size(), 0);
    for (const PlacedRows& part : parts) {
        GSE_CHECK_EQ(part.rows.size(), all.size());
        for (std::size_t row = 0; row < all.size(); ++row)
            if (part.rows[row] != 0) all[row] = 1;
    }
    const GaussianSet before = state.current.filtered(all);  // of a large scene little is moved
    std::vector<RowId> ids;
    for (std::size_t row = 0; row < all.size(); ++row)
        if (all[row] != 0) ids.push_back((*state.row_ids)[row]);
    GaussianSet after = before;
    for (const PlacedRows& part : parts) {
        std::vector<std::uint8_t> rows;
        for (std::size_t row = 0; row < all.size(); ++row)
            if (all[row] != 0) rows.push_back(part.rows[row]);
        after = transformed(after, rows, part.placement);
    }
    std::vector<std::int64_t> kept(before.size());
    std::iota(kept.begin(), kept.end(), std::int64_t{0});
    EditNode node;
    node.id = id;
    node.name = fmt::format("Move {} splats", before.size());
    node.delta = std::make_shared<const SceneDelta>(make_delta(before, ids, after, kept, id));
    return node;
}

EditNode transform_of(const DocumentState& state, std::span<const std::uint8_t> rows, const Affine& placement,
                      std::uint64_t id) {
    const PlacedRows part{rows, placement};
    return transform_of(state, {&part, 1}, id);
}

EditNode copies_of(const DocumentState& state, std::span<const std::uint8_t> rows,
                   std::span<const Affine> placements, std::uint64_t id) {
    GSE_CHECK(id > 0 && id < (std::uint64_t{1} << EditIdShift));
    const GaussianSet some = state.current.filtered(rows);
    if (some.size() != 0 && placements.size() > (std::uint64_t{1} << EditIdShift) / some.size())
        throw Error(ErrorCode::InvalidArgument, "so many copies are too many splats",
                    "make fewer copies at once");
    SceneDelta delta;
    delta.changed_rows.sh_degree = delta.added_rows.sh_degree = some.sh_degree();
    for (const Affine& placement : placements) append(delta.added_rows, transformed(some, placement));
    delta.added.resize(delta.added_rows.size());
    std::iota(delta.added.begin(), delta.added.end(), id << EditIdShift);
    EditNode node;
    node.id = id;
    node.name = placements.size() == 1
                    ? fmt::format("Copy {} splats", some.size())
                    : fmt::format("Copy {} splats {} times", some.size(), placements.size());
    node.delta = std::make_shared<const SceneDelta>(std::move(delta));
    return node;
}

}  // namespace gse
