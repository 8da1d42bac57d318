// Workflows of ComfyUI: places by title, by Krita's nodes and by guess, and what is refused.
#include <doctest/doctest.h>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/json.h"
#include "engine/remote/workflow/workflow.h"
#include "engine/remote/workflow/workflow_files.h"
#include "tests/test_paths.h"

namespace gse::remote {
namespace {

/// Workflow without any title, as the window exports it.
nlohmann::json plain_graph() {
    return parse_json(R"({
        "1": {"class_type": "CheckpointLoaderSimple", "inputs": {"ckpt_name": "a.safetensors"}},
        "2": {"class_type": "LoadImage", "inputs": {"image": "example.png", "upload": "image"}},
        "3": {"class_type": "CLIPTextEncode", "inputs": {"text": "good", "clip": ["1", 1]}},
        "4": {"class_type": "CLIPTextEncode", "inputs": {"text": "bad", "clip": ["1", 1]}},
        "5": {"class_type": "VAEEncode", "inputs": {"pixels": ["2", 0], "vae": ["1", 2]}},
        "6": {"class_type": "SetLatentNoiseMask", "inputs": {"samples": ["5", 0], "mask": ["2", 1]}},
        "7": {"class_type": "ControlNetApplyAdvanced", "inputs": {"positive": ["3", 0], "negative": ["4", 0],
              "strength": 1}},
        "8": {"class_type": "KSampler", "inputs": {"model": ["1", 0], "seed": 1, "steps": 20, "cfg": 7,
              "denoise": 0.5, "positive": ["7", 0], "negative": ["7", 1], "latent_image": ["6", 0]}},
        "9": {"class_type": "VAEDecode", "inputs": {"samples": ["8", 0], "vae": ["1", 2]}},
        "10": {"class_type": "SaveImage", "inputs": {"images": ["9", 0], "filename_prefix": "x"}}})",
                      "the graph");
}

Workflow bound(const nlohmann::json& graph) { return read_workflow(graph.dump()); }

std::string place(const Workflow& workflow, WorkflowRole role) {
    const auto* found = workflow.find(role);
    return found == nullptr ? "none" : found->node + "." + found->input;
}

ErrorCode refusal(const nlohmann::json& graph) {
    try {
        bound(graph);
    } catch (const Error& error) {
        DOCTEST_CHECK(!error.hint().empty());
        return error.code();
    }
    return ErrorCode::Cancelled;  // none
}

DOCTEST_TEST_CASE("places without a title are found where there is one candidate") {
    const auto workflow = bound(plain_graph());
    DOCTEST_CHECK(place(workflow, WorkflowRole::Image) == "2.image");
    DOCTEST_CHECK(place(workflow, WorkflowRole::Prompt) == "3.text");
    DOCTEST_CHECK(place(workflow, WorkflowRole::Negative) == "4.text");
    DOCTEST_CHECK(place(workflow, WorkflowRole::Seed) == "8.seed");
    DOCTEST_CHECK(place(workflow, WorkflowRole::Steps) == "8.steps");
    DOCTEST_CHECK(place(workflow, WorkflowRole::Strength) == "8.denoise");
    DOCTEST_CHECK(place(workflow, WorkflowRole::Model) == "1.ckpt_name");
    DOCTEST_CHECK(place(workflow, WorkflowRole::Guidance) == "none");
    DOCTEST_CHECK(place(workflow, WorkflowRole::Output) == "10.");
    DOCTEST_CHECK(workflow.mask_in_alpha);
    DOCTEST_CHECK(workflow.graph["10"]["class_type"] == "PreviewImage");
    DOCTEST_CHECK(!workflow.graph["10"]["inputs"].contains("filename_prefix"));
    DOCTEST_CHECK(workflow.table().front() == "image: node 2 (LoadImage), image");
}

DOCTEST_TEST_CASE("values are set in their places and nowhere else") {
    const auto workflow = bound(plain_graph());
    WorkflowValues values;
    values.image = "gse/a.png [temp]";
    values.prompt = "a \"golden\" bear\n";
    values.negative_prompt = "blurred";
    values.seed = 77;
    values.steps = 12;
    values.strength = 0.75;
    const auto filled = filled_workflow(workflow, values);
    auto expected = workflow.graph;
    expected["2"]["inputs"]["image"] = "gse/a.png [temp]";
    expected["3"]["inputs"]["text"] = "a \"golden\" bear\n";
    expected["4"]["inputs"]["text"] = "blurred";
    expected["8"]["inputs"]["seed"] = 77;
    expected["8"]["inputs"]["steps"] = 12;
    expected["8"]["inputs"]["denoise"] = 0.75;
    DOCTEST_CHECK(filled == expected);
}

