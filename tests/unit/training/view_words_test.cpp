// Names of a training picture's side, and the editor's names for it.
#include <doctest/doctest.h>

#include "engine/edit/search/front_reading.h"
#include "engine/laboratory/synth/synth.h"

namespace view_words_test {

DOCTEST_TEST_CASE("between two sides, captions and the editor mix the same words") {
    for (double azimuth = -7; azimuth < 7; azimuth += 0.1) {
        const auto here = gse::synth::side_blend(azimuth);
        const auto there = gse::edit::side_blend(azimuth);
        DOCTEST_CHECK_EQ(here.words, there.words);
        DOCTEST_CHECK_EQ(here.next_words, there.next_words);
        DOCTEST_CHECK_EQ(here.share, doctest::Approx(there.share).epsilon(1e-12));
        // The nearer of the two is what the side is called, and the mixture goes on where the sector ends.
        DOCTEST_CHECK_EQ(here.share < 0.5 ? here.words : here.next_words,
                         gse::synth::sided_view_words(azimuth));
        constexpr double sector = 0.78539816339744831;
        DOCTEST_CHECK_EQ(gse::synth::side_blend(azimuth + sector).words, here.next_words);
    }
}

DOCTEST_TEST_CASE("captions and the editor call the eight sides of a thing by the same names") {
    for (double azimuth = -7; azimuth < 7; azimuth += 0.1)
        DOCTEST_CHECK_EQ(gse::synth::sided_view_words(azimuth), gse::edit::view_words(azimuth, true));
}

}  // namespace view_words_test
