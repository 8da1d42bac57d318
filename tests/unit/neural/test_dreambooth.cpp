// DreamBooth on tiny models: what it learns, what it keeps, that it repeats, can be stopped and undone; LoRA
// files.
#include <cmath>
#include <limits>

#include "engine/neural/diffusion/pipelines.h"
#include "engine/neural/guidance/dreambooth.h"
#include "engine/neural/model.h"
#include "tests/unit/neural/tiny_model.h"

using namespace gse;
using namespace gse::neural;
using namespace gse::test;

namespace {

/// Four looks at one thing: a bright disc on a dark ground that moves a little.
std::vector<Image> scene_pictures() {
    std::vector<Image> pictures;
    for (int view = 0; view < 4; ++view) {
        Image picture(32, 32, 3, 0.1f);
        for (int y = 0; y < 32; ++y)
            for (int x = 0; x < 32; ++x)
                if ((x - 14 - view) * (x - 14 - view) + (y - 16) * (y - 16) < 64) {
                    picture.at(x, y, 0) = 0.9f;
                    picture.at(x, y, 1) = 0.3f + 0.1f * static_cast<float>(view);
                }
        pictures.push_back(std::move(picture));
    }
    return pictures;
}

DreamBoothParameters small_parameters() {
    DreamBoothParameters parameters;
    parameters.steps = 40;
    parameters.class_images = 6;
    parameters.class_steps = 3;
    parameters.learning_rate = 5e-3;
    parameters.lora_learning_rate = 2e-2;
    parameters.threads = 1;
    return parameters;
}

const char* const InstancePrompt = "a photo of a bear";
const char* const ClassPrompt = "a red bear";

TuningResult tuned(const ModelBundle& bundle, const DreamBoothParameters& parameters) {
    const auto pictures = scene_pictures();
    return run_dreambooth(bundle, parameters, {pictures, InstancePrompt, ClassPrompt}, {});
}

Image sample_of(const TextToImage& model) {
    SampleRequest request;
    request.prompt = ClassPrompt;
    request.steps = 2;
    return model.sample(request);
}

/// A LoRA file holds fp32; merging it again may round once.
constexpr double MergeTolerance = 1e-6;

}  // namespace

DOCTEST_TEST_CASE("dreambooth: learns the scene and, with prior preservation, keeps the class") {
    for (const char* prediction : {"epsilon", "v_prediction"}) {
        const TinyModel model(prediction);
        const auto bundle = load_bundle(model.path());
        auto parameters = small_parameters();
        const auto kept = tuned(bundle, parameters).report;
        DOCTEST_CHECK(kept.steps == parameters.steps);
        DOCTEST_CHECK(kept.skipped == 0);
        DOCTEST_CHECK(kept.instance_after < 0.8 * kept.instance_before);
        DOCTEST_CHECK(kept.prior_after < kept.prior_before);
        // The same class pictures, but they do not count.
        parameters.prior_weight = 1e-12;
        const auto drifted = tuned(bundle, parameters).report;
        DOCTEST_CHECK(drifted.prior_before == doctest::Approx(kept.prior_before));
        DOCTEST_CHECK(drifted.instance_after < drifted.instance_before);
        DOCTEST_CHECK(kept.prior_after < drifted.prior_after);
    }
}

DOCTEST_TEST_CASE("dreambooth: without class pictures there is no prior") {
    const TinyModel model;
    const auto bundle = load_bundle(model.path());
    auto parameters = small_parameters();
    parameters.steps = 3;
    parameters.prior_weight = 0;
    const auto report = tuned(bundle, parameters).report;
    DOCTEST_CHECK(report.prior_losses.empty());
    DOCTEST_CHECK(report.prior_before == 0);
    DOCTEST_CHECK(report.instance_losses.size() == 3);
}

DOCTEST_TEST_CASE(
    "dreambooth: one seed, one result, with one thread or two; the model itself is never written to") {
    const TinyModel model;
    const auto bundle = load_bundle(model.path());
    const auto before = tensors_of(bundle.unet);
    std::vector<torch::Tensor> copies;
    for (const auto& [name, tensor] : before) copies.push_back(tensor.clone());
    for (const int rank : {0, 2}) {
        auto parameters = small_parameters();
        parameters.steps = 6;
        parameters.rank = rank;
        const auto first = tuned(bundle, parameters);
        parameters.threads = 2;
        const auto second = tuned(bundle, parameters);
        parameters.seed = 1;
        const auto other = tuned(bundle, parameters);
        const auto a = tensors_of(first.bundle->unet), b = tensors_of(second.bundle->unet),
                   c = tensors_of(other.bundle->unet);
        bool moved = false, differs = false;
        for (std::size_t i = 0; i < a.size(); ++i) {
            DOCTEST_CHECK_MESSAGE(torch::equal(a[i].second, b[i].second), a[i].first);
            moved |= !torch::equal(a[i].second, before[i].second);
            differs |= !torch::equal(a[i].second, c[i].second);
        }
        DOCTEST_CHECK(moved);
        DOCTEST_CHECK(differs);
        DOCTEST_CHECK(first.report.instance_losses == second.report.instance_losses);
    }
    for (std::size_t i = 0; i < copies.size(); ++i)
        DOCTEST_CHECK_MESSAGE(torch::equal(copies[i], before[i].second), before[i].first);
}

