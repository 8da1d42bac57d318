// Weights files, model folders and the tokenizer: round trips and what is refused with which words.
#include "engine/neural/model.h"
#include "engine/neural/weights/key_map.h"
#include "tests/unit/neural/quantized.h"
#include "tests/unit/neural/tiny_model.h"

using namespace gse;
using namespace gse::neural;
using namespace gse::test;

DOCTEST_TEST_CASE("safetensors: what is written is read back bit for bit") {
    const ScratchFolder scratch;
    const auto path = scratch.path() / "deep/folder/x.safetensors";
    NamedTensors tensors = {{"b.bytes", torch::arange(3, torch::kUInt8)},  // makes the next one unaligned
                            {"a.float", torch::randn({2, 3})},
                            {"half", torch::randn({5}).to(torch::kHalf)},
                            {"brain", torch::randn({1, 4}).to(torch::kBFloat16)},
                            {"double", torch::randn({2}, torch::kFloat64)},
                            {"ids", torch::arange(4, torch::kInt64)},
                            {"flags", torch::tensor({true, false})},
                            {"scalar", torch::tensor(2.5f)},
                            {"empty", torch::zeros({0, 7})},
                            {"strided", torch::randn({4, 3}).t()}};
    write_safetensors(path, tensors, {{"format", "pt"}});
    const SafetensorsFile file(path);
    DOCTEST_CHECK(file.metadata().at("format") == "pt");
    DOCTEST_CHECK(file.entries().size() == tensors.size());
    for (const auto& [name, tensor] : tensors) {
        DOCTEST_CHECK((file.tensor(name).scalar_type() == tensor.scalar_type()));
        DOCTEST_CHECK_MESSAGE(torch::equal(file.tensor(name), tensor), name);
    }
    auto target = torch::zeros({3, 2}, torch::kFloat64);
    file.copy_to("a.float", target);
    DOCTEST_CHECK(torch::equal(target.view({2, 3}), tensors[1].second.to(torch::kFloat64)));
    DOCTEST_CHECK(contains(message_of([&] { file.tensor("nothing"); }), "\"nothing\""));
}

DOCTEST_TEST_CASE(
    "safetensors: weights in eight bits are off by half a step at most, row by row, and vectors by none of "
    "these") {
    const ScratchFolder scratch;
    const auto path = scratch.path() / "weights.safetensors";
    torch::manual_seed(11);
    auto matrix = torch::randn({5, 7}),
         kernel = torch::randn({4, 3, 3, 3}) * torch::tensor({1e-4, 1.0, 30.0, 0.0}).view({4, 1, 1, 1});
    const auto vector = torch::randn({9}).to(torch::kHalf).to(torch::kFloat);
    write_safetensors(path, quantized({{"matrix", matrix}, {"kernel", kernel}, {"vector", vector}}));
    const SafetensorsFile file(path);
    DOCTEST_CHECK((file.entries().at("kernel").dtype == torch::kInt8));
    for (const auto& [name, values] : NamedTensors{{"matrix", matrix}, {"kernel", kernel}}) {
        auto read = torch::full_like(values, 9);
        file.copy_to(name, read);
        const auto rows = values.flatten(1), error = (read.flatten(1) - rows).abs();
        const auto step = rows.abs().amax(1, true) / 127;
        constexpr double Half = 0.5 + 1e-4;  // products are rounded once more
        DOCTEST_CHECK_MESSAGE((error <= Half * step).all().item<bool>(), name);
        DOCTEST_CHECK(error.max().item<double>() > 0);
    }
    auto same = torch::zeros_like(vector);
    file.copy_to("vector", same);
    DOCTEST_CHECK(torch::equal(same, vector));
    write_safetensors(path, {{"matrix", torch::ones({5, 7}, torch::kInt8)},
                             {std::string("matrix") + QuantizationScale, torch::ones({4})}});
    DOCTEST_CHECK_THROWS_WITH_AS(SafetensorsFile(path).copy_to("matrix", matrix),
                                 doctest::Contains("one per row"), Error);
}

