// Attention maps, score distillation and sampling on a tiny random model: properties that hold for any
// weights.
#include <cmath>
#include <limits>

#include "engine/neural/api/network_use.h"
#include "engine/neural/guidance/attention_source.h"
#include "engine/neural/guidance/sds_guidance.h"
#include "engine/neural/layers/images.h"
#include "engine/neural/model.h"
#include "tests/unit/neural/tiny_model.h"

using namespace gse;
using namespace gse::neural;
using namespace gse::test;

namespace {

Image gradient_image(int width, int height) {
    Image image(width, height, 3);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < 3; ++c)
                image.at(x, y, c) = static_cast<float>((x * (c + 1) + y * 2) % 17) / 17.0f;
    return image;
}

std::shared_ptr<const ModelBundle> load_shared(const TinyModel& model) {
    return std::make_shared<const ModelBundle>(load_bundle(model.path()));
}

edit::GuidanceInput input_at(const Image& image, const View& view, int iteration) {
    edit::GuidanceInput input{image, view};
    input.iteration = iteration;
    input.iteration_count = 10;
    input.seed = 99;
    return input;
}

}  // namespace

DOCTEST_TEST_CASE(
    "attention source: one map per word, at the image's size, repeatable, and of one scale for all "
    "pictures") {
    const TinyModel model;
    const Image image = gradient_image(50, 40);
    for (const char* method : {"probes", "img2img"}) {
        AttentionParameters parameters;
        parameters.method = method;
        parameters.steps = 4;
        BundleAttentionSource source(load_shared(model), parameters);
        edit::AttentionQuery query{image, "a red bear", {"bear", "red", "red bear"}};
        query.view_words = "front view";
        query.repeats = 2;
        const auto maps = source.locate(query);
        DOCTEST_REQUIRE(maps.size() == 3);
        for (const auto& map : maps) {
            DOCTEST_CHECK(map.width == image.width);
            DOCTEST_CHECK(map.height == image.height);
            DOCTEST_CHECK(*std::min_element(map.data.begin(), map.data.end()) >= 0.0f);
            DOCTEST_CHECK(*std::max_element(map.data.begin(), map.data.end()) > 0.0f);
            // Not divided by its own maximum.
            DOCTEST_CHECK(*std::max_element(map.data.begin(), map.data.end()) != 1.0f);
        }
        DOCTEST_CHECK(source.locate(query)[0].data == maps[0].data);
        query.seed = 1;
        DOCTEST_CHECK(source.locate(query)[0].data != maps[0].data);
        query.absent = true;
        DOCTEST_CHECK(source.locate(query).size() == 3);
        query.words = {"hat"};
        DOCTEST_CHECK(contains(message_of([&] { source.locate(query); }), "hat"));
    }
}

DOCTEST_TEST_CASE("attention source: a sentence is encoded once, whatever pictures it is asked about") {
    const TinyModel model;
    const auto bundle = load_shared(model);
    const Image image = gradient_image(50, 40), other = gradient_image(40, 50);
    const auto arithmetic = [](auto&& pass) {
        const auto before = thread_use();
        pass();
        return (thread_use() - before).flop;
    };
    const double encoding = arithmetic([&] { bundle->encode_prompts({"a red bear"}); });
    BundleAttentionSource source(bundle, {}), fresh(bundle, {});
    const edit::AttentionQuery first{image, "a red bear", {"bear"}}, second{other, "a red bear", {"bear"}};
    std::vector<Image> maps;
    const double whole = arithmetic([&] { source.locate(first); }),
                 rest = arithmetic([&] { maps = source.locate(second); });
    DOCTEST_CHECK(encoding > 0);
    DOCTEST_CHECK(whole - rest == doctest::Approx(encoding));
    DOCTEST_CHECK(maps[0].data == fresh.locate(second)[0].data);
}

