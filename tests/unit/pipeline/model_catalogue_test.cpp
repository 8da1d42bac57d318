// Models as the headers of files and folders describe them.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/pipeline/models/installed.h"
#include "engine/pipeline/models/model_catalogue.h"
#include "engine/pipeline/report/scene_report.h"
#include "tests/test_paths.h"

namespace model_catalogue_test {

namespace {

using namespace gse;
using namespace gse::pipeline;
namespace fs = std::filesystem;
using HeaderJson = nlohmann::json;

/// Tensors of these shapes, none of their numbers: only the header counts.
void write_checkpoint(const fs::path& path,
                      const std::vector<std::pair<std::string, std::vector<int>>>& tensors) {
    HeaderJson header;
    for (const auto& [name, shape] : tensors)
        header[name] = {{"dtype", "F16"}, {"shape", shape}, {"data_offsets", {0, 0}}};
    const std::string text = header.dump();
    std::string bytes;
    for (int i = 0; i < 8; ++i) bytes.push_back(static_cast<char>((text.size() >> (8 * i)) & 255));
    write_file(path, bytes + text);
}

std::vector<std::pair<std::string, std::vector<int>>> whole_model(int channels, int width) {
    return {{"model.diffusion_model.input_blocks.0.0.weight", {320, channels, 3, 3}},
            {"model.diffusion_model.input_blocks.2.1.transformer_blocks.0.attn2.to_k.weight", {320, width}},
            {"cond_stage_model.model.token_embedding.weight", {49408, width}},
            {"first_stage_model.decoder.conv_in.weight", {512, 4, 3, 3}}};
}

FoundModel found_at(const std::vector<FoundModel>& models, const fs::path& path) {
    const auto row = std::find_if(models.begin(), models.end(),
                                  [&](const auto& model) { return model.path == path.string(); });
    DOCTEST_REQUIRE_MESSAGE(row != models.end(), path.string());
    return *row;
}

}  // namespace

DOCTEST_TEST_CASE(
    "model catalogue: checkpoints are told apart by their headers, and say why they cannot be used") {
    const test::ScratchFolder folder;
    const auto file = [&](const char* name) { return folder.path() / name; };
    write_checkpoint(file("one.safetensors"), whole_model(4, 768));
    write_checkpoint(file("two.safetensors"), whole_model(4, 1024));
    write_checkpoint(file("told.safetensors"), whole_model(8, 768));
    write_checkpoint(file("inpaint.safetensors"), whole_model(9, 768));
    write_checkpoint(file("lora.safetensors"), {{"lora_unet_mid.lora_up.weight", {4, 4}}});
    write_checkpoint(file("xl.safetensors"), whole_model(4, 2048));
    auto without_vae = whole_model(4, 768);
    without_vae.pop_back();
    write_checkpoint(file("no_vae.safetensors"), without_vae);
    write_checkpoint(file("SHOUTED.SAFETENSORS"), whole_model(4, 768));
    write_checkpoint(file("short.sft"), whole_model(4, 768));
    write_file(file("noise.safetensors"), "not a header");
    write_file(file("old.ckpt"), "pickled");
    write_file(file("OLD.CKPT"), "pickled");
    write_file(file("readme.txt"), "nothing");
    setenv("GSE_MODELS", (folder.path().string() + ":/nowhere/at/all").c_str(), 1);
    const auto models = find_models({(folder.path() / "gone").string()});
    unsetenv("GSE_MODELS");

    DOCTEST_CHECK(models.front().path == starter_model_path().string());
    DOCTEST_CHECK(models.front().structure == "starter");
    DOCTEST_CHECK(models.front().usable);
    struct Expected {
        const char* name;
        const char* structure;
        const char* problem;  // part of it; "" = usable
    };
    for (const auto& [name, structure, problem] :
         {Expected{"one.safetensors", "Stable Diffusion 1.x", ""},
          Expected{"two.safetensors", "Stable Diffusion 2.x", ""},
          Expected{"told.safetensors", "Stable Diffusion 1.x, InstructPix2Pix", ""},
          Expected{"inpaint.safetensors", "Stable Diffusion 1.x inpainting",
                   "inpainting models are not supported"},
          Expected{"lora.safetensors", "LoRA, fp16", "no whole model"},
          Expected{"xl.safetensors", "SDXL", "only Stable Diffusion 1.x and 2.x are loaded here"},
          Expected{"no_vae.safetensors", "Stable Diffusion 1.x", "no_vae.vae.safetensors"},
          Expected{"SHOUTED.SAFETENSORS", "Stable Diffusion 1.x", ""},
          Expected{"short.sft", "Stable Diffusion 1.x", ""},
          Expected{"noise.safetensors", "", "not a file of weights"}, Expected{"old.ckpt", "", "pickled"},
          Expected{"OLD.CKPT", "", "pickled"}, Expected{"gone", "", "not there any more"}}) {
        const FoundModel model = found_at(models, file(name));
        const std::string wanted = problem;
        DOCTEST_CHECK(model.structure == structure);
        DOCTEST_CHECK(model.usable == wanted.empty());
        DOCTEST_CHECK(model.problem.find(wanted) != std::string::npos);
        DOCTEST_CHECK(model.problem.empty() == wanted.empty());
    }
    DOCTEST_CHECK(std::none_of(models.begin(), models.end(),
                               [](const auto& model) { return model.path.ends_with("readme.txt"); }));
}

DOCTEST_TEST_CASE("model catalogue: a folder names itself and the parts that it lacks") {
    const test::ScratchFolder folder;
    const auto model = folder.path() / "mine";
    fs::create_directories(model / "unet");
    fs::create_directories(model / "text_encoder");
    write_file(model / "gseditpro.json", R"({"name": "my own"})");
    write_file(model / "unet/config.json", R"({"in_channels": 4})");
    const auto listed = found_at(find_models({model.string()}), model);
    DOCTEST_CHECK(listed.name == "my own");
    DOCTEST_CHECK_FALSE(listed.usable);
    DOCTEST_CHECK(listed.problem == "missing: vae, tokenizer");
    DOCTEST_CHECK(listed.bytes > 0);
    for (const char* part : {"vae", "tokenizer"}) fs::create_directories(model / part);
    DOCTEST_CHECK(found_at(find_models({model.string()}), model).usable);
}

DOCTEST_TEST_CASE("model catalogue: a model says what it predicts, and by which file that is known") {
    const test::ScratchFolder folder;
    const auto path = folder.path() / "model.safetensors";
    write_checkpoint(path, whole_model(4, 768));
    DOCTEST_CHECK(describe_model(path).prediction == "predicts noise");
    auto marked = whole_model(4, 768);
    marked.push_back({"v_pred", {0}});
    marked.push_back({"ztsnr", {0}});
    write_checkpoint(path, marked);
    DOCTEST_CHECK(describe_model(path).prediction ==
                  "predicts velocity, from pure noise on (zero terminal SNR) (by its tensor \"v_pred\")");
    write_file(folder.path() / "scheduler_config.json", R"({"prediction_type": "epsilon"})");
    DOCTEST_CHECK(describe_model(path).prediction == "predicts noise (by scheduler_config.json)");
    DOCTEST_CHECK(describe_model(starter_model_path()).prediction ==
                  "predicts velocity (by scheduler_config.json)");
}

DOCTEST_TEST_CASE("model catalogue: info tells what a model is, and refuses what is none") {
    const test::ScratchFolder folder;
    const auto path = folder.path() / "MODEL.SFT";
    auto marked = whole_model(4, 768);
    marked.push_back({"v_pred", {0}});
    write_checkpoint(path, marked);
    const auto json = scene_report(path);
    DOCTEST_CHECK(json["structure"] == "Stable Diffusion 1.x");
    DOCTEST_CHECK(json["usable"] == true);
    const auto text = report_text(json);
    DOCTEST_CHECK(text.find("predicts velocity (by its tensor \"v_pred\")") != std::string::npos);
    DOCTEST_CHECK(scene_report(starter_model_path())["structure"] == "starter");
    write_file(folder.path() / "noise.safetensors", "not a header");
    write_file(folder.path() / "old.CKPT", "pickled");
    for (const char* name : {"noise.safetensors", "old.CKPT", "nowhere.safetensors"})
        DOCTEST_CHECK_THROWS_AS(scene_report(folder.path() / name), Error);
}

}  // namespace model_catalogue_test