DOCTEST_TEST_CASE("safetensors: a place that cannot be written leaves nothing behind") {
    const ScratchFolder scratch;
    write_file(scratch.path() / "file", "x");
    DOCTEST_CHECK(
        !message_of([&] {
             write_safetensors(scratch.path() / "file/inside.safetensors", {{"a", torch::zeros({1})}});
         }).empty());
    DOCTEST_CHECK(read_file(scratch.path() / "file") == "x");
}

DOCTEST_TEST_CASE("model: a complete folder loads, and its description needs no weights") {
    const TinyModel model;
    const auto bundle = load_bundle(model.path());
    DOCTEST_CHECK(bundle.image_size() == 32);  // sample_size 8 times factor 4
    DOCTEST_CHECK(bundle.facts.name == "tiny");
    DOCTEST_CHECK(bundle.token_count() == 24);
    for (const auto& [name, tensor] : model.unet)
        DOCTEST_CHECK(torch::equal(*bundle.unet->named_parameters().find(name), tensor));
    const auto description = describe_model(model.path());
    DOCTEST_CHECK(description.vocabulary == tiny_words());
    std::int64_t count = 0;
    for (const auto* part : {&model.unet, &model.vae, &model.text})
        for (const auto& [name, tensor] : *part) count += tensor.numel();
    DOCTEST_CHECK(description.parameters == count);
}

DOCTEST_TEST_CASE("model: a missing, an extra and a mis-shaped tensor are named") {
    TinyModel model;
    const auto complaint = [&] {
        model.write_weights();
        const auto loading = message_of([&] { load_bundle(model.path()); });
        DOCTEST_CHECK(message_of([&] { describe_model(model.path()); }) == loading);
        return loading;
    };
    DOCTEST_CHECK(complaint().empty());
    const auto original = model.unet;
    const auto name = original[5].first;
    model.unet.erase(model.unet.begin() + 5);
    DOCTEST_CHECK(contains(complaint(), "no tensor \"" + name + "\""));
    model.unet = original;
    model.unet.emplace_back("stray.weight", torch::zeros({1}));
    DOCTEST_CHECK(contains(complaint(), "stray.weight"));
    model.unet = original;
    model.unet[5].second = torch::zeros({3, 1, 2});
    const auto shape = complaint();
    DOCTEST_CHECK(contains(shape, name));
    DOCTEST_CHECK(contains(shape, "[3,1,2]"));
}

DOCTEST_TEST_CASE("model: what cannot be opened is refused with one sentence") {
    const ScratchFolder scratch;
    const auto refused = [](const std::filesystem::path& path, ErrorCode code) {
        try {
            load_bundle(path);
        } catch (const Error& error) {
            DOCTEST_CHECK((error.code() == code));
            DOCTEST_CHECK(error.message().find('\n') == std::string::npos);
            return;
        }
        DOCTEST_FAIL_CHECK("accepted ", path.string());
    };
    refused(scratch.path() / "nowhere", ErrorCode::NotFound);
    refused(scratch.path(), ErrorCode::NotFound);
    for (const char* pickle : {"a.ckpt", "a.pt", "a.pth", "a.bin"}) {
        write_file(scratch.path() / pickle, "\x80\x02}q");
        refused(scratch.path() / pickle, ErrorCode::Unsupported);
    }
    write_file(scratch.path() / "a.png", "x");
    refused(scratch.path() / "a.png", ErrorCode::Unsupported);
    write_file(scratch.path() / "short.safetensors", "abc");
    refused(scratch.path() / "short.safetensors", ErrorCode::Malformed);
    write_safetensors(scratch.path() / "lora.safetensors", {{"lora_unet.up.weight", torch::zeros({2})}});
    refused(scratch.path() / "lora.safetensors", ErrorCode::Model);

    for (const char* part : {"unet", "vae", "text_encoder", "scheduler", "tokenizer"}) {
        const TinyModel model;
        std::filesystem::remove_all(model.path() / part);
        refused(model.path(), ErrorCode::NotFound);
    }
    const TinyModel model;
    std::filesystem::rename(model.path() / "unet/diffusion_pytorch_model.safetensors",
                            model.path() / "unet/diffusion_pytorch_model.bin");
    refused(model.path(), ErrorCode::Unsupported);
    DOCTEST_CHECK(!message_of([&] { load_model(model.path(), "tpu"); }).empty());
}

