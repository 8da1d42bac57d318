// A UNet in bfloat16 is as near to fp32 as rounding allows, and no nearer: it really computes in it
// (goldens/precision).
#include "engine/neural/diffusion/unet.h"
#include "engine/neural/layers/precision.h"
#include "engine/neural/weights/key_map.h"
#include "engine/neural/weights/weights.h"
#include "tests/golden/neural/golden_case.h"
#include "tests/test_paths.h"

using namespace gse;
using namespace gse::neural;
using namespace gse::test;

namespace {

constexpr double MostOfAll = 1.5;  // times the emulated error with every result rounded: the case's README
constexpr double LeastOfOperands = 0.3;  // times the emulated error with operands rounded only

double relative_error(const torch::Tensor& value, const torch::Tensor& expected) {
    return ((value - expected).norm() / expected.norm()).item<double>();
}

void check_error(const Json& bounds, const torch::Tensor& value, const torch::Tensor& expected) {
    const double error = relative_error(value, expected);
    DOCTEST_CHECK(error <= MostOfAll * bounds.at("bf16_all").at("max").get<double>());
    DOCTEST_CHECK(error >= LeastOfOperands * bounds.at("bf16_operands").at("min").get<double>());
}

}  // namespace

DOCTEST_TEST_CASE("bf16: the UNet's error is that of rounding (precision)") {
    const GoldenCase precision("precision");
    if (!precision.present) return;
    if (!multiplies_bfloat16(torch::kCPU)) {
        test::skip("this processor does not compute in bfloat16");
        return;
    }
    const auto all_bounds = precision.json("precision.json");
    for (const std::string name : {"unet_sd1", "unet_sd2"}) {
        DOCTEST_INFO(name);
        const GoldenCase golden(name);
        if (!golden.present) continue;
        UNet unet(UNetConfig::from_json(golden.json("config.json"), golden.folder / "config.json"),
                  WeightOptions{torch::kCPU, torch::kBFloat16, false});
        load_weights(*unet, golden.tensors("diffusion_pytorch_model.safetensors"), unet_plan());
        const auto& bounds = all_bounds.at(name);
        const auto io = golden.tensors();
        const torch::NoGradGuard no_grad;
        const auto sample = io.tensor("sample"), context = io.tensor("encoder_hidden_states");
        for (const std::string t : {"t0", "t1"})
            check_error(bounds.at("out_" + t), unet->forward(sample, io.tensor(t), context),
                        io.tensor("out_" + t));
        check_error(
            bounds.at("out_odd"),
            unet->forward(io.tensor("sample_odd"), io.tensor("t0"), io.tensor("encoder_hidden_states_odd")),
            io.tensor("out_odd"));
    }
}
