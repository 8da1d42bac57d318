// Bodies of requests: fields of each product, steps that really run, orders that are not sent.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/remote/protocols/order_checks.h"
#include "engine/remote/protocols/sdcpp_server.h"
#include "engine/remote/protocols/webui_request.h"

namespace gse::remote {
namespace {

RedrawOrder plain_order() {
    RedrawOrder order;
    order.picture = Image(64, 128, 3, 0.5f);
    order.mask = Image(64, 128, 1, 1);
    order.prompt = "a golden bear";
    return order;
}

int levels_run(int steps, double strength) { return std::min(steps, static_cast<int>(strength * steps) + 1); }

DOCTEST_TEST_CASE("as many steps run as were ordered") {
    for (int real = 1; real <= 40; ++real)
        for (const double strength : {0.25, 0.3, 0.5, 0.6, 0.75, 0.8, 0.9, 0.95, 1.0}) {
            DOCTEST_CAPTURE(real);
            DOCTEST_CAPTURE(strength);
            DOCTEST_CHECK(levels_run(steps_to_ask_of_levels(real, strength), strength) == real);
            DOCTEST_CHECK(static_cast<int>(strength * webui_steps(WebuiProduct::SdNext, real, strength) +
                                           1e-9) >= real);
        }
}

DOCTEST_TEST_CASE("fields of one product stay away from others") {
    auto order = plain_order();
    order.distilled_guidance = 3.5;
    DOCTEST_CHECK(webui_body(order, WebuiProduct::Forge, "t")["distilled_cfg_scale"] == 3.5);
    DOCTEST_CHECK(webui_body(order, WebuiProduct::Forge, "t")["force_task_id"] == "t");
    for (const auto product : {WebuiProduct::SdNext, WebuiProduct::KoboldCpp, WebuiProduct::SdServer}) {
        const auto body = webui_body(order, product, "t");
        DOCTEST_CHECK(!body.contains("distilled_cfg_scale"));
        DOCTEST_CHECK(!body.contains("force_task_id"));
        DOCTEST_CHECK(!body.contains("sampler_name"));
        DOCTEST_CHECK(!body.contains("mask_blur_x"));
    }
    DOCTEST_CHECK(sdcpp_body(order)["sample_params"]["guidance"]["distilled_guidance"] == 3.5);
}

DOCTEST_TEST_CASE("without a mask no field of inpainting is sent") {
    auto order = plain_order();
    order.mask = {};
    const auto body = webui_body(order, WebuiProduct::A1111, "t");
    for (const char* name : {"mask", "inpaint_full_res", "inpainting_fill", "mask_blur"})
        DOCTEST_CHECK(!body.contains(name));
    DOCTEST_CHECK(!sdcpp_body(order).contains("mask_image"));
}

DOCTEST_TEST_CASE("the model of an answer is read from its info") {
    DOCTEST_CHECK(webui_model({{"info", R"({"sd_model_name":"dream"})"}}) == "dream");
    for (const nlohmann::json& info :
         {nlohmann::json(""), nlohmann::json("{"), nlohmann::json(7), nlohmann::json("[]")})
        DOCTEST_CHECK(webui_model({{"info", info}}).empty());
}

DOCTEST_TEST_CASE("orders that no server must see are refused") {
    ServerFacts facts;
    facts.references = 1;
    DOCTEST_CHECK_NOTHROW(check_order(plain_order(), facts));
    const auto refused = [&](auto&& change) {
        auto order = plain_order();
        change(order);
        DOCTEST_CHECK_THROWS_AS(check_order(order, facts), Error);
    };
    refused([](RedrawOrder& o) { o.prompt = " \n"; });
    refused([](RedrawOrder& o) { o.picture = Image(65, 64, 3); });
    refused([](RedrawOrder& o) { o.picture = Image(64, 128, 1); });
    refused([](RedrawOrder& o) { o.side_step = 112; });
    refused([](RedrawOrder& o) { o.side_step = 8; });
    refused([](RedrawOrder& o) { o.mask = Image(64, 64, 1); });
    refused([](RedrawOrder& o) { o.strength = 0; });
    refused([](RedrawOrder& o) { o.strength = std::nan(""); });
    refused([](RedrawOrder& o) { o.seed = 1u << 31; });
    refused([](RedrawOrder& o) { o.steps = 0; });
    refused([](RedrawOrder& o) { o.references = {o.picture, o.picture}; });
    refused([](RedrawOrder& o) { o.references = {Image{}}; });
}

DOCTEST_TEST_CASE("sides may be multiples of another step than 64") {
    auto order = plain_order();
    order.picture = Image(224, 112, 3);
    order.mask = {};
    order.side_step = 112;
    DOCTEST_CHECK_NOTHROW(check_order(order, {}));
}

DOCTEST_TEST_CASE("answers are bounded by what a picture can need") {
    auto order = plain_order();
    DOCTEST_CHECK(picture_answer_bytes(order, 0) > 64 * 128 * 4);
    DOCTEST_CHECK(picture_answer_bytes(order, 0) < (std::size_t{2} << 20));
    order.picture = Image(4096, 4096, 3);
    DOCTEST_CHECK(picture_answer_bytes(order, 2) == std::size_t{64} << 20);
}

}  // namespace
}  // namespace gse::remote
