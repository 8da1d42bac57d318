// Pictures that do not follow the order, as servers draw them: told by their surroundings.
#include <doctest/doctest.h>

#include "engine/localize/clusters.h"
#include "engine/remote/protocols/connect.h"
#include "engine/remote/views/acceptance.h"
#include "tests/stress/remote/stand_in.h"

namespace gse::remote {
namespace {

constexpr int FrameSide = 256;

/// Two waves of different lengths: a shift of one picture fits no other place.
ViewFrame wavy_frame() {
    ViewFrame frame;
    frame.picture = Image(FrameSide, FrameSide, 3);
    frame.mask = Mask(FrameSide, FrameSide);
    for (int y = 0; y < FrameSide; ++y)
        for (int x = 0; x < FrameSide; ++x) {
            for (int c = 0; c < 3; ++c)
                frame.picture.at(x, y, c) =
                    0.5f + 0.2f * std::sin(0.11f * static_cast<float>(x + y * c)) +
                    0.2f * std::cos(0.043f * static_cast<float>(y * y / 40 - x * (c + 1)));
            frame.mask.at(x, y) = std::hypot(x - 128, y - 128) < 50 ? 1 : 0;
        }
    frame.original = frame.picture;
    frame.sent_mask = localize::dilate(frame.mask, 12);
    return frame;
}

CheckedPicture checked(const char* flavour, const Knobs& knobs, const std::string& prompt = "a golden wall") {
    const auto frame = wavy_frame();
    auto& stand_in = shared_stand_in(flavour);
    const auto server = connect(stand_in.address(), {});
    stand_in.reset(knobs);
    auto order = small_order(prompt);
    order.picture = frame.picture;
    order.mask = as_image(frame.sent_mask);
    return check_answer(frame, server->redraw(order, {}).picture);
}

DOCTEST_TEST_CASE("drawn pictures that moved by 1 or 5 pixels are moved back, those by 40 are refused") {
    if (!can_stand_in()) return;
    DOCTEST_CHECK(checked("sdserver", {}).flaw == Flaw::None);
    const auto one = checked("sdserver", {{"drift", "1"}}), five = checked("sdserver", {{"drift", "5"}});
    DOCTEST_CHECK(one.flaw == Flaw::None);
    DOCTEST_CHECK(five.flaw == Flaw::None);
    DOCTEST_CHECK(five.drift * FrameSide == doctest::Approx(5).epsilon(0.2));
    DOCTEST_CHECK(five.psnr > 25);
    DOCTEST_CHECK(checked("sdserver", {{"drift", "40"}}).flaw != Flaw::None);
}

DOCTEST_TEST_CASE("another picture, an ignored mask and an unedited copy are found out") {
    if (!can_stand_in()) return;
    DOCTEST_CHECK(checked("lookalike", {{"fault", "unrelated"}}).flaw == Flaw::Unrelated);
    const auto whole = checked("lookalike", {{"fault", "mask_ignored"}});
    DOCTEST_CHECK(whole.flaw == Flaw::Unrelated);
    DOCTEST_CHECK(whole.note.find("has not looked at our picture") != std::string::npos);
    DOCTEST_CHECK(checked("lookalike", {}, "a wall").flaw == Flaw::Unedited);  // no colour is named
}

}  // namespace
}  // namespace gse::remote
