// Documents: the stack of edits, labels that follow their rows, undo against a plain model, memory bounds.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <map>

#include "tests/unit/scene/random_sets.h"

namespace document_test {

using namespace gse;
using namespace gse::test;

namespace {

DocumentState fresh_state(std::size_t count, std::uint64_t seed, int degree = 1) {
    Scene scene;
    scene.gaussians = random_set(count, degree, seed);
    return initial_state(scene, {});
}

/// Deep copy of a state's looks.
struct Picture {
    GaussianData rows;
    std::vector<RowId> ids;
    std::vector<std::vector<std::uint8_t>> bits;
    std::size_t edits = 0;
};

Picture picture_of(const DocumentState& state) {
    Picture picture{state.current.to_data(), *state.row_ids, {}, state.stack.size()};
    for (const auto& label : state.labels) picture.bits.push_back(*label.bits);
    return picture;
}

bool same(const Picture& a, const Picture& b) {
    return bits_equal(GaussianSet(a.rows), GaussianSet(b.rows)) && a.ids == b.ids && a.bits == b.bits &&
           a.edits == b.edits;
}

/// Weight and correction by identity.
std::map<RowId, std::pair<float, int>> by_identity(const DocumentState& state, std::size_t label) {
    std::map<RowId, std::pair<float, int>> values;
    for (std::size_t row = 0; row < state.row_ids->size(); ++row)
        values[(*state.row_ids)[row]] = {(*state.labels[label].weight)[row],
                                         (*state.labels[label].manual)[row]};
    return values;
}

}  // namespace

DOCTEST_TEST_CASE("a loaded label keeps its bits") {
    Scene scene;
    scene.gaussians = random_set(4, 0, 1);
    scene.labels.labels.push_back(make_label("hat", {0.1f, 0.3f, 0.6f, 0.9f}, 0.2f));
    const DocumentState state = initial_state(scene, {});
    DOCTEST_REQUIRE(state.labels.size() == 1);
    DOCTEST_CHECK(state.active_label == 0);
    DOCTEST_CHECK(*state.labels[0].bits == std::vector<std::uint8_t>{0, 1, 1, 1});
    DOCTEST_CHECK(*state.labels[0].weight == *scene.labels.labels[0].weight);
    DOCTEST_CHECK(state.current.shares_all_with(scene.gaussians));
}

DOCTEST_TEST_CASE("bits follow weight, threshold and corrections") {
    NamedLabel label;
    label.weight = std::make_shared<const std::vector<float>>(std::vector<float>{0.2f, 0.8f, 0.2f, 0.8f});
    label.manual = std::make_shared<const std::vector<std::int8_t>>(std::vector<std::int8_t>{0, 0, 1, -1});
    DOCTEST_CHECK(*with_bits(label).bits == std::vector<std::uint8_t>{0, 1, 1, 0});
    label.manual = nullptr;
    DOCTEST_CHECK(*with_bits(label).bits == std::vector<std::uint8_t>{0, 1, 0, 1});
}

DOCTEST_TEST_CASE("the strength of an edit of the stack can be changed, undone and brought back") {
    for (std::uint64_t seed = 0; seed < 6; ++seed) {
        DocumentState state = fresh_state(120, seed);
        for (std::uint64_t i = 0; i < 3; ++i) state = with_edit(state, random_node(state, seed * 10 + i));
        state.labels = {random_label(state, seed)};
        const Picture whole = picture_of(state);
        Document document(state);
        const auto set_strength = [&](std::size_t which, double strength) {
            auto stack = document.state().stack;
            stack[which].strength = strength;
            document.apply("Strength", with_stack(document.state(), std::move(stack)));
        };
        for (std::size_t which = 0; which < 3; ++which) {
            set_strength(which, 0.5);
            DOCTEST_CHECK(!same(picture_of(document.state()), whole));
            document.undo();
            DOCTEST_CHECK(same(picture_of(document.state()), whole));
            set_strength(which, 0.5);
            set_strength(which, 1);
            DOCTEST_CHECK(same(picture_of(document.state()), whole));
            // None of an edit is the same as the edit switched off.
            auto stack = state.stack;
            stack[which].enabled = false;
            const Picture off = picture_of(with_stack(state, std::move(stack)));
            set_strength(which, 0);
            DOCTEST_CHECK(same(picture_of(document.state()), off));
            set_strength(which, 1);
        }
    }
}

DOCTEST_TEST_CASE("edits switched off and on again give the same scene and the same labels") {
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
        DocumentState state = fresh_state(120, seed);
        for (std::uint64_t i = 0; i < 4; ++i) state = with_edit(state, random_node(state, seed * 10 + i));
        state.labels = {random_label(state, seed), random_label(state, seed + 1)};
        const Picture whole = picture_of(state);
        const auto values = by_identity(state, 0);
        Random random(seed);
        for (int flip = 0; flip < 12; ++flip) {
            auto stack = state.stack;
            const auto which = random.below(stack.size());
            stack[which].enabled = !stack[which].enabled;
            state = with_stack(state, std::move(stack));
            // Rows of base that no enabled edit names are those of the base, bit for bit.
            for (std::size_t row = 0; row < state.row_ids->size(); ++row) {
                const RowId id = (*state.row_ids)[row];
                const bool named =
                    std::any_of(state.stack.begin(), state.stack.end(), [&](const EditNode& edit) {
                        return edit.enabled &&
                               std::binary_search(edit.delta->changed.begin(), edit.delta->changed.end(), id);
                    });
                if (id >> 32 == 0 && !named)
                    DOCTEST_CHECK(same_row(state.current.spans(), row, state.base.spans(),
                                           static_cast<std::size_t>(id)));
            }
            for (const auto& [id, value] : by_identity(state, 0)) {
                const auto before = values.find(id);
                const bool same_value =
                    (before == values.end() ? std::pair<float, int>{0, 0} : before->second) == value;
                DOCTEST_CHECK(same_value);
            }
        }
        auto stack = state.stack;
        for (auto& edit : stack) edit.enabled = true;
        state = with_stack(state, std::move(stack));
        DOCTEST_CHECK(same(picture_of(state), whole));
    }
}

