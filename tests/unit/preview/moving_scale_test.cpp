// The resolution while the camera moves: it settles where frames are fast enough, and stays there.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include "engine/preview/moving_scale.h"

#include <doctest/doctest.h>

#include <set>

namespace moving_scale_test {

using gse::preview::MovingScale;

namespace {

/// Milliseconds of a frame: some for every picture, some for its pixels.
struct Load {
    double fixed, full;
    double at(double share) const { return fixed + full * share * share; }
};

}  // namespace

DOCTEST_TEST_CASE("resolution falls until a frame takes at most 50 ms, and no farther") {
    for (const Load load :
         {Load{5, 20}, Load{5, 100}, Load{20, 100}, Load{30, 400}, Load{10, 2000}, Load{45, 900}}) {
        DOCTEST_CAPTURE(load.full);
        MovingScale scale;
        for (int frame = 0; frame < 12; ++frame) scale.learn(load.at(scale.scale()), scale.scale());
        std::set<double> settled;
        for (int frame = 0; frame < 50; ++frame) {
            settled.insert(scale.scale());
            scale.learn(load.at(scale.scale()), scale.scale());
        }
        DOCTEST_CHECK(settled.size() == 1);  // no flicker between sizes
        const double share = *settled.begin();
        DOCTEST_CHECK((load.at(share) <= MovingScale::FrameMs || share < 0.25));
        DOCTEST_CHECK((share == 1 || load.at(share * 1.42) > 0.8 * MovingScale::FrameMs));
    }
}

DOCTEST_TEST_CASE("other work makes it fall at once, and it comes back when that is over") {
    MovingScale scale;
    for (int frame = 0; frame < 20; ++frame) scale.learn(Load{4, 30}.at(scale.scale()), scale.scale());
    DOCTEST_CHECK(scale.scale() == 1);
    const Load busy{12, 240};
    int frames = 0;
    while (busy.at(scale.scale()) > MovingScale::FrameMs && frames < 20) {
        scale.learn(busy.at(scale.scale()), scale.scale());
        ++frames;
    }
    DOCTEST_CHECK(frames <= 3);
    for (int frame = 0; frame < 20; ++frame) scale.learn(Load{4, 30}.at(scale.scale()), scale.scale());
    DOCTEST_CHECK(scale.scale() == 1);
}

DOCTEST_TEST_CASE(
    "a picture at rest that was slow lowers the first one that moves, and numbers that are none teach "
    "nothing") {
    MovingScale scale;
    scale.learn(800, 1);
    DOCTEST_CHECK(scale.scale() < 0.51);
    const double before = scale.scale();
    scale.learn(0, 1);
    scale.learn(-5, 1);
    DOCTEST_CHECK(scale.scale() == before);
}

}  // namespace moving_scale_test