DOCTEST_TEST_CASE("titles come before guesses, and one node may have several") {
    auto graph = plain_graph();
    graph["20"] = {
        {"class_type", "LoadImage"}, {"inputs", {{"image", "b"}}}, {"_meta", {{"title", "GSE Reference 2"}}}};
    graph["21"] = {
        {"class_type", "LoadImage"}, {"inputs", {{"image", "c"}}}, {"_meta", {{"title", "gse reference 1"}}}};
    graph["22"] = {
        {"class_type", "LoadImageMask"}, {"inputs", {{"image", "c"}}}, {"_meta", {{"title", "gse mask"}}}};
    graph["8"]["_meta"] = {{"title", "gse seed, steps, guidance"}};
    const auto workflow = bound(graph);
    DOCTEST_CHECK(place(workflow, WorkflowRole::Image) == "2.image");
    DOCTEST_CHECK(place(workflow, WorkflowRole::Mask) == "22.image");
    DOCTEST_CHECK(place(workflow, WorkflowRole::Guidance) == "8.cfg");
    DOCTEST_CHECK(workflow.count(WorkflowRole::Reference) == 2);
    WorkflowValues values;
    values.references = {"first", "second"};
    const auto filled = filled_workflow(workflow, values);
    DOCTEST_CHECK(filled["21"]["inputs"]["image"] == "first");
    DOCTEST_CHECK(filled["20"]["inputs"]["image"] == "second");
}

DOCTEST_TEST_CASE("two candidates are asked about, never picked") {
    for (const char* extra : {R"({"20": {"class_type": "LoadImage", "inputs": {"image": "b"}}})",
                              R"({"20": {"class_type": "KSampler", "inputs": {"seed": 3}}})",
                              R"({"20": {"class_type": "PreviewImage", "inputs": {"images": ["9", 0]}}})",
                              R"({"20": {"class_type": "LoadImageMask", "inputs": {"image": "b"}},
              "21": {"class_type": "LoadImageMask", "inputs": {"image": "b"}}})"}) {
        auto graph = plain_graph();
        graph.update(parse_json(extra, "extra"));
        DOCTEST_CAPTURE(extra);
        DOCTEST_CHECK(refusal(graph) == ErrorCode::InvalidArgument);
    }
    auto titled = plain_graph();
    titled["3"]["_meta"] = titled["4"]["_meta"] = {{"title", "gse prompt"}};
    DOCTEST_CHECK(refusal(titled) == ErrorCode::InvalidArgument);
    titled["4"]["_meta"] = {{"title", "gse unheard-of"}};
    DOCTEST_CHECK(refusal(titled) == ErrorCode::InvalidArgument);
}

DOCTEST_TEST_CASE("what is no workflow in API format is refused") {
    for (const char* text : {"", "{", "[]", "{}", "7", R"({"nodes": [], "links": []})", R"({"1": 2})",
                             R"({"1": {"class_type": 3, "inputs": {}}})", R"({"1": {"class_type": "A"}})",
                             R"({"1": {"class_type": "A", "inputs": []}})"}) {
        DOCTEST_CAPTURE(text);
        DOCTEST_CHECK_THROWS_AS(read_workflow(text), Error);
    }
    DOCTEST_CHECK_THROWS_AS(read_workflow(std::string(2 << 20, ' ')), Error);
    auto graph = plain_graph();
    graph.erase("2");
    DOCTEST_CHECK(refusal(graph) == ErrorCode::InvalidArgument);
    const nlohmann::json wrapped{{"prompt", plain_graph()}};
    DOCTEST_CHECK(place(bound(wrapped), WorkflowRole::Image) == "2.image");
}

DOCTEST_TEST_CASE("circles of links end") {
    auto graph = plain_graph();
    graph["7"]["inputs"]["positive"] = {"8", 0};
    graph["8"]["inputs"]["positive"] = {"7", 0};
    graph["7"]["inputs"]["negative"] = {"77", 5};
    DOCTEST_CHECK(refusal(graph) == ErrorCode::InvalidArgument);  // no text is found
}

