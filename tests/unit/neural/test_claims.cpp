// Claims of files of weights and settings: more memory than there is, numbers that are none.
#include <fstream>
#include <nlohmann/json.hpp>

#include "engine/base/memory.h"
#include "engine/neural/diffusion/taesd.h"
#include "engine/neural/sam/sam_model.h"
#include "engine/neural/weights/key_map.h"
#include "engine/neural/weights/lora.h"
#include "tests/unit/neural/tiny_model.h"

using namespace gse;
using namespace gse::neural;
using namespace gse::test;

namespace {

const WeightOptions Described{torch::kMeta, torch::kFloat32, false};

/// A safetensors file of these tensors, all of whose numbers are a hole in the file: it takes no space,
/// whatever its size.
void write_hollow(const std::filesystem::path& path, const KeyShapes& shapes) {
    nlohmann::json header;
    std::uint64_t end = 0;
    for (const auto& [name, shape] : shapes) {
        std::uint64_t bytes = sizeof(float);
        for (const auto side : shape) bytes *= static_cast<std::uint64_t>(side);
        header[name] = {{"dtype", "F32"}, {"shape", shape}, {"data_offsets", {end, end + bytes}}};
        end += bytes;
    }
    const std::string text = header.dump();
    const std::uint64_t length = text.size();
    std::ofstream stream(path, std::ios::binary);
    stream.write(reinterpret_cast<const char*>(&length), sizeof length);
    stream << text;
    stream.close();
    std::filesystem::resize_file(path, sizeof length + length + end);
}

KeyShapes shapes_of(const torch::nn::Module& module) {
    KeyShapes shapes;
    for (const auto& item : module.named_parameters()) shapes[item.key()] = item.value().sizes().vec();
    return shapes;
}

template <class Load> void needs_memory(Load load, const std::string& begin) {
    try {
        load();
        DOCTEST_FAIL("it was read");
    } catch (const OutOfMemory& error) {
        DOCTEST_CHECK_MESSAGE(error.message().starts_with(begin + " needs "), error.message());
    }
}

}  // namespace

DOCTEST_TEST_CASE("weights of more memory than there is are one sentence, before any of it is taken") {
    const ScratchFolder scratch;
    const auto file = scratch.path() / "model.safetensors";

    TinyAutoencoderConfig tiny;
    tiny.channels = 1 << 16;
    tiny.encoder_blocks = tiny.decoder_blocks = {1, 1};
    write_file(scratch.path() / "config.json", tiny.to_json().dump());
    write_hollow(scratch.path() / "diffusion_pytorch_model.safetensors",
                 shapes_of(*TinyAutoencoder(tiny, Described)));
    needs_memory([&] { load_tiny_autoencoder(scratch.path()); }, "the tiny autoencoder");

    SamVitShape vit;
    vit.inner = 1 << 28;
    vit.windows = {vit.side};
    write_hollow(file, shapes_of(*SamModel(SamShape{vit, {}, "SAM"}, Described)));
    needs_memory([&] { load_sam(file, torch::kCPU); }, "the segmenter");

    constexpr std::int64_t terabyte = std::int64_t{1} << 38;  // numbers
    write_hollow(file, {{"lora_unet_mid_block_x.lora_down.weight", {1, terabyte}},
                        {"lora_unet_mid_block_x.lora_up.weight", {terabyte, 1}}});
    needs_memory([&] { read_lora(file); }, "the LoRA \"model.safetensors\"");
}

DOCTEST_TEST_CASE("numbers in names of tensors and tokens may have any length, or none") {
    const auto plan = single_file_text_plan(TextEncoderConfig{}, SingleFileText::OpenClip);
    const std::string blocks = "cond_stage_model.model.transformer.resblocks.";
    DOCTEST_CHECK_FALSE(plan.ignore(blocks + "11.ln_1.weight"));
    DOCTEST_CHECK(plan.ignore(blocks + "12.ln_1.weight"));
    DOCTEST_CHECK(plan.ignore(blocks + "99999999999999999999999999.ln_1.weight"));
    for (const char* odd : {"", "x", "-1.ln_1.weight", "-99999999999999999999999999"})
        DOCTEST_CHECK_FALSE(plan.ignore(blocks + odd));

    const TinyModel model;
    write_file(
        model.path() / "tokenizer/tokenizer_config.json",
        R"({"added_tokens_decoder": {"": {"content": "<none>"}, "99999999999": {"content": "<far>"}}})");
    DOCTEST_CHECK(Tokenizer(model.path() / "tokenizer").vocabulary_size() ==
                  Tokenizer(TinyModel().path() / "tokenizer").vocabulary_size());
}
