// A diffusers folder with a tiny random model, so that whole-model code can be tested without reference data.
#pragma once

#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>
#include <torch/torch.h>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/neural/diffusion/model_bundle.h"
#include "engine/neural/weights/safetensors.h"
#include "tests/test_paths.h"

namespace gse::test {

inline neural::UNetConfig tiny_unet_config() {
    neural::UNetConfig config;
    config.sample_size = 8;
    config.block_out_channels = {16, 32};
    config.down_block_types = {"CrossAttnDownBlock2D", "DownBlock2D"};
    config.up_block_types = {"UpBlock2D", "CrossAttnUpBlock2D"};
    config.layers_per_block = 1;
    config.norm_num_groups = 4;
    config.heads = {2, 4};
    config.cross_attention_dim = 16;
    return config;
}

inline neural::VaeConfig tiny_vae_config() {
    neural::VaeConfig config;
    config.sample_size = 32;
    config.block_out_channels = {8, 8, 16};
    config.layers_per_block = 1;
    config.norm_num_groups = 4;
    return config;
}

/// Merges that make "a", "red", "hat", "bear" one token each; all other words stay in letters.
inline std::string tiny_merges() {
    return "#version: 0.2\nr e\nre d</w>\nh a\nha t</w>\nb e\na r</w>\nbe ar</w>\n";
}

inline neural::TextEncoderConfig tiny_text_config() {
    neural::TextEncoderConfig config;
    config.vocab_size = 512 + 7 + 2;  // bytes with and without word end, merges, start and end
    config.hidden_size = 16;
    config.intermediate_size = 32;
    config.num_hidden_layers = 2;
    config.num_attention_heads = 2;
    config.max_position_embeddings = 24;
    return config;
}

template <class Holder> neural::NamedTensors tensors_of(const Holder& module) {
    neural::NamedTensors tensors;
    for (const auto& item : module->named_parameters())
        tensors.emplace_back(item.key(), item.value().detach());
    return tensors;
}

/// Words of the tiny model: those of the tests' sentences.
inline std::vector<std::string> tiny_words() {
    return {"bear", "hat",  "dog", "square", "a",    "of",   "photo", "red",   "blue",
            "sks",  "make", "it",  "front",  "side", "back", "left",  "right", "view"};
}

struct TinyModel {
    explicit TinyModel(const std::string& prediction = "epsilon",
                       const neural::UNetConfig& unet_config = tiny_unet_config(),
                       const std::string& scheduler_class = "DDIMScheduler") {
        const auto root = scratch.path();
        torch::manual_seed(7);
        unet = tensors_of(neural::UNet(unet_config));
        vae = tensors_of(neural::AutoencoderKl(tiny_vae_config()));
        text = tensors_of(neural::ClipTextEncoder(tiny_text_config()));
        write_weights();
        write_file(root / "unet/config.json", unet_config.to_json().dump());
        write_file(root / "vae/config.json", tiny_vae_config().to_json().dump());
        write_file(root / "text_encoder/config.json", tiny_text_config().to_json().dump());
        neural::SchedulerConfig scheduler;
        scheduler.prediction_type = prediction;
        scheduler.class_name = scheduler_class;
        write_file(root / "scheduler/scheduler_config.json", scheduler.to_json().dump());
        write_file(root / "tokenizer/merges.txt", tiny_merges());
        write_file(root / "tokenizer/tokenizer_config.json", "{\"model_max_length\": 24}");
        write_file(root / "model_index.json", "{}");
        write_file(root / "gseditpro.json", R"({"name": "tiny", "attention_sizes": [8], "vocabulary": )" +
                                                nlohmann::json(tiny_words()).dump() + "}");
    }
    void write_weights() const {
        neural::write_safetensors(path() / "unet/diffusion_pytorch_model.safetensors", unet);
        neural::write_safetensors(path() / "vae/diffusion_pytorch_model.safetensors", vae);
        neural::write_safetensors(path() / "text_encoder/model.safetensors", text);
    }
    const std::filesystem::path& path() const { return scratch.path(); }

    ScratchFolder scratch;
    neural::NamedTensors unet, vae, text;
};

/// The message of the Error that `work` throws, or "".
template <class Work> std::string message_of(Work&& work) {
    try {
        work();
    } catch (const Error& error) { return error.message(); }
    return {};
}

inline bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

}  // namespace gse::test
