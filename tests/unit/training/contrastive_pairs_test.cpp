// Twin pictures of the image-text encoder: true and false sentences.
#include <doctest/doctest.h>

#include <set>
#include <string>

#include "engine/laboratory/training/contrastive_pairs.h"
#include "engine/language/words.h"

namespace contrastive_pairs_test {

using namespace gse;

DOCTEST_TEST_CASE("false sentences of a twin differ from its true one, and are of its wording") {
    const auto pairs = training::make_contrastive_pairs(3);
    std::size_t told = 0;
    for (std::uint64_t index = 0; index < 120; ++index) {
        const auto own = pairs->claim(index, index, true);
        DOCTEST_CHECK((own.facts & ~pairs->facts(index)) == 0);
        const auto words = language::words_of(own.text);
        const std::set<std::string> mine(words.begin(), words.end());
        for (const auto& text : pairs->false_claims(index, index, true)) {
            DOCTEST_CAPTURE(own.text);
            DOCTEST_CAPTURE(text);
            DOCTEST_CHECK(text != own.text);
            std::size_t other = 0;
            for (const auto& word : language::words_of(text)) other += mine.contains(word) ? 0 : 1;
            // The replacement of an accessory differs in name, colour, "wearing a" or "with"; another object
            // in one word.
            DOCTEST_CHECK(other <= 4);
            ++told;
        }
    }
    DOCTEST_CHECK(told > 120);  // an object at least, of every picture but where the pair is held out
}

}  // namespace contrastive_pairs_test
