// Views of one scene that are denoised together.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "engine/base/error.h"
#include "engine/neural/diffusion/conditioning.h"
#include "engine/neural/diffusion/scene_views.h"
#include "tests/test_paths.h"
#include "tests/unit/neural/quantized.h"

namespace {

using namespace gse::neural;
using gse::test::write_shape_unet;

UNet small_unet() {
    UNetConfig config;
    config.sample_size = 8;
    config.block_out_channels = {16, 32};
    config.down_block_types = {"CrossAttnDownBlock2D", "CrossAttnDownBlock2D"};
    config.up_block_types = {"CrossAttnUpBlock2D", "CrossAttnUpBlock2D"};
    config.layers_per_block = 1;
    config.heads = {2, 2};
    config.norm_num_groups = 8;
    config.cross_attention_dim = 12;
    torch::manual_seed(5);
    return UNet(config);
}

SceneViews telling(torch::Tensor& outline) {
    SceneViews views;
    views.outline = &outline;
    return views;
}

}  // namespace

DOCTEST_TEST_CASE("views that are denoised together see each other, and no others") {
    const torch::NoGradGuard no_grad;
    const UNet unet = small_unet();
    torch::manual_seed(6);
    auto views = torch::randn({4, 4, 8, 8});
    const auto words = torch::randn({4, 3, 12}), t = torch::full({1}, 400.0f);
    const auto together = [&](std::int64_t count) {
        return unet->forward(views, t, words, nullptr, {}, {count, {}});
    };
    const auto apart = together(1), pairs = together(2);
    DOCTEST_CHECK(torch::equal(apart, unet->forward(views, t, words)));
    DOCTEST_CHECK(!torch::allclose(apart, pairs, 1e-4, 1e-5));
    views[3] += 1;  // of the second pair
    const auto changed = together(2);
    DOCTEST_CHECK(torch::equal(pairs.narrow(0, 0, 2), changed.narrow(0, 0, 2)));
    DOCTEST_CHECK(!torch::allclose(pairs[2], changed[2], 1e-4, 1e-5));
    DOCTEST_CHECK(torch::equal(apart[2], together(1)[2]));
}

DOCTEST_TEST_CASE("views that are the same see nothing new in each other") {
    const torch::NoGradGuard no_grad;
    const UNet unet = small_unet();
    torch::manual_seed(7);
    const auto views = torch::randn({1, 4, 8, 8}).repeat({3, 1, 1, 1}),
               words = torch::randn({1, 3, 12}).repeat({3, 1, 1});
    const auto t = torch::full({1}, 700.0f);
    // Attention over copies is attention over one; sums of three times as many terms round otherwise.
    DOCTEST_CHECK(torch::allclose(unet->forward(views, t, words),
                                  unet->forward(views, t, words, nullptr, {}, {3, {}}), 1e-4, 1e-5));
}

DOCTEST_TEST_CASE("an embedding of cameras says nothing before it was trained") {
    const torch::NoGradGuard no_grad;
    const UNet plain = small_unet(), told = with_scene_inputs(plain);
    torch::manual_seed(8);
    const auto views = torch::randn({2, 4, 8, 8}), words = torch::randn({2, 3, 12}),
               t = torch::full({1}, 100.0f);
    const auto cameras = torch::randn({2, CameraFeatures});
    const auto before = plain->forward(views, t, words);
    DOCTEST_CHECK(torch::equal(before, told->forward(views, t, words, nullptr, {}, {1, cameras})));
    for (auto& [name, weight] : scene_input_weights(told)) weight.fill_(0.1);
    DOCTEST_CHECK(
        !torch::allclose(before, told->forward(views, t, words, nullptr, {}, {1, cameras}), 1e-4, 1e-5));
    DOCTEST_CHECK(torch::equal(before, told->forward(views, t, words)));  // where nothing is known of them
    DOCTEST_CHECK(scene_input_weights(told).size() == 10);
    DOCTEST_CHECK(scene_input_weights(plain).empty());
}

DOCTEST_TEST_CASE("what was there is shown where it may be, and says nothing before that was trained") {
    const torch::NoGradGuard no_grad;
    const UNet plain = small_unet(), shown_it = with_scene_inputs(plain);
    torch::manual_seed(9);
    const auto views = torch::randn({2, 4, 8, 8}), words = torch::randn({2, 3, 12}),
               t = torch::full({1}, 100.0f);
    auto mask = torch::zeros({2, 1, 8, 8}), shown = torch::ones({2, 1, 8, 8});
    mask.slice(2, 2, 5) = 1;
    shown.slice(2, 3, 4) = 0;
    auto latents = torch::randn({2, 4, 8, 8});
    const auto output = [&] {
        return shown_it->forward(views, t, words, nullptr, {}, {1, {}, inpainting(mask, shown, latents)});
    };
    DOCTEST_CHECK(torch::equal(plain->forward(views, t, words), output()));
    for (auto& [name, weight] : scene_input_weights(shown_it)) weight.normal_();
    const auto told = output();
    DOCTEST_CHECK(!torch::allclose(plain->forward(views, t, words), told, 1e-4, 1e-5));
    latents.slice(2, 3, 4) += 1;  // not shown
    DOCTEST_CHECK(torch::equal(told, output()));
    latents.slice(2, 4, 5) += 1;
    DOCTEST_CHECK(!torch::allclose(told, output(), 1e-4, 1e-5));
}

