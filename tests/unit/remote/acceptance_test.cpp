// Answers that are used, and answers that are not.
#include <doctest/doctest.h>

#include "engine/localize/clusters.h"
#include "engine/remote/views/acceptance.h"
#include "engine/remote/views/colour_match.h"
#include "tests/unit/remote/test_pictures.h"

namespace acceptance_test {
namespace {

using namespace gse;
using namespace gse::remote;

using namespace remote_pictures;

constexpr int Side = 256;

ViewFrame frame_with_disc() {
    ViewFrame frame;
    frame.section = {0, 0, Side};
    frame.picture = frame.original = waves(Side);
    frame.mask = disc(Side, 60);
    frame.sent_mask = localize::dilate(frame.mask, 12);
    return frame;
}

Image edited(const ViewFrame& frame, Image picture) {
    paint(picture, frame.mask, {0.9f, 0.7f, 0.1f});
    return picture;
}

DOCTEST_TEST_CASE("acceptance: an edit with a decoder's error around it is used") {
    const auto frame = frame_with_disc();
    auto answer = edited(frame, frame.picture);
    add_noise(answer, 0.03, 1);
    const auto checked = check_answer(frame, answer);
    DOCTEST_CHECK(checked.flaw == Flaw::None);
    DOCTEST_CHECK(checked.note.empty());
    DOCTEST_CHECK(checked.psnr > 28);
    DOCTEST_CHECK(checked.drift < 0.002);
}

DOCTEST_TEST_CASE("acceptance: a picture of something else has not looked at ours") {
    const auto frame = frame_with_disc();
    Image other(Side, Side, 3);
    Random random(5);
    for (auto& value : other.data) value = static_cast<float>(random.uniform());
    const auto checked = check_answer(frame, other);
    DOCTEST_CHECK(checked.flaw == Flaw::Unrelated);
    DOCTEST_CHECK(checked.note.find("has not looked at our picture") != std::string::npos);
}

DOCTEST_TEST_CASE("acceptance: a copy of what was sent is not an edit") {
    const auto frame = frame_with_disc();
    auto answer = frame.picture;
    add_noise(answer, 0.004, 1);
    DOCTEST_CHECK(check_answer(frame, answer).flaw == Flaw::Unedited);
}

DOCTEST_TEST_CASE("acceptance: drift is undone up to 2 %, and refused beyond") {
    const auto frame = frame_with_disc();
    const auto near = check_answer(frame, edited(frame, waves(Side, 3, 2)));
    DOCTEST_CHECK(near.flaw == Flaw::None);
    DOCTEST_CHECK(near.drift * Side == doctest::Approx(3.6).epsilon(0.1));
    DOCTEST_CHECK(psnr_outside(frame.picture, near.picture, frame.sent_mask) > 30);
    DOCTEST_CHECK(check_answer(frame, edited(frame, waves(Side, 1, 0))).flaw == Flaw::None);
    DOCTEST_CHECK(check_answer(frame, edited(frame, waves(Side, 5, 0))).flaw == Flaw::None);
    for (const auto& far : {waves(Side, 14, 0), waves(Side, 40, 0), waves(Side, 0, 0, 1.03)})
        DOCTEST_CHECK(check_answer(frame, edited(frame, far)).flaw != Flaw::None);
}

DOCTEST_TEST_CASE("acceptance: another size of one aspect is brought to ours, another aspect is refused") {
    const auto frame = frame_with_disc();
    const auto twice = check_answer(frame, at_side(edited(frame, frame.picture), 2 * Side));
    DOCTEST_CHECK(twice.flaw == Flaw::None);
    DOCTEST_CHECK(twice.picture.width == Side);
    DOCTEST_CHECK(twice.note.find("512 x 512") != std::string::npos);
    const auto wide = check_answer(frame, Image(Side, Side / 2, 3, 0.5f));
    DOCTEST_CHECK(wide.flaw == Flaw::WrongSize);
    DOCTEST_CHECK(wide.picture.data.empty());
}

DOCTEST_TEST_CASE("acceptance: where everything may change there are no surroundings to compare") {
    auto frame = frame_with_disc();
    frame.mask = frame.sent_mask = Mask(Side, Side, 1);
    const auto checked = check_answer(frame, Image(Side, Side, 3, 0.2f));
    DOCTEST_CHECK(checked.flaw == Flaw::None);
    DOCTEST_CHECK(checked.psnr < 0);
}

DOCTEST_TEST_CASE("colour match: a tint of the whole picture is taken off around and inside the mask") {
    const auto frame = frame_with_disc();
    const auto right = edited(frame, frame.picture);
    auto tinted = right;
    for (std::size_t i = 0; i < tinted.data.size(); i += 3) {
        tinted.data[i] = std::min(1.0f, tinted.data[i] + 0.05f);
        tinted.data[i + 2] = std::max(0.0f, tinted.data[i + 2] - 0.03f);
    }
    const auto matched = match_colours(tinted, frame.picture, frame.sent_mask);
    DOCTEST_CHECK(change_inside(right, matched, frame.mask) < 0.8 * change_inside(right, tinted, frame.mask));
    const Mask around = disc(Side, 128);
    DOCTEST_CHECK(change_inside(right, matched, around) < 0.5 * change_inside(right, tinted, around));
    DOCTEST_CHECK(change_inside(match_colours(right, frame.picture, frame.sent_mask), right, around) < 0.004);
}

}  // namespace
}  // namespace acceptance_test
