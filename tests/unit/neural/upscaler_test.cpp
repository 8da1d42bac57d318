// Enlargement of drawn pictures: sizes, an untrained network, and files that must be refused.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/neural/diffusion/upscaler.h"
#include "engine/neural/model.h"
#include "engine/neural/weights/safetensors.h"
#include "tests/test_paths.h"
#include "tests/unit/neural/tiny_model.h"
#include "tests/unit/neural/wall_views.h"

namespace upscaler_test {

namespace {

using namespace gse::neural;

const Json Stated{{"latent_channels", 4}, {"width", 8}, {"blocks", 2}};

/// A folder with drawn weights.
std::filesystem::path written(const std::filesystem::path& folder) {
    torch::manual_seed(5);
    const Upscaler network(UpscalerConfig::from_json(Stated, "config.json"));
    NamedTensors weights;
    for (const auto& parameter : network->named_parameters())
        weights.emplace_back(parameter.key(), torch::randn(parameter.value().sizes()) * 0.3);
    gse::write_file(folder / "config.json", Stated.dump());
    write_safetensors(folder / "model.safetensors", weights);
    return folder;
}

bool refused(const std::filesystem::path& folder, gse::ErrorCode code) {
    try {
        load_upscaler(folder, torch::kCPU);
    } catch (const gse::Error& error) { return error.code() == code; }
    return false;
}

}  // namespace

DOCTEST_TEST_CASE("pictures come out four times as large; an untrained network enlarges them") {
    const torch::NoGradGuard no_grad;
    torch::manual_seed(2);
    const auto picture = torch::rand({2, 3, 16, 16}) * 2 - 1, latents = torch::randn({2, 4, 4, 4});
    const Upscaler untrained(UpscalerConfig::from_json(Stated, "config.json"));
    DOCTEST_CHECK(torch::equal(untrained->forward(picture, latents),
                               torch::upsample_bicubic2d(picture, {64, 64}, false)));
    const gse::test::ScratchFolder scratch;
    const auto drawn = load_upscaler(written(scratch.path()), torch::kCPU);
    const auto large = drawn->forward(picture, latents);
    DOCTEST_CHECK(large.sizes() == torch::IntArrayRef({2, 3, 64, 64}));
    // It looks at the latents, and at each picture by itself.
    DOCTEST_CHECK_FALSE(torch::equal(large, drawn->forward(picture, -latents)));
    constexpr double Rounding = 1e-5;  // of sums in fp32 in another order, of the largest value
    const auto first = drawn->forward(picture.narrow(0, 0, 1), latents.narrow(0, 0, 1));
    DOCTEST_CHECK((large.narrow(0, 0, 1) - first).abs().max().item<double>() <
                  Rounding * large.abs().max().item<double>());
}

DOCTEST_TEST_CASE("upscalers that cannot be used are refused by what is wrong") {
    const gse::test::ScratchFolder scratch;
    DOCTEST_CHECK(refused(scratch.path(), gse::ErrorCode::NotFound));
    const auto folder = written(scratch.path());
    for (const auto& [key, value] :
         {std::pair{"width", 6}, {"width", 0}, {"blocks", 0}, {"latent_channels", 0}}) {
        auto wrong = Stated;
        wrong[key] = value;
        gse::write_file(folder / "config.json", wrong.dump());
        DOCTEST_CHECK_MESSAGE(refused(folder, gse::ErrorCode::Model), key);
    }
    gse::write_file(folder / "config.json", Json{{"width", "wide"}}.dump());
    DOCTEST_CHECK(refused(folder, gse::ErrorCode::Malformed));
    auto other = Stated;
    other["blocks"] = 3;  // the file has two
    gse::write_file(folder / "config.json", other.dump());
    DOCTEST_CHECK(refused(folder, gse::ErrorCode::Model));
    gse::write_file(folder / "config.json", Stated.dump());
    std::filesystem::remove(folder / "model.safetensors");
    DOCTEST_CHECK(refused(folder, gse::ErrorCode::NotFound));
}

DOCTEST_TEST_CASE("a model that names an upscaler draws new things with it, and everything else as before") {
    const gse::test::TinyModel model;
    const auto plain = load_model(model.path(), "cpu");
    const Upscaler network(UpscalerConfig::from_json(Stated, "config.json"));
    NamedTensors weights;
    for (const auto& parameter : network->named_parameters()) {
        auto value = parameter.value().detach().clone();
        if (parameter.key() == "conv_out.bias") value.fill_(-1.0);  // an enlargement, darker by a half
        weights.emplace_back(parameter.key(), value);
    }
    gse::write_file(model.path() / "lift/config.json", Stated.dump());
    write_safetensors(model.path() / "lift/model.safetensors", weights);
    gse::write_file(model.path() / "gseditpro.json", R"({"upscaler": "lift"})");
    const auto with = load_model(model.path(), "cpu");
    auto views = gse::test::wall_views();
    for (auto& view : views) view.clean_plate.picture = view.original;
    const auto drawn = [&](const TextToImage& by, bool anew) {
        gse::edit::EditViewsRequest input;
        input.steps = 2;
        input.anew = anew;
        return by.views("a bear", {})->edit(views, input, {}).images.front();
    };
    DOCTEST_CHECK(drawn(*with, false).data == drawn(*plain, false).data);
    const auto mean = [](const gse::Image& image) {
        double sum = 0;
        for (const float value : image.data) sum += value / static_cast<double>(image.data.size());
        return sum;
    };
    DOCTEST_CHECK(mean(drawn(*with, true)) < mean(drawn(*plain, true)) - 0.2);
    for (const char* facts : {R"({"upscaler": "gone"})", R"({"upscaler": 3})"}) {
        gse::write_file(model.path() / "gseditpro.json", facts);
        DOCTEST_CHECK_THROWS_AS(load_bundle(model.path()), gse::Error);
    }
    auto other = Stated;
    other["latent_channels"] = 8;
    gse::write_file(model.path() / "lift/config.json", other.dump());
    gse::write_file(model.path() / "gseditpro.json", R"({"upscaler": "lift"})");
    DOCTEST_CHECK_THROWS_AS(load_bundle(model.path()), gse::Error);
}

}  // namespace upscaler_test
