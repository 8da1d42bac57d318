// What a training picture's side is called, and what the editor calls it.
#include <doctest/doctest.h>

#include "engine/edit/front_reading.h"
#include "engine/synth/synth.h"

DOCTEST_TEST_CASE("captions and the editor call the eight sides of a thing by the same names") {
    for (double azimuth = -7; azimuth < 7; azimuth += 0.1)
        DOCTEST_CHECK_EQ(gse::synth::sided_view_words(azimuth), gse::edit::view_words(azimuth, true));
}
