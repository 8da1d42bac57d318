// Inputs and LoRAs that an artist sets in a workflow.
#include <doctest/doctest.h>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/remote/workflow/workflow_loras.h"
#include "engine/remote/workflow/workflow_options.h"
#include "tests/test_paths.h"

namespace workflow_inputs_test {
namespace {

using namespace gse;
using namespace gse::remote;

Workflow bundled(const char* name) {
    return read_workflow(
        read_file(test::source_folder() / "assets/workflows" / (std::string(name) + ".json")));
}

std::string refusal(Workflow workflow, const std::string& option) {
    try {
        set_inputs(workflow, parse_server_options({option}));
    } catch (const Error& error) {
        DOCTEST_CHECK(error.code() == ErrorCode::InvalidArgument);
        DOCTEST_CHECK(!error.hint().empty());
        return error.message();
    }
    return {};
}

DOCTEST_TEST_CASE("workflow options: inputs are named by class, title or number, and keep their kind") {
    auto workflow = bundled("inpainting");
    workflow.graph["7"]["_meta"]["title"] = "my sampler v1.5";
    set_inputs(workflow, parse_server_options({"my sampler v1.5.scheduler=karras", "KSampler.sampler_name=7",
                                               "6.noise_mask=false"}));
    DOCTEST_CHECK(workflow.graph["7"]["inputs"]["scheduler"] == "karras");
    DOCTEST_CHECK(workflow.graph["7"]["inputs"]["sampler_name"] == "7");
    DOCTEST_CHECK(workflow.graph["6"]["inputs"]["noise_mask"] == false);
}

DOCTEST_TEST_CASE("workflow options: what is missing, linked, of several nodes or set already is refused") {
    const auto workflow = bundled("inpainting");
    const auto says = [&](const char* option, const char* words) {
        const auto message = refusal(workflow, option);
        DOCTEST_CAPTURE(message);
        return message.find(words) != std::string::npos;
    };
    DOCTEST_CHECK(says("KSampler.nonsense=1", "is no input of the workflow"));
    DOCTEST_CHECK(says("Sampler.scheduler=1", "is no input of the workflow"));
    DOCTEST_CHECK(says("scheduler=1", "is no input of the workflow"));
    DOCTEST_CHECK(says("KSampler.model=1", "is linked to another node"));
    DOCTEST_CHECK(says("CLIPTextEncode.text=1", "belongs to several nodes"));
    DOCTEST_CHECK(says("KSampler.seed=1", "is set by the program"));
    DOCTEST_CHECK(says("LoadImage.image=x", "is set by the program"));
    DOCTEST_CHECK(says("InpaintModelConditioning.noise_mask=3", "takes no such value"));
}

DOCTEST_TEST_CASE("workflow options: a forced input is given to a node that the workflow has, and no link") {
    auto workflow = bundled("inpainting");
    set_inputs(workflow, parse_server_options({"force:KSampler.eta=0.5", "force:KSampler.cfg_end=2"}));
    DOCTEST_CHECK(workflow.graph["7"]["inputs"]["eta"] == 0.5);
    DOCTEST_CHECK(workflow.graph["7"]["inputs"]["cfg_end"] == 2);
    for (const char* option : {"force:Sampler.eta=1", "force:KSampler.=1", "force:eta=1"})
        DOCTEST_CHECK(refusal(workflow, option).find("is no input of the workflow") != std::string::npos);
    DOCTEST_CHECK(refusal(workflow, "force:KSampler.seed=1").find("is set by the program") !=
                  std::string::npos);
    DOCTEST_CHECK(refusal(workflow, "force:KSampler.model=1").find("is linked") != std::string::npos);
    DOCTEST_CHECK(refusal(workflow, "force:KSampler.sigmas=[\"1\", 0]").find("takes no such value") !=
                  std::string::npos);
}

DOCTEST_TEST_CASE("workflow loras: everything gets model and text encoder through the loaders, in a chain") {
    auto workflow = bundled("inpainting");
    add_lora_loaders(workflow, {{"a.safetensors", 1}, {"b.safetensors", 0.5}});
    const auto& graph = workflow.graph;
    const auto link = [](const char* node, int output) { return nlohmann::json::array({node, output}); };
    DOCTEST_CHECK(graph["gse lora 1"]["inputs"]["model"] == link("1", 0));
    DOCTEST_CHECK(graph["gse lora 2"]["inputs"]["model"] == link("gse lora 1", 0));
    DOCTEST_CHECK(graph["gse lora 2"]["inputs"]["clip"] == link("gse lora 1", 1));
    DOCTEST_CHECK(graph["gse lora 2"]["inputs"]["strength_clip"] == 0.5);
    DOCTEST_CHECK(graph["7"]["inputs"]["model"] == link("gse lora 2", 0));
    DOCTEST_CHECK(graph["4"]["inputs"]["clip"] == link("gse lora 2", 1));
    DOCTEST_CHECK(graph["6"]["inputs"]["vae"] == link("1", 2));
}

DOCTEST_TEST_CASE("workflow loras: a loader of a network alone gives no text encoder") {
    auto workflow = bundled("edit");
    add_lora_loaders(workflow, {{"a.safetensors", 1}});
    DOCTEST_CHECK(workflow.graph["gse lora 1"]["class_type"] == "LoraLoaderModelOnly");
    DOCTEST_CHECK(!workflow.graph["gse lora 1"]["inputs"].contains("clip"));
    for (const auto& node : workflow.graph)
        if (node["class_type"] == "KSampler") DOCTEST_CHECK(node["inputs"]["model"][0] == "gse lora 1");
    auto without = workflow;
    std::erase_if(without.places, [](const auto& place) { return place.role == WorkflowRole::Model; });
    DOCTEST_CHECK_THROWS_AS(add_lora_loaders(without, {{"a", 1}}), Error);
}

}  // namespace
}  // namespace workflow_inputs_test
