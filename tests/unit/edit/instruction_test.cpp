// Descriptions become orders for models that edit pictures by instructions.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "engine/edit/request/checked_request.h"
#include "engine/edit/request/unchecked_request.h"

namespace instruction_test {

using namespace gse::edit;

namespace {

EditRequest asked(const std::string& source, const std::string& prompt, const std::string& instruction = {}) {
    EditRequest request;
    request.source = source;
    request.prompt = prompt;
    request.instruction = instruction;
    return request;
}

}  // namespace

DOCTEST_TEST_CASE(
    "instruction: what the artist says, else the source is turned into what the sentence describes") {
    DOCTEST_CHECK(instruction_of(asked("bear", "a golden bear", "make the bear golden")) ==
                  "make the bear golden");
    DOCTEST_CHECK(instruction_of(asked("bear", "a golden bear")) == "turn the bear into golden bear");
    DOCTEST_CHECK(instruction_of(asked("teddy bear", "The teddy bear wearing a hat.")) ==
                  "turn the teddy bear into teddy bear wearing a hat");
    DOCTEST_CHECK(instruction_of(asked("bear", "an orange * bear")) == "turn the bear into orange bear");
    DOCTEST_CHECK(instruction_of(asked("", "a snowy garden")) == "make it snowy garden");
    DOCTEST_CHECK(instruction_of(check(asked("bear", "A golden bear."))) == "turn the bear into golden bear");
    DOCTEST_CHECK(instruction_of(check(asked("bear", "a golden bear", "gild it"))) == "gild it");
    // No article.
    DOCTEST_CHECK(instruction_of(asked("bear", "andalusian bear")) == "turn the bear into andalusian bear");
}

}  // namespace instruction_test