DOCTEST_TEST_CASE("attention: words that a model of a fixed vocabulary was not trained on are not told it") {
    const TinyModel model;
    const auto bundle = load_shared(model);
    DOCTEST_CHECK(bundle->model_prompt("A shiny red * bear, front view") == "a red * bear, front view");
    DOCTEST_CHECK(
        torch::equal(bundle->token_ids({"a very shiny red bear"}), bundle->token_ids({"a red bear"})));
    BundleAttentionSource source(bundle, {});
    const Image picture = gradient_image(32, 32);
    const auto maps = [&](const std::string& sentence) {
        return source.locate({picture, sentence, {"bear"}})[0].data;
    };
    DOCTEST_CHECK(maps("a shiny red bear") == maps("a red bear"));
    DOCTEST_CHECK(maps("a blue bear") != maps("a red bear"));
    auto open = load_bundle(model.path());
    open.facts.vocabulary.clear();  // it takes any word
    DOCTEST_CHECK(open.model_prompt("A shiny red bear") == "A shiny red bear");
    DOCTEST_CHECK(!torch::equal(open.token_ids({"a shiny red bear"}), open.token_ids({"a red bear"})));
}

DOCTEST_TEST_CASE(
    "attention source: the noise levels that are named are those looked at; others are refused in a "
    "sentence") {
    const TinyModel model;
    const edit::AttentionQuery query{gradient_image(32, 32), "a red bear", {"bear"}};
    const auto looked = [&](const std::string& levels) {
        AttentionParameters parameters;
        parameters.levels = levels;
        return BundleAttentionSource(load_shared(model), parameters).locate(query)[0].data;
    };
    DOCTEST_CHECK(looked("") == looked(" 0.45"));  // what is looked at where neither model nor recipe says
    DOCTEST_CHECK(looked("0.3 0.5 0.7") != looked("0.45"));
    for (const char* wrong : {"1.5", "half", "0.5,0.7", "nan"})
        DOCTEST_CHECK(contains(message_of([&] { looked(wrong); }), "noise level"));
}

DOCTEST_TEST_CASE("attention accumulator: a hand-made map comes back") {
    AttentionAccumulator sum(4, 2);
    auto probabilities = torch::zeros({1, 2, 16, 2});  // heads 2, 4x4, two columns
    probabilities.index_put_({0, 0, 5, 0}, 1.0);
    probabilities.index_put_({0, 1, 5, 0}, 0.5);
    probabilities.index_put_({0, torch::indexing::Slice(), 10, 1}, 0.25);
    std::vector<AttentionCapture::Map> maps = {{"a", 4, 4, probabilities},
                                               {"b", 2, 2, torch::full({1, 2, 4, 2}, 0.5)}};
    sum.take(maps);
    DOCTEST_CHECK(maps.empty());
    const auto mean = sum.mean();
    DOCTEST_CHECK(mean[0][1][1].item<float>() == doctest::Approx((0.75 + 0.5) / 2));
    DOCTEST_CHECK(mean[1][2][2].item<float>() == doctest::Approx((0.25 + 0.5) / 2));
    DOCTEST_CHECK(mean[0][3][3].item<float>() == doctest::Approx(0.25));
}

DOCTEST_TEST_CASE(
    "attention accumulator: refinement gives a map what its pixels attend to; the largest affinity counts") {
    AttentionAccumulator sum(2, 1);
    const auto seen = torch::tensor({1.0f, 0.0f, 0.5f, 0.0f}).reshape({1, 1, 4, 1});
    std::vector<AttentionCapture::Map> maps = {{"a", 2, 2, seen}};
    sum.take(maps);
    DOCTEST_CHECK(torch::equal(sum.refined(2), sum.mean()));  // nothing to refine with
    const auto pairs = torch::tensor({0.5f, 0.5f, 0.0f, 0.0f, 0.5f, 0.5f, 0.0f, 0.0f, 0.0f, 0.0f, 0.5f, 0.5f,
                                      0.0f, 0.0f, 0.5f, 0.5f})
                           .reshape({1, 4, 4});
    std::vector<AttentionCapture::Map> affinities = {{"a", 1, 1, torch::ones({1, 1, 1})}, {"b", 2, 2, pairs}};
    sum.take_affinities(affinities);
    DOCTEST_CHECK(affinities.empty());
    DOCTEST_CHECK(torch::equal(sum.refined(0), sum.mean()));
    const auto expected = torch::tensor({0.5f, 0.5f, 0.25f, 0.25f}).reshape({1, 2, 2});
    DOCTEST_CHECK(torch::allclose(sum.refined(1), expected));
    DOCTEST_CHECK(torch::allclose(sum.refined(3), expected));  // pairs share all they have already
}

