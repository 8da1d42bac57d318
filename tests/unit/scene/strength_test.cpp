// Edits at other strengths than their own.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/base/random.h"
#include "engine/math/sh.h"
#include "engine/scene/delta.h"
#include "engine/scene/strength.h"
#include "engine/scene/transform/transformed.h"
#include "engine/scene/transform/turn_share.h"

namespace strength_test {

namespace {

using namespace gse;

constexpr double Rounding = 1e-5;  // of float values near one that went through a logarithm

double opacity(float logit) { return 1 / (1 + std::exp(-static_cast<double>(logit))); }

/// Five rows, of which an edit changes the first, removes the second, leaves the rest and adds one.
struct Case {
    GaussianSet before, after;
    std::vector<RowId> ids{0, 1, 2, 3, 4};
    std::vector<std::int64_t> map{0, -1, 1, 2, 3};
    SceneDelta delta;

    Case() {
        GaussianData data;
        data.sh_degree = 1;
        data.resize(5);
        for (std::size_t i = 0; i < data.sh.size(); ++i) data.sh[i] = 0.01f * static_cast<float>(i % 7);
        for (std::size_t i = 0; i < data.position.size(); ++i)
            data.position[i] = 0.3f * static_cast<float>(i);
        for (std::size_t row = 0; row < 5; ++row) {
            data.rotation[row * 4] = 2;  // files need not hold unit quaternions
            data.opacity_logit[row] = 1;
        }
        before = GaussianSet(GaussianData(data));
        GaussianData edited;
        edited.sh_degree = 1;
        for (const std::size_t row : {0, 2, 3, 4, 1}) edited.append_row(data, row);
        edited.position[0] += 1;
        edited.log_scale[0] += 0.5f;
        edited.rotation[0] = 0;
        edited.rotation[1] = -1;
        edited.opacity_logit[0] = 30;  // 1 in floating point, yet on the way it must not be
        edited.sh[0] += 0.4f;
        edited.sh[3] += 0.2f;
        after = GaussianSet(std::move(edited));
        delta = make_delta(before, ids, after, map, 1);
    }
    std::pair<GaussianSet, std::vector<RowId>> at(double strength) const {
        return apply_delta(before, ids, with_strength(before, ids, delta, strength));
    }
};

}  // namespace

DOCTEST_TEST_CASE("an edit at strength 1 is the edit, at 0 it is none") {
    const Case edit;
    const auto [full, full_ids] = edit.at(1);
    DOCTEST_REQUIRE(full.size() == edit.after.size());
    for (std::size_t row = 0; row < full.size(); ++row)
        DOCTEST_CHECK(same_row(full.spans(), row, edit.after.spans(), row));
    const auto [none, none_ids] = edit.at(0);
    DOCTEST_CHECK(none.shares_all_with(edit.before));
    DOCTEST_CHECK(none_ids == edit.ids);
}

DOCTEST_TEST_CASE("below 1 rows lie between before and after, come in and go away by their opacity") {
    const Case edit;
    double last_changed = opacity(1), last_added = 0, last_removed = opacity(1);
    float last_position = edit.before.position()[0], last_sh = edit.before.sh()[0];
    for (const double strength : {0.25, 0.5, 0.75}) {
        const auto [set, ids] = edit.at(strength);
        DOCTEST_REQUIRE(ids == std::vector<RowId>{0, 1, 2, 3, 4, RowId{1} << EditIdShift});
        DOCTEST_CHECK(set.position()[0] > last_position);
        DOCTEST_CHECK(set.sh()[0] > last_sh);
        last_position = set.position()[0];
        last_sh = set.sh()[0];
        const double changed = opacity(set.opacity_logit()[0]), removed = opacity(set.opacity_logit()[1]),
                     added = opacity(set.opacity_logit()[5]);
        DOCTEST_CHECK(changed > last_changed);
        DOCTEST_CHECK(changed < 1);
        DOCTEST_CHECK(removed < last_removed);
        DOCTEST_CHECK(added > last_added);
        DOCTEST_CHECK(std::abs(removed - (1 - strength) * opacity(1)) < Rounding);
        DOCTEST_CHECK(std::abs(added - strength * opacity(1)) < Rounding);
        last_changed = changed;
        last_removed = removed;
        last_added = added;
        double length = 0;
        for (std::size_t i = 0; i < 4; ++i) length += std::pow(set.rotation()[i], 2);
        DOCTEST_CHECK(std::abs(length - 1) < Rounding);
        for (std::size_t row = 2; row < 5; ++row)
            DOCTEST_CHECK(same_row(set.spans(), row, edit.before.spans(), row));
    }
}

DOCTEST_TEST_CASE("above 1 only colours go on, and no further than a colour can") {
    const Case edit;
    const auto [set, ids] = edit.at(MostStrength);
    DOCTEST_REQUIRE(set.size() == edit.after.size());
    const float step = edit.after.sh()[0] - edit.before.sh()[0];
    DOCTEST_CHECK(std::abs(set.sh()[0] - (edit.before.sh()[0] + 2 * step)) < Rounding);
    DOCTEST_CHECK(set.sh()[3] > edit.after.sh()[3]);
    for (std::size_t i = 0; i < 3; ++i) DOCTEST_CHECK(set.position()[i] == edit.after.position()[i]);
    DOCTEST_CHECK(set.opacity_logit()[0] == edit.after.opacity_logit()[0]);
    for (std::size_t row = 1; row < set.size(); ++row)
        DOCTEST_CHECK(same_row(set.spans(), row, edit.after.spans(), row));
    SceneDelta bright = edit.delta;
    bright.changed_rows.sh[0] = 1.5f;  // nearly white
    const auto brighter = with_strength(edit.before, edit.ids, bright, MostStrength);
    DOCTEST_CHECK(brighter.changed_rows.sh[0] >= 1.5f);
    DOCTEST_CHECK(colour_from_sh(brighter.changed_rows.sh[0]) <= 1 + Rounding);
}

DOCTEST_TEST_CASE("a weaker edit over rows that an earlier one no longer brings touches what is there") {
    const Case edit;
    const std::vector<RowId> fewer{0, 3};
    GaussianData data;
    data.sh_degree = 1;
    data.append_row(edit.before.to_data(), 0);
    data.append_row(edit.before.to_data(), 3);
    const GaussianSet some(std::move(data));
    const auto [set, ids] = apply_delta(some, fewer, with_strength(some, fewer, edit.delta, 0.5));
    DOCTEST_CHECK(ids == std::vector<RowId>{0, 3, RowId{1} << EditIdShift});
    DOCTEST_CHECK(same_row(set.spans(), 1, some.spans(), 1));
    DOCTEST_CHECK(!same_row(set.spans(), 0, some.spans(), 0));
}

namespace {

/// Rows with a turn, a move and a scale done to them by an edit of the stack.
struct Turned {
    GaussianSet before;
    std::vector<RowId> ids;
    Affine map;
    SceneDelta delta;

