// Properties of attention, norms and captures that hold for any weights.
#include "engine/neural/api/network_use.h"
#include "engine/neural/diffusion/unet.h"
#include "engine/neural/layers/blocks.h"
#include "tests/unit/neural/tiny_model.h"

using namespace gse;
using namespace gse::neural;
using namespace gse::test;

namespace {

constexpr double FloatNoise = 1e-5;  // fp32 sums in another order
constexpr double Bf16Noise = 0.05;   // bfloat16 keeps 8 bits: relative error of a deep network's output

double difference(const torch::Tensor& a, const torch::Tensor& b) {
    return (a - b).abs().max().item<double>();
}

torch::Tensor plain_attention(const torch::Tensor& q, const torch::Tensor& k, const torch::Tensor& v,
                              std::int64_t heads) {
    std::vector<torch::Tensor> outputs;
    const auto qs = q.chunk(heads, 2), ks = k.chunk(heads, 2), vs = v.chunk(heads, 2);
    for (std::size_t h = 0; h < qs.size(); ++h) {
        const auto scores =
            torch::matmul(qs[h], ks[h].transpose(1, 2)) / std::sqrt(static_cast<double>(qs[h].size(2)));
        outputs.push_back(torch::matmul(scores.softmax(-1), vs[h]));
    }
    return torch::cat(outputs, 2);
}

}  // namespace

DOCTEST_TEST_CASE("attention: in pieces, with a graph and by the definition agree") {
    torch::manual_seed(1);
    // 2 heads of 3000 x 3000 scores are more than one piece may hold.
    for (const std::int64_t tokens : {5, 3000}) {
        const auto q = torch::randn({1, tokens, 8}), k = torch::randn({1, tokens, 8}),
                   v = torch::randn({1, tokens, 8});
        AttentionRequest request;
        request.heads = 2;
        const auto expected = plain_attention(q, k, v, 2);
        {
            const torch::NoGradGuard no_grad;
            DOCTEST_CHECK(difference(attend(q, k, v, request).output, expected) < FloatNoise);
        }
        if (tokens > 100) continue;
        request.want_probabilities = true;
        const auto result = attend(q, k, v, request);
        DOCTEST_CHECK(difference(result.output, expected) < FloatNoise);
        DOCTEST_CHECK(difference(result.probabilities.sum(-1), torch::ones({1, 2, tokens})) < FloatNoise);
    }
}

DOCTEST_TEST_CASE("attention: memory full of NaN from earlier tensors does no harm") {
    const torch::NoGradGuard no_grad;
    for (int i = 0; i < 300; ++i) {
        { const auto poison = torch::full({64}, std::nan("")); }
        const auto x = torch::ones({1, 4, 4});
        DOCTEST_REQUIRE(torch::isfinite(attend(x, x, x, {}).output).all().item<bool>());
    }
}

DOCTEST_TEST_CASE("unet: captured columns are those of the full map; the conditional half is the second") {
    const torch::NoGradGuard no_grad;
    torch::manual_seed(2);
    const UNet unet(tiny_unet_config());
    const auto x = torch::randn({2, 4, 8, 8}), context = torch::randn({2, 6, 16}),
               t = torch::tensor({10, 500});
    AttentionCapture all, some;
    const auto output = unet->forward(x, t, context, &all);
    some.columns = {4, 1};
    some.conditional_half_only = true;
    some.wants = [](std::string_view layer, std::int64_t height, std::int64_t) {
        return layer.starts_with("up_blocks") && height == 8;
    };
    DOCTEST_CHECK(torch::equal(unet->forward(x, t, context, &some), output));
    DOCTEST_CHECK(torch::equal(unet->forward(x, t, context), output));
    DOCTEST_CHECK(all.maps.size() == 4);  // 1 down, 1 middle, 2 up
    DOCTEST_REQUIRE(some.maps.size() == 2);
    for (const auto& map : some.maps) {
        const auto full = std::find_if(all.maps.begin(), all.maps.end(),
                                       [&](const auto& m) { return m.layer == map.layer; });
        DOCTEST_REQUIRE(full != all.maps.end());
        const auto expected = full->probabilities.narrow(0, 1, 1).index_select(3, torch::tensor({4, 1}));
        DOCTEST_CHECK(torch::equal(map.probabilities, expected));
    }
}

DOCTEST_TEST_CASE("unet: a pass that stops after the last wanted layer captures the same for less") {
    const torch::NoGradGuard no_grad;
    torch::manual_seed(2);
    const UNet unet(tiny_unet_config());
    const auto x = torch::randn({2, 4, 8, 8}), context = torch::randn({2, 6, 16}),
               t = torch::tensor({10, 500});
    for (const std::string part : {"down_blocks", "mid_block", "up_blocks.1.attentions.0"}) {
        DOCTEST_INFO(part);
        AttentionCapture whole, stopped;
        whole.wants = stopped.wants = [&](std::string_view layer, std::int64_t, std::int64_t) {
            return layer.starts_with(part);
        };
        stopped.stop_after_last = true;
        const double before = thread_use().flop;
        DOCTEST_CHECK(unet->forward(x, t, context, &whole).defined());
        const double between = thread_use().flop;
        DOCTEST_CHECK_FALSE(unet->forward(x, t, context, &stopped).defined());
        DOCTEST_CHECK(thread_use().flop - between < between - before);
        DOCTEST_REQUIRE(whole.maps.size() == stopped.maps.size());
        for (std::size_t i = 0; i < whole.maps.size(); ++i)
            DOCTEST_CHECK(torch::equal(whole.maps[i].probabilities, stopped.maps[i].probabilities));
    }
}

