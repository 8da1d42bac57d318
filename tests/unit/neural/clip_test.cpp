// The image-text encoder: shapes, unit vectors, files there and back, and files that must be refused.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <cmath>
#include <fstream>
#include <numeric>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/laboratory/starter/starter_stages.h"
#include "engine/language/vocabulary.h"
#include "engine/neural/clip/clip_score.h"
#include "engine/neural/weights/safetensors.h"
#include "tests/test_paths.h"

namespace {

using namespace gse::neural;
using gse::training::build_vocabulary;
using gse::training::export_clip;

constexpr double UnitTolerance = 1e-5;  // of a length in fp32
constexpr double HalfTolerance = 2e-3;  // fp16 weights of a two-layer model

ClipConfig tiny_config(int vocabulary) {
    ClipConfig config;
    config.projection_dim = config.text.projection_dim = 12;
    config.text.with_projection = true;
    config.text.vocab_size = vocabulary;
    config.text.hidden_size = 16;
    config.text.intermediate_size = 32;
    config.text.num_hidden_layers = 2;
    config.text.num_attention_heads = 2;
    config.text.max_position_embeddings = 16;
    config.vision.hidden_size = 24;
    config.vision.intermediate_size = 48;
    config.vision.num_hidden_layers = 2;
    config.vision.num_attention_heads = 3;
    config.vision.image_size = 16;
    config.vision.patch_size = 4;
    return config;
}

/// A folder with an untrained encoder, and a tokenizer beside it.
struct TinyFolder {
    TinyFolder() {
        const auto vocabulary = build_vocabulary({"a", "red", "blue", "bear"});
        config = tiny_config(vocabulary.size);
        config.text.eos_token_id = vocabulary.eos;
        torch::manual_seed(3);
        model = ClipModel(config);
        export_clip(model, folder.path);
        gse::write_file(folder.tokenizer / "vocab.json", vocabulary.vocab_json);
        gse::write_file(folder.tokenizer / "merges.txt", vocabulary.merges_txt);
    }
    void edit_config(const std::function<void(Json&)>& change) const {
        auto json = read_json_file(folder.path / "config.json");
        change(json);
        gse::write_file(folder.path / "config.json", json.dump());
    }

    gse::test::ScratchFolder scratch;
    ClipFolder folder{scratch.path() / "clip", scratch.path() / "tokenizer", {}};
    ClipConfig config;
    ClipModel model{nullptr};
};

gse::Image gradient(int width, int height) {
    gse::Image image(width, height, 3);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < 3; ++c)
                image.at(x, y, c) = static_cast<float>(c == 0 ? x / double(width) : y / double(height));
    return image;
}

double dot(const std::vector<float>& a, const std::vector<float>& b) {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

}  // namespace

DOCTEST_TEST_CASE("pictures of any size and sentences become unit vectors of one length") {
    const TinyFolder tiny;
    const auto score = load_clip_score(tiny.folder);
    const auto sentence = score->text("a red bear");
    DOCTEST_CHECK(sentence.size() == 12);
    DOCTEST_CHECK(std::abs(dot(sentence, sentence) - 1) < UnitTolerance);
    for (const auto& [width, height] : {std::pair{16, 16}, {64, 64}, {7, 7}, {90, 50}, {1, 1}}) {
        const auto vector = score->image(gradient(width, height));
        DOCTEST_CHECK(vector.size() == 12);
        DOCTEST_CHECK(std::abs(dot(vector, vector) - 1) < UnitTolerance);
    }
    DOCTEST_CHECK(dot(sentence, score->text("a blue bear")) < 1 - 1e-4);
    DOCTEST_CHECK(score->text("") == score->text(" "));
}

DOCTEST_TEST_CASE("a written encoder comes back with the names that transformers uses") {
    const TinyFolder tiny;
    const SafetensorsFile file(tiny.folder.path / "model.safetensors");
    for (const char* name :
         {"logit_scale", "visual_projection.weight", "text_projection.weight",
          "vision_model.pre_layrnorm.weight", "vision_model.post_layernorm.bias",
          "vision_model.embeddings.class_embedding", "vision_model.embeddings.patch_embedding.weight",
          "vision_model.embeddings.position_embedding.weight",
          "vision_model.encoder.layers.1.self_attn.q_proj.weight", "text_model.final_layer_norm.weight",
          "text_model.embeddings.token_embedding.weight", "text_model.encoder.layers.0.mlp.fc1.bias"})
        DOCTEST_CHECK_MESSAGE(file.contains(name), name);
    const auto read = ClipConfig::from_json(tiny.config.to_json(), "config.json");
    DOCTEST_CHECK(read.to_json() == tiny.config.to_json());

    const auto score = load_clip_score(tiny.folder);
    const torch::NoGradGuard no_grad;
    ClipPreprocessing preprocessing;
    preprocessing.size = 16;
    const auto pixels = preprocessing.pixels(torch::full({1, 3, 16, 16}, 0.25));
    const auto expected = tiny.model->image_vectors(pixels).squeeze(0);
    gse::Image flat(16, 16, 3);
    std::fill(flat.data.begin(), flat.data.end(), 0.25f);
    const auto vector = score->image(flat);
    for (std::size_t i = 0; i < vector.size(); ++i)
        DOCTEST_CHECK(std::abs(vector[i] - expected[static_cast<std::int64_t>(i)].item<float>()) <
                      HalfTolerance);
}

