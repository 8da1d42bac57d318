// LoRA files as programs write them: strengths that stand beside the tensors, and tensors that are no part of
// a LoRA.
#include "engine/neural/guidance/dreambooth.h"
#include "engine/neural/model.h"
#include "tests/unit/neural/tiny_model.h"

namespace lora_files_test {
namespace {

using namespace gse;
using namespace gse::neural;
using namespace gse::test;

const std::string Value = "down_blocks.0.attentions.0.transformer_blocks.0.attn2.to_v",
                  Query = "text_model.encoder.layers.0.self_attn.q_proj";

std::string flat(std::string name) {
    std::replace(name.begin(), name.end(), '.', '_');
    return name;
}

/// Matrices of rank 2 for one layer of the tiny UNet and one of its text encoder.
struct TinyLora {
    torch::Tensor value_down, value_up, query_down, query_up;
    TinyLora() {
        torch::manual_seed(5);
        value_down = torch::randn({2, 16});
        value_up = torch::randn({16, 2});
        query_down = torch::randn({2, 16});
        query_up = torch::randn({16, 2});
    }
    NamedTensors kohya() const {
        const auto unet = "lora_unet_" + flat(Value), text = "lora_te_" + flat(Query);
        return {{unet + ".lora_down.weight", value_down},
                {unet + ".lora_up.weight", value_up},
                {text + ".lora_down.weight", query_down},
                {text + ".lora_up.weight", query_up}};
    }
    NamedTensors kohya(float alpha) const {
        auto tensors = kohya();
        for (const auto& stem : {"lora_unet_" + flat(Value), "lora_te_" + flat(Query)})
            tensors.emplace_back(stem + ".alpha", torch::tensor(alpha));
        return tensors;
    }
    NamedTensors peft(const std::string& unet, const std::string& text) const {
        return {{unet + Value + ".lora_A.weight", value_down},
                {unet + Value + ".lora_B.weight", value_up},
                {text + Query + ".lora_A.weight", query_down},
                {text + Query + ".lora_B.weight", query_up}};
    }
};

/// All weights of the tiny model with a LoRA.
std::vector<torch::Tensor> merged(const TinyModel& model, const std::filesystem::path& lora) {
    const auto bundle = with_lora(load_bundle(model.path()), read_lora(lora), 1);
    auto weights = bundle.unet->parameters();
    const auto text = bundle.text_encoder->parameters();
    weights.insert(weights.end(), text.begin(), text.end());
    return weights;
}

bool same(const std::vector<torch::Tensor>& a, const std::vector<torch::Tensor>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](const auto& x, const auto& y) { return torch::equal(x, y); });
}

std::vector<float> sample_of(const TextToImage& model) {
    SampleRequest request;
    request.prompt = "a red bear";
    request.steps = 2;
    return model.sample(request).data;
}

std::filesystem::path odd(const char* name) { return shared_folder() / "data/odd" / name; }

}  // namespace

DOCTEST_TEST_CASE("lora: one strength, wherever a file states it") {
    const TinyModel model;
    const TinyLora lora;
    const ScratchFolder folder;
    const auto file = [&](const char* name) { return folder.path() / name; };
    write_safetensors(file("kohya8.safetensors"), lora.kohya(8));
    write_safetensors(file("kohya2.safetensors"), lora.kohya(2));
    const auto expected = merged(model, file("kohya8.safetensors")),
               weak = merged(model, file("kohya2.safetensors"));
    DOCTEST_CHECK_FALSE(same(expected, weak));

    write_safetensors(file("metadata.safetensors"), lora.kohya(), {{"ss_network_alpha", "8.0"}});
    write_safetensors(file("plain.safetensors"), lora.peft("unet.", "text_encoder."), {{"lora_alpha", "8"}});
    write_safetensors(
        file("diffusers.safetensors"), lora.peft("unet.", "text_encoder."),
        {{"lora_adapter_metadata", R"({"unet.lora_alpha": 8, "unet.r": 2, "text_encoder.lora_alpha": 8})"}});
    write_safetensors(file("peft/adapter_model.safetensors"),
                      lora.peft("base_model.model.", "base_model.model."));
    write_file(file("peft/adapter_config.json"), R"({"r": 2, "lora_alpha": 8})");
    write_safetensors(file("pattern/adapter_model.safetensors"),
                      lora.peft("base_model.model.", "base_model.model."));
    write_file(file("pattern/adapter_config.json"),
               R"({"r": 2, "lora_alpha": 1, "alpha_pattern": {"attn2.to_v": 8, "q_proj": 8}})");
    for (const char* name : {"metadata.safetensors", "plain.safetensors", "diffusers.safetensors",
                             "peft/adapter_model.safetensors", "pattern/adapter_model.safetensors"})
        DOCTEST_CHECK_MESSAGE(same(merged(model, file(name)), expected), name);

    // An alpha among the tensors counts before all of these.
    auto both = lora.peft("unet.", "text_encoder.");
    both.emplace_back("unet." + Value + ".alpha", torch::tensor(2.0f));
    both.emplace_back("text_encoder." + Query + ".alpha", torch::tensor(2.0f));
    write_safetensors(file("both.safetensors"), both, {{"lora_alpha", "8"}});
    DOCTEST_CHECK(same(merged(model, file("both.safetensors")), weak));
}

