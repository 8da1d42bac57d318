// Tells whether a label or a search says what an edit may change.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "app/session/state/edit_scope.h"
#include "engine/scene/label_ops.h"

namespace reach_test {

namespace {

using namespace gse;
using app::label_says;
using app::ReachChoice;

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

DOCTEST_TEST_CASE("the artist's word goes first, for the source it was given for") {
    const ReachChoice label{true, "label", "bear"}, search{false, "bear", "bear"}, any{true, "label", ""};
    DOCTEST_CHECK(label_says(painted("label"), about("bear", "golden"), Known, label));
    DOCTEST_CHECK_FALSE(label_says(painted("label"), about("grass", "golden"), Known, label));
    DOCTEST_CHECK_FALSE(label_says(painted("other"), about("bear", "golden"), Known, label));
    DOCTEST_CHECK_FALSE(label_says(found("bear", "bear"), about("bear", "golden"), Known, search));
    DOCTEST_CHECK(label_says(painted("label"), about("grass", "golden"), Known, any));
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

}  // namespace reach_test
