// Tells whether a label or a search says what an edit may change.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "app/session/state/edit_scope.h"
#include "engine/base/fields.h"
#include "engine/scene/label_ops.h"

namespace edit_scope_test {

namespace {

using namespace gse;
using app::label_says;
using app::ScopeChoice;

const std::vector<std::string> Known{"bear", "hat", "golden", "grass"};

NamedLabel painted(const std::string& name) {
    return combine(empty_label(name, 4), std::vector<std::uint8_t>{1, 1, 0, 0}, LabelOperation::Add);
}

NamedLabel found(const std::string& name, const std::string& word) {
    NamedLabel label = empty_label(name, 4);
    label.found_for = word;
    label.weight = std::make_shared<const std::vector<float>>(std::vector<float>{0.9f, 0.8f, 0, 0});
    return with_bits(label);
}

edit::EditRequest about(const std::string& source, const std::string& target) {
    edit::EditRequest request;
    request.source = source;
    request.target = target;
    return request;
}

}  // namespace

DOCTEST_TEST_CASE(
    "a label made by hand drives the edit of its own word, and of one that the model cannot find") {
    DOCTEST_CHECK(label_says(painted("hat"), about("hat", "golden"), Known, {}));
    DOCTEST_CHECK(label_says(painted("hat"), about("Hat", "golden"), Known, {}));
    DOCTEST_CHECK_FALSE(
        label_says(painted("hat"), about("bear", "golden"), Known, {}));  // what an addition left
    DOCTEST_CHECK(label_says(painted("label"), about("crane", "golden"), Known, {}));
    DOCTEST_CHECK_FALSE(
        label_says(painted("label"), about("bear", "golden"), {}, {}));  // a model that takes any word
    DOCTEST_CHECK_FALSE(
        label_says(empty_label("hat", 4), about("hat", "golden"), Known, {}));  // nothing in it
    DOCTEST_CHECK(label_says(painted("label"), about("", "crane"), Known, {}));
    DOCTEST_CHECK_FALSE(label_says(painted("label"), about("", "golden"), Known, {}));
}

DOCTEST_TEST_CASE("a label named like a file answers to its thing, behind one with the very name") {
    using app::scope_label;
    DocumentState state;
    state.labels = {painted("bear"), painted("object_guitar")};
    state.active_label = 0;
    DOCTEST_CHECK(scope_label(state, about("guitar", "blue"), Known, {}) == std::size_t{1});
    DOCTEST_CHECK(scope_label(state, about("bear", "blue"), Known, {}) == std::size_t{0});
    state.labels.push_back(painted("guitar"));
    state.active_label = 1;
    DOCTEST_CHECK(scope_label(state, about("guitar", "blue"), Known, {}) == std::size_t{2});
    DOCTEST_CHECK(app::things_labelled(state) ==
                  std::vector<std::string>{"bear", "object guitar", "guitar", "guitar"});
}

DOCTEST_TEST_CASE("the artist's word goes first, for the source it was given for") {
    const ScopeChoice label{true, "label", "bear"}, search{false, "bear", "bear"}, any{true, "label", ""};
    DOCTEST_CHECK(label_says(painted("label"), about("bear", "golden"), Known, label));
    DOCTEST_CHECK_FALSE(label_says(painted("label"), about("grass", "golden"), Known, label));
    DOCTEST_CHECK_FALSE(label_says(painted("other"), about("bear", "golden"), Known, label));
    DOCTEST_CHECK_FALSE(label_says(found("bear", "bear"), about("bear", "golden"), Known, search));
    DOCTEST_CHECK(label_says(painted("label"), about("grass", "golden"), Known, any));
}

DOCTEST_TEST_CASE(
    "the label of an edit is the one that is named for its thing, not what an addition left active") {
    using app::scope_label;
    DocumentState state;
    std::vector<RowId> ids{0, 1, 2, (RowId{5} << EditIdShift) + 1};  // the last row is of edit 5
    state.row_ids = std::make_shared<const std::vector<RowId>>(ids);
    const auto hat =
        combine(empty_label("hat", 4), std::vector<std::uint8_t>{0, 0, 0, 1}, LabelOperation::Add);
    DOCTEST_CHECK(app::is_addition(hat, ids));
    DOCTEST_CHECK_FALSE(app::is_addition(painted("hat"), ids));
    state.labels = {found("Bruno", "bear"), painted("cut out"), hat};
    state.active_label = 2;
    const auto index = [&](const edit::EditRequest& request, const std::optional<ScopeChoice>& choice) {
        return static_cast<int>(scope_label(state, request, Known, choice).value_or(99));
    };
    constexpr int searched = 99;
    const ScopeChoice for_crane{true, "cut out", "crane"}, never{false, "Bruno", "bear"};
    DOCTEST_CHECK(index(about("bear", "golden"), {}) == 0);
    DOCTEST_CHECK(index(about("bear", "golden"), never) == searched);
    DOCTEST_CHECK(index(about("hat", "blue"), {}) == 2);
    DOCTEST_CHECK(index(about("", "hat"), {}) == 2);
    DOCTEST_CHECK(index(about("grass", "snow"), {}) == searched);
    DOCTEST_CHECK(index(about("crane", "golden"), {}) == searched);  // the addition is no crane
    DOCTEST_CHECK(index(about("crane", "golden"), for_crane) == 1);
    state.active_label = 1;
    DOCTEST_CHECK(index(about("crane", "golden"), {}) == 1);  // made by hand, and of no other thing
    DOCTEST_CHECK(index(about("scarf", "golden"), for_crane) == searched);
    DOCTEST_CHECK(index(about("bear", "golden"), for_crane) == 0);
    state.active_label = -1;
    DOCTEST_CHECK(index(about("bear", "golden"), {}) == 0);
    DOCTEST_CHECK(index(about("crane", "golden"), {}) == searched);
}

DOCTEST_TEST_CASE("a thing that is there already is known by what added it, and by its label") {
    using app::present_already;
    DocumentState state;
    edit::EditRequest request = about("bear", "hat");
    request.prompt = "a bear wearing a red hat";
    DOCTEST_CHECK(present_already(state, request) == "");
    EditNode node;
    node.recipe = nlohmann::json{{"request", fields_to_json(request)}}.dump();
    state.stack = {node};
    DOCTEST_CHECK(present_already(state, request) == "hat");
    edit::EditRequest other = request;
    other.prompt = "a bear wearing a crown";
    other.target = "crown";
    DOCTEST_CHECK(present_already(state, other) == "");
    edit::EditRequest change = about("hat", "red");
    change.prompt = "a red hat";
    DOCTEST_CHECK(present_already(state, change) == "");
    state.stack[0].enabled = false;
    DOCTEST_CHECK(present_already(state, request) == "");
    edit::EditRequest seen = request;
    seen.target = "red";  // that much is new, as a search saw it
    DOCTEST_CHECK(present_already(state, seen, "red") == "hat");
    DOCTEST_CHECK(present_already(state, request, "hat") == "");
    state.labels = {painted("hat")};
    DOCTEST_CHECK(present_already(state, request) == "hat");
}

DOCTEST_TEST_CASE("a label that was found belongs to its word under any name") {
    DOCTEST_CHECK(label_says(found("bear", "bear"), about("bear", "golden"), Known, {}));
    DOCTEST_CHECK(label_says(found("Bruno", "bear"), about("bear", "golden"), Known, {}));
    DOCTEST_CHECK_FALSE(label_says(found("Bruno", "bear"), about("grass", "golden"), Known, {}));
}

DOCTEST_TEST_CASE("the label of a thing that the model drew and cannot find says where it is") {
    using app::stands_alone;
    DOCTEST_CHECK(label_says(found("rabbit", "bear"), about("rabbit", "pink"), Known,
                             {}));  // named after what came in the bear's place
    DOCTEST_CHECK(stands_alone(found("rabbit", "bear"), about("rabbit", "pink"), Known));
    DOCTEST_CHECK(stands_alone(found("rabbit", "bear"), about("Rabbit", "pink"), Known));
    DOCTEST_CHECK_FALSE(
        stands_alone(found("rabbit", "bear"), about("bear", "golden"), Known));  // that is looked for
    DOCTEST_CHECK_FALSE(
        stands_alone(found("rabbit", "bear"), about("horse", "pink"), Known));  // of another thing
    DOCTEST_CHECK_FALSE(
        stands_alone(found("rabbit", "bear"), about("rabbit", "pink"), {}));  // a model that takes any word
    DOCTEST_CHECK(stands_alone(painted("label"), about("bear", "golden"), Known));
}

}  // namespace edit_scope_test
