// Edits for the stack: what is deleted, and what an edit added belongs to a label.
#include <doctest/doctest.h>

#include <algorithm>

#include "engine/scene/label_ops.h"
#include "engine/scene/stack_edits.h"

namespace stack_edits_test {

using namespace gse;

namespace {

GaussianData rows(std::size_t count) {
    GaussianData data;
    data.resize(count);
    for (std::size_t row = 0; row < count; ++row) {
        data.position[row * 3] = static_cast<float>(row);
        data.rotation[row * 4] = 1;
    }
    return data;
}

DocumentState state_of(std::size_t count) {
    Scene scene;
    scene.gaussians = GaussianSet(rows(count));
    return initial_state(scene, {});
}

/// An edit that adds two rows.
EditNode adding(const DocumentState& state, std::uint64_t id) {
    const std::size_t count = state.current.size();
    std::vector<std::int64_t> kept(count);
    for (std::size_t row = 0; row < count; ++row) kept[row] = static_cast<std::int64_t>(row);
    EditNode node;
    node.id = id;
    node.delta = std::make_shared<const SceneDelta>(
        make_delta(state.current, *state.row_ids, GaussianSet(rows(count + 2)), kept, id));
    return node;
}

}  // namespace

DOCTEST_TEST_CASE("rows that are deleted go by identity, and switching the edit off brings them back") {
    const DocumentState state = state_of(5);
    const EditNode node = removal_of(state, std::vector<std::uint8_t>{0, 1, 0, 0, 1}, 3);
    DOCTEST_CHECK(node.name == "Delete 2 splats");
    DOCTEST_CHECK(node.delta->removed == std::vector<RowId>{1, 4});
    const DocumentState after = with_stack(state, {node});
    DOCTEST_CHECK(*after.row_ids == std::vector<RowId>{0, 2, 3});
    EditNode off = node;
    off.enabled = false;
    DOCTEST_CHECK(with_stack(state, {off}).current.size() == 5);
    DOCTEST_CHECK(removal_of(state, std::vector<std::uint8_t>(5), 3).delta->removed.empty());
    // Twice: the second speaks of rows as they are then.
    const EditNode second = removal_of(after, std::vector<std::uint8_t>{1, 0, 0}, 4);
    DOCTEST_CHECK(second.delta->removed == std::vector<RowId>{0});
}

DOCTEST_TEST_CASE("edits that build on another are named") {
    const DocumentState state = state_of(4);
    const EditNode hat = adding(state, 7);
    const DocumentState with_hat = with_stack(state, {hat});
    std::vector<std::uint8_t> of_hat(with_hat.current.size(), 0), of_rest = of_hat;
    of_hat.back() = 1, of_rest.front() = 1;
    EditNode on_hat = removal_of(with_hat, of_hat, 8), beside = removal_of(with_hat, of_rest, 9);
    on_hat.name = "on the hat", beside.name = "beside";
    DOCTEST_CHECK(edits_built_on({hat, on_hat, beside}, 7) == std::vector<std::string>{"on the hat"});
    DOCTEST_CHECK(edits_built_on({hat, on_hat, beside}, 8).empty());
    on_hat.enabled = false;
    DOCTEST_CHECK(edits_built_on({hat, on_hat, beside}, 7).empty());
}

DOCTEST_TEST_CASE("what an edit added belongs to the active label, or to one of its own") {
    DocumentState state = state_of(4);
    const auto nothing_active = with_edit(state, adding(state, 7), "hat", false);
    DOCTEST_REQUIRE(nothing_active.labels.size() == 1);
    DOCTEST_CHECK(nothing_active.labels[0].name == "hat");
    DOCTEST_CHECK(*nothing_active.labels[0].bits == std::vector<std::uint8_t>{0, 0, 0, 0, 1, 1});
    state.labels = {
        combine(empty_label("bear", 4), std::vector<std::uint8_t>{1, 0, 0, 0}, LabelOperation::Add)};
    state.active_label = 0;
    const auto grown = with_edit(state, adding(state, 7), "hat", false);
    DOCTEST_REQUIRE(grown.labels.size() == 1);
    DOCTEST_CHECK(*grown.labels[0].bits == std::vector<std::uint8_t>{1, 0, 0, 0, 1, 1});
    const auto beside = with_edit(state, adding(state, 7), "hat", true);
    DOCTEST_REQUIRE(beside.labels.size() == 2);
    DOCTEST_CHECK(beside.active_label == 1);
    DOCTEST_CHECK(count_labelled(beside.labels[0]) == 1);
    const auto only_less =
        with_edit(state, removal_of(state, std::vector<std::uint8_t>{0, 0, 0, 1}, 8), "hat", true);
    DOCTEST_CHECK(only_less.labels.size() == 1);  // nothing was added
    DOCTEST_CHECK(only_less.current.size() == 3);
}

DOCTEST_TEST_CASE("rows that fill a hole come with those that go, and belong to no label") {
    const DocumentState state = state_of(4);
    GaussianData fill = state.current.to_data();
    fill.resize(2);
    const EditNode node = exchange_of(state, std::vector<std::uint8_t>{0, 1, 0, 0}, fill, 7);
    DOCTEST_CHECK(node.delta->removed == std::vector<RowId>{1});
    DOCTEST_CHECK(node.delta->added.size() == 2);
    const auto healed = with_edit(state, node, "bear", false, std::vector<std::uint8_t>{1, 1});
    DOCTEST_CHECK(healed.labels.empty());
    DOCTEST_CHECK(healed.current.size() == 5);
    const auto half = with_edit(state, node, "bear", false, std::vector<std::uint8_t>{1, 0});
    DOCTEST_REQUIRE(half.labels.size() == 1);
    DOCTEST_CHECK(count_labelled(half.labels[0]) == 1);
}

}  // namespace stack_edits_test
