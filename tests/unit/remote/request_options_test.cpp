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
    DOCTEST_CHECK(says(refusal([] { parse_server_options({"eta=1", "force:eta=2"}); }), "twice"));
    DOCTEST_CHECK(says(refusal([] { parse_server_options({"force:a.b=1", "force:a=2"}); }), "twice"));
    DOCTEST_CHECK(parse_server_options({"force:a.b=1", "force:a.bc=2"}).size() == 2);
}

DOCTEST_TEST_CASE("options: a name that is forced is sent unknown, but no secret and no field of ours") {
    const auto forced = parse_server_option("force:hires.scale=1.5");
    DOCTEST_CHECK(forced.name == "hires.scale");
    DOCTEST_CHECK(forced.forced);
    DOCTEST_CHECK_FALSE(parse_server_option("eta=force:1").forced);
    for (const char* text : {"force:=3", "force:eta", "force:"})
        DOCTEST_CHECK(says(refusal([&] { parse_server_option(text); }), "NAME=VALUE"));
    DOCTEST_CHECK(says(refusal([] { parse_server_option("force:api_key=x"); }), "GSEDITPRO_SERVER_TOKEN"));
    const auto webui = [](const char* text) {
        return refusal(
            [&] { check_webui_options(parse_server_options({text}), WebuiProduct::Forge, server()); });
    };
    DOCTEST_CHECK(says(webui("hr_scale=2"), "force:NAME=VALUE"));
    DOCTEST_CHECK(webui("force:hr_scale=2").empty());
    DOCTEST_CHECK(webui("force:scheduler=karras").empty());
    for (const char* text : {"force:width=64", "force:mask=x", "force:width.x=1", "force:lora=[]"})
        DOCTEST_CHECK(says(webui(text), "is set by the program"));
    for (const char* text : {"force:override_settings={}", "force:override_settings.sd_vae=x",
                             "force:override_settings_restore_afterwards=false"})
        DOCTEST_CHECK(says(webui(text), "--server-model"));
    for (const char* text : {"force:a..b=1", "force:.a=1", "force:a.=1", "force:a b=1", "force:a\"b=1"})
        DOCTEST_CHECK(says(webui(text), "is no name of a field"));
    const auto forms = [](const char* text) {
        return refusal(
            [&] { check_openai_options(parse_server_options({text}), OpenAiProduct::Vllm, server()); });
    };
    DOCTEST_CHECK(forms("force:layers=4").empty());
    for (const char* text : {"force:image=x", "force:mask_image=x", "force:seed=2"})
        DOCTEST_CHECK(says(forms(text), "is set by the program"));
    nlohmann::json body;
    add_options(body, {forced});
    DOCTEST_CHECK(body["hires"]["scale"] == 1.5);
}

DOCTEST_TEST_CASE("options: a value that the server does not offer is refused, unless it is forced") {
    const auto check = [](const char* text, const std::vector<std::string>& offered) {
        return refusal([&] {
            check_offered_value(parse_server_options({text}), "sample_params.scheduler", offered, server());
        });
    };
    DOCTEST_CHECK(check("sample_params.scheduler=karras", {"discrete", "karras"}).empty());
    DOCTEST_CHECK(says(check("sample_params.scheduler=karas", {"discrete", "karras"}),
                       "\"karas\" for sample_params.scheduler; it has: discrete, karras"));
    DOCTEST_CHECK(check("force:sample_params.scheduler=karas", {"karras"}).empty());
    DOCTEST_CHECK(check("sample_params.scheduler=karas", {}).empty());
    DOCTEST_CHECK(check("sample_params.eta=1", {"karras"}).empty());
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

DOCTEST_TEST_CASE("loras: where a server has no list, any name goes, and a path keeps its folders") {
    const auto named = [](LoraNames names) {
        return named_loras(parse_server_loras({"looks/brass.safetensors:0.5"}), {}, names, server());
    };
    const auto any = named(LoraNames::Any);
    DOCTEST_REQUIRE(any.size() == 1);
    DOCTEST_CHECK(any[0].name == "brass");
    DOCTEST_CHECK(any[0].path == "looks/brass.safetensors");
    DOCTEST_CHECK(prompt_with_loras("a bear", any) == "a bear <lora:brass:0.5>");
    for (const auto names : {LoraNames::None, LoraNames::Listed})
        DOCTEST_CHECK(says(refusal([&] { named(names); }), "has no LoRA"));
}

}  // namespace
}  // namespace request_options_test
