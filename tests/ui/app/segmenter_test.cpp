// SAM's weights in the artist's window: tried before they count, kept until the next start, and GrabCut is a click away.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "engine/base/file.h"
#include "tests/ui/app/session.h"

using namespace gse;
using namespace gse::test;

DOCTEST_TEST_CASE("a segmenter: bad weights change nothing, good ones cut out the masks and are there again") {
    const auto weights = fs::absolute(goldens_folder() / "sam/sam_original.safetensors").lexically_normal();
    if (!networks() || !available(weights)) return;
    const Place place;
    const auto bad = place.folder / "bad.pth";
    write_file(bad, "no weights");
    {
        Session session;
        session.open_bear();
        auto& app = session.app;
        for (const auto& path : {bad, place.folder / "gone.pth"}) {
            app.choose_segmenter(ui::SegmenterRole::Clicks, path.string());
            DOCTEST_CHECK(app.model().segmenters[0].checking);
            DOCTEST_REQUIRE(session.settled());
            DOCTEST_CHECK(!app.model().segmenters[0].checking);
            DOCTEST_CHECK(app.model().segmenters[0].path.empty());
            DOCTEST_CHECK(app.model().toasts.back().is_error);
            DOCTEST_CHECK(app.model().toasts.back().text.find("segmenter") != std::string::npos);
        }
        app.choose_segmenter(ui::SegmenterRole::Words, place.folder.string());   // no CLIPSeg
        DOCTEST_CHECK(app.model().segmenters[1].checking);
        DOCTEST_REQUIRE(session.settled());
        DOCTEST_CHECK(app.model().segmenters[1].path.empty());
        DOCTEST_CHECK(app.model().toasts.back().text.find("segmenter") != std::string::npos);
        app.choose_segmenter(ui::SegmenterRole::Clicks, weights.string());
        DOCTEST_REQUIRE(session.settled());
        DOCTEST_CHECK(app.model().segmenters[0].path == weights.string());
        app.locate();
        DOCTEST_REQUIRE(session.settled());   // of weights drawn at random; whether they find anything is theirs
        app.shut_down();
    }
    Session again;
    DOCTEST_CHECK(again.app.model().segmenters[0].path == weights.string());
    again.app.choose_segmenter(ui::SegmenterRole::Clicks, {});
    DOCTEST_CHECK(again.app.model().segmenters[0].path.empty());
    again.app.shut_down();
}
