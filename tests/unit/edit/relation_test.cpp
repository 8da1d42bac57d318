// Relations in sentences: places of the target.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <string>

#include "engine/edit/request/decide_mode.h"
#include "engine/edit/search/locate.h"
#include "engine/language/lexicon.h"
#include "engine/language/sentence.h"
#include "tests/unit/edit/requests.h"

namespace relation_test {

namespace {

using namespace gse;
using language::Relation;

struct Said {
    std::string sentence, target;
    Relation relation;
    std::string before;  // the sentence before the edit, of a bear
};

const std::vector<Said>& table() {
    static const std::vector<Said> all{
        {"a ball beside a bear", "ball", Relation::Beside, "a bear"},
        {"a bear beside a ball", "ball", Relation::Beside, "a bear"},
        {"a bear with a ball beside it", "ball", Relation::Beside, "a bear"},
        {"a bear next to a red ball on the grass", "ball", Relation::Beside, "a bear on the grass"},
        {"a beach ball near a brown bear", "beach ball", Relation::Beside, "a brown bear"},
        {"a ball bouncing beside a bear", "ball", Relation::Beside, "a bear"},
        {"a ball behind the bear", "ball", Relation::Behind, "the bear"},
        {"a bear behind a ball", "ball", Relation::Before, "a bear"},
        {"a bear with flames behind it on the grass", "flames", Relation::Behind, "a bear on the grass"},
        {"a bear in front of a tree", "tree", Relation::Behind, "a bear"},
        {"a ball in front of a bear", "ball", Relation::Before, "a bear"},
        {"a ball to the left of the bear", "ball", Relation::Left, "the bear"},
        {"a bear left of a ball", "ball", Relation::Right, "a bear"},
        {"a ball right of a bear", "ball", Relation::Right, "a bear"},
        {"a bear under a hat", "hat", Relation::Above, "a bear"},
        {"a rug under a bear", "rug", Relation::Under, "a bear"},
        {"a bear on a car", "car", Relation::Under, "a bear"},
        {"a hat on the bear", "hat", Relation::Above, "the bear"},
        {"a hat on top of a bear", "hat", Relation::Above, "a bear"},
        {"a bear wearing a hat", "hat", Relation::None, "a bear"},
        {"a bear on grass wearing a hat", "hat", Relation::None, "a bear on grass"},
        {"a bear with a hat beside a tree", "hat", Relation::None, "a bear beside a tree"},
        {"a blue bear on the grass", "blue", Relation::None, "a bear on the grass"},
        {"a bear made of stone", "stone", Relation::None, "a bear"},
        {"a panda beside a tree", "panda", Relation::None, "a bear beside a tree"},
        {"a bear", "bear", Relation::None, "a bear"}};
    return all;
}

}  // namespace

DOCTEST_TEST_CASE("the sentence says where the target is, seen from the source") {
    for (const auto& said : table()) {
        DOCTEST_INFO(said.sentence);
        DOCTEST_CHECK(
            language::EditSentence(language::Sentence(said.sentence), "bear", said.target).relation() ==
            said.relation);
    }
    DOCTEST_CHECK(
        language::EditSentence(language::Sentence("a blue bear on the grass"), "grass", "blue").relation() ==
        Relation::None);
    DOCTEST_CHECK(
        language::EditSentence(language::Sentence("a bear beside a ball"), "ball", "bear").relation() ==
        Relation::Beside);
}

DOCTEST_TEST_CASE("what stands somewhere is added, and the sentence before has neither it nor its place") {
    for (const auto& said : table()) {
        DOCTEST_INFO(said.sentence);
        const auto request = test::asked("bear", said.sentence, said.target);
        DOCTEST_CHECK(request.sentence().before() == said.before);
        if (said.relation != Relation::None)
            DOCTEST_CHECK(edit::decide_mode(request, std::nullopt).first == edit::EditMode::Add);
    }
}

DOCTEST_TEST_CASE(
    "a thing in a scene whose ground was named is added; another ground or look changes the ground") {
    const auto mode = [](const char* sentence, const char* target) {
        return edit::decide_mode(test::asked("floor", sentence, target), std::nullopt).first;
    };
    DOCTEST_CHECK(mode("a red chair in a kitchen", "chair") == edit::EditMode::Add);
    DOCTEST_CHECK(mode("a bear on the snow", "snow") == edit::EditMode::Modify);
    DOCTEST_CHECK(mode("make it wooden", "wooden") == edit::EditMode::Modify);
    DOCTEST_CHECK(mode("a kitchen with a wooden floor", "wooden") == edit::EditMode::Modify);
}

DOCTEST_TEST_CASE("compound prepositions name no things") {
    using Things = std::vector<std::string>;
    DOCTEST_CHECK(language::Sentence("a bear next to a ball").things() == Things{"bear", "ball"});
    DOCTEST_CHECK(language::Sentence("a bear in front of a tree to the left of a ball").things() ==
                  Things{"bear", "tree", "ball"});
}

}  // namespace relation_test