DOCTEST_TEST_CASE("labels forget the rows of deleted edits") {
    DocumentState state = fresh_state(60, 3);
    state = with_edit(state, random_node(state, 31));
    state.labels = {random_label(state, 5)};
    const DocumentState without = with_stack(state, {});
    DOCTEST_CHECK(without.labels[0].bits->size() == 60);
    if (without.labels[0].absent != nullptr)
        for (const RowId id : without.labels[0].absent->ids) DOCTEST_CHECK((id >> 32) == 0u);
}

DOCTEST_TEST_CASE("undo and redo walk like a plain list of copies") {
    for (std::uint64_t seed = 0; seed < 8; ++seed) {
        Random random(seed);
        DocumentState start = fresh_state(80, seed);
        // Half of the documents have so few bytes that states give up their arrays and are built again.
        Document::Limits limits;
        if (seed % 2 == 1) limits.bytes = 60000;
        Document document(start, limits);
        std::vector<Picture> model{picture_of(start)};
        std::size_t position = 0;
        for (int step = 0; step < 60; ++step) {
            const auto what = random.below(5);
            if (what < 2) {
                DocumentState next = document.state();
                if (random.below(2) == 0) next = with_edit(next, random_node(next, random.next()));
                else next.labels.push_back(random_label(next, random.next()));
                document.apply("step", next);
                model.resize(position + 1);
                model.push_back(picture_of(next));
                ++position;
            } else if (what == 2) {
                DOCTEST_CHECK(document.can_undo() == (document.position() > 0));
                if (document.can_undo()) --position;
                document.undo();
            } else if (what == 3) {
                if (document.can_redo()) ++position;
                document.redo();
            } else {
                const auto to = random.below(document.names().size());
                position = position - document.position() + to;
                document.go_to(to);
            }
            const auto any = static_cast<std::size_t>(step * 7) %
                             document.names().size();  // looked at without going there
            DOCTEST_REQUIRE(
                same(picture_of(document.state_at(any)), model[position - document.position() + any]));
            DOCTEST_CHECK(document.revision_at(document.position()) == document.revision());
            DOCTEST_REQUIRE(same(picture_of(document.state()), model[position]));
            DOCTEST_CHECK(document.undo_bytes() <= limits.bytes);
            DOCTEST_CHECK(document.names().size() <= limits.entries);
        }
    }
}