DOCTEST_TEST_CASE("sds guidance: repeatable gradient at the render's size, silent when nothing is asked") {
    for (const char* prediction : {"epsilon", "v_prediction"}) {
        const TinyModel model(prediction);
        const auto bundle = load_shared(model);
        const Image image = gradient_image(48, 40);
        const View view;
        SdsParameters parameters;
        SdsGuidance guidance(bundle, "a red bear", parameters);
        const auto first = guidance.evaluate(input_at(image, view, 3));
        DOCTEST_CHECK(first.gradient.width == 48);
        DOCTEST_CHECK(first.gradient.height == 40);
        DOCTEST_CHECK(first.scalars.at("gradient_norm") > 0);
        DOCTEST_CHECK(std::all_of(first.gradient.data.begin(), first.gradient.data.end(),
                                  [](float v) { return std::isfinite(v); }));
        DOCTEST_CHECK(guidance.evaluate(input_at(image, view, 3)).gradient.data == first.gradient.data);
        parameters.weight = 0;
        DOCTEST_CHECK(SdsGuidance(bundle, "a red bear", parameters)
                          .evaluate(input_at(image, view, 3))
                          .scalars.at("gradient_norm") == 0);
    }
}

DOCTEST_TEST_CASE(
    "sds guidance: a picture that makes the model overflow gives a gradient that says so, and no error") {
    const TinyModel model;
    const auto bundle = load_shared(model);
    Image image = gradient_image(48, 40);
    image.data[100] = std::numeric_limits<float>::quiet_NaN();
    const View view;
    SdsGuidance guidance(bundle, "a red bear", SdsParameters{});
    const auto output = guidance.evaluate(input_at(image, view, 3));
    DOCTEST_CHECK(output.gradient.width == 48);
    DOCTEST_CHECK(output.gradient.height == 40);
    DOCTEST_CHECK(std::none_of(output.gradient.data.begin(), output.gradient.data.end(),
                               [](float v) { return std::isfinite(v); }));
    DOCTEST_CHECK(output.scalars.count("loss") == 0);
    const Image sound = gradient_image(48, 40);  // the next step is as if nothing had been
    DOCTEST_CHECK(
        guidance.evaluate(input_at(sound, view, 4)).gradient.data ==
        SdsGuidance(bundle, "a red bear", SdsParameters{}).evaluate(input_at(sound, view, 4)).gradient.data);
}

DOCTEST_TEST_CASE("sds guidance: the pull on the unedited picture is taken off") {
    const TinyModel model;
    const auto bundle = load_shared(model);
    const Image original = gradient_image(32, 32);
    Image changed = original;
    for (auto& value : changed.data) value = 1 - value;
    const View view;
    const auto gradient = [&](const Image& shown, const Image* before, const std::string& sentence,
                              double delta) {
        SdsParameters parameters;
        parameters.clamp = 0;  // what is clamped does not add up
        parameters.before_prompt = sentence;
        parameters.delta = delta;
        auto input = input_at(shown, view, 3);
        input.original = before;
        return SdsGuidance(bundle, "a red bear", parameters).evaluate(input);
    };
    const auto plain = gradient(changed, nullptr, "a bear", 1).gradient.data;
    DOCTEST_CHECK(gradient(changed, &original, "", 1).gradient.data == plain);
    DOCTEST_CHECK(gradient(changed, &original, "a bear", 0).gradient.data == plain);
    // The sentence says nothing.
    DOCTEST_CHECK(gradient(changed, &original, "a red bear", 1).gradient.data == plain);
    // An unedited picture under a sentence of the same words has nothing left to change.
    constexpr double Rounding = 1e-5;  // of the plain gradient: one forward pass more in fp32
    DOCTEST_CHECK(gradient(original, &original, "A red bear", 1).scalars.at("gradient_norm") <=
                  Rounding * gradient(original, nullptr, "", 1).scalars.at("gradient_norm"));
    const auto whole = gradient(changed, &original, "a bear", 1).gradient.data;
    const auto half = gradient(changed, &original, "a bear", 0.5).gradient.data;
    DOCTEST_CHECK(whole != plain);
    double largest = 0, off = 0;
    for (std::size_t i = 0; i < half.size(); ++i) {
        largest = std::max(largest, std::abs(static_cast<double>(plain[i])));
        off = std::max(off, std::abs(half[i] - 0.5 * (static_cast<double>(plain[i]) + whole[i])));
    }
    DOCTEST_CHECK(off <= Rounding * largest);
}

