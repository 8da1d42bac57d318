// CLIPSeg against its reference: every layer of the decoder, both ways of enlarging, words and a picture as
// the condition.
#include <algorithm>

#include "engine/neural/clip/clipseg_model.h"
#include "tests/golden/neural/golden_case.h"

namespace gse::test {
namespace {

using namespace gse::neural;

constexpr double ClipSegLogitTolerance = 2e-5;  // of the largest value, at least of 1 (clipseg/README.md)

void check_clipseg(const std::string& name) {
    const GoldenCase golden(name);
    if (!golden.present) return;
    const torch::NoGradGuard no_grad;
    const auto config = ClipSegConfig::from_json(golden.json("config.json"), golden.folder / "config.json");
    ClipSegModel model(config, WeightOptions{torch::kCPU, torch::kFloat32, false});
    load_weights(*model, golden.tensors("model.safetensors"), clipseg_plan());
    const auto io = golden.tensors();
    Margins margins(name);
    const auto near = [&](const std::string& what, const torch::Tensor& actual) {
        const auto expected = io.tensor(what);
        margins.near(what, actual, expected, ClipSegLogitTolerance * std::max(1.0, largest(expected)));
    };
    const auto ids = io.tensor("input_ids"), pixels = io.tensor("pixel_values");
    const auto shown = [&](const torch::Tensor& picture, std::int64_t count) {
        auto activations = model->activations(picture);
        for (auto& activation : activations) activation = activation.expand({count, -1, -1});
        return activations;
    };
    std::vector<torch::Tensor> layers;
    const auto condition = model->clip->text->forward(ids, io.tensor("attention_mask")).text_embeds;
    near("conditional_embeddings", condition);
    const auto logits = model->logits(shown(pixels, ids.size(0)), condition, &layers);
    for (std::size_t i = 0; i < layers.size(); ++i)
        if (const auto what = "decoder.hidden_states." + std::to_string(i); io.contains(what))
            near(what, layers[i]);
    near("logits", logits);
    if (io.contains("prob")) near("prob", torch::sigmoid(logits));
    near("logits_native_size",
         model->logits(shown(pixels.slice(2, 0, 64).slice(3, 0, 64), 1), condition.slice(0, 0, 1)));
    if (io.contains("logits_image_conditioned"))
        near("logits_image_conditioned",
             model->logits(shown(pixels, 1), model->clip->vision->forward(pixels.flip({3})).image_embeds));
}

}  // namespace

DOCTEST_TEST_CASE("clipseg: logits of words and of a picture, every layer of the decoder") {
    check_clipseg("clipseg");
}

DOCTEST_TEST_CASE("clipseg_simple: enlarged in one step") { check_clipseg("clipseg_simple"); }

DOCTEST_TEST_CASE("manifests: names and shapes of the published CLIPSeg") {
    const GoldenCase golden("manifests");
    if (!golden.present) return;
    const auto config = ClipSegConfig::from_json({{"model_type", "clipseg"},
                                                  {"use_complex_transposed_convolution", true},
                                                  {"vision_config", {{"patch_size", 16}}},
                                                  {"extract_layers", {3, 6, 9}}},
                                                 golden.folder);
    const auto path = golden.folder / "clipseg_rd64_refined.tsv";
    check_weights(*ClipSegModel(config, WeightOptions{torch::kMeta, torch::kFloat32, false}),
                  read_manifest(path), clipseg_plan(), path);
}

}  // namespace gse::test
