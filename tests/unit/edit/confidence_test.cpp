// How sure a search is, and when that is not enough.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "engine/edit/search/confidence.h"
#include "tests/unit/edit/locate_scenes.h"

namespace confidence_test {

using namespace locate_scenes;

DOCTEST_TEST_CASE("a search that is less sure than asked for is marked, with what it found") {
    const Quiet quiet;
    Fixture fixture;
    auto request = request_for("a blue ball", "blue");
    request.least_confidence = 0;
    const auto found = edit::locate(fixture.input(request), fixture.tools());
    DOCTEST_CHECK(found.problem == edit::SearchProblem::None);
    DOCTEST_CHECK(found.confidence.value > 0);
    DOCTEST_CHECK(found.confidence.value <= 1);
    for (const double part : {found.confidence.part("agreement"), found.confidence.part("attention_inside"),
                              found.confidence.part("labelled_share")})
        DOCTEST_CHECK((part > 0 && part <= 1));
    edit::require_found(found);
    request.least_confidence = 1;
    const auto unsure = edit::locate(fixture.input(request), fixture.tools());
    DOCTEST_CHECK(unsure.problem == edit::SearchProblem::Unsure);
    DOCTEST_CHECK(*unsure.label.bits == *found.label.bits);
    DOCTEST_CHECK(unsure.confidence.value == found.confidence.value);
    DOCTEST_CHECK_THROWS_AS(edit::require_found(unsure), Error);
    // An addition belongs to something that must be found, too.
    request = request_for("a ball with a hat", "hat");
    request.least_confidence = 1;
    const auto nowhere = edit::locate(fixture.input(request), fixture.tools());
    DOCTEST_CHECK(nowhere.mode == edit::EditMode::Add);
    DOCTEST_CHECK(nowhere.problem == edit::SearchProblem::Unsure);
    DOCTEST_CHECK(nowhere.word == "ball");
    DOCTEST_CHECK(nowhere.seeds.size() == 0);
}

DOCTEST_TEST_CASE("one or two splats are no thing") {
    const Quiet quiet;
    Fixture fixture;
    auto request = request_for("a blue ball", "blue");
    request.label_smoothness = 0;
    request.least_confidence = 0;
    const auto whole = fixture.scene;
    for (const std::size_t red : {2, 12}) {
        auto keep = whole.first;
        for (std::size_t row = 0, left = red; row < keep.size(); ++row)
            keep[row] = keep[row] == 0 || (left > 0 && left-- > 0) ? 1 : 0;
        fixture.scene.set = whole.set.filtered(keep);
        const auto found = edit::locate(fixture.input(request), fixture.tools());
        const auto labelled = std::count(found.label.bits->begin(), found.label.bits->end(), std::uint8_t{1});
        DOCTEST_CHECK((found.problem == edit::SearchProblem::None) == (red > 2));
        DOCTEST_CHECK((labelled > 3) == (red > 2));
        if (red == 2) DOCTEST_CHECK(found.problem == edit::SearchProblem::NothingLabelled);
    }
}

DOCTEST_TEST_CASE(
    "a word that is found in everything is not found where the sentence names other things too") {
    const Quiet quiet;
    Fixture fixture;
    fixture.scene.set = fixture.scene.set.filtered(fixture.scene.first);  // the red ball alone
    auto request = request_for("a blue ball", "blue");
    request.least_confidence = 0.05;
    const auto alone = edit::locate(fixture.input(request), fixture.tools());
    DOCTEST_CHECK(alone.problem == edit::SearchProblem::None);
    DOCTEST_CHECK(alone.confidence.part("labelled_share") > 0.99);
    request = request_for("a blue ball on the grass", "blue");
    request.least_confidence = 0.05;
    const auto all = edit::locate(fixture.input(request), fixture.tools());
    DOCTEST_CHECK(all.confidence.part("labelled_share") > 0.97);
    DOCTEST_CHECK(all.confidence.value == 0);
    DOCTEST_CHECK(all.problem == edit::SearchProblem::Unsure);
    request.competing_words = "none";  // whoever knows better may say so
    DOCTEST_CHECK(edit::locate(fixture.input(request), fixture.tools()).problem == edit::SearchProblem::None);
}

}  // namespace confidence_test