    explicit Turned(const Affine& placement) : map(placement) {
        Random random(5);
        GaussianData data;
        data.sh_degree = 2;
        data.resize(40);
        for (auto* column : {&data.position, &data.log_scale, &data.rotation, &data.opacity_logit, &data.sh})
            for (float& value : *column) value = static_cast<float>(random.normal());
        before = GaussianSet(std::move(data));
        std::vector<std::int64_t> kept(before.size());
        std::iota(kept.begin(), kept.end(), std::int64_t{0});
        ids.assign(kept.begin(), kept.end());
        delta = make_delta(before, ids, transformed(before, map), kept, 1);
    }
    GaussianSet at(double strength) const {
        return apply_delta(before, ids, with_strength(before, ids, delta, strength)).first;
    }
};

double farthest(const GaussianSet& a, const GaussianSet& b) {
    double most = 0;
    for (std::size_t i = 0; i < a.position().size(); ++i)
        most = std::max(most, std::abs(static_cast<double>(a.position()[i]) - b.position()[i]));
    for (std::size_t i = 0; i < a.sh().size(); ++i)
        most = std::max(most, std::abs(static_cast<double>(a.sh()[i]) - b.sh()[i]));
    return most;
}

}  // namespace

DOCTEST_TEST_CASE("a thing that an edit turns goes along its turn, about the same place") {
    const Vec3 axis{0.2, 1, -0.1}, foot{1, -2, 0.5};
    for (const double angle : {0.3, 1.5, -2.8}) {
        const Turned edit(Affine::turn_about(axis, angle, foot));
        for (const double strength : {0.25, 0.5, 0.9}) {
            const auto wanted = transformed(edit.before, Affine::turn_about(axis, strength * angle, foot));
            DOCTEST_CHECK(farthest(edit.at(strength), wanted) < 2 * Rounding);
        }
        DOCTEST_CHECK(edit.at(MostStrength).size() == edit.before.size());
        DOCTEST_CHECK(farthest(edit.at(MostStrength), edit.at(1)) == 0);  // nothing has another colour
    }
}

DOCTEST_TEST_CASE("half of a turn with a move and a scale, done twice, is all of it") {
    const Affine all = Affine::move_by({0.5, 0.2, -1}) * Affine::scale_about(1.7, {3, 1, 0}) *
                       Affine::turn_about({1, 1, 0}, 2, {0, 1, 0});
    const Affine half = share_of_turn(all, 0.5), whole = half * half;
    for (const Vec3& p : {Vec3{0, 0, 0}, Vec3{1, 2, 3}, Vec3{-4, 0, 1}})
        DOCTEST_CHECK(length(whole(p) - all(p)) < 1e-9);
    const Turned edit(all);
    DOCTEST_CHECK(farthest(edit.at(0.5), transformed(edit.before, half)) < 2 * Rounding);
}

DOCTEST_TEST_CASE("a mirror image, and rows of which one is another, have no common turn") {
    const Turned mirrored(Affine::mirror_at({1, 0, 0}, {0, 0, 0}));
    std::vector<std::size_t> from(mirrored.before.size());
    std::iota(from.begin(), from.end(), std::size_t{0});
    const auto before = mirrored.before.spans();
    DOCTEST_CHECK_FALSE(common_turn(before, from, mirrored.delta.changed_rows));
    Turned turned(Affine::turn_about({0, 1, 0}, 1, {}));
    DOCTEST_CHECK(common_turn(before, from, turned.delta.changed_rows));
    turned.delta.changed_rows.position[30] += 0.01f;
    DOCTEST_CHECK_FALSE(common_turn(before, from, turned.delta.changed_rows));
    turned.delta.changed_rows.position[30] -= 0.01f;
    turned.delta.changed_rows.sh[0] += 0.01f;
    DOCTEST_CHECK_FALSE(common_turn(before, from, turned.delta.changed_rows));
}

}  // namespace strength_test
