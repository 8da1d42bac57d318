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
        DOCTEST_CHECK(family.side % 64 == 0);
        if (family.instructed()) DOCTEST_CHECK(family.strength == 1);
    }
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
