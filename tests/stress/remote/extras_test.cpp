// Options, LoRAs and smaller pictures over each protocol of the stand-in.
#include <doctest/doctest.h>

#include <algorithm>

#include "engine/base/json.h"
#include "engine/remote/protocols/connect.h"
#include "engine/remote/views/picture_source.h"
#include "engine/remote/views/view_frame.h"
#include "tests/stress/remote/stand_in.h"

namespace gse::remote {
namespace {

struct Spoken {
    const char* flavour;
    ServerKind kind;
    const char* place;  // of a drawing
};

const std::vector<Spoken>& spoken() {
    static const std::vector<Spoken> all{{"forge", ServerKind::Webui, "/img2img"},
                                         {"vllm", ServerKind::OpenAi, "/edits"},
                                         {"sdserver", ServerKind::SdCpp, "/img_gen"},
                                         {"comfy", ServerKind::Comfy, "/prompt"}};
    return all;
}

ServerAddress address_of(StandIn& stand_in, ServerKind kind) {
    auto address = stand_in.address();
    address.kind = kind;
    return address;
}

RedrawOrder order_of_side(int side) {
    auto order = small_order();
    order.picture = at_side(order.picture, side);
    order.mask = at_side(order.mask, side);
    for (auto& value : order.mask.data) value = value > 0.5f ? 1.0f : 0.0f;
    return order;
}

DOCTEST_TEST_CASE("options reach the requests, and wrong ones are refused before a picture is sent") {
    if (!can_stand_in()) return;
    const char* options[] = {"scheduler=karras", "guidance_scale=2", "sample_params.flow_shift=3",
                             "KSampler.scheduler=simple"};
    const char* wrong[] = {"width=8", "mask_image=x", "init_image=x", "KSampler.seed=1"};
    for (std::size_t i = 0; i < spoken().size(); ++i) {
        const auto& [flavour, kind, place] = spoken()[i];
        DOCTEST_CAPTURE(flavour);
        auto& stand_in = shared_stand_in(flavour);
        auto address = address_of(stand_in, kind);
        address.options = {parse_server_option(options[i])};
        connect(address, {})->redraw(small_order(), {});
        const auto sent = stand_in.asked(place).at(0);
        const auto fields = sent["fields"];
        if (kind == ServerKind::Webui) DOCTEST_CHECK(sent["json"]["scheduler"] == "karras");
        if (kind == ServerKind::SdCpp) DOCTEST_CHECK(sent["json"]["sample_params"]["flow_shift"] == 3);
        if (kind == ServerKind::Comfy)
            DOCTEST_CHECK(sent["json"]["prompt"]["7"]["inputs"]["scheduler"] == "simple");
        if (kind == ServerKind::OpenAi)
            DOCTEST_CHECK(std::count(fields.begin(), fields.end(),
                                     nlohmann::json::array({"guidance_scale", "", "2"})) == 1);
        stand_in.reset();
        address.options = {parse_server_option(wrong[i])};
        DOCTEST_CHECK(caught([&] { connect(address, {}); }).says("set by the program"));
        for (const auto& entry : stand_in.log()) DOCTEST_CHECK(entry["method"] == "GET");
    }
    auto& comfy = shared_stand_in("comfy");
    auto address = comfy.address();
    address.options = {parse_server_option("KSampler.scheduler=nonsense")};
    const auto refused = caught([&] { connect(address, {})->redraw(small_order(), {}); });
    DOCTEST_CHECK(refused.says("does not have \"nonsense\""));
    DOCTEST_CHECK(comfy.asked("/upload/image").empty());
}

DOCTEST_TEST_CASE("an option that is forced reaches the request though the program does not know its name") {
    if (!can_stand_in()) return;
    const char* options[] = {"force:hr.scale=2", "force:layers=4", "force:hires.scale=2",
                             "force:KSampler.eta=0.5"};
    for (std::size_t i = 0; i < spoken().size(); ++i) {
        const auto& [flavour, kind, place] = spoken()[i];
        DOCTEST_CAPTURE(flavour);
        auto& stand_in = shared_stand_in(flavour);
        auto address = address_of(stand_in, kind);
        address.options = {parse_server_option(std::string(options[i]).substr(6))};
        DOCTEST_CHECK(caught([&] { connect(address, {}); }).hint.find("force:") != std::string::npos);
        address.options = {parse_server_option(options[i])};
        connect(address, {})->redraw(small_order(), {});
        const auto sent = stand_in.asked(place).at(0);
        const auto fields = sent["fields"];
        if (kind == ServerKind::Webui) DOCTEST_CHECK(sent["json"]["hr"]["scale"] == 2);
        if (kind == ServerKind::SdCpp) DOCTEST_CHECK(sent["json"]["hires"]["scale"] == 2);
        if (kind == ServerKind::Comfy) DOCTEST_CHECK(sent["json"]["prompt"]["7"]["inputs"]["eta"] == 0.5);
        if (kind == ServerKind::OpenAi)
            DOCTEST_CHECK(
                std::count(fields.begin(), fields.end(), nlohmann::json::array({"layers", "", "4"})) == 1);
    }
}

DOCTEST_TEST_CASE("sd-server is told samplers by its own names: it passes over others without a word") {
    if (!can_stand_in()) return;
    auto& stand_in = shared_stand_in("sdserver");
    auto order = small_order();
    order.sampler = "Euler";
    connect(address_of(stand_in, ServerKind::SdCpp), {})->redraw(order, {});
    DOCTEST_CHECK(stand_in.asked("/img_gen").at(0)["json"]["sample_params"]["sample_method"] == "euler");
    connect(address_of(stand_in, ServerKind::OpenAi), {})->redraw(order, {});
    DOCTEST_CHECK(stand_in.asked("/edits").at(0)["fields"].dump().find("\"sample_method\\\":\\\"euler") !=
                  std::string::npos);
    auto address = address_of(stand_in, ServerKind::SdCpp);
    for (const char* name : {"sample_params.scheduler", "sample_params.sample_method"}) {
        address.options = {{name, "nonsense"}};
        DOCTEST_CHECK(caught([&] { connect(address, {}); }).says("no \"nonsense\""));
    }
}

DOCTEST_TEST_CASE("vLLM-Omni is told LoRAs by name or path, and says itself which it lacks") {
    if (!can_stand_in()) return;
    auto& vllm = shared_stand_in("vllm");
    auto address = address_of(vllm, ServerKind::OpenAi);
    const auto sent = [&](std::vector<ServerLora> loras) {
        vllm.reset();
        address.loras = std::move(loras);
        DOCTEST_CHECK(connect(address, {})->redraw(small_order(), {}).picture.width == 64);
        const auto asked = vllm.asked("/edits").at(0);
        for (const auto& field : asked["fields"])
            if (field[0] == "lora") return parse_json(field[2].get<std::string>(), "the LoRA");
        return nlohmann::json();
    };
    DOCTEST_CHECK(sent({}).is_null());
    DOCTEST_CHECK(sent({{"bronze", 0.5}}) == nlohmann::json{{"name", "bronze"}, {"scale", 0.5}});
    const nlohmann::json path{{"name", "brass"}, {"local_path", "/models/brass.safetensors"}, {"scale", 1.0}};
    DOCTEST_CHECK(sent({{"/models/brass.safetensors", 1}}) == path);
    DOCTEST_CHECK(sent({{"bronze", 0.5}, {"/models/brass.safetensors", 1}}).size() == 2);
    address.loras = {{"brass", 1}};
    DOCTEST_CHECK(caught([&] { connect(address, {})->redraw(small_order(), {}); }).says("not registered"));
}

DOCTEST_TEST_CASE("LoRAs are told as each server takes them, and those it lacks are refused with its list") {
    if (!can_stand_in()) return;
    struct Told {
        const char* flavour;
        ServerKind kind;
    };
    for (const auto& [flavour, kind] :
         {Told{"forge", ServerKind::Webui}, Told{"kcpp", ServerKind::Webui},
          Told{"sdserver", ServerKind::SdCpp}, Told{"sdserver", ServerKind::OpenAi},
          Told{"comfy", ServerKind::Comfy}, Told{"openai", ServerKind::OpenAi}}) {
        DOCTEST_CAPTURE(flavour);
        auto& stand_in = shared_stand_in(flavour);
        auto address = address_of(stand_in, kind);
        address.loras = {{"brass", 1}};
        const auto refused = caught([&] { connect(address, {}); });
        DOCTEST_CHECK(refused.says("has no LoRA \"brass\""));
        const bool has_any = std::string(flavour) != "openai";
        DOCTEST_CHECK((refused.hint.find("it has: bronze") != std::string::npos) == has_any);
        if (!has_any) continue;
        address.loras = {{"bronze", 0.5}};
        const auto server = connect(address, {});
        DOCTEST_CHECK(server->redraw(small_order(), {}).picture.width == 64);
        const nlohmann::json listed{{{"path", "bronze.safetensors"}, {"multiplier", 0.5}}};
        if (kind == ServerKind::OpenAi) {
            DOCTEST_CHECK(stand_in.asked("/edits").at(0)["fields"].dump().find("bronze.safetensors") !=
                          std::string::npos);
        } else if (kind == ServerKind::SdCpp) {
            DOCTEST_CHECK(stand_in.asked("/img_gen").at(0)["json"]["lora"] == listed);
        } else if (kind == ServerKind::Comfy) {
            const auto graph = stand_in.asked("/prompt").at(0)["json"]["prompt"];
            DOCTEST_CHECK(graph["gse lora 1"]["inputs"]["lora_name"] == "bronze.safetensors");
            DOCTEST_CHECK(graph["7"]["inputs"]["model"][0] == "gse lora 1");
        } else {
            const auto sent = stand_in.asked("/img2img").at(0)["json"];
            const bool tagged = std::string(flavour) == "forge";
            DOCTEST_CHECK(sent["prompt"] == (tagged ? "a golden bear <lora:bronze:0.5>" : "a golden bear"));
            if (!tagged) DOCTEST_CHECK(sent["lora"] == listed);
        }
    }
}

DOCTEST_TEST_CASE("servers tell whether they take LoRAs; one without a list is told any name") {
    if (!can_stand_in()) return;
    struct Taken {
        const char* flavour;
        ServerKind kind;
        LoraNames names;
    };
    for (const auto& [flavour, kind, names] : {Taken{"forge", ServerKind::Webui, LoraNames::Listed},
                                               Taken{"sdserver", ServerKind::SdCpp, LoraNames::Listed},
                                               Taken{"sdserver", ServerKind::OpenAi, LoraNames::Listed},
                                               Taken{"comfy", ServerKind::Comfy, LoraNames::Listed},
                                               Taken{"vllm", ServerKind::OpenAi, LoraNames::Any},
                                               Taken{"local", ServerKind::OpenAi, LoraNames::Any},
                                               Taken{"openai", ServerKind::OpenAi, LoraNames::None}}) {
        DOCTEST_CAPTURE(flavour);
        const auto facts = connect(address_of(shared_stand_in(flavour), kind), {})->probe({});
        DOCTEST_CHECK(facts.lora_names == names);
        DOCTEST_CHECK(facts.loras.empty() == (names != LoraNames::Listed));
    }
    auto& local = shared_stand_in("local");
    auto address = address_of(local, ServerKind::OpenAi);
    address.loras = {{"looks/brass.safetensors", 0.5}};
    const auto server = connect(address, {});
    DOCTEST_CHECK(server->probe({}).notes.at(0).find("LoRAs") != std::string::npos);
    DOCTEST_CHECK(server->redraw(small_order(), {}).picture.width == 64);
    const auto form = local.asked("/edits").at(0)["fields"];
    const nlohmann::json told{{"name", "brass"}, {"scale", 0.5}, {"local_path", "looks/brass.safetensors"}};
    DOCTEST_CHECK(std::count(form.begin(), form.end(), nlohmann::json::array({"lora", "", told.dump()})) ==
                  1);
    for (const char* flavour : {"forge", "kcpp"}) {
        auto& webui = shared_stand_in(flavour);
        webui.set({{"no_loras", "1"}});
        auto unlisted = address_of(webui, ServerKind::Webui);
        unlisted.loras = {{"brass", 1}};
        connect(unlisted, {})->redraw(small_order(), {});
        const auto sent = webui.asked("/img2img").at(0)["json"];
        const bool tagged = std::string(flavour) == "forge";
        if (tagged) DOCTEST_CHECK(sent["prompt"] == "a golden bear <lora:brass:1>");
        else DOCTEST_CHECK(sent["lora"][0]["path"] == "brass");
    }
}

DOCTEST_TEST_CASE("a server whose memory does not do is asked once at 3/4 of the side, then given up") {
    if (!can_stand_in()) return;
    for (const auto& [flavour, kind, place] : spoken()) {
        DOCTEST_CAPTURE(flavour);
        auto& stand_in = shared_stand_in(flavour);
        const auto server = connect(address_of(stand_in, kind), {});
        stand_in.set({{"most_side", "192"}});
        PictureSource source(*server, server->probe({}), "", nullptr);
        DOCTEST_CHECK(source.ask(order_of_side(256), {}).width == 256);
        DOCTEST_CHECK(source.use().smaller_side == 192);
        DOCTEST_CHECK(source.ask(order_of_side(256), {}).width == 256);
        DOCTEST_CHECK(stand_in.asked(place).size() == 3);  // the second picture is asked for smaller at once
        DOCTEST_CHECK(source.ask(order_of_side(128), {}).width == 128);
        stand_in.reset({{"most_side", "64"}});
        PictureSource other(*server, server->probe({}), "", nullptr);
        const auto error = caught([&] { other.ask(order_of_side(256), {}); });
        DOCTEST_CHECK(error.says("ran out of memory, also at 192 x 192 pixels"));
        DOCTEST_CHECK(error.hint == TooLargeHint);
        DOCTEST_CHECK(stand_in.asked(place).size() == 2);
    }
}

}  // namespace
}  // namespace gse::remote