DOCTEST_TEST_CASE("weights of before there was inpainting, or outlines, are read without it") {
    const gse::test::ScratchFolder scratch;
    const auto path = scratch.path() / "cameras.safetensors";
    const UNet plain = small_unet();
    const auto written_without = [&](const std::vector<std::string>& parts) {
        auto weights = scene_input_weights(with_scene_inputs(plain));
        std::erase_if(weights, [&](const auto& weight) {
            return std::ranges::any_of(parts,
                                       [&](const auto& part) { return weight.first.starts_with(part); });
        });
        for (auto& [name, weight] : weights) weight = torch::full_like(weight, 0.25).detach();
        write_safetensors(path, weights);
        return SafetensorsFile(path);
    };
    const auto old = written_without({"conv_inpaint.", "outline."}), shown = written_without({"outline."});
    DOCTEST_CHECK(with_scene_inputs(plain, old)->config().inpaint_channels == 0);
    DOCTEST_CHECK(scene_input_weights(with_scene_inputs(plain, old)).size() == 4);
    DOCTEST_CHECK(with_scene_inputs(plain, shown)->config().inpaint_channels == 6);
    DOCTEST_CHECK(scene_input_weights(with_scene_inputs(plain, shown)).size() == 6);
    DOCTEST_CHECK(with_scene_inputs(plain, shown)->config().outline_scale == 0);
}

DOCTEST_TEST_CASE(
    "outlines are told by networks that know them, at the pixels of the picture, and change nothing of what "
    "is drawn") {
    const torch::NoGradGuard no_grad;
    torch::manual_seed(9);
    const UNet plain = small_unet(), tells = with_scene_inputs(plain);
    const auto views = torch::randn({4, 4, 8, 8}), words = torch::randn({4, 5, 12}),
               t = torch::full({1}, 500.0f);
    torch::Tensor none, outline;
    plain->forward(views, t, words, nullptr, {}, telling(none));
    DOCTEST_CHECK(!none.defined());
    const auto asked = tells->forward(views, t, words, nullptr, {}, telling(outline));
    DOCTEST_CHECK(torch::equal(asked, tells->forward(views, t, words)));
    DOCTEST_REQUIRE(outline.sizes() == torch::IntArrayRef({4, 1, 8 * OutlineScale, 8 * OutlineScale}));
    DOCTEST_CHECK(
        (outline.sigmoid() < 0.1).all().item<bool>());  // before it has learned of any there is none
    // Under guidance it is that of the positive text.
    for (auto& [name, weight] : scene_input_weights(tells))
        if (name.starts_with("outline.")) weight.normal_();
    const auto context = torch::randn({4, 2, 5, 12});
    torch::Tensor guided_outline, positive;
    Conditioning conditioning{context, 3};
    conditioning.views.outline = &guided_outline;
    guided_output(tells, views, t, conditioning);
    tells->forward(views, t, context.select(1, 1), nullptr, {}, telling(positive));
    // Sums over another batch size round otherwise; weights of one standard deviation make values of
    // hundreds.
    constexpr double Rounding = 1e-4;  // of the largest value
    DOCTEST_CHECK((guided_outline - positive).abs().max().item<double>() <=
                  Rounding * positive.abs().max().item<double>());
}

DOCTEST_TEST_CASE("an embedding of cameras is read as it was written, and refused where it does not fit") {
    const gse::test::ScratchFolder scratch;
    const auto path = scratch.path() / "cameras.safetensors";
    const UNet plain = small_unet();
    auto weights = scene_input_weights(with_scene_inputs(plain));
    for (auto& [name, weight] : weights) weight = torch::full_like(weight, 0.25).detach();
    write_safetensors(path, weights);
    const auto read = scene_input_weights(with_scene_inputs(plain, SafetensorsFile(path)));
    for (std::size_t i = 0; i < weights.size(); ++i)
        DOCTEST_CHECK(torch::equal(read[i].second, weights[i].second));
    weights[1].second = torch::zeros({2, 2});
    write_safetensors(path, weights);
    DOCTEST_CHECK_THROWS_WITH_AS(with_scene_inputs(plain, SafetensorsFile(path)),
                                 doctest::Contains("another shape"), gse::Error);
    weights.erase(weights.begin() + 1);
    write_safetensors(path, weights);
    DOCTEST_CHECK_THROWS_WITH_AS(with_scene_inputs(plain, SafetensorsFile(path)), doctest::Contains("has no"),
                                 gse::Error);
}