DOCTEST_TEST_CASE("keys that transformers leaves out are those of ViT-B/32") {
    const auto config =
        ClipConfig::from_json(Json::parse(R"({"model_type": "clip", "text_config": {}})"), "c");
    DOCTEST_CHECK(config.text.hidden_size == 512);
    DOCTEST_CHECK(config.text.num_attention_heads == 8);
    DOCTEST_CHECK(config.vision.hidden_size == 768);
    DOCTEST_CHECK(config.vision.patch_size == 32);
    DOCTEST_CHECK(config.projection_dim == 512);
    DOCTEST_CHECK(config.text.with_projection);
}

DOCTEST_TEST_CASE("words the encoder never saw are left out") {
    const std::vector<std::string> known{"a", "red", "bear", "front", "view"};
    DOCTEST_CHECK(gse::language::filter_to_vocabulary("A sks red, shiny bear; front view!", known) ==
                  "a red, bear front view");
    DOCTEST_CHECK(gse::language::filter_to_vocabulary("nothing known", known).empty());
    DOCTEST_CHECK(gse::language::filter_to_vocabulary("a shiny red * bear, front view", known, "*") ==
                  "a red * bear, front view");
    DOCTEST_CHECK(gse::language::filter_to_vocabulary("a caf\xc3\xa9", {"a", "caf\xc3\xa9"}) ==
                  "a caf\xc3\xa9");
    TinyFolder tiny;
    tiny.folder.known_words = {"a", "red", "bear"};
    const auto score = load_clip_score(tiny.folder);
    DOCTEST_CHECK(score->text("a sks red bear") == score->text("a red bear"));
}

DOCTEST_TEST_CASE("the preprocessing of the folder is used") {
    const TinyFolder tiny;
    const auto before = load_clip_score(tiny.folder)->image(gradient(16, 16));
    gse::write_file(tiny.folder.path / "preprocessor_config.json",
                    R"({"image_mean": [0.5, 0.5, 0.5], "image_std": [0.5, 0.5, 0.5]})");
    DOCTEST_CHECK(load_clip_score(tiny.folder)->image(gradient(16, 16)) != before);
    gse::write_file(tiny.folder.path / "preprocessor_config.json", R"({"image_std": [0.5, 0, 0.5]})");
    DOCTEST_CHECK_THROWS_WITH_AS(load_clip_score(tiny.folder), doctest::Contains("image_std"), gse::Error);
    gse::write_file(tiny.folder.path / "preprocessor_config.json", R"({"image_mean": "grey"})");
    DOCTEST_CHECK_THROWS_WITH_AS(load_clip_score(tiny.folder), doctest::Contains("image_mean"), gse::Error);
}

DOCTEST_TEST_CASE("bad folders are refused with a sentence") {
    const auto refuses = [](const TinyFolder& tiny, const char* word) {
        DOCTEST_CHECK_THROWS_WITH_AS(load_clip_score(tiny.folder), doctest::Contains(word), gse::Error);
    };
    const auto configured = [&](const char* tower, const char* key, const Json& value, const char* word) {
        const TinyFolder tiny;
        tiny.edit_config([&](Json& json) { (*tower == 0 ? json : json[tower])[key] = value; });
        refuses(tiny, word);
    };
    configured("vision_config", "patch_size", 5, "patch_size");
    configured("vision_config", "patch_size", 0, "patch_size");
    configured("vision_config", "num_attention_heads", 5, "number of heads");
    configured("vision_config", "num_channels", 4, "three channels");
    configured("vision_config", "hidden_size", "wide", "wrong type");
    configured("vision_config", "hidden_act", "tanh", "hidden_act");
    configured("vision_config", "num_hidden_layers", 3, "no tensor");
    configured("vision_config", "num_hidden_layers", 1, "not known");
    configured("text_config", "hidden_size", 18, "shape");
    configured("text_config", "vocab_size", 4, "tokens");
    configured("", "model_type", "siglip", "model_type");
    configured("", "projection_dim", -1, "projection_dim");
    const TinyFolder cut;
    const auto bytes = gse::read_file(cut.folder.path / "model.safetensors");
    gse::write_file(cut.folder.path / "model.safetensors", bytes.substr(0, bytes.size() / 2));
    DOCTEST_CHECK_THROWS_AS(load_clip_score(cut.folder), gse::Error);
    std::filesystem::remove(cut.folder.path / "model.safetensors");
    refuses(cut, "incomplete");
}
