// LoRAs in the artist's window: tried before they count, kept with the project, and the model stays as it was
// where they fail.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <cstring>
#include <map>

#include "engine/base/file.h"
#include "engine/base/safetensors_header.h"
#include "tests/ui/app/session.h"
#include "tests/unit/prompt/header_file.h"

namespace lora_test {

using namespace gse;
using namespace gse::test;

namespace {

/// A safetensors file of ones; names and shapes.
void write_ones(const fs::path& path, const std::map<std::string, std::vector<std::size_t>>& tensors) {
    nlohmann::json header;
    std::string data;
    for (const auto& [name, shape] : tensors) {
        std::size_t count = 1;
        for (const auto extent : shape) count *= extent;
        const std::vector<float> ones(count, 0.05f);
        const auto begin = data.size();
        data.append(reinterpret_cast<const char*>(ones.data()), ones.size() * sizeof(float));
        header[name] = {{"dtype", "F32"}, {"shape", shape}, {"data_offsets", {begin, data.size()}}};
    }
    const auto text = header.dump();
    std::uint64_t length = text.size();
    std::string prefix(sizeof(length), '\0');
    std::memcpy(prefix.data(), &length, sizeof(length));
    write_file(path, prefix + text + data);
}

/// A LoRA for one layer of the starter, of rank 1.
void write_starter_lora(const fs::path& path) {
    const std::string layer = "down_blocks.0.attentions.0.transformer_blocks.0.attn2.to_k";
    const auto header =
        safetensors_header(app::starter_model_path() / "unet/diffusion_pytorch_model.safetensors");
    const auto shape = header[layer + ".weight"]["shape"].get<std::vector<std::size_t>>();
    write_ones(path, {{"unet." + layer + ".lora_A.weight", {1, shape[1]}},
                      {"unet." + layer + ".lora_B.weight", {shape[0], 1}}});
}

}  // namespace

DOCTEST_TEST_CASE(
    "LoRAs: added, weighed, taken off; a bad one leaves the model as it was; the project keeps them") {
    if (!networks()) return;
    const Place place;
    const auto good = place.folder / "style.safetensors", fast = place.folder / "lcm style.safetensors",
               other = place.folder / "other.safetensors", project = place.folder / "with.gsep";
    write_starter_lora(good);
    write_starter_lora(fast);
    write_ones(other, {{"lora_unet_no_such_layer.lora_down.weight", {1, 4}},
                       {"lora_unet_no_such_layer.lora_up.weight", {4, 1}}});
    {
        Session session;
        session.open_bear();
        auto& app = session.app;
        app.run(command::AddLora{good.string() + ":0.5"});
        DOCTEST_REQUIRE(session.settled());
        DOCTEST_REQUIRE(app.model().loras.size() == 1);
        DOCTEST_CHECK(app.model().loras[0].name == "style");
        DOCTEST_CHECK(app.model().loras[0].strength == 0.5);
        app.run(command::SetLoraStrength{0, -0.25});
        DOCTEST_REQUIRE(session.settled());
        DOCTEST_CHECK(app.model().loras[0].strength == -0.25);
        for (const auto& bad : {other, place.folder / "gone.safetensors"}) {
            app.run(command::AddLora{bad.string()});
            DOCTEST_REQUIRE(session.settled());
            DOCTEST_CHECK(app.model().loras.size() == 1);
            DOCTEST_CHECK(app.model().toasts.back().is_error);
            DOCTEST_CHECK(app.model().toasts.back().text.find("LoRA") != std::string::npos);
        }
        const int rounds = app.model().request.rounds;
        app.run(command::AddLora{fast.string()});  // brings settings of its own
        DOCTEST_REQUIRE(session.settled());
        DOCTEST_REQUIRE(app.model().loras.size() == 2);
        DOCTEST_CHECK(app.model().request.rounds == 2);
        app.run(command::RemoveLora{1});
        DOCTEST_REQUIRE(session.settled());
        DOCTEST_CHECK(app.model().loras.size() == 1);
        DOCTEST_CHECK(app.model().request.rounds == rounds);
        app.run(command::SaveProject{project});
        DOCTEST_REQUIRE(session.settled());
        app.run(command::RemoveLora{0});
        DOCTEST_REQUIRE(session.settled());
        DOCTEST_CHECK(app.model().loras.empty());
        app.shut_down();
    }
    {
        Session again;
        DOCTEST_CHECK(again.app.model().loras.empty());
        again.app.run(command::Open{project});
        DOCTEST_REQUIRE(again.settled());
        DOCTEST_REQUIRE(again.app.model().loras.size() == 1);
        DOCTEST_CHECK(again.app.model().loras[0].strength == -0.25);
        again.app.shut_down();
    }
    fs::remove(good);  // gone until the next start: the model works without it
    Session last;
    DOCTEST_REQUIRE(last.settled());
    DOCTEST_CHECK(last.app.model().loras.empty());
    DOCTEST_CHECK(last.app.model().toasts.back().text.find("without them") != std::string::npos);
}

DOCTEST_TEST_CASE(
    "weights that are opened are used by their kind, or refused in one sentence with what to do") {
    if (!networks()) return;
    const Place place;
    const auto lora = place.folder / "style.safetensors", unknown = place.folder / "other.safetensors",
               pickle = place.folder / "old.ckpt", gguf = place.folder / "flux.gguf",
               adapter = place.folder / "adapter", model = place.folder / "model";
    write_starter_lora(lora);
    fs::create_directories(adapter);
    write_starter_lora(adapter / "adapter_model.safetensors");
    write_file(adapter / "adapter_config.json", "{\"lora_alpha\": 1, \"r\": 1}");
    write_ones(unknown, {{"some.layer.weight", {2, 2}}});
    write_file(pickle, "PK\x03\x04 and so on");
    write_file(gguf, GgufBytes()
                             .magic(1, 1)
                             .statement("general.architecture", "flux")
                             .tensor("double_blocks.0.img_attn.qkv.weight", {32, 32}, 2)
                             .bytes() +
                         std::string(4096, '\0'));
    fs::copy(app::starter_model_path(), model, fs::copy_options::recursive);
    Session session;
    session.open_bear();
    auto& app = session.app;
    const auto said = [&](const fs::path& path) {
        app.run(command::OpenModel{path});
        DOCTEST_REQUIRE(session.settled());
        return app.model().toasts.empty() ? std::string() : app.model().toasts.back().text;
    };
    const auto in_use = [&] {
        for (const auto& row : app.model().models)
            if (row.chosen) return fs::path(row.path);
        return fs::path();
    };
    said(lora);
    DOCTEST_REQUIRE(app.model().loras.size() == 1);
    DOCTEST_CHECK(app.model().loras[0].name == "style");
    said(adapter);
    DOCTEST_CHECK(app.model().loras.size() == 2);
    for (const auto& [path, remedy] :
         {std::pair{gguf, "image server"}, std::pair{pickle, "convert it"}, std::pair{unknown, "no model"}}) {
        const auto text = said(path);
        DOCTEST_CHECK_MESSAGE(text.find(path.filename().string()) != std::string::npos, text);
        DOCTEST_CHECK_MESSAGE(text.find(remedy) != std::string::npos, text);
        DOCTEST_CHECK(text.find(". ") == std::string::npos);  // one sentence
        DOCTEST_CHECK(app.model().toasts.back().is_error);
        DOCTEST_CHECK(app.model().loras.size() == 2);
    }
    said(model);
    DOCTEST_CHECK(in_use() == model);
    app.shut_down();
}

}  // namespace lora_test
