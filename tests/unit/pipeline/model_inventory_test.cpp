// The list of models on a machine: usual places, rows, and the table.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>

#include "engine/base/error.h"
#include "engine/pipeline/inventory/inventory_report.h"
#include "engine/pipeline/models/model_places.h"
#include "tests/test_paths.h"
#include "tests/unit/prompt/header_file.h"

namespace model_inventory_test {
namespace {

using namespace gse;
using namespace gse::pipeline;
using neural::WeightPlace;
namespace fs = std::filesystem;

/// An environment variable for the time of a test.
class Variable {
public:
    Variable(const char* name, const std::string& value) : name_(name) {
        if (const char* before = std::getenv(name)) before_ = before;
        setenv(name, value.c_str(), 1);
    }
    ~Variable() { setenv(name_, before_.c_str(), 1); }
    Variable(const Variable&) = delete;
    Variable& operator=(const Variable&) = delete;

private:
    const char* name_;
    std::string before_ = {};
};

void write_flux(const fs::path& path) {
    fs::create_directories(path.parent_path());
    test::write_header_file(path, {{"double_blocks.0.img_attn.norm.key_norm.scale", {128}},
                                   {"img_in.weight", {3072, 64}},
                                   {"guidance_in.in_layer.weight", {3072, 256}}});
}

const ModelFile& row_of(const ModelInventory& inventory, const std::string& name) {
    const auto row = std::find_if(inventory.files.begin(), inventory.files.end(),
                                  [&](const ModelFile& file) { return file.path.filename() == name; });
    DOCTEST_REQUIRE_MESSAGE(row != inventory.files.end(), name);
    return *row;
}

}  // namespace

DOCTEST_TEST_CASE("model inventory: models of all programs below the home folder are found, each once") {
    const test::ScratchFolder home;
    const Variable is_home("HOME", home.path().string()), data("XDG_DATA_HOME", ""), own("GSE_MODELS", ""),
        comfy("COMFYUI_PATH", (home.path() / "elsewhere").string());
    write_flux(home.path() / "ComfyUI/models/diffusion_models/flux1-kontext-dev.safetensors");
    write_flux(home.path() / "elsewhere/models/unet/plain.safetensors");
    write_flux(home.path() / "stable-diffusion-webui-forge/models/Stable-diffusion/forge.safetensors");
    write_flux(home.path() / ".local/share/krita/ai_diffusion/server/models/checkpoints/krita.safetensors");
    write_flux(home.path() / "big disk/unet/extra.safetensors");
    write_file(home.path() / "ComfyUI/extra_model_paths.yaml",
               "# mine\na111:\n    base_path: ~/big disk  # slow\n    is_default: true\n"
               "    diffusion_models: |\n        unet\n        nowhere/at/all\n"
               "    loras: ../stable-diffusion-webui-forge/models\n");
    fs::create_directory_symlink(home.path() / "ComfyUI/models", home.path() / "ComfyUI/models/circle");
    const auto inventory = list_models({}, {});
    DOCTEST_CHECK(inventory.files.size() == 5);
    DOCTEST_CHECK_FALSE(inventory.cut_short);
    DOCTEST_CHECK(row_of(inventory, "flux1-kontext-dev.safetensors").server_family == "kontext");
    DOCTEST_CHECK(row_of(inventory, "plain.safetensors").server_family == "flux1");
    for (const auto& file : inventory.files) DOCTEST_CHECK((file.use.place == WeightPlace::Server));
    DOCTEST_CHECK(std::is_sorted(inventory.files.begin(), inventory.files.end(),
                                 [](const auto& one, const auto& other) {
                                     return one.path.parent_path() < other.path.parent_path();
                                 }));
}

DOCTEST_TEST_CASE("model inventory: where nothing is found, it says where it looked") {
    const test::ScratchFolder home;
    const Variable is_home("HOME", home.path().string()), data("XDG_DATA_HOME", ""), own("GSE_MODELS", ""),
        comfy("COMFYUI_PATH", "");
    const auto inventory = list_models({}, {});
    DOCTEST_CHECK(inventory.files.empty());
    const auto text = inventory_text(inventory);
    for (const char* place : {"ComfyUI/models (ComfyUI): not there", "stable-diffusion-webui/models (A1111)",
                              "krita/ai_diffusion/server/models (krita-ai-diffusion)"})
        DOCTEST_CHECK_MESSAGE(text.find(place) != std::string::npos, place);
    DOCTEST_CHECK_THROWS_AS(list_models({home.path() / "nowhere"}, {}), Error);
}

DOCTEST_TEST_CASE("model inventory: a broken file is a row with its reason, and hides no other") {
    const test::ScratchFolder folder;
    write_flux(folder.path() / "a/good.safetensors");
    write_file(folder.path() / "a/page.safetensors", "<!DOCTYPE html>");
    write_file(folder.path() / "a/old.ckpt", "PK\x03\x04");
    write_file(folder.path() / "a/cut.gguf", "GGUF");
    write_file(folder.path() / "a/bad\x1b[2Jname.safetensors", "");
    write_file(folder.path() / "a/readme.txt", "nothing");
    write_file(folder.path() / ".hidden/secret.safetensors", "");
    std::string promised = R"({"emb_params": {"dtype": "F16", "shape": [8], "data_offsets": [0, 16]}})";
    write_file(folder.path() / "a/short.safetensors",
               test::GgufBytes().number(promised.size(), 8).bytes() + promised);
    const auto inventory = list_models({folder.path()}, {});
    DOCTEST_CHECK(inventory.files.size() == 6);
    DOCTEST_CHECK_FALSE(row_of(inventory, "good.safetensors").broken);
    for (const char* name : {"page.safetensors", "cut.gguf", "short.safetensors"}) {
        DOCTEST_CHECK(row_of(inventory, name).broken);
        DOCTEST_CHECK_FALSE(row_of(inventory, name).use.why.empty());
    }
    DOCTEST_CHECK(row_of(inventory, "old.ckpt").kind == "pickled weights");
    const auto text = inventory_text(inventory);
    DOCTEST_CHECK(text.find('\x1b') == std::string::npos);
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);)
        if (line.starts_with("  ")) DOCTEST_CHECK_MESSAGE(line.size() <= 100, line);
    const auto json = inventory_json(inventory);
    DOCTEST_CHECK(json["models"].size() == 6);
    DOCTEST_CHECK(json["complete"] == true);
}