DOCTEST_TEST_CASE(
    "dreambooth: tuning gives another model; the one it was asked of stays as it was, also on a stop") {
    const TinyModel model;
    const auto loaded = load_model(model.path(), "cpu");
    const auto pictures = scene_pictures();
    auto parameters = small_parameters();
    parameters.steps = 5;
    const auto original = sample_of(*loaded).data;
    for (const auto* stage : {"class pictures", "tuning"}) {
        std::stop_source stop;
        JobControl job;
        job.stop = stop.get_token();
        job.progress = [&](std::string_view at, int step, int) {
            if (at == stage && step > 0) stop.request_stop();
        };
        DOCTEST_CHECK(contains(
            message_of([&] { loaded->tune(parameters, pictures, InstancePrompt, ClassPrompt, job); }),
            "stopped"));
        DOCTEST_CHECK(sample_of(*loaded).data == original);
    }
    const auto old_guidance = loaded->guidance(ClassPrompt, SdsParameters{});
    const View view;
    const auto pulled = [&](edit::Guidance& guidance) {
        edit::GuidanceInput input{pictures[0], view};
        input.seed = 4;
        return guidance.evaluate(input).gradient.data;
    };
    const auto before = pulled(*old_guidance);
    auto first = loaded->tune(parameters, pictures, InstancePrompt, ClassPrompt, {});
    DOCTEST_CHECK(first.report.steps == parameters.steps);
    const auto learned = sample_of(*first.model).data;
    DOCTEST_CHECK(learned != original);
    DOCTEST_CHECK(pulled(*first.model->guidance(ClassPrompt, SdsParameters{})) != before);
    DOCTEST_CHECK(pulled(*old_guidance) == before);
    DOCTEST_CHECK(pulled(*loaded->guidance(ClassPrompt, SdsParameters{})) == before);
    DOCTEST_CHECK(sample_of(*loaded).data == original);
    // A tuned model's tuning begins at the loaded weights; the two share nothing that changes.
    const auto again = first.model->tune(parameters, pictures, InstancePrompt, ClassPrompt, {});
    DOCTEST_CHECK(sample_of(*again.model).data == learned);
    parameters.seed = 1;
    const auto other = loaded->tune(parameters, pictures, InstancePrompt, ClassPrompt, {});
    DOCTEST_CHECK(sample_of(*other.model).data != learned);
    DOCTEST_CHECK(sample_of(*first.model).data == learned);
    first.model.reset();
    DOCTEST_CHECK(sample_of(*loaded).data == original);
}

DOCTEST_TEST_CASE("dreambooth: a step that is not finite is left out and counted; no pictures are refused") {
    const TinyModel model;
    const auto bundle = load_bundle(model.path());
    auto parameters = small_parameters();
    DreamBoothTrainer trainer(bundle, parameters);
    const auto ids = bundle.token_ids({InstancePrompt});
    const auto latents = seeded_noise({1, 4, 8, 8}, 1);
    TuningBatch batch{ids, latents, seeded_noise({1, 4, 8, 8}, 2), torch::tensor({std::int64_t{300}})};
    auto broken = batch;
    broken.noise = torch::full({1, 4, 8, 8}, std::numeric_limits<float>::infinity());
    const double loss = trainer.loss_of(batch);
    DOCTEST_CHECK(trainer.step(broken, nullptr).skipped);
    DOCTEST_CHECK(trainer.loss_of(batch) == loss);
    DOCTEST_CHECK(trainer.step(batch, &broken).skipped);
    DOCTEST_CHECK(trainer.loss_of(batch) == loss);
    DOCTEST_CHECK(!trainer.step(batch, nullptr).skipped);
    DOCTEST_CHECK(trainer.loss_of(batch) != loss);
    DOCTEST_CHECK(contains(message_of([&] {
                               run_dreambooth(bundle, parameters, {{}, InstancePrompt, ClassPrompt}, {});
                           }),
                           "pictures"));
    std::vector<Image> pictures = scene_pictures();
    pictures[1].at(3, 3, 1) = std::numeric_limits<float>::quiet_NaN();
    DOCTEST_CHECK(
        contains(message_of([&] {
                     run_dreambooth(bundle, parameters, {pictures, InstancePrompt, ClassPrompt}, {});
                 }),
                 "finite"));
}

