// Files of weights told apart by their headers, with the names that the models' authors publish.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "engine/base/error.h"
#include "engine/neural/api/files/gguf_header.h"
#include "engine/neural/api/files/weight_use.h"
#include "tests/test_paths.h"
#include "tests/unit/prompt/header_file.h"

namespace weight_kind_test {
namespace {

using namespace gse;
using namespace gse::neural;
namespace fs = std::filesystem;

using Tensors = std::vector<std::pair<std::string, std::vector<int>>>;

/// A file of these tensors.
struct File {
    test::ScratchFolder scratch;
    fs::path path;
    explicit File(const Tensors& tensors, const nlohmann::json& metadata = {}, const char* type = "F16")
        : path(scratch.path() / "model.safetensors") {
        test::write_header_file(path, tensors, metadata, type);
    }
    explicit File(const std::string& bytes) : path(scratch.path() / "model.gguf") { write_file(path, bytes); }
    WeightKind kind() const { return weight_kind(read_weight_header(path)); }
    WeightUse use() const { return weight_use(kind()); }
};

const std::string Ldm = "model.diffusion_model.";

Tensors ldm(const std::string& block, int width, int channels = 4) {
    return {{Ldm + "input_blocks.0.0.weight", {320, channels, 3, 3}},
            {Ldm + "input_blocks." + block + ".1.transformer_blocks.0.attn2.to_k.weight", {320, width}},
            {Ldm + "middle_block.0.in_layers.0.weight", {1280}}};
}

Tensors with(Tensors tensors, const Tensors& more) {
    tensors.insert(tensors.end(), more.begin(), more.end());
    return tensors;
}

const Tensors FirstText{
    {"cond_stage_model.transformer.text_model.embeddings.token_embedding.weight", {49408, 768}}};
const Tensors LargeText{{"conditioner.embedders.0.transformer.text_model.final_layer_norm.weight", {768}},
                        {"conditioner.embedders.1.model.ln_final.weight", {1280}}};

struct Expected {
    Tensors tensors;
    std::string text;
    WeightPlace place;
    std::string how = {};
};

void check(const std::vector<Expected>& cases) {
    for (const auto& [tensors, text, place, how] : cases) {
        const File file(tensors);
        DOCTEST_CHECK(kind_text(file.kind()) == text + ", fp16");
        DOCTEST_CHECK_MESSAGE((file.use().place == place), text);
        DOCTEST_CHECK_MESSAGE(file.use().how == how, text);
        DOCTEST_CHECK_MESSAGE(file.use().why.empty() == (place == WeightPlace::Here), text);
    }
}

}  // namespace

DOCTEST_TEST_CASE("weight kind: whole models and denoisers of every family") {
    check({
        {with(ldm("1.1", 768), FirstText), "Stable Diffusion 1.x checkpoint", WeightPlace::Here, "--model"},
        {with(ldm("1.1", 1024), FirstText), "Stable Diffusion 2.x checkpoint", WeightPlace::Here, "--model"},
        {with(ldm("1.1", 768, 8), FirstText), "Stable Diffusion 1.x InstructPix2Pix checkpoint",
         WeightPlace::Here, "--model"},
        {with(ldm("1.1", 768, 9), FirstText), "Stable Diffusion 1.x inpainting checkpoint",
         WeightPlace::Server},
        {ldm("1.1", 768), "Stable Diffusion 1.x diffusion model", WeightPlace::Server},
        {with(ldm("4.1", 2048), LargeText), "SDXL checkpoint", WeightPlace::Server},
        {with(ldm("4.1", 2048, 9), LargeText), "SDXL inpainting checkpoint", WeightPlace::Server},
        {{{"conv_in.weight", {320, 4, 3, 3}},
          {"down_blocks.1.attentions.0.transformer_blocks.0.attn2.to_k.weight", {640, 2048}}},
         "SDXL diffusion model",
         WeightPlace::Server},
        {{{Ldm + "joint_blocks.0.context_block.attn.qkv.weight", {4608, 1536}}},
         "Stable Diffusion 3 diffusion model",
         WeightPlace::Server},
        {{{"double_blocks.0.img_attn.norm.key_norm.scale", {128}},
          {"img_in.weight", {3072, 64}},
          {"guidance_in.in_layer.weight", {3072, 256}}},
         "FLUX.1 diffusion model",
         WeightPlace::Server},
        {{{"double_blocks.0.img_attn.norm.key_norm.scale", {128}}, {"img_in.weight", {3072, 64}}},
         "FLUX.1 schnell diffusion model",
         WeightPlace::Server},
        {{{Ldm + "double_blocks.0.img_attn.norm.key_norm.scale", {128}},
          {Ldm + "img_in.weight", {3072, 384}},
          {Ldm + "guidance_in.in_layer.weight", {3072, 256}},
          {"text_encoders.clip_l.transformer.text_model.final_layer_norm.weight", {768}}},
         "FLUX.1 Fill checkpoint",
         WeightPlace::Server},
        {{{"single_transformer_blocks.0.attn.norm_k.weight", {128}},
          {"x_embedder.weight", {3072, 64}},
          {"time_text_embed.guidance_embedder.linear_1.weight", {3072, 256}}},
         "FLUX.1 diffusion model",
         WeightPlace::Server},
        {{{"double_blocks.0.img_attn.norm.key_norm.scale", {128}},
          {"double_stream_modulation_img.lin.weight", {18432, 3072}}},
         "FLUX.2 diffusion model",
         WeightPlace::Server},
        {{{"double_blocks.0.img_attn.norm.key_norm.scale", {128}},
          {"distilled_guidance_layer.norms.0.scale", {5120}}},
         "Chroma diffusion model",
         WeightPlace::Server},
        {{{"txt_norm.weight", {3584}}, {"transformer_blocks.0.attn.add_q_proj.weight", {3072, 3072}}},
         "Qwen-Image diffusion model",
         WeightPlace::Server},
        {{{"cap_embedder.1.weight", {3840, 2560}}, {"noise_refiner.0.attention.k_norm.weight", {128}}},
         "Z-Image diffusion model",
         WeightPlace::Server},
        {{{"cap_embedder.1.weight", {2304, 2304}}, {"noise_refiner.0.attention.k_norm.weight", {96}}},
         "Lumina 2 diffusion model",
         WeightPlace::Server},
        {{{"head.modulation", {1, 2, 5120}}}, "Wan diffusion model", WeightPlace::Nowhere},
    });
}

DOCTEST_TEST_CASE("weight kind: LoRAs by the model that they change, in the names of all trainers") {
    const std::string kohya = "lora_unet_down_blocks_0_attentions_0_transformer_blocks_0_attn2_to_k";
    const std::string large = "lora_unet_input_blocks_4_1_transformer_blocks_0_attn2_to_k";
    const auto down = [](const std::string& layer, int in) {
        return std::pair<std::string, std::vector<int>>{layer + ".lora_down.weight", {16, in}};
    };
    check({
        {{down(kohya, 768)}, "LoRA of Stable Diffusion 1.x", WeightPlace::Here, "--lora"},
        {{down(kohya, 1024)}, "LoRA of Stable Diffusion 2.x", WeightPlace::Here, "--lora"},
        {{down(large, 2048)}, "LoRA of SDXL", WeightPlace::Server},
        {{{"unet.down_blocks.1.attentions.0.transformer_blocks.0.attn2.to_k.lora_A.weight", {8, 2048}}},
         "LoRA of SDXL",
         WeightPlace::Server},
        {{{"unet.down_blocks.0.attentions.0.transformer_blocks.0.attn2.processor.to_k_lora.down.weight",
           {4, 768}}},
         "LoRA of Stable Diffusion 1.x",
         WeightPlace::Here,
         "--lora"},
        {{{kohya + ".hada_w1_a", {320, 8}}}, "LoHa of Stable Diffusion 1.x", WeightPlace::Server},
        {{{kohya + ".dora_scale", {320, 1}}, down(kohya, 768)},
         "DoRA of Stable Diffusion 1.x",
         WeightPlace::Server},
        {{down("lora_unet_double_blocks_0_img_attn_proj", 3072)}, "LoRA of FLUX.1", WeightPlace::Server},
        {{{"transformer.single_transformer_blocks.0.attn.to_q.lora_A.weight", {16, 3072}}},
         "LoRA of FLUX.1",
         WeightPlace::Server},
        {{{"transformer.single_transformer_blocks.0.attn.to_qkv_mlp_proj.lora_A.weight", {16, 3072}}},
         "LoRA of FLUX.2",
         WeightPlace::Server},
        {{{"diffusion_model.double_blocks.0.img_attn.qkv.lora_A.weight", {16, 4096}}},
         "LoRA of FLUX.2",
         WeightPlace::Server},
        {{{"transformer_blocks.0.attn.add_k_proj.lora_A.weight", {16, 3072}},
          {"transformer_blocks.0.img_mlp.net.0.proj.lora_A.weight", {16, 3072}}},
         "LoRA of Qwen-Image",
         WeightPlace::Server},
        {{{"diffusion_model.layers.0.attention.to_q.lora_A.weight", {16, 3840}}},
         "LoRA of Z-Image",
         WeightPlace::Server},
        {{down("something_else", 12)}, "LoRA", WeightPlace::Nowhere},
    });
    const File stated({down("lora_unet_double_blocks_0_img_attn_proj", 3072)},
                      {{"ss_base_model_version", "flux2_klein_4b"}});
    DOCTEST_CHECK(stated.kind().family == "FLUX.2");
}

DOCTEST_TEST_CASE("weight kind: parts of models, and what edits do not use") {
    check({
        {{{"first_stage_model.decoder.conv_in.weight", {512, 4, 3, 3}}},
         "VAE of Stable Diffusion",
         WeightPlace::Here,
         "beside a checkpoint"},
        {{{"decoder.conv_in.weight", {512, 16, 3, 3}}}, "VAE of FLUX.1, SD 3, Z-Image", WeightPlace::Server},
        {{{"decoder.conv_in.weight", {512, 32, 3, 3}}}, "VAE of FLUX.2", WeightPlace::Server},
        {{{"decoder.middle.0.residual.0.gamma", {384, 1, 1, 1}}},
         "VAE of Wan, Qwen-Image",
         WeightPlace::Server},
        {{{"decoder.layers.0.weight", {64, 4, 3, 3}}},
         "tiny VAE of Stable Diffusion",
         WeightPlace::Here,
         "--taesd"},
        {{{"text_model.encoder.layers.0.mlp.fc1.weight", {3072, 768}}},
         "text encoder CLIP-L",
         WeightPlace::Server},
        {{{"encoder.block.0.layer.0.SelfAttention.k.weight", {4096, 4096}}, {"shared.weight", {32128, 4096}}},
         "text encoder T5-XXL",
         WeightPlace::Server},
        {{{"encoder.block.0.layer.0.SelfAttention.k.weight", {4096, 4096}},
          {"shared.weight", {256384, 4096}}},
         "text encoder UMT5-XXL",
         WeightPlace::Server},
        {{{"model.layers.0.self_attn.k_proj.weight", {512, 3584}},
          {"model.layers.0.self_attn.k_proj.bias", {512}}},
         "text encoder Qwen2.5-VL 7B",
         WeightPlace::Server},
        {{{"model.layers.0.self_attn.k_proj.weight", {1024, 2560}},
          {"model.layers.0.self_attn.q_norm.weight", {128}}},
         "text encoder Qwen3 4B",
         WeightPlace::Server},
        {{{"vision_model.encoder.layers.0.mlp.fc1.weight", {5120, 1280}}},
         "image encoder CLIP vision",
         WeightPlace::Server},
        {{{"control_model.input_hint_block.0.weight", {16, 3, 3, 3}}}, "ControlNet", WeightPlace::Nowhere},
        {with({{"controlnet_cond_embedding.conv_in.weight", {16, 3, 3, 3}}},
              {{"conv_in.weight", {320, 4, 3, 3}},
               {"down_blocks.0.attentions.0.transformer_blocks.0.attn2.to_k.weight", {320, 768}}}),
         "ControlNet", WeightPlace::Nowhere},
        {{{"ip_adapter.1.to_k_ip.weight", {320, 768}}}, "IP-Adapter", WeightPlace::Nowhere},
        {{{"model.1.sub.0.RDB1.conv1.0.weight", {32, 64, 3, 3}}}, "upscaler ESRGAN", WeightPlace::Nowhere},
        {{{"emb_params", {8, 768}}}, "embedding", WeightPlace::Nowhere},
        {{{"mask_decoder.iou_token.weight", {1, 256}}}, "segmenter SAM", WeightPlace::Here, "--segmenter"},
        {{{"what", {1}}}, "unknown weights", WeightPlace::Nowhere},
    });
}

DOCTEST_TEST_CASE("weight kind: numbers that are not read here are for a server, whatever the model") {
    const auto tensors = with(ldm("1.1", 768), FirstText);
    for (const char* type : {"F8_E4M3", "F8_E5M2"}) {
        const File file(tensors, {}, type);
        DOCTEST_CHECK(kind_text(file.kind()) == "Stable Diffusion 1.x checkpoint, fp8");
        DOCTEST_CHECK((file.use().place == WeightPlace::Server));
        DOCTEST_CHECK_THROWS_AS(refuse_foreign_model(file.path), Error);
    }
    const File four(with(tensors, {{"model.x.weight.quant_state.bitsandbytes__nf4", {80}}}), {}, "U8");
    DOCTEST_CHECK(kind_text(four.kind()) == "Stable Diffusion 1.x checkpoint, 4 bits");
    DOCTEST_CHECK((four.use().place == WeightPlace::Server));
    DOCTEST_CHECK(File(tensors, {}, "BF16").use().how == "--model");
    DOCTEST_CHECK_NOTHROW(refuse_foreign_model(File(tensors, {}, "F32").path));
}

DOCTEST_TEST_CASE("weight kind: GGUF by its tensors, and by the architecture that it states") {
    using test::GgufBytes;
    constexpr int Q4K = 12, F32 = 0;
    const File flux(GgufBytes()
                        .magic(2, 1)
                        .statement("general.architecture", "flux")
                        .tensor("double_blocks.0.img_attn.norm.key_norm.scale", {128}, F32)
                        .tensor("img_in.weight", {3072, 384}, Q4K)
                        .bytes());
    DOCTEST_CHECK(kind_text(flux.kind()) == "FLUX.1 Fill diffusion model, GGUF Q4_K");
    DOCTEST_CHECK((flux.use().place == WeightPlace::Server));
    DOCTEST_CHECK_THROWS_AS(refuse_foreign_model(flux.path), Error);
    const File text(GgufBytes()
                        .magic(1, 2, 2)
                        .statement("general.architecture", "t5encoder")
                        .text("tokenizer.ggml.tokens")
                        .number(9, 4)
                        .number(8, 4)
                        .number(2, 8)
                        .text("a")
                        .text("b")
                        .tensor("token_embd.weight", {64, 32}, F32)
                        .bytes());
    DOCTEST_CHECK(kind_text(text.kind()) == "text encoder T5, GGUF F32");
    const File old(GgufBytes().magic(0, 0, 1).bytes());
    DOCTEST_CHECK_THROWS_AS(read_weight_header(old.path), Error);
}

DOCTEST_TEST_CASE("weight header: a damaged file is an error, wherever it is cut or changed") {
    const auto bytes = test::GgufBytes()
                           .magic(1, 2)
                           .statement("general.architecture", "flux")
                           .text("list")
                           .number(9, 4)
                           .number(4, 4)
                           .number(3, 8)
                           .number(0, 8)
                           .number(0, 4)
                           .tensor("a.weight", {4, 4}, 0)
                           .bytes();
    const test::ScratchFolder folder;
    const auto path = folder.path() / "x.gguf";
    for (std::size_t size = 0; size < bytes.size(); ++size) {
        write_file(path, bytes.substr(0, size));
        DOCTEST_CHECK_THROWS_AS(read_weight_header(path), Error);
    }
    write_file(path, bytes);
    DOCTEST_CHECK(read_weight_header(path).missing_bytes > 0);
    write_file(path, bytes + std::string(200, '\0'));
    DOCTEST_CHECK(read_weight_header(path).missing_bytes == 0);
    for (std::size_t at = 4; at < bytes.size(); ++at) {
        auto changed = bytes;
        changed[at] = static_cast<char>(0xff);
        write_file(path, changed);
        try {
            weight_use(weight_kind(read_weight_header(path)));
        } catch (const Error& error) { DOCTEST_CHECK_FALSE(error.message().empty()); }
    }
}

DOCTEST_TEST_CASE("weight header: hostile safetensors headers are errors, and short files are noticed") {
    const test::ScratchFolder folder;
    const auto path = folder.path() / "x.safetensors";
    const auto write = [&](const std::string& json, std::uint64_t length) {
        write_file(path, test::GgufBytes().number(length, 8).bytes() + json);
    };
    for (const std::string json :
         {R"({"a": 1})", R"({"a": {"dtype": 3, "shape": [], "data_offsets": [0, 0]}})", "{", "[]", "{]",
          R"({"a": {"dtype": "F16", "shape": [-1], "data_offsets": [0, 0]}})",
          R"({"a": {"dtype": "F16", "shape": [1], "data_offsets": [0]}})"}) {
        write(json, json.size());
        DOCTEST_CHECK_THROWS_AS(read_weight_header(path), Error);
    }
    write("{}", std::uint64_t{1} << 39);  // longer than the file
    DOCTEST_CHECK_THROWS_AS(read_weight_header(path), Error);
    write("{}" + std::string(std::size_t{17} << 20, ' '), (std::uint64_t{17} << 20) + 2);
    DOCTEST_CHECK_THROWS_AS(read_weight_header(path), Error);
    const std::string deep = "{\"a\":" + std::string(100'000, '[');
    write(deep, deep.size());
    DOCTEST_CHECK_THROWS_AS(read_weight_header(path), Error);
    const std::string promised = R"({"a": {"dtype": "F16", "shape": [8], "data_offsets": [0, 16]}})";
    write(promised, promised.size());
    DOCTEST_CHECK(read_weight_header(path).missing_bytes == 16);
    write_file(path, "");
    DOCTEST_CHECK_THROWS_AS(read_weight_header(path), Error);
    write_file(path, "<!DOCTYPE html>");
    DOCTEST_CHECK_THROWS_AS(read_weight_header(path), Error);
}

DOCTEST_TEST_CASE("weight header: pickles are told by their first bytes and not opened") {
    const test::ScratchFolder folder;
    const auto path = folder.path() / "x.ckpt";
    for (const std::string& bytes : {std::string("PK\x03\x04zip"), std::string("\x80\x02}q")}) {
        write_file(path, bytes);
        DOCTEST_CHECK((weight_format(path) == WeightFormat::Pickle));
        DOCTEST_CHECK_THROWS_AS(read_weight_header(path), Error);
    }
    DOCTEST_CHECK_THROWS_AS(weight_format(folder.path() / "nowhere"), Error);
}

}  // namespace weight_kind_test
