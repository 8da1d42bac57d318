// Shortcuts follow what is written on the keys.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "engine/window/key_names.h"

namespace key_names_test {

using gse::window::written_key;

DOCTEST_TEST_CASE("a letter is the key that it is written on") {
    DOCTEST_CHECK(written_key('Y', "z") == 'Z');  // QWERTZ: Ctrl + Z is where Z is
    DOCTEST_CHECK(written_key('Z', "y") == 'Y');
    DOCTEST_CHECK(written_key('Q', "a") == 'A');  // AZERTY
    DOCTEST_CHECK(written_key(';', "m") == 'M');
    DOCTEST_CHECK(written_key('M', ",") == ',');  // and not a second M
    DOCTEST_CHECK(written_key('B', "b") == 'B');
}

DOCTEST_TEST_CASE("what has no name, or another one than a letter, stays where it is") {
    DOCTEST_CHECK(written_key('A', nullptr) == 'A');
    DOCTEST_CHECK(written_key('A', "") == 'A');
    DOCTEST_CHECK(written_key('[', "\xC3\xBC") == '[');  // ü on QWERTZ: the brush's size
    DOCTEST_CHECK(written_key('B', "\xD0\xB8") == 'B');  // и: Cyrillic keyboards have no other B
    DOCTEST_CHECK(written_key('1', "&") == '1');         // AZERTY's digits are shifted
}

}  // namespace key_names_test