DOCTEST_TEST_CASE("model inventory: a checkpoint that is loaded here says so, and what it lacks beside it") {
    const test::ScratchFolder folder;
    const auto path = folder.path() / "v1.safetensors";
    test::write_header_file(
        path, {{"model.diffusion_model.input_blocks.0.0.weight", {320, 4, 3, 3}},
               {"model.diffusion_model.input_blocks.1.1.transformer_blocks.0.attn2.to_k.weight", {320, 768}},
               {"cond_stage_model.transformer.text_model.embeddings.token_embedding.weight", {49408, 768}}});
    auto row = describe_model_file(path);
    DOCTEST_CHECK((row.use.place == WeightPlace::Nowhere));
    DOCTEST_CHECK(row.use.why.find("no VAE") != std::string::npos);
    test::write_header_file(folder.path() / "v1.vae.safetensors",
                            {{"decoder.conv_in.weight", {512, 4, 3, 3}}});
    row = describe_model_file(path);
    DOCTEST_CHECK(row.use.how == "--model");
    DOCTEST_CHECK(row.use.why.empty());
}

DOCTEST_TEST_CASE(
    "model places: extra_model_paths.yaml is read as ComfyUI reads it, and rubbish names nothing") {
    const Variable home("HOME", "/home/me");
    const auto folders = [](const std::string& text) {
        std::vector<std::string> names;
        for (const auto& folder : extra_model_folders(text, "/comfy")) names.push_back(folder.string());
        return names;
    };
    DOCTEST_CHECK(folders("a:\n  base_path: /data\n  loras: models/Lora\n") ==
                  std::vector<std::string>{"/data/models/Lora"});
    DOCTEST_CHECK(folders("a:\n  loras: \"~/x y\"\nb:\n  vae: rel\n") ==
                  std::vector<std::string>{"/home/me/x y", "/comfy/rel"});
    DOCTEST_CHECK(folders("a:\n  loras: |\n    one\n    two\n  vae: three\n  custom_nodes: no\n") ==
                  std::vector<std::string>{"/comfy/one", "/comfy/two", "/comfy/three"});
    for (const std::string text : {"", "\xff\xfe", "- a\n- b\n", "  loras: x\n", "{", "a:\n\tloras\n", "#"})
        DOCTEST_CHECK(folders(text).empty());
}

}  // namespace model_inventory_test