DOCTEST_TEST_CASE("undo is bounded in entries and bytes, and labels alone cost little") {
    Document::Limits limits;
    limits.entries = 10;
    limits.bytes = 1 << 20;
    DocumentState state = fresh_state(2000, 1, 3);
    Document document(state, limits);
    for (std::uint64_t i = 0; i < 40; ++i) {
        DocumentState next = document.state();
        next.labels = {random_label(next, i)};
        document.apply("label", next);
        DOCTEST_CHECK(document.names().size() <= 10);
        DOCTEST_CHECK(document.undo_bytes() <= limits.bytes);
    }
    DOCTEST_CHECK(document.undo_bytes() <
                  10 * 2000 * 10);  // 6 bytes a row and state, the scene itself is shared
    limits.bytes = 1000;
    Document tight(state, limits);
    for (std::uint64_t i = 0; i < 5; ++i)
        tight.apply("edit", with_edit(tight.state(), random_node(tight.state(), i)));
    DOCTEST_CHECK(tight.undo_bytes() <= limits.bytes);
    DOCTEST_CHECK(tight.names().size() < 6);
    DOCTEST_CHECK(tight.state().stack.size() == 5);
}

DOCTEST_TEST_CASE("a step is part of the document until it is undone, and again when it is redone") {
    Document document(fresh_state(20, 3), {.entries = 4});
    std::vector<std::uint64_t> steps{document.revision()};
    for (int step = 0; step < 3; ++step) {
        document.apply("step", document.state());
        steps.push_back(document.revision());
    }
    for (std::size_t position = 0; position < steps.size(); ++position) {
        document.go_to(position);
        for (std::size_t step = 0; step < steps.size(); ++step)
            DOCTEST_CHECK(document.includes(steps[step]) == (step <= position));
    }
    document.go_to(1);
    document.apply("another way", document.state());
    DOCTEST_CHECK(document.includes(steps[1]));
    DOCTEST_CHECK_FALSE(document.includes(steps[2]));  // it cannot be had back
    for (int step = 0; step < 6; ++step) document.apply("more", document.state());
    DOCTEST_CHECK(document.includes(steps[0]));  // forgotten, not undone
    DOCTEST_CHECK_FALSE(Document().includes(1));
}

DOCTEST_TEST_CASE("steps of one stroke become one; revisions tell what is unsaved") {
    Document document(fresh_state(10, 1));
    const auto saved = document.revision();
    for (std::uint64_t i = 0; i < 3; ++i) {
        DocumentState next = document.state();
        next.labels = {random_label(next, i)};
        document.apply("brush", next, "stroke 1");
    }
    DOCTEST_CHECK(document.names() == std::vector<std::string>{"Open", "brush"});
    DOCTEST_CHECK(document.revision() != saved);
    const auto stroke = document.revision();
    document.undo();
    DOCTEST_CHECK(document.revision() == saved);
    document.redo();
    DOCTEST_CHECK(document.revision() == stroke);
    document.apply("brush", document.state(), "stroke 1");  // after moving about it is a new stroke
    DOCTEST_CHECK(document.names().size() == 3);
    DOCTEST_CHECK(Document().empty());
}

}  // namespace document_test
