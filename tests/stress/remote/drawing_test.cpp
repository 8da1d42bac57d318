// Pictures redrawn by the stand-in over each protocol: what was sent, and what came back.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "engine/base/file.h"
#include "engine/base/json.h"
#include "engine/remote/protocols/connect.h"
#include "tests/stress/remote/stand_in.h"
#include "tests/test_paths.h"

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

DOCTEST_TEST_CASE("servers of the OpenAI protocol redraw inside a mask of either convention") {
    if (!can_stand_in()) return;
    for (const std::string flavour : {"sdserver", "vllm", "openai", "local"}) {
        DOCTEST_CAPTURE(flavour);
        StandIn& stand_in = shared_stand_in(flavour);
        auto address = stand_in.address();
        address.kind = ServerKind::OpenAi;
        const bool seeds = flavour == "sdserver" || flavour == "vllm";
        DOCTEST_CHECK(connect(address, {})->probe({}).repeats == seeds);
        check_redraws(stand_in, address, seeds);
        const auto sent = stand_in.asked("/edits").at(0)["fields"];
        const std::string mask = flavour == "vllm" ? "mask_image" : "mask";
        int masks = 0;
        for (const auto& field : sent) {
            DOCTEST_CHECK(field[0] != "image[]");
            if (field[0] != mask) continue;
            ++masks;
            DOCTEST_CHECK(field[2]["white"] == 32 * 32);
            if (mask == "mask") DOCTEST_CHECK(field[2]["clear"] == 32 * 32);
        }
        DOCTEST_CHECK(masks == 1);
    }
}

DOCTEST_TEST_CASE("ComfyUI runs the bundled workflows and keeps nothing") {
    if (!can_stand_in()) return;
    StandIn& stand_in = shared_stand_in("comfy");
    check_redraws(stand_in, stand_in.address());
    const auto sent = stand_in.asked("/prompt").at(0)["json"];
    DOCTEST_CHECK(sent["prompt"]["9"]["class_type"] == "PreviewImage");
    DOCTEST_CHECK(sent["prompt"]["7"]["inputs"]["steps"] == 20);
    DOCTEST_CHECK(sent["prompt"]["7"]["inputs"]["denoise"] == 0.75);
    DOCTEST_CHECK(sent["prompt"]["1"]["inputs"]["ckpt_name"] == "stand-in.safetensors");
    DOCTEST_CHECK(!sent["client_id"].get<std::string>().empty());
    for (const auto& upload : stand_in.asked("/upload/image"))
        for (const auto& field : upload["fields"]) {
            if (field[0] == "type") DOCTEST_CHECK(field[2] == "temp");
            if (field[0] == "image") DOCTEST_CHECK(field[1].get<std::string>().starts_with("gse_"));
        }
    std::size_t forgotten = 0;
    for (int i = 0; i < 100 && forgotten == 0; ++i)
        for (const auto& entry : stand_in.asked("/history")) forgotten += entry["method"] == "POST" ? 1u : 0u;
    DOCTEST_CHECK(forgotten > 0);
}

DOCTEST_TEST_CASE("the workflow follows from mask, references and wish") {
    if (!can_stand_in()) return;
    StandIn& stand_in = shared_stand_in("comfy");
    auto order = small_order();
    const auto redrawn = [&](const ServerAddress& address) {
        stand_in.reset();
        connect(address, {})->redraw(order, {});
        std::vector<std::string> kinds;
        const auto sent = stand_in.asked("/prompt").at(0);
        for (const auto& node : sent["json"]["prompt"]) kinds.push_back(node["class_type"]);
        return kinds;
    };
    const auto count = [](const std::vector<std::string>& kinds, const std::string& kind) {
        return std::count(kinds.begin(), kinds.end(), kind);
    };
    auto address = stand_in.address();
    DOCTEST_CHECK(count(redrawn(address), "InpaintModelConditioning") == 1);
    order.mask = {};
    DOCTEST_CHECK(count(redrawn(address), "LoadImageMask") == 0);
    address.workflow = "edit";
    DOCTEST_CHECK(count(redrawn(address), "ReferenceLatent") == 1);
    order.references = {order.picture};
    DOCTEST_CHECK(count(redrawn(address), "ReferenceLatent") == 2);
    order.references.clear();
    address.workflow.clear();
    address.model = "flux-2-klein-4b.safetensors";  // no checkpoint: it comes without a text encoder
    DOCTEST_CHECK(count(redrawn(address), "ReferenceLatent") == 1);
    address.model = "stand-in.safetensors";
    DOCTEST_CHECK(count(redrawn(address), "ReferenceLatent") == 0);
}

DOCTEST_TEST_CASE("loaders that know no temporary folder get their pictures from another") {
    if (!can_stand_in()) return;
    StandIn& stand_in = shared_stand_in("comfy");
    const auto server = connect(stand_in.address(), {});
    stand_in.set({{"fault", "no_temp"}, {"at", "nothing"}});
    DOCTEST_CHECK(server->redraw(small_order(), {}).picture.width == 64);
    DOCTEST_CHECK(server->redraw(small_order(), {}).picture.width == 64);
    DOCTEST_CHECK(stand_in.asked("/prompt").size() == 3);
}

DOCTEST_TEST_CASE("a workflow that the server cannot run is refused before a picture is sent") {
    if (!can_stand_in()) return;
    StandIn& stand_in = shared_stand_in("comfy");
    const test::ScratchFolder folder;
    const auto refused = [&](const std::string& extra) {
        auto address = stand_in.address();
        address.workflow = folder.path() / "mine.json";
        auto graph = parse_json(read_file(test::source_folder() / "assets/workflows/img2img.json"), "it");
        graph.update(parse_json(extra, "extra"));
        write_file(address.workflow, graph.dump());
        return caught([&] { connect(address, {}); });
    };
    DOCTEST_CHECK(refused("{}").code == -1);
    DOCTEST_CHECK(
        refused(R"({"90":{"class_type":"Fancy","inputs":{}}})").says("lacks nodes of the workflow: Fancy"));
    DOCTEST_CHECK(
        refused(R"({"90":{"class_type":"PaidApi","inputs":{"image":["2",0]}}})").says("paid service"));
    DOCTEST_CHECK(refused(R"({"90":{"class_type":"VAELoader","inputs":{"vae_name":"x.pt"}}})")
                      .says("does not have \"x.pt\""));
    DOCTEST_CHECK(stand_in.asked("/upload/image").empty());
    auto address = stand_in.address();
    address.model = "other.safetensors";
    DOCTEST_CHECK(caught([&] { connect(address, {})->redraw(small_order(), {}); }).says("other.safetensors"));
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
    auto address = shared_stand_in("sdserver").address();
    address.model = "other";
    DOCTEST_CHECK(caught([&] { connect(address, {}); }).says("draws with stand-in alone"));
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
