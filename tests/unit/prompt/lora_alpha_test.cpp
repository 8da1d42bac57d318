// Alphas of LoRA layers that are stated beside the tensors.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <cmath>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/neural/api/lora_alpha.h"
#include "tests/test_paths.h"

namespace lora_alpha_test {
namespace {

using namespace gse;
using namespace gse::neural;
using Metadata = std::map<std::string, std::string>;

constexpr double Exact = 1e-12;  // one product and one root in double

const std::string Query = "down_blocks.0.attentions.0.transformer_blocks.0.attn1.to_q",
                  Value = "down_blocks.0.attentions.0.transformer_blocks.0.attn1.to_v",
                  Projection = "text_model.encoder.layers.0.self_attn.q_proj";

/// Layers of rank 4 as PEFT names them: two of the UNet, one of the text encoder.
std::vector<LoraLayer> peft_layers() {
    return {{false, Query, 4, true}, {false, Value, 4, true}, {true, Projection, 4, true}};
}

std::vector<double> alphas(const Metadata& metadata, const std::string& config = {},
                           const std::vector<LoraLayer>& layers = peft_layers()) {
    const test::ScratchFolder folder;
    if (!config.empty()) write_file(folder.path() / "adapter_config.json", config);
    return stated_alphas(folder.path() / "adapter_model.safetensors", metadata, layers).alphas;
}

using Alphas = std::vector<double>;

}  // namespace

DOCTEST_TEST_CASE("lora alpha: the rank where nothing is stated") {
    DOCTEST_CHECK(alphas({}) == Alphas{4, 4, 4});
    DOCTEST_CHECK(alphas({{"ss_network_alpha", "None"}, {"lora_alpha", ""}}) == Alphas{4, 4, 4});
    DOCTEST_CHECK(alphas({{"ss_network_alpha", "Dynamic"}}) == Alphas{4, 4, 4});
}

DOCTEST_TEST_CASE("lora alpha: PEFT's configuration beside the file") {
    DOCTEST_CHECK(alphas({}, R"({"r": 4, "lora_alpha": 16})") == Alphas{16, 16, 16});
    DOCTEST_CHECK(alphas({}, R"({"r": 4, "lora_alpha": 16, "alpha_pattern": {"to_v": 2}})") ==
                  Alphas{16, 2, 16});
    DOCTEST_CHECK(alphas({}, R"({"r": 4, "lora_alpha": 16, "alpha_pattern": {"o_v": 2, "attn1.to_q": 3}})") ==
                  Alphas{3, 16, 16});
    DOCTEST_CHECK(alphas({}, R"x({"lora_alpha": 1, "alpha_pattern": {"attn1.to_(q|v)": 5, "to_q": 6}})x") ==
                  Alphas{5, 5, 1});
    DOCTEST_CHECK(alphas({}, R"({"lora_alpha": 1, "alpha_pattern": {"^text_model.*q_proj": 7}})") ==
                  Alphas{1, 1, 7});
    DOCTEST_CHECK(alphas({}, "{\"lora_alpha\": 8, \"alpha_pattern\": {\"" + Query + "\": 32}}") ==
                  Alphas{32, 8, 8});
}

DOCTEST_TEST_CASE("lora alpha: with use_rslora the strength is alpha over the root of the rank") {
    for (const double alpha : alphas({}, R"({"r": 4, "lora_alpha": 6, "use_rslora": true})"))
        DOCTEST_CHECK(std::abs(alpha / 4 - 6 / std::sqrt(4.0)) <= Exact);
    const auto nine =
        alphas({}, R"({"r": 4, "rank_pattern": {"to_v": 9}, "lora_alpha": 6, "use_rslora": true})",
               {{false, Query, 4, true}, {false, Value, 9, true}});
    DOCTEST_REQUIRE(nine.size() == 2);
    DOCTEST_CHECK(std::abs(nine[1] / 9 - 6 / std::sqrt(9.0)) <= Exact);
}

DOCTEST_TEST_CASE("lora alpha: a configuration of other ranks is of another adapter, which is said") {
    const test::ScratchFolder folder;
    const auto file = folder.path() / "style.safetensors";
    write_file(folder.path() / "adapter_config.json", R"({"r": 16, "lora_alpha": 64})");
    const auto stated = stated_alphas(file, {}, peft_layers());
    DOCTEST_CHECK(stated.alphas == Alphas{4, 4, 4});
    DOCTEST_CHECK(stated.note.find("adapter_config.json") != std::string::npos);
    // It says nothing of files that are not PEFT's.
    auto kohya = peft_layers();
    for (auto& layer : kohya) layer.peft = false;
    write_file(folder.path() / "adapter_config.json", "damaged");
    DOCTEST_CHECK(stated_alphas(file, {}, kohya).alphas == Alphas{4, 4, 4});
    DOCTEST_CHECK_THROWS_AS(stated_alphas(file, {}, peft_layers()), Error);
}

DOCTEST_TEST_CASE("lora alpha: diffusers' metadata has parts for UNet and text encoder") {
    const char* key = "lora_adapter_metadata";
    DOCTEST_CHECK(alphas({{key, R"({"unet.r": 4, "unet.lora_alpha": 8, "text_encoder.lora_alpha": 2})"}}) ==
                  Alphas{8, 8, 2});
    DOCTEST_CHECK(alphas({{key, R"({"unet.lora_alpha": 8})"}}) == Alphas{8, 8, 4});
    DOCTEST_CHECK(alphas({{key, R"({"unet.lora_alpha": 8, "unet.alpha_pattern": {"to_v": 1}})"}}) ==
                  Alphas{8, 1, 4});
    DOCTEST_CHECK(alphas({{key, R"({"unet.lora_alpha": 8, "unet.use_rslora": true})"}}) == Alphas{16, 16, 4});
    DOCTEST_CHECK(alphas({{key, R"({"lora_alpha": 8})"}}) == Alphas{8, 8, 8});
    DOCTEST_CHECK(alphas({{key, R"({"unet": {"lora_alpha": 8}})"}}) == Alphas{8, 8, 4});
    DOCTEST_CHECK_THROWS_AS(alphas({{key, "{"}}), Error);
    DOCTEST_CHECK_THROWS_AS(alphas({{key, R"({"unet.lora_alpha": "much"})"}}), Error);
    DOCTEST_CHECK_THROWS_AS(alphas({{key, R"({"unet.alpha_pattern": 3})"}}), Error);
}

DOCTEST_TEST_CASE("lora alpha: kohya's metadata, and that of convolutions") {
    const std::vector<LoraLayer> layers{{false, "mid_block_attentions_0_proj_in", 8},
                                        {false, "mid_block_resnets_0_conv1", 8, false, true}};
    DOCTEST_CHECK(alphas({{"ss_network_alpha", "2.0"}}, {}, layers) == Alphas{2, 2});
    DOCTEST_CHECK(alphas({{"lora_alpha", "4"}}, {}, layers) == Alphas{4, 4});
    DOCTEST_CHECK(
        alphas({{"ss_network_alpha", "2"}, {"ss_network_args", R"({"conv_dim": "8", "conv_alpha": "1.5"})"}},
               {}, layers) == Alphas{2, 1.5});
    DOCTEST_CHECK(alphas({{"ss_network_alpha", "2"}, {"ss_network_args", R"({"conv_dim": "8"})"}}, {},
                         layers) == Alphas{2, 1});
}

DOCTEST_TEST_CASE("lora alpha: patterns of any source come before alphas of any") {
    const Metadata metadata{
        {"lora_adapter_metadata", R"({"unet.alpha_pattern": {"to_q": 3}, "unet.lora_alpha": 9})"},
        {"ss_network_alpha", "1"}};
    DOCTEST_CHECK(alphas(metadata, R"({"r": 4, "lora_alpha": 16})") == Alphas{3, 16, 16});
}

DOCTEST_TEST_CASE("lora alpha: an expression without an end is given up") {
    const std::string endless = R"({"lora_alpha": 2, "alpha_pattern": {"(a*)*(a*)*(a*)*b": 3, "to_v": 5}})";
    const std::vector<LoraLayer> layers{{false, std::string(4000, 'a'), 4, true}, {false, Value, 4, true}};
    DOCTEST_CHECK(alphas({}, endless, layers) == Alphas{2, 5});
}

}  // namespace lora_alpha_test