DOCTEST_TEST_CASE("dreambooth: one gradient value that is not finite costs one step, which is counted") {
    const TinyModel model;
    const auto bundle = load_bundle(model.path());
    TuningBatch batch{bundle.token_ids({InstancePrompt}), seeded_noise({1, 4, 8, 8}, 1),
                      seeded_noise({1, 4, 8, 8}, 2), torch::tensor({std::int64_t{300}})};
    for (const int rank : {0, 2}) {
        auto parameters = small_parameters();
        parameters.rank = rank;
        DreamBoothTrainer trainer(bundle, parameters);
        TuneReport report;
        const double loss = trainer.loss_of(batch);
        auto step = trainer.accumulate(batch, nullptr);
        const auto weights = trainer.trained();
        const auto moved = std::find_if(weights.begin(), weights.end(),
                                        [](const auto& named) { return named.second.grad().defined(); });
        DOCTEST_REQUIRE(moved != weights.end());
        moved->second.grad().view({-1})[0] = std::numeric_limits<float>::quiet_NaN();
        trainer.apply(step);
        DOCTEST_CHECK(std::isfinite(step.loss));
        DOCTEST_CHECK(step.skipped);
        DOCTEST_CHECK(trainer.loss_of(batch) == loss);
        count_step(report, step, 3);
        const auto next = trainer.step(batch, nullptr);
        DOCTEST_CHECK(!next.skipped);
        DOCTEST_CHECK(std::isfinite(trainer.loss_of(batch)));
        count_step(report, next, 3);
        DOCTEST_CHECK(report.steps == 2);
        DOCTEST_CHECK(report.skipped == 1);
        DOCTEST_CHECK(contains(message_of([&] { count_step(report, step, 3); }), "2 of the first 3"));
    }
}

DOCTEST_TEST_CASE(
    "dreambooth: a tuning most of whose steps are not finite ends in an error that says so, and early") {
    const TinyModel model;
    const auto bundle = load_bundle(model.path());
    auto parameters = small_parameters();
    parameters.class_images = 0;
    parameters.learning_rate = 1e30;
    int last = 0;
    JobControl job;
    job.progress = [&](std::string_view, int step, int) { last = step; };
    const auto pictures = scene_pictures();
    const auto message = message_of([&] {
        run_dreambooth(bundle, parameters, {pictures, InstancePrompt, ClassPrompt}, job);
    });
    DOCTEST_CHECK_MESSAGE(contains(message, "21 of the first 22 tuning steps were not finite"), message);
    DOCTEST_CHECK(last == 21);
}

DOCTEST_TEST_CASE(
    "lora: learns, changes the attention projections only, and W + alpha/r up down is what comes out") {
    const TinyModel model;
    const auto bundle = load_bundle(model.path());
    auto parameters = small_parameters();
    parameters.rank = 2;
    const auto result = tuned(bundle, parameters);
    DOCTEST_CHECK(result.report.instance_after < result.report.instance_before);
    DOCTEST_REQUIRE(result.lora.has_value());
    const auto& factors = result.lora->unet;
    DOCTEST_CHECK(factors.size() == lora_targets(*bundle.unet).size());
    DOCTEST_CHECK(factors.size() % 8 == 0);  // q, k, v, out of two attentions per transformer
    std::map<std::string, const LoraFactor*> by_layer;
    for (const auto& factor : factors) by_layer[factor.layer] = &factor;
    const auto before = tensors_of(bundle.unet), after = tensors_of(result.bundle->unet);
    std::size_t changed = 0;
    for (std::size_t i = 0; i < before.size(); ++i) {
        auto layer = before[i].first.substr(0, before[i].first.rfind('.'));
        std::replace(layer.begin(), layer.end(), '.', '_');
        const auto found = before[i].first.ends_with(".weight") ? by_layer.find(layer) : by_layer.end();
        if (found == by_layer.end()) {
            DOCTEST_CHECK_MESSAGE(torch::equal(before[i].second, after[i].second), before[i].first);
            continue;
        }
        ++changed;
        const auto& factor = *found->second;
        const auto expected = before[i].second + factor.up.mm(factor.down) * (factor.alpha / 2.0);
        DOCTEST_CHECK((after[i].second - expected).abs().max().item<double>() <= MergeTolerance);
        DOCTEST_CHECK(factor.up.abs().max().item<double>() > 0);
    }
    DOCTEST_CHECK(changed == factors.size());
}

