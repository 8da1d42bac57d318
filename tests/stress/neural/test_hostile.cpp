// Damaged files, odd texts and unusable images: an Error or a result, never a crash, a hang or a value that
// is not finite.
#include <cmath>
#include <fstream>

#include "engine/base/random.h"
#include "engine/neural/guidance/attention_source.h"
#include "engine/neural/guidance/sds_guidance.h"
#include "engine/neural/weights/key_map.h"
#include "tests/unit/neural/tiny_model.h"

using namespace gse;
using namespace gse::neural;
using namespace gse::test;

namespace {

std::string valid_file(const ScratchFolder& scratch) {
    const auto path = scratch.path() / "valid.safetensors";
    write_safetensors(path, {{"a", torch::arange(6, torch::kFloat32).view({2, 3})},
                             {"b", torch::ones({5}).to(torch::kHalf)}});
    return read_file(path);
}

/// Opens the bytes as a file and reads every tensor; an Error is fine.
bool opens(const ScratchFolder& scratch, const std::string& bytes) {
    const auto path = scratch.path() / "mutant.safetensors";
    std::ofstream(path, std::ios::binary) << bytes;
    try {
        const SafetensorsFile file(path);
        for (const auto& [name, entry] : file.entries()) file.tensor(name);
        return true;
    } catch (const Error&) { return false; }
}

/// A safetensors file with this header.
std::string with_header(const std::string& header, std::size_t data_bytes) {
    std::string bytes(8, '\0');
    for (std::size_t i = 0; i < 8; ++i) bytes[i] = static_cast<char>(header.size() >> (8 * i) & 0xff);
    return bytes + header + std::string(data_bytes, 'x');
}

}  // namespace

DOCTEST_TEST_CASE("safetensors: mutated and cut files are read or refused") {
    const ScratchFolder scratch;
    const auto valid = valid_file(scratch);
    DOCTEST_REQUIRE(opens(scratch, valid));
    Random random(1);
    constexpr int Mutants = 400;
    int refused = 0;
    for (int i = 0; i < Mutants; ++i) {
        auto bytes = valid;
        for (std::uint64_t k = random.below(4) + 1; k > 0; --k)
            bytes[random.below(bytes.size())] = static_cast<char>(random.below(256));
        if (random.below(4) == 0) bytes.resize(random.below(bytes.size() + 1));
        refused += opens(scratch, bytes) ? 0 : 1;
    }
    DOCTEST_CHECK(refused > Mutants / 4);
    for (std::size_t size = 0; size < valid.size(); ++size)
        DOCTEST_CHECK_FALSE(opens(scratch, valid.substr(0, size)));
    DOCTEST_CHECK_FALSE(opens(scratch, valid + "x"));
}

DOCTEST_TEST_CASE("safetensors: lying headers do not allocate or overflow") {
    const ScratchFolder scratch;
    for (const char* header :
         {R"({"a":{"dtype":"F32","shape":[18446744073709551615],"data_offsets":[0,4]}})",
          R"({"a":{"dtype":"F32","shape":[4611686018427387904,4],"data_offsets":[0,0]}})",
          R"({"a":{"dtype":"F32","shape":[0,18446744073709551615],"data_offsets":[0,0]}})",
          R"({"a":{"dtype":"F32","shape":[1],"data_offsets":[18446744073709551612,18446744073709551616]}})",
          R"({"a":{"dtype":"F32","shape":[1e0],"data_offsets":[0,4]}})",
          R"({"a":{"dtype":"F32","shape":"1","data_offsets":[0,4]}})",
          R"({"a":{"dtype":7,"shape":[1],"data_offsets":[0,4]}})",
          R"({"a":{"dtype":"F32","shape":[1],"data_offsets":[0,4,8]}})", R"({"a":null})", R"({"a":{}})",
          R"([])", R"(null)", "", "{", "\xff\xfe"})
        DOCTEST_CHECK_MESSAGE(!opens(scratch, with_header(header, 4)), header);
    std::string deep = "{\"a\":";
    for (int i = 0; i < 100000; ++i) deep += "[";
    DOCTEST_CHECK_FALSE(opens(scratch, with_header(deep, 0)));
}