DOCTEST_TEST_CASE(
    "a network of its own for new things is read as it was written, in eight bits, and refused where a part "
    "is missing") {
    const torch::NoGradGuard no_grad;
    const gse::test::ScratchFolder scratch;
    const UNet written = with_scene_inputs(small_unet());
    torch::manual_seed(12);
    for (auto& [name, weight] : scene_input_weights(written)) weight.normal_(0, 0.1);
    write_shape_unet(written, scratch.path());
    DOCTEST_CHECK(shape_unet_shows_scene(scratch.path()));
    const UNet read = load_shape_unet(scratch.path());
    DOCTEST_CHECK((read->config().camera_dim == CameraFeatures && read->config().inpaint_channels == 6 &&
                   read->config().outline_scale == OutlineScale));
    const auto views = torch::randn({2, 4, 8, 8}), words = torch::randn({2, 3, 12}),
               t = torch::full({1}, 300.0f);
    const auto cameras = torch::randn({2, CameraFeatures}), shown = torch::randn({2, 6, 8, 8});
    const auto output = [&](const UNet& unet) {
        return unet->forward(views, t, words, nullptr, {}, {2, cameras, shown});
    };
    const auto before = output(written), after = output(read);
    // Share of the output: errors of 1 / 254 of a row's largest weight, through twenty layers.
    constexpr double EightBits = 0.02;
    DOCTEST_CHECK((before - after).norm().item<double>() < EightBits * before.norm().item<double>());
    write_shape_unet(read, scratch.path() / "again");  // what is in eight bits already stays as it is
    DOCTEST_CHECK(torch::allclose(after, output(load_shape_unet(scratch.path() / "again")), 1e-4, 1e-5));
    write_shape_unet(small_unet(), scratch.path());
    DOCTEST_CHECK_FALSE(shape_unet_shows_scene(scratch.path()));
    DOCTEST_CHECK_THROWS_WITH_AS(load_shape_unet(scratch.path()),
                                 doctest::Contains("UNet for new things has no tensor \"camera_embedding."),
                                 gse::Error);
    DOCTEST_CHECK_THROWS_AS(load_shape_unet(scratch.path() / "none"), gse::Error);
}

DOCTEST_TEST_CASE("camera features turn with the camera, and are zero where nothing is known") {
    for (const float value : camera_features(std::nullopt, 0.3)) DOCTEST_CHECK(value == 0);
    const auto front = camera_features(0.0, 0.2), round = camera_features(2 * std::numbers::pi, 0.2),
               back = camera_features(std::numbers::pi, 0.2);
    for (std::size_t i = 0; i < front.size(); ++i)
        DOCTEST_CHECK(front[i] == doctest::Approx(round[i]).epsilon(1e-6));
    DOCTEST_CHECK(front[1] == doctest::Approx(-back[1]));
    DOCTEST_CHECK(front[4] == doctest::Approx(std::sin(0.2)));
}

DOCTEST_TEST_CASE("every view is in one group; around the thing or beside each other") {
    std::vector<std::optional<double>> azimuths;
    for (const int sixth : {3, 0, 5, 1, 4, 2}) azimuths.push_back(sixth * std::numbers::pi / 3);
    for (const std::int64_t together : {1, 2, 3, 4, 6, 9})
        for (const bool around : {false, true}) {
            const auto groups = view_groups(azimuths, together, around);
            std::set<std::int64_t> seen;
            for (const auto& group : groups) {
                DOCTEST_CHECK(static_cast<std::int64_t>(group.size()) <= together);
                seen.insert(group.begin(), group.end());
            }
            DOCTEST_CHECK(seen.size() == azimuths.size());
        }
    const auto across = [&](const std::vector<std::int64_t>& group) {
        return std::abs(std::remainder(
            *azimuths[static_cast<std::size_t>(group[0])] - *azimuths[static_cast<std::size_t>(group[1])],
            2 * std::numbers::pi));
    };
    for (const auto& group : view_groups(azimuths, 2, true))
        DOCTEST_CHECK(across(group) == doctest::Approx(std::numbers::pi));
    for (const auto& group : view_groups(azimuths, 2, false))
        DOCTEST_CHECK(across(group) == doctest::Approx(std::numbers::pi / 3));
    DOCTEST_CHECK(view_groups({}, 4, true).empty());
}