DOCTEST_TEST_CASE("sds guidance: the gradient is that of the latents, back through resize and encoder") {
    const TinyModel model;
    const auto bundle = load_shared(model);
    SdsParameters parameters;
    parameters.sample_posterior = false;
    parameters.t_min = parameters.t_max_start = parameters.t_max_end = 0.4;
    parameters.clamp = 0;
    const Image image = gradient_image(32, 32);
    const View view;
    const auto output = SdsGuidance(bundle, "a red bear", parameters).evaluate(input_at(image, view, 0));
    DOCTEST_CHECK(output.scalars.at("timestep") == 400);
    // Directional derivative of sum(latents * g / n) by central differences in double precision.
    auto vae = load_bundle(model.path()).vae;
    vae->to(torch::kFloat64);
    const auto x = to_tensor(image, torch::kCPU).to(torch::kFloat64);
    torch::manual_seed(3);
    const auto direction = torch::randn_like(x);
    const torch::NoGradGuard no_grad;
    const auto latents_at = [&](double step) {
        return vae->encode_moments((x + step * direction) * 2 - 1).mean * bundle->scaling_factor();
    };
    constexpr double Step = 1e-4, Tolerance = 1e-3;  // of the value; fp32 gradient against fp64 differences
    Random random(99);
    draw_timestep(parameters, 0, bundle->schedule.steps(), random);
    const auto noise = seeded_noise(latents_at(0).sizes(), random.next());
    const auto g =
        sds_gradient(*bundle, latents_at(0).to(torch::kFloat32),
                     {noise, 400, parameters.guidance_scale, bundle->encode_prompts({"", "a red bear"})})
            .gradient;
    const double expected = ((latents_at(Step) - latents_at(-Step)) / (2 * Step) * g).sum().item<double>() /
                            static_cast<double>(g.numel());
    const double actual = (to_tensor(output.gradient, torch::kCPU) * direction).sum().item<double>();
    DOCTEST_CHECK(std::abs(actual - expected) <= Tolerance * std::abs(expected));
}

DOCTEST_TEST_CASE("sds guidance: timesteps stay within the annealed range") {
    SdsParameters parameters;
    parameters.t_min = 0.1;
    parameters.t_max_start = 0.9;
    parameters.t_max_end = 0.3;
    Random random(5);
    for (const double progress : {0.0, 0.5, 1.0}) {
        const auto high = static_cast<std::int64_t>(std::llround((0.9 - 0.6 * progress) * 1000));
        std::int64_t lowest = 1000, highest = 0;
        for (int i = 0; i < 2000; ++i) {
            const auto t = draw_timestep(parameters, progress, 1000, random);
            lowest = std::min(lowest, t);
            highest = std::max(highest, t);
        }
        DOCTEST_CHECK(lowest >= 100);
        DOCTEST_CHECK(highest <= high);
        DOCTEST_CHECK(highest > high - 20);  // 2000 draws reach the last 2 %
    }
    parameters.t_max_end = 0.01;  // below t_min: the range collapses to t_min
    DOCTEST_CHECK(draw_timestep(parameters, 1, 1000, random) == 100);
}