DOCTEST_TEST_CASE("lora: kohya's file there and back") {
    const TinyModel model;
    const auto loaded = load_model(model.path(), "cpu");
    const ScratchFolder scratch;
    const auto path = scratch.path() / "tuned.safetensors";
    DOCTEST_CHECK(contains(message_of([&] { loaded->save_lora(path); }), "LoRA"));
    const auto pictures = scene_pictures();
    auto parameters = small_parameters();
    parameters.steps = 10;
    parameters.rank = 3;
    const auto original = sample_of(*loaded).data;
    const auto tuned_model = loaded->tune(parameters, pictures, InstancePrompt, ClassPrompt, {}).model;
    const auto tuned_sample = sample_of(*tuned_model).data;
    tuned_model->save_lora(path);
    const SafetensorsFile file(path);
    const std::string stem = "lora_unet_down_blocks_0_attentions_0_transformer_blocks_0_attn1_to_out_0";
    DOCTEST_CHECK(file.contains(stem + ".lora_down.weight"));
    DOCTEST_CHECK(file.contains("lora_te_text_model_encoder_layers_0_self_attn_q_proj.lora_up.weight"));
    DOCTEST_CHECK(file.tensor(stem + ".alpha").item<float>() == 3.0f);
    DOCTEST_CHECK(file.tensor(stem + ".lora_down.weight").sizes() == torch::IntArrayRef({3, 16}));
    DOCTEST_CHECK(sample_of(*loaded->load_lora(path, 0.0)).data == original);
    DOCTEST_CHECK(sample_of(*loaded->load_lora(path)).data == tuned_sample);

    auto weights = read_lora(path);
    weights.unet.front().layer = "no_such_layer";
    write_lora(path, weights);
    DOCTEST_CHECK(contains(loaded->load_lora(path)->notes().front(), "no_such_layer"));
    write_lora(path, {{weights.unet.front()}, {}});
    DOCTEST_CHECK(contains(message_of([&] { loaded->load_lora(path); }), "no_such_layer"));
    weights = {{LoraFactor{"conv_in", torch::ones({1, 5, 3, 3}), torch::ones({16, 1, 1, 1}), 1}}, {}};
    write_lora(path, weights);
    DOCTEST_CHECK(contains(message_of([&] { loaded->load_lora(path); }), "shape"));
    DOCTEST_CHECK(sample_of(*loaded).data == original);  // whatever was read, merged or refused
    write_safetensors(path, {{"lora_unet_x.hada_w1_a", torch::ones({1})}});
    DOCTEST_CHECK(contains(message_of([&] { loaded->load_lora(path); }), "hada"));
}

DOCTEST_TEST_CASE("lora: a convolution's change is the composition of its two") {
    torch::manual_seed(1);
    const LoraFactor factor{"conv", torch::randn({2, 3, 3, 3}), torch::randn({5, 2, 1, 1}), 4};
    const auto weight = torch::randn({5, 3, 3, 3}), x = torch::randn({1, 3, 7, 7});
    const auto expected = torch::conv2d(x, weight, {}, 1, 1) +
                          torch::conv2d(torch::conv2d(x, factor.down, {}, 1, 1), factor.up) * (4.0 / 2.0);
    constexpr double Tolerance = 1e-4;  // fp32, sums of 27 products of magnitude 1
    const auto actual = torch::conv2d(x, weight + factor.change_of(weight), {}, 1, 1);
    DOCTEST_CHECK((actual - expected).abs().max().item<double>() <= Tolerance);
}

DOCTEST_TEST_CASE(
    "lora: merged weights are of the type that they were loaded in, and what does not change is not stored "
    "twice") {
    const TinyModel model;
    auto bundle = load_bundle(model.path());
    bundle.unet->to(torch::kBFloat16);
    const auto targets = lora_targets(*bundle.unet);
    auto factors = new_lora({targets.front()}, 2, 3);
    for (auto& factor : factors) factor.up.fill_(0.5);
    const auto merged = with_lora(bundle, {factors, {}}, 1);
    const auto before = bundle.unet->named_parameters(), after = merged.unet->named_parameters();
    std::size_t changed = 0;
    for (const auto& item : before) {
        const auto& now = after[item.key()];
        DOCTEST_CHECK((now.scalar_type() == torch::kBFloat16));
        if (now.data_ptr() != item.value().data_ptr()) ++changed;
    }
    DOCTEST_CHECK(changed == 1);
    DOCTEST_CHECK(merged.text_encoder->parameters().front().data_ptr() ==
                  bundle.text_encoder->parameters().front().data_ptr());
}