DOCTEST_TEST_CASE("configurations: survive a round trip; unsupported structures are refused") {
    const auto unet = tiny_unet_config();
    DOCTEST_CHECK(UNetConfig::from_json(unet.to_json(), "x").to_json() == unet.to_json());
    DOCTEST_CHECK(VaeConfig::from_json(tiny_vae_config().to_json(), "x").to_json() ==
                  tiny_vae_config().to_json());
    DOCTEST_CHECK(TextEncoderConfig::from_json(tiny_text_config().to_json(), "x").to_json() ==
                  tiny_text_config().to_json());
    SchedulerConfig scheduler;
    DOCTEST_CHECK(SchedulerConfig::from_json(scheduler.to_json(), "x").to_json() == scheduler.to_json());
    for (const auto& [key, value] :
         std::vector<std::pair<std::string, Json>>{{"block_out_channels", Json::array()},
                                                   {"norm_num_groups", 0},
                                                   {"norm_num_groups", 5},
                                                   {"act_fn", "gelu"},
                                                   {"addition_embed_type", "text_time"},
                                                   {"attention_head_dim", 3},
                                                   {"layers_per_block", "two"},
                                                   {"block_out_channels", {16, -32}},
                                                   {"down_block_types", {"Odd", "DownBlock2D"}},
                                                   {"sample_size", 0},
                                                   {"sample_size", -64},
                                                   {"sample_size", 1 << 20},
                                                   {"sample_size", 1e300},
                                                   {"in_channels", 1e9}}) {
        auto json = unet.to_json();
        json[key] = value;
        DOCTEST_CHECK_MESSAGE(!message_of([&] { UNetConfig::from_json(json, "x"); }).empty(), key);
    }
}

DOCTEST_TEST_CASE("tokenizer: columns of whole words, all occurrences, several tokens") {
    const TinyModel model;
    const Tokenizer tokenizer(model.path() / "tokenizer");
    using Columns = std::vector<std::int64_t>;
    DOCTEST_CHECK(tokenizer.find_word("a red hat", "hat") == Columns{3});
    DOCTEST_CHECK(tokenizer.find_word("A Red HAT, hat.", "Hat") == Columns{3, 5});
    DOCTEST_CHECK(tokenizer.find_word("a red hat", "red hat") == Columns{2, 3});
    DOCTEST_CHECK(tokenizer.find_word("a dog", "dog") == Columns{2, 3, 4});  // d, o, g</w>
    DOCTEST_CHECK(tokenizer.find_word("dog hat", "hat") == Columns{4});
    for (const char* prompt : {"a hatter", "that", "a red", "", "h at"})
        DOCTEST_CHECK(contains(message_of([&] { tokenizer.find_word(prompt, "hat"); }), "hat"));
    DOCTEST_CHECK(!message_of([&] { tokenizer.find_word("a hat", ""); }).empty());
    std::string lengthy;
    for (int i = 0; i < 30; ++i) lengthy += "red ";
    DOCTEST_CHECK(contains(message_of([&] { tokenizer.find_word(lengthy + "hat", "hat"); }), "beyond"));
    const auto encoding = tokenizer.encode(lengthy);
    DOCTEST_CHECK(encoding.truncated);
    DOCTEST_CHECK(encoding.ids.size() == 24);
    DOCTEST_CHECK(encoding.ids.front() == tokenizer.bos());
    DOCTEST_CHECK(encoding.ids.back() == tokenizer.eos());
}