DOCTEST_TEST_CASE("samplers: image to image with strength 0.75 of 50 steps starts at 721 and has 37 steps") {
    const NoiseSchedule schedule{SchedulerConfig{}};
    const auto sampler = make_sampler(SamplerKind::Ddim, schedule, 50);
    const auto first = first_step(sampler->step_count(), 0.75);
    DOCTEST_CHECK(sampler->step_count() - first == 37);
    DOCTEST_CHECK(sampler->timestep(first) == 721);
    DOCTEST_CHECK(sampler->timestep(sampler->step_count() - 1) == 1);
}

DOCTEST_TEST_CASE("samplers: with an oracle that knows the clean sample, every sampler ends there") {
    const NoiseSchedule schedule{SchedulerConfig{}};
    const auto target = torch::randn({1, 4, 4, 4});
    using enum SamplerKind;
    for (const auto kind : {Ddim, Euler, EulerAncestral, Pndm, DpmSolverPp2M, Ddpm}) {
        const auto sampler = make_sampler(kind, schedule, 20);
        auto x = torch::randn({1, 4, 4, 4}) * sampler->initial_sigma();
        for (std::int64_t i = 0; i < sampler->step_count(); ++i) {
            const auto t = torch::full({1}, static_cast<std::int64_t>(sampler->timestep(i)), torch::kInt64);
            const auto in = sampler->scale_input(x, i);
            const double a = schedule.alpha_cumprod(t.item<std::int64_t>());
            const auto epsilon = (in - std::sqrt(a) * target) / std::sqrt(1 - a);
            x = sampler->step(epsilon, x, i, torch::randn_like(x));
        }
        // DDIM and PNDM end at alphas_cumprod[0], DDPM at its last step: a little noise is left over.
        constexpr double Leftover = 0.2;
        DOCTEST_CHECK((x - target).abs().max().item<double>() < Leftover);
    }
}

DOCTEST_TEST_CASE("images: resizing keeps the mean and flows gradient to every pixel") {
    for (const auto& [width, height] :
         {std::pair(64, 64), std::pair(16, 16), std::pair(100, 24), std::pair(32, 32)}) {
        const auto image = to_tensor(gradient_image(width, height), torch::kCPU).requires_grad_(true);
        const auto resized = resize_square(image, 32);
        DOCTEST_CHECK(resized.size(2) == 32);
        DOCTEST_CHECK(resized.size(3) == 32);
        DOCTEST_CHECK(resized.mean().item<float>() ==
                      doctest::Approx(image.mean().item<float>()).epsilon(0.02));
        const auto gradient = torch::autograd::grad({resized.sum()}, {image})[0];
        DOCTEST_CHECK(gradient.min().item<float>() > 0);
    }
    const Image image = gradient_image(5, 7);
    DOCTEST_CHECK(to_image(to_tensor(image, torch::kCPU)).data == image.data);
}

DOCTEST_TEST_CASE(
    "model: samples are repeatable images in [0,1]; weak img2img stays near the decoded image") {
    const TinyModel model;
    const auto loaded = load_model(model.path(), "cpu");
    SampleRequest request;
    request.prompt = "a red bear";
    request.steps = 3;
    const auto sample = loaded->sample(request);
    DOCTEST_CHECK(sample.width == loaded->image_size());
    DOCTEST_CHECK(loaded->sample(request).data == sample.data);
    DOCTEST_CHECK(
        std::all_of(sample.data.begin(), sample.data.end(), [](float v) { return v >= 0 && v <= 1; }));
    request.seed = 1;
    DOCTEST_CHECK(loaded->sample(request).data != sample.data);
    const Image image = gradient_image(32, 32);
    request.strength = 0.34;
    DOCTEST_CHECK(loaded->img2img(image, request).width == loaded->image_size());
    DOCTEST_CHECK(loaded->known_words() == tiny_words());
}