DOCTEST_TEST_CASE(
    "unet: affinities are kept up to the side asked for; every pixel shares one whole among the others") {
    const torch::NoGradGuard no_grad;
    torch::manual_seed(2);
    const UNet unet(tiny_unet_config());
    const auto x = torch::randn({2, 4, 8, 8}), context = torch::randn({2, 6, 16}),
               t = torch::tensor({10, 500});
    const auto plain = unet->forward(x, t, context);
    AttentionCapture capture;
    capture.self_attention_side = 8;
    DOCTEST_CHECK(torch::allclose(unet->forward(x, t, context, &capture), plain, 1e-5, 1e-5));
    DOCTEST_REQUIRE(capture.affinities.size() == 4);  // 1 down, 1 middle, 2 up
    for (const auto& map : capture.affinities) {
        DOCTEST_CHECK(map.probabilities.sizes().vec() ==
                      std::vector<std::int64_t>{2, map.height * map.width, map.height * map.width});
        DOCTEST_CHECK(torch::allclose(map.probabilities.sum(2), torch::ones({2, map.height * map.width})));
    }
    AttentionCapture small;
    small.self_attention_side = 4;
    unet->forward(x, t, context, &small);
    DOCTEST_CHECK(small.affinities.size() == 1);  // the middle
}

DOCTEST_TEST_CASE("unet: gradients flow through captured probabilities only when asked") {
    torch::manual_seed(3);
    const UNet unet(tiny_unet_config());
    const auto x = torch::randn({1, 4, 8, 8}), context = torch::randn({1, 6, 16});
    for (const bool keep : {false, true}) {
        AttentionCapture capture;
        capture.keep_graph = keep;
        unet->forward(x, torch::tensor(100), context, &capture);
        DOCTEST_CHECK(capture.maps.front().probabilities.requires_grad() == keep);
        if (!keep) continue;
        capture.maps.front().probabilities.select(3, 2).sum().backward();
        const auto parameters = unet->named_parameters();
        const auto* weight = parameters.find(capture.maps.front().layer + ".to_k.weight");
        DOCTEST_REQUIRE(weight != nullptr);
        DOCTEST_CHECK(weight->grad().abs().sum().item<double>() > 0);
    }
}

DOCTEST_TEST_CASE("unet: bfloat16 weights stay close to fp32") {
    const torch::NoGradGuard no_grad;
    torch::manual_seed(4);
    UNet unet(tiny_unet_config());
    const auto x = torch::randn({2, 4, 8, 8}), context = torch::randn({2, 6, 16}), t = torch::tensor(300);
    const auto expected = unet->forward(x, t, context);
    unet->to(torch::kBFloat16);
    const auto actual = unet->forward(x.to(torch::kBFloat16), t, context.to(torch::kBFloat16));
    DOCTEST_CHECK((actual.scalar_type() == torch::kBFloat16));
    DOCTEST_CHECK(difference(actual.to(torch::kFloat32), expected) <
                  Bf16Noise * expected.abs().max().item<double>());
}

DOCTEST_TEST_CASE("unet: rows of a batch do not see each other, memory format does not matter") {
    const torch::NoGradGuard no_grad;
    torch::manual_seed(5);
    const UNet unet(tiny_unet_config());
    const auto x = torch::randn({3, 4, 7, 9}), context = torch::randn({3, 6, 16}),
               t = torch::tensor({1, 400, 999});
    const auto together = unet->forward(x, t, context);
    for (std::int64_t i = 0; i < 3; ++i)
        DOCTEST_CHECK(difference(unet->forward(x.narrow(0, i, 1), t.narrow(0, i, 1), context.narrow(0, i, 1)),
                                 together.narrow(0, i, 1)) < FloatNoise);
    DOCTEST_CHECK(difference(unet->forward(x.contiguous(torch::MemoryFormat::ChannelsLast), t, context),
                             together) < FloatNoise);
}

DOCTEST_TEST_CASE("weights: the same seed draws the same values") {
    UNet a(tiny_unet_config()), b(tiny_unet_config());
    init_weights(*a, 11);
    init_weights(*b, 11);
    const auto first = a->parameters(), second = b->parameters();
    bool same = true;
    for (std::size_t i = 0; i < first.size(); ++i) same = same && torch::equal(first[i], second[i]);
    DOCTEST_CHECK(same);
    init_weights(*b, 12);
    DOCTEST_CHECK(!torch::equal(a->parameters()[0], b->parameters()[0]));
}
