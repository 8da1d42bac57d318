// LoRAs in the artist's window: tried before they count, kept with the project, and the model stays as it was
// where they fail.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <cstring>
#include <map>

#include "engine/base/file.h"
#include "engine/base/safetensors_header.h"
#include "tests/ui/app/session.h"

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
    const std::string layer = "mid_block.attentions.0.transformer_blocks.0.attn2.to_q";
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

}  // namespace lora_test