DOCTEST_TEST_CASE("tokenizer: any bytes give ids within the vocabulary") {
    const TinyModel model;
    const Tokenizer tokenizer(model.path() / "tokenizer");
    Random random(2);
    for (int i = 0; i < 500; ++i) {
        std::string text;
        for (std::uint64_t k = random.below(60); k > 0; --k) text += static_cast<char>(random.below(256));
        const auto encoding = tokenizer.encode(text);
        DOCTEST_REQUIRE(encoding.ids.size() == static_cast<std::size_t>(tokenizer.max_length()));
        for (const auto id : encoding.ids) DOCTEST_REQUIRE((id >= 0 && id < tokenizer.vocabulary_size()));
    }
    DOCTEST_CHECK(tokenizer.encode(std::string(100000, 'a')).truncated);
    DOCTEST_CHECK(tokenizer.encode(std::string(20000, '<')).truncated);
}

namespace {

bool finite(const Image& image) {
    return std::all_of(image.data.begin(), image.data.end(),
                       [](float value) { return std::isfinite(value); });
}

}  // namespace

DOCTEST_TEST_CASE("guidance and attention: odd images") {
    const TinyModel model;
    const auto bundle = std::make_shared<const ModelBundle>(load_bundle(model.path()));
    BundleAttentionSource source(bundle, {});
    SdsGuidance guidance(bundle, "a red bear", {});
    const View view;
    for (const auto& [width, height] :
         {std::pair(1, 1), std::pair(3, 500), std::pair(33, 31), std::pair(700, 2)})
        for (const float fill : {0.0f, 1.0f, -1e4f, 1e6f}) {
            const Image image(width, height, 3, fill);
            const auto maps = source.locate({image, "a red bear", {"bear"}});
            DOCTEST_CHECK(maps[0].width == width);
            edit::GuidanceInput input{image, view};
            const auto output = guidance.evaluate(input);
            DOCTEST_CHECK(finite(maps[0]));
            DOCTEST_CHECK(finite(output.gradient));
        }
    Image broken(32, 32, 3, 0.5f);
    broken.at(3, 3, 1) = NAN;
    edit::GuidanceInput input{broken, view};
    DOCTEST_CHECK_FALSE(
        finite(guidance.evaluate(input).gradient));  // the loop leaves such a step out and counts it
    DOCTEST_CHECK(contains(message_of([&] { source.locate({broken, "a red bear", {"bear"}}); }), "finite"));
}

DOCTEST_TEST_CASE("guidance: what damaged weights give is seen as such") {
    TinyModel model;
    for (auto& [name, tensor] : model.unet)
        if (name == "conv_out.bias") tensor.fill_(NAN);
    model.write_weights();
    const auto bundle = std::make_shared<const ModelBundle>(load_bundle(model.path()));
    const Image image(32, 32, 3, 0.5f);
    const View view;
    edit::GuidanceInput input{image, view};
    DOCTEST_CHECK_FALSE(finite(SdsGuidance(bundle, "a red bear", {}).evaluate(input).gradient));
}

DOCTEST_TEST_CASE("configurations: random values never crash the reader") {
    Random random(3);
    const std::vector<Json> values = {nullptr,
                                      true,
                                      -1,
                                      0,
                                      3,
                                      1e300,
                                      "text",
                                      Json::array(),
                                      Json::array({-1, "x"}),
                                      Json::array({16, 32}),
                                      Json::object(),
                                      1 << 20};
    for (int i = 0; i < 2000; ++i) {
        auto unet = tiny_unet_config().to_json(), vae = tiny_vae_config().to_json(),
             text = tiny_text_config().to_json(), scheduler = SchedulerConfig{}.to_json();
        for (auto* json : {&unet, &vae, &text, &scheduler}) {
            auto item = json->begin();
            std::advance(item, static_cast<std::ptrdiff_t>(random.below(json->size())));
            *item = values[random.below(values.size())];
        }
        message_of([&] { UNetConfig::from_json(unet, "x"); });
        message_of([&] { VaeConfig::from_json(vae, "x"); });
        message_of([&] { TextEncoderConfig::from_json(text, "x"); });
        message_of([&] { SchedulerConfig::from_json(scheduler, "x"); });
    }
}
