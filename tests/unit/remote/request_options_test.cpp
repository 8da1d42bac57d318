// Options and LoRAs of an artist: read, refused, and put into requests.
#include <doctest/doctest.h>

#include <algorithm>

#include "engine/base/error.h"
#include "engine/remote/protocols/request_options.h"
#include "engine/remote/protocols/server_loras.h"

namespace request_options_test {
namespace {

using namespace gse;
using namespace gse::remote;

/// Message and hint of the refusal; empty without one.
template <class F> std::string refusal(F&& body) {
    try {
        body();
    } catch (const Error& error) {
        DOCTEST_CHECK(error.code() == ErrorCode::InvalidArgument);
        DOCTEST_CHECK(!error.hint().empty());
        return error.message() + "; " + error.hint();
    }
    return {};
}

bool says(const std::string& text, const char* words) { return text.find(words) != std::string::npos; }

ServerUrl server() { return {.host = "127.0.0.1", .port = 7860}; }

DOCTEST_TEST_CASE("options: names end at the first equals sign, and values are JSON where they read so") {
    const auto option = parse_server_option("alwayson_scripts={\"a\": \"b=c\"}");
    DOCTEST_CHECK(option.name == "alwayson_scripts");
    DOCTEST_CHECK(json_value(option)["a"] == "b=c");
    DOCTEST_CHECK(json_value(parse_server_option("eta=0.5")) == 0.5);
    DOCTEST_CHECK(json_value(parse_server_option("tiling=true")) == true);
    DOCTEST_CHECK(json_value(parse_server_option("scheduler=karras")) == "karras");
    DOCTEST_CHECK(json_value(parse_server_option("scheduler=")) == "");
}

DOCTEST_TEST_CASE("options: other forms, secrets and names given twice are refused") {
    for (const char* text : {"", "eta", "=3", "\x1b[31m"})
        DOCTEST_CHECK(says(refusal([&] { parse_server_option(text); }), "NAME=VALUE"));
    DOCTEST_CHECK(says(refusal([] { parse_server_option("a=" + std::string(5000, 'x')); }), "NAME=VALUE"));
    for (const char* text : {"token=abc", "Authorization=Bearer abc", "node.API_KEY=abc", "password=abc"}) {
        const auto words = refusal([&] { parse_server_option(text); });
        DOCTEST_CHECK(says(words, "GSEDITPRO_SERVER_TOKEN"));
        DOCTEST_CHECK(!says(words, "abc"));
    }
    DOCTEST_CHECK(says(refusal([] { parse_server_options({"eta=1", "eta=2"}); }), "twice"));
}

DOCTEST_TEST_CASE("options: fields that the program sets are refused, and so are unknown ones") {
    const auto webui = [](const char* text) {
        return refusal(
            [&] { check_webui_options(parse_server_options({text}), WebuiProduct::Forge, server()); });
    };
    DOCTEST_CHECK(webui("scheduler=karras").empty());
    DOCTEST_CHECK(webui("override_settings.CLIP_stop_at_last_layers=2").empty());
    for (const char* name : {"width=64", "prompt=x", "init_images=[]", "mask=x", "save_images=true",
                             "denoising_strength=1", "force_task_id=x", "lora=[]"})
        DOCTEST_CHECK(says(webui(name), "is set by the program"));
    DOCTEST_CHECK(says(webui("shceduler=karras"), "has no option \"shceduler\"; it takes sampler_name"));
    for (const char* name : {"override_settings.sd_model_checkpoint=x",
                             "override_settings.forge_additional_modules=[]", "override_settings.sd_vae=x"})
        DOCTEST_CHECK(says(webui(name), "--server-model"));
    DOCTEST_CHECK(says(webui("override_settings={}"), "has no option"));
    const auto jobs = [](const char* text) {
        return refusal([&] { check_sdcpp_options(parse_server_options({text}), server()); });
    };
    DOCTEST_CHECK(jobs("sample_params.flow_shift=3").empty());
    DOCTEST_CHECK(says(jobs("sample_params.sample_steps=3"), "is set by the program"));
    DOCTEST_CHECK(says(jobs("sample_params={}"), "is set by the program"));
    DOCTEST_CHECK(says(jobs("control_image=x"), "has no option"));
    const auto forms = [](const char* text, OpenAiProduct product) {
        return refusal([&] { check_openai_options(parse_server_options({text}), product, server()); });
    };
    DOCTEST_CHECK(forms("quality=high", OpenAiProduct::OpenAi).empty());
    DOCTEST_CHECK(forms("guidance_scale=2", OpenAiProduct::Vllm).empty());
    DOCTEST_CHECK(forms("sample_params.eta=1", OpenAiProduct::SdServer).empty());
    DOCTEST_CHECK(says(forms("seed=2", OpenAiProduct::Vllm), "is set by the program"));
    DOCTEST_CHECK(says(forms("quality=high", OpenAiProduct::Vllm), "has no option"));
}

DOCTEST_TEST_CASE("options: dots lead into inner objects, and what is there stays") {
    nlohmann::json body{{"sample_params", {{"sample_steps", 20}}}};
    add_options(body, parse_server_options({"sample_params.flow_shift=3",
                                            "sample_params.guidance.img_cfg=1.5", "clip_skip=2"}));
    DOCTEST_CHECK(body["sample_params"]["sample_steps"] == 20);
    DOCTEST_CHECK(body["sample_params"]["flow_shift"] == 3);
    DOCTEST_CHECK(body["sample_params"]["guidance"]["img_cfg"] == 1.5);
    DOCTEST_CHECK(body["clip_skip"] == 2);
}

DOCTEST_TEST_CASE("options: a form holds each field once, and sd-server's ride in the prompt") {
    RedrawOrder order;
    order.picture = Image(64, 64, 3);
    order.prompt = "a golden bear";
    order.distilled_guidance = 3;
    const auto parts =
        openai_parts(order, OpenAiProduct::Vllm, "m", {{}, parse_server_options({"guidance_scale=2"})});
    const auto count = std::count_if(parts.begin(), parts.end(), [](const auto& part) {
        return part.name == "guidance_scale" && part.content == "2";
    });
    DOCTEST_CHECK(count == 1);
    const auto prompt =
        openai_parts(order, OpenAiProduct::SdServer, "",
                     {{{"bronze", "b.safetensors", 0.5}}, parse_server_options({"clip_skip=2"})})
            .front()
            .content;
    DOCTEST_CHECK(says(prompt, "\"clip_skip\":2"));
    DOCTEST_CHECK(says(prompt, "\"lora\":[{\"multiplier\":0.5,\"path\":\"b.safetensors\"}]"));
}

DOCTEST_TEST_CASE("loras: a name may have a weight, and both have limits") {
    DOCTEST_CHECK(parse_server_lora("bronze").weight == 1);
    DOCTEST_CHECK(parse_server_lora("bronze:0.8").weight == 0.8);
    DOCTEST_CHECK(parse_server_lora("looks/bronze.safetensors:-1").name == "looks/bronze.safetensors");
    for (const char* text : {"", ":1", "a<lora:b:1>", "a:b"})
        DOCTEST_CHECK(says(refusal([&] { parse_server_lora(text); }), "NAME:0.8"));
    for (const char* text : {"bronze:11", "bronze:nan", "bronze:inf"})
        DOCTEST_CHECK(!refusal([&] { parse_server_lora(text); }).empty());
}

DOCTEST_TEST_CASE("loras: a server's own name is told, and a missing one is refused with those it has") {
    const auto offered = offered_loras({{{"name", "bronze"}, {"path", "metal/bronze.safetensors"}},
                                        {{"name", "oil paint"}, {"path", ""}},
                                        {{"alias", "nameless"}},
                                        7});
    DOCTEST_REQUIRE(offered.size() == 2);
    for (const char* name : {"bronze", "bronze.safetensors", "metal/bronze.safetensors"}) {
        const auto chosen = chosen_loras(parse_server_loras({name}), offered, server());
        DOCTEST_REQUIRE(chosen.size() == 1);
        DOCTEST_CHECK(chosen[0].name == "bronze");
    }
    const auto both = chosen_loras(parse_server_loras({"oil paint:0.5", "bronze"}), offered, server());
    DOCTEST_CHECK(prompt_with_loras("a bear", both) == "a bear <lora:oil paint:0.5> <lora:bronze:1>");
    DOCTEST_CHECK(lora_list(both)[1]["path"] == "metal/bronze.safetensors");
    DOCTEST_CHECK(lora_list(both)[0]["path"] == "oil paint");
    const auto missing = refusal([&] { chosen_loras(parse_server_loras({"brass"}), offered, server()); });
    DOCTEST_CHECK(says(missing, "has no LoRA \"brass\"; it has: bronze, oil paint"));
    DOCTEST_CHECK(says(refusal([] { chosen_loras(parse_server_loras({"x"}), {}, server()); }), "none"));
}

}  // namespace
}  // namespace request_options_test
