// Pictures in the making: shown where a server has them, and never a reason to lose the drawing.
#include <doctest/doctest.h>

#include "engine/remote/protocols/connect.h"
#include "tests/stress/remote/stand_in.h"

namespace gse::remote {
namespace {

/// Answer to an order whose previews are looked at, and what they were.
struct Shown {
    std::vector<Image> previews;
    Image picture;
};

Shown drawn_with_previews(StandIn& stand_in, const ServerTimes& times = patient_times()) {
    auto address = stand_in.address();
    address.times = times;
    Shown shown;
    auto order = small_order();
    order.preview = [&](const Image& preview) { shown.previews.push_back(preview); };
    JobControl job;
    job.progress = [](std::string_view, int, int) {};
    shown.picture = connect(address, {})->redraw(order, job).picture;
    return shown;
}

DOCTEST_TEST_CASE("a picture in the making is shown while it is drawn") {
    if (!can_stand_in()) return;
    for (const std::string flavour : {"forge", "a1111", "sdnext"}) {
        DOCTEST_CAPTURE(flavour);
        StandIn& stand_in = shared_stand_in(flavour);
        stand_in.set({{"draw_s", "2.4"}, {"previews", "1"}});
        DOCTEST_CHECK(connect(stand_in.address(), {})->probe({}).shows_previews);
        const auto shown = drawn_with_previews(stand_in);
        DOCTEST_REQUIRE_FALSE(shown.previews.empty());
        if (flavour != "sdnext") DOCTEST_CHECK(shown.previews.size() == 1);  // one that is known is not sent
        const auto& preview = shown.previews.front();
        DOCTEST_REQUIRE(preview.width == 8);
        DOCTEST_CHECK(preview.at(4, 4, 0) > 1.5f * preview.at(4, 4, 2));  // golden inside the mask
        DOCTEST_CHECK(shown.picture.width == 64);
    }
}

DOCTEST_TEST_CASE("where nobody looks, or a server has none, no picture in the making is asked for or sent") {
    if (!can_stand_in()) return;
    StandIn& forge = shared_stand_in("forge");
    forge.set({{"draw_s", "1.4"}, {"previews", "1"}});
    JobControl job;
    job.progress = [](std::string_view, int, int) {};
    connect(forge.address(), {})->redraw(small_order(), job);
    const auto asked = forge.asked("/internal/progress");
    DOCTEST_REQUIRE_FALSE(asked.empty());
    for (const auto& one : asked) DOCTEST_CHECK(one["json"]["live_preview"] == false);
    StandIn& sdnext = shared_stand_in("sdnext");
    sdnext.set({{"draw_s", "1.4"}});
    connect(sdnext.address(), {})->redraw(small_order(), job);
    for (const auto& one : sdnext.asked("/sdapi/v1/progress"))
        DOCTEST_CHECK(one["query"]["skip_current_image"] == "true");
    StandIn& sdserver = shared_stand_in("sdserver");
    DOCTEST_CHECK_FALSE(connect(sdserver.address(), {})->probe({}).shows_previews);
    DOCTEST_CHECK(drawn_with_previews(sdserver).previews.empty());
}

DOCTEST_TEST_CASE("a broken preview is not shown, not asked for again, and leaves the drawing as it is") {
    if (!can_stand_in()) return;
    auto times = patient_times();
    times.answer = Milliseconds(250);
    for (const std::string fault : {"png_crc", "png_huge", "png_bomb", "gif", "svg", "b64_rubbish",
                                    "b64_lines", "html_500", "json_brackets", "json_nan", "empty", "hang"}) {
        DOCTEST_CAPTURE(fault);
        StandIn& stand_in = shared_stand_in("forge");
        const auto plain = drawn_with_previews(stand_in).picture;
        const bool looks_again = fault == "png_crc" || fault == "html_500";
        // The first answer may come before there is a picture that could be broken.
        const bool of_picture =
            fault.starts_with("png") || fault.starts_with("b64") || fault == "gif" || fault == "svg";
        stand_in.set({{"draw_s", looks_again ? "3.6" : "1.2"},
                      {"previews", "1"},
                      {"at", "progress"},
                      {"fault", fault},
                      {"times", of_picture ? "100" : "1"}});
        const auto shown = drawn_with_previews(stand_in, times);
        // The excess of a bomb is not unpacked, and the rest is a picture.
        if (fault != "png_bomb") DOCTEST_CHECK(shown.previews.empty());
        DOCTEST_CHECK(shown.picture.data == plain.data);
        const auto asked = stand_in.asked("/internal/progress");
        DOCTEST_REQUIRE(asked.size() >= (looks_again ? 2 : 1));
        DOCTEST_CHECK(asked.front()["json"]["live_preview"] == true);
        if (looks_again) DOCTEST_CHECK(asked.back()["json"]["live_preview"] == false);
    }
}

}  // namespace
}  // namespace gse::remote
