// Pictures redrawn by the stand-in over each protocol: what was sent, and what came back.
#include <doctest/doctest.h>

#include <cmath>

#include "engine/remote/protocols/connect.h"
#include "tests/stress/remote/stand_in.h"

namespace gse::remote {
namespace {

/// Mean distance of two pictures inside (or outside) of a mask, in [0,1].
double distance(const Image& a, const Image& b, const Image& mask, bool inside) {
    double sum = 0;
    int count = 0;
    for (std::size_t i = 0; i < a.pixel_count(); ++i) {
        if ((mask.data[i] > 0.5f) != inside) continue;
        for (std::size_t c = 0; c < 3; ++c) sum += std::abs(a.data[i * 3 + c] - b.data[i * 3 + c]);
        count += 3;
    }
    return sum / count;
}

/// Blue is the least of the colours inside: the stand-in has painted it golden.
bool is_golden(const Image& picture, const Image& mask) {
    double sums[3] = {};
    for (std::size_t i = 0; i < picture.pixel_count(); ++i)
        if (mask.data[i] > 0.5f)
            for (std::size_t c = 0; c < 3; ++c) sums[c] += picture.data[i * 3 + c];
    return sums[0] > sums[1] && sums[1] > 2 * sums[2];
}

void check_redraws(StandIn& stand_in, const ServerAddress& address, bool repeats_seed = true) {
    const auto server = connect(address, {});
    const auto order = small_order();
    const auto first = server->redraw(order, {});
    DOCTEST_REQUIRE(first.picture.width == 64);
    DOCTEST_REQUIRE(first.picture.height == 64);
    DOCTEST_CHECK(is_golden(first.picture, order.mask));
    DOCTEST_CHECK(distance(first.picture, order.picture, order.mask, false) < 0.02);
    DOCTEST_CHECK(distance(first.picture, order.picture, order.mask, true) > 0.1);
    DOCTEST_CHECK(server->redraw(order, {}).picture.data == first.picture.data);
    stand_in.set({{"noise", "20"}});
    auto other = order;
    other.seed = 6;
    const auto noisy = server->redraw(order, {}).picture;
    if (repeats_seed) {
        DOCTEST_CHECK(server->redraw(order, {}).picture.data == noisy.data);
        DOCTEST_CHECK(server->redraw(other, {}).picture.data != noisy.data);
    }
}

DOCTEST_TEST_CASE("sd-server's jobs redraw inside the mask and keep the rest") {
    if (!can_stand_in()) return;
    StandIn& stand_in = shared_stand_in("sdserver");
    check_redraws(stand_in, stand_in.address());
    const auto sent = stand_in.asked("/img_gen").at(0)["json"];
    DOCTEST_CHECK(sent["init_image"]["picture"] == nlohmann::json({64, 64, 3}));
    DOCTEST_CHECK(sent["mask_image"]["picture"] == nlohmann::json({64, 64, 1}));
    DOCTEST_CHECK(sent["mask_image"]["white"] == 32 * 32);
    DOCTEST_CHECK(sent["width"] == 64);
    DOCTEST_CHECK(sent["embed_image_metadata"] == false);
    DOCTEST_CHECK(sent["sample_params"]["sample_steps"] == 26);  // of which 20 run at a strength of 0.75
}

DOCTEST_TEST_CASE("every WebUI redraws inside the mask and keeps the rest") {
    if (!can_stand_in()) return;
    for (const std::string flavour : {"a1111", "forge", "sdnext", "kcpp", "sdserver", "lookalike"}) {
        DOCTEST_CAPTURE(flavour);
        StandIn& stand_in = shared_stand_in(flavour);
        auto address = stand_in.address();
        address.kind = ServerKind::Webui;
        check_redraws(stand_in, address);
        const auto sent = stand_in.asked("/img2img").at(0)["json"];
        DOCTEST_CHECK(sent["init_images"][0]["picture"] == nlohmann::json({64, 64, 3}));
        DOCTEST_CHECK(sent["mask"]["white"] == 32 * 32);
        DOCTEST_CHECK(sent["inpaint_full_res"] == false);
        DOCTEST_CHECK(sent["inpainting_fill"] == 1);
        DOCTEST_CHECK(sent["save_images"] == false);
        DOCTEST_CHECK(!sent.contains("override_settings"));
        DOCTEST_CHECK(sent.contains("force_task_id") == (flavour == "a1111" || flavour == "forge"));
        for (const auto& entry : stand_in.log()) {
            DOCTEST_CHECK(entry["path"] != "/sdapi/v1/cmd-flags");
            DOCTEST_CHECK(entry["path"] != "/internal/sysinfo");
        }
    }
}

DOCTEST_TEST_CASE("references go to servers that take them, and to no others") {
    if (!can_stand_in()) return;
    StandIn& stand_in = shared_stand_in("sdserver");
    auto order = small_order();
    order.references = {order.picture, order.picture};
    const auto jobs = connect(stand_in.address(), {});
    DOCTEST_CHECK(jobs->probe({}).references == 4);
    jobs->redraw(order, {});
    DOCTEST_CHECK(stand_in.asked("/img_gen").at(0)["json"]["ref_images"].size() == 2);
    StandIn& forge = shared_stand_in("forge");
    const auto error = caught([&] { connect(forge.address(), {})->redraw(order, {}); });
    DOCTEST_CHECK(error.is(ErrorCode::InvalidArgument));
    DOCTEST_CHECK(forge.asked("/img2img").empty());
}

DOCTEST_TEST_CASE("a mask that is black asks nothing and keeps the picture") {
    if (!can_stand_in()) return;
    for (const std::string flavour : {"sdserver", "a1111"}) {
        StandIn& stand_in = shared_stand_in(flavour);
        auto order = small_order();
        order.mask = Image(64, 64, 1);
        const auto kept = connect(stand_in.address(), {})->redraw(order, {});
        DOCTEST_CHECK(kept.picture.data == order.picture.data);
        DOCTEST_CHECK(stand_in.asked("/img2img").empty());
        DOCTEST_CHECK(stand_in.asked("/img_gen").empty());
    }
}

DOCTEST_TEST_CASE("a model is switched to only where it is asked for") {
    if (!can_stand_in()) return;
    for (const std::string flavour : {"forge", "sdnext"}) {
        StandIn& stand_in = shared_stand_in(flavour);
        DOCTEST_CHECK(connect(stand_in.address(), {})->probe({}).model == "stand-in");
        DOCTEST_CHECK(stand_in.asked("/options").at(0)["method"] == "GET");
        auto address = stand_in.address();
        address.model = "other";
        const auto server = connect(address, {});
        DOCTEST_CHECK(server->probe({}).model == "other");
        DOCTEST_CHECK(server->redraw(small_order(), {}).model == "other");
        address.model = "unheard-of";
        DOCTEST_CHECK(caught([&] { connect(address, {}); }).is(ErrorCode::InvalidArgument));
    }
}

DOCTEST_TEST_CASE("progress of a drawing is told where the server tells it") {
    if (!can_stand_in()) return;
    StandIn& stand_in = shared_stand_in("forge");
    stand_in.set({{"draw_s", "1.4"}});
    int told = 0;
    JobControl job;
    job.progress = [&](std::string_view, int step, int total) { told += total == 100 && step == 50 ? 1 : 0; };
    connect(stand_in.address(), {})->redraw(small_order(), job);
    DOCTEST_CHECK(told > 0);
}

}  // namespace
}  // namespace gse::remote
