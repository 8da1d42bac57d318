// Families by the names that servers tell.
#include <doctest/doctest.h>

#include <string>
#include <utility>
#include <vector>

#include "engine/base/error.h"
#include "engine/remote/views/agreement.h"
#include "engine/remote/views/family.h"
#include "engine/remote/views/remote_prompt.h"

namespace family_test {
namespace {

using namespace gse;
using namespace gse::remote;

DOCTEST_TEST_CASE("family: names of real models lead to the family that drives them") {
    const std::vector<std::pair<std::string, std::string>> cases{
        {"v1-5-pruned-emaonly.safetensors [6ce0161689]", "sd15"},
        {"", "sd15"},
        {"sd-v1-5-inpainting.ckpt", "sd15-inpainting"},
        {"instruct-pix2pix-00-22000.safetensors", "ip2p"},
        {"sd_xl_base_1.0.safetensors", "sdxl"},
        {"ponyDiffusionV6XL_v6.safetensors", "sdxl"},
        {"juggernautXL_lightning", "sdxl-distilled"},
        {"sd_xl_base_1.0_inpainting_0.1", "sdxl-inpainting"},
        {"flux1-dev-Q2_K.gguf", "flux1"},
        {"flux1-fill-dev.safetensors", "flux1-fill"},
        {"flux1-kontext-dev-Q4_0.gguf", "kontext"},
        {"flux-2-klein-4b-Q8_0.gguf", "flux2-klein"},
        {"FLUX.2-klein-base-9B", "flux2-klein-base"},
        {"FLUX.2-dev", "flux2"},
        {"Qwen-Image-Edit", "qwen-edit"},
        {"qwen_image_edit_2509_fp8.safetensors", "qwen-edit-plus"},
        {"qwen-image-Q4_K_S.gguf", "qwen-image"},
        {"z_image_turbo_bf16.safetensors", "z-image"},
        {"Z-Image-Base-Q8_0.gguf", "z-image-base"},
        {"gpt-image-1", "editor"}};
    for (const auto& [model, family] : cases) {
        DOCTEST_CAPTURE(model);
        DOCTEST_CHECK(family_of(model).name == family);
    }
    DOCTEST_CHECK(family_of("unheard of", "editor").name == "editor");
    DOCTEST_CHECK_THROWS_AS(family_named("gan"), Error);
}

DOCTEST_TEST_CASE("family: every family has settings that a server takes") {
    for (const auto& family : model_families()) {
        DOCTEST_CAPTURE(family.name);
        DOCTEST_CHECK(family.steps >= 1);
        DOCTEST_CHECK(family.strength <= 1);
        DOCTEST_CHECK(family.again_strength <= family.strength);
        DOCTEST_CHECK(family.side % family.side_step == 0);
        DOCTEST_CHECK(family.side_step % family.latent_cell == 0);
        if (family.instructed()) DOCTEST_CHECK(family.strength == 1);
    }
}

DOCTEST_TEST_CASE("family: Qwen's pictures have sides in steps of 112") {
    for (const auto* name : {"qwen-image", "qwen-edit", "qwen-edit-plus"}) {
        DOCTEST_CHECK(family_named(name).side == 9 * 112);
        DOCTEST_CHECK(order_of(family_named(name)).side_step == 112);
    }
    for (const auto* name : {"flux1", "kontext", "flux2", "flux2-klein", "z-image"})
        DOCTEST_CHECK(family_named(name).side_step % 16 == 0);
}

DOCTEST_TEST_CASE("family: whole pictures are redrawn with a mask only where the server keeps the rest") {
    const auto masked = [](ServerKind kind, const std::string& product, std::string_view family) {
        ServerFacts facts;
        facts.kind = kind;
        facts.product = product;
        RedrawOrder order;
        order.picture = Image(64, 64, 3);
        order.mask = Image(64, 64, 1, 1);
        suit_to_server(order, facts, family_named(family));
        return !order.mask.data.empty();
    };
    for (const auto* family : {"kontext", "flux2-klein", "qwen-edit-plus", "editor"}) {
        DOCTEST_CAPTURE(family);
        DOCTEST_CHECK(masked(ServerKind::SdCpp, "sd-server", family));
        DOCTEST_CHECK(masked(ServerKind::Comfy, "ComfyUI", family));
        DOCTEST_CHECK(masked(ServerKind::OpenAi, "sd-server", family));
        DOCTEST_CHECK_FALSE(masked(ServerKind::OpenAi, "vLLM-Omni", family));
        DOCTEST_CHECK_FALSE(masked(ServerKind::Webui, "SD.Next", family));
    }
    DOCTEST_CHECK(masked(ServerKind::Webui, "A1111", "ip2p"));
    DOCTEST_CHECK(masked(ServerKind::Webui, "Forge", "flux1-fill"));
    DOCTEST_CHECK(masked(ServerKind::OpenAi, "vLLM-Omni", "sd15"));
}

DOCTEST_TEST_CASE("agreement: what suits a family depends on what the server takes") {
    ServerFacts facts;
    facts.references = 4;
    const auto suited = [&](std::string_view family) {
        return suited_agreement(Agreement::Auto, family_named(family), facts);
    };
    DOCTEST_CHECK(suited("flux2-klein") == Agreement::Reference);
    DOCTEST_CHECK(suited("kontext") == Agreement::Sheet);
    DOCTEST_CHECK(suited("flux1-fill") == Agreement::Warp);
    DOCTEST_CHECK(suited("sd15") == Agreement::None);
    facts.references = 0;
    DOCTEST_CHECK(suited("flux2-klein") == Agreement::Sheet);
    DOCTEST_CHECK_THROWS_AS(suited_agreement(Agreement::Reference, family_named("sd15"), facts), Error);
    DOCTEST_CHECK(suited_agreement(Agreement::Warp, family_named("sd15"), facts) == Agreement::Warp);
    for (const auto agreement :
         {Agreement::Auto, Agreement::None, Agreement::Sheet, Agreement::Reference, Agreement::Warp})
        DOCTEST_CHECK(agreement_of(agreement_name(agreement)) == agreement);
    DOCTEST_CHECK_THROWS_AS(agreement_of("vote"), Error);
}

DOCTEST_TEST_CASE("prompt: a description tells the side, an instruction what to do and what to keep") {
    const EditText text{"a golden bear", "make the bear golden", ""};
    DOCTEST_CHECK(prompt_for_view(family_named("sd15"), text, "back view", false) ==
                  "a golden bear, back view");
    const auto told = prompt_for_view(family_named("kontext"), text, "back view", false);
    DOCTEST_CHECK(told.starts_with("Make the bear golden. "));
    DOCTEST_CHECK(told.find("back view") == std::string::npos);
    DOCTEST_CHECK(told.find("exactly the same") != std::string::npos);
    DOCTEST_CHECK(prompt_with_reference(family_named("qwen-edit-plus"), text, "").find("Picture 2") !=
                  std::string::npos);
    DOCTEST_CHECK(prompt_with_reference(family_named("flux2"), text, "").find("image 2") !=
                  std::string::npos);
}

}  // namespace
}  // namespace family_test