DOCTEST_TEST_CASE("lora: the same edit from PEFT's folder, diffusers' file and kohya's") {
    const auto folder = odd("01_lora_alpha_in_config");
    if (!available(folder)) return;
    const auto model = source_folder() / "assets/models/starter";
    const auto weights = [&](const char* name) {
        const auto lora = read_lora(folder / name);
        return with_lora(load_bundle(model), lora, 1).unet->parameters();
    };
    const auto expected = weights("kohya_alpha8.safetensors");
    DOCTEST_CHECK(same(weights("peft_alpha8/adapter_model.safetensors"), expected));
    DOCTEST_CHECK(same(weights("diffusers_meta_alpha8/pytorch_lora_weights.safetensors"), expected));
    DOCTEST_CHECK_FALSE(same(weights("kohya_alpha2.safetensors"), expected));
}

DOCTEST_TEST_CASE("lora: what is no part of it is left out, and said") {
    const TinyModel model;
    const TinyLora lora;
    const ScratchFolder folder;
    const auto path = folder.path() / "style.safetensors";
    write_safetensors(path, lora.kohya(8));
    const auto plain = load_model(model.path(), ModelOptions{"cpu", {{path, 1}}});
    const auto expected = sample_of(*plain);
    DOCTEST_CHECK(plain->notes().empty());
    const std::string unet = "lora_unet_" + flat(Value), norm = "lora_unet_down_blocks_0_attentions_0_norm";
    struct Extra {
        std::string name, said;
    };
    for (const auto& [name, said] :
         {Extra{"bundle_emb.my style.string_to_param.*", "embeddings"},
          Extra{norm + ".w_norm", "norm layers"}, Extra{norm + ".b_norm", "norm layers"},
          Extra{unet + ".diff_b", "biases"}, Extra{norm + ".diff", "whole weights"},
          Extra{"unet." + Value + ".lora_B.bias", "biases"},
          Extra{"lora_unet_mid_block_resnets_0_conv1.lokr_w1", "LoKr"},
          Extra{"lora_unet_mid_block_resnets_0_conv1.hada_w1_a", "LoHa"}, Extra{"something", "not known"}}) {
        auto tensors = lora.kohya(8);
        tensors.emplace_back(name, torch::ones({16}));
        write_safetensors(path, tensors);
        const auto loaded = load_model(model.path(), ModelOptions{"cpu", {{path, 1}}});
        DOCTEST_REQUIRE_MESSAGE(loaded->notes().size() == 1, name);
        DOCTEST_CHECK_MESSAGE(contains(loaded->notes().front(), said), loaded->notes().front());
        DOCTEST_CHECK_MESSAGE(contains(loaded->notes().front(), name), loaded->notes().front());
        DOCTEST_CHECK_MESSAGE(sample_of(*loaded) == expected, name);
    }
}

DOCTEST_TEST_CASE("lora: layers that the model does not have are left out; refused where none is left") {
    const TinyModel model;
    const TinyLora lora;
    const ScratchFolder folder;
    const auto path = folder.path() / "style.safetensors";
    auto tensors = lora.kohya(8);
    write_safetensors(path, tensors);
    const auto expected = sample_of(*load_model(model.path(), ModelOptions{"cpu", {{path, 1}}}));
    const std::string unknown = "lora_unet_down_blocks_9_attentions_0_transformer_blocks_0_attn2_to_v";
    tensors.emplace_back(unknown + ".lora_down.weight", lora.value_down);
    tensors.emplace_back(unknown + ".lora_up.weight", lora.value_up);
    tensors.emplace_back("lora_te_text_model_encoder_layers_11_mlp_fc1.lora_down.weight", lora.value_down);
    tensors.emplace_back("lora_te_text_model_encoder_layers_11_mlp_fc1.lora_up.weight", lora.value_up);
    write_safetensors(path, tensors);
    const auto loaded = load_model(model.path(), ModelOptions{"cpu", {{path, 1}}});
    DOCTEST_REQUIRE(loaded->notes().size() == 1);
    DOCTEST_CHECK(contains(loaded->notes().front(), "2 layers that the model does not have (\"" + unknown));
    DOCTEST_CHECK(sample_of(*loaded) == expected);
    write_safetensors(path, {tensors.begin() + 6, tensors.end()});
    DOCTEST_CHECK(contains(message_of([&] {
                               load_model(model.path(), ModelOptions{"cpu", {{path, 1}}});
                           }),
                           "2 of 2"));
}

DOCTEST_TEST_CASE("lora: files with bundled embeddings and with norm layers are those without") {
    const auto folder = odd("18_lora_bundle_emb");
    if (!available(folder)) return;
    const auto base = read_lora(odd("01_lora_alpha_in_config/kohya_alpha8.safetensors"));
    for (const char* name : {"with_bundle_emb.safetensors", "lycoris_train_norm.safetensors"}) {
        const auto lora = read_lora(folder / name);
        DOCTEST_REQUIRE_MESSAGE(lora.unet.size() == base.unet.size(), name);
        DOCTEST_CHECK(lora.notes().size() == 1);
    }
}

}  // namespace lora_files_test