DOCTEST_TEST_CASE("a guider of newer workflows leads to its text") {
    const auto graph = parse_json(R"({
        "1": {"class_type": "LoadImage", "inputs": {"image": "a"}},
        "2": {"class_type": "PrimitiveString", "inputs": {"value": "hello"}},
        "3": {"class_type": "CLIPTextEncode", "inputs": {"text": ["2", 0]}},
        "4": {"class_type": "FluxGuidance", "inputs": {"conditioning": ["3", 0], "guidance": 3.5}},
        "5": {"class_type": "ReferenceLatent", "inputs": {"conditioning": ["4", 0], "latent": ["1", 0]}},
        "6": {"class_type": "BasicGuider", "inputs": {"conditioning": ["5", 0]}},
        "7": {"class_type": "RandomNoise", "inputs": {"noise_seed": 4}},
        "8": {"class_type": "BasicScheduler", "inputs": {"steps": 4, "denoise": 1}},
        "9": {"class_type": "SamplerCustomAdvanced", "inputs": {"guider": ["6", 0], "noise": ["7", 0]}},
        "10": {"class_type": "PreviewImage", "inputs": {"images": ["9", 0]}}})",
                                  "the graph");
    const auto workflow = bound(graph);
    DOCTEST_CHECK(place(workflow, WorkflowRole::Prompt) == "2.value");
    DOCTEST_CHECK(place(workflow, WorkflowRole::Negative) == "none");
    DOCTEST_CHECK(place(workflow, WorkflowRole::Seed) == "7.noise_seed");
    DOCTEST_CHECK(place(workflow, WorkflowRole::Steps) == "8.steps");
}

DOCTEST_TEST_CASE("nodes of Krita become core nodes, and those of its layers are refused") {
    auto graph = plain_graph();
    graph["2"] = {{"class_type", "ETN_KritaCanvas"}, {"inputs", nlohmann::json::object()}};
    graph["11"] = {{"class_type", "ETN_KritaSelection"}, {"inputs", nlohmann::json::object()}};
    graph["12"] = {{"class_type", "ETN_Parameter"},
                   {"inputs", {{"name", "Prompt"}, {"type", "prompt"}, {"default", "a"}}}};
    graph["13"] = {{"class_type", "ETN_Parameter"}, {"inputs", {{"name", "Fun"}, {"default", 6}}}};
    graph["10"] = {{"class_type", "ETN_KritaOutput"}, {"inputs", {{"images", {"9", 0}}}}};
    graph["3"]["inputs"]["text"] = {"12", 0};
    graph["6"]["inputs"]["mask"] = {"11", 0};
    graph["8"]["inputs"]["seed"] = {"2", 3};
    graph["8"]["inputs"]["cfg"] = {"13", 0};
    const auto workflow = bound(graph);
    DOCTEST_CHECK(workflow.graph["2"]["class_type"] == "LoadImage");
    DOCTEST_CHECK(workflow.graph["11"]["class_type"] == "LoadImageMask");
    DOCTEST_CHECK(workflow.graph["10"]["class_type"] == "PreviewImage");
    DOCTEST_CHECK(!workflow.graph.contains("12"));
    DOCTEST_CHECK(workflow.graph["8"]["inputs"]["cfg"] == 6);
    DOCTEST_CHECK(place(workflow, WorkflowRole::Prompt) == "3.text");
    DOCTEST_CHECK(place(workflow, WorkflowRole::Mask) == "11.image");
    DOCTEST_CHECK(place(workflow, WorkflowRole::Seed) == "8.seed");
    graph["14"] = {{"class_type", "ETN_KritaImageLayer"}, {"inputs", nlohmann::json::object()}};
    DOCTEST_CHECK(refusal(graph) == ErrorCode::Unsupported);
}

DOCTEST_TEST_CASE("every bundled workflow binds all that an order holds") {
    for (const char* name : {"img2img", "inpainting", "edit", "edit_reference"}) {
        DOCTEST_CAPTURE(name);
        const auto workflow = load_workflow(name);
        for (const auto role :
             {WorkflowRole::Image, WorkflowRole::Prompt, WorkflowRole::Seed, WorkflowRole::Steps,
              WorkflowRole::Strength, WorkflowRole::Guidance, WorkflowRole::Model, WorkflowRole::Output})
            DOCTEST_CHECK(workflow.find(role) != nullptr);
        DOCTEST_CHECK(workflow.count(WorkflowRole::Reference) ==
                      (std::string(name) == "edit_reference" ? 1 : 0));
        DOCTEST_CHECK((workflow.find(WorkflowRole::Mask) != nullptr) == (std::string(name) != "img2img"));
    }
}

}  // namespace
}  // namespace gse::remote
