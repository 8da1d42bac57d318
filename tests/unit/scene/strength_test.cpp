// Edits at other strengths than their own.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <cmath>

#include "engine/math/sh.h"
#include "engine/scene/delta.h"
#include "engine/scene/strength.h"

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

}  // namespace strength_test
