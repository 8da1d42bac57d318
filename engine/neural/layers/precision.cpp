// Asks the processor, then the clock.
#include "engine/neural/layers/precision.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <limits>

#include "engine/base/error.h"
#include "engine/base/log.h"

#if defined(__x86_64__)
#include <cpuid.h>
#endif

namespace gse::neural {
namespace {

constexpr std::int64_t WidestSmallUNet = 256;  // channels: below, norms and copies take longer than products
constexpr double WorthGain = 1.15;             // least ratio of the times for which rounding is accepted
constexpr int Runs = 3;

bool processor_has_bfloat16() {
#if defined(__x86_64__)
    unsigned a = 0, b = 0, c = 0, d = 0;
    const bool avx512 = __get_cpuid_count(7, 1, &a, &b, &c, &d) != 0 && (a & (1u << 5)) != 0;
    const bool amx = __get_cpuid_count(7, 0, &a, &b, &c, &d) != 0 && (d & (1u << 22)) != 0;
    return avx512 || amx;
#else
    return false;
#endif
}

}  // namespace

bool multiplies_bfloat16(const torch::Device& device) {
    if (device.is_cuda()) return true;
    return torch::hasMKLDNN() && processor_has_bfloat16();
}

double layer_seconds(const UNetConfig& config, torch::Dtype dtype) {
    const torch::NoGradGuard no_grad;
    const auto width = config.block_out_channels.front(),
               side = std::min<std::int64_t>(64, config.sample_size);
    const auto image =
        torch::zeros({1, width, side, side}).to(dtype).contiguous(torch::MemoryFormat::ChannelsLast);
    const auto kernel =
        torch::zeros({width, width, 3, 3}).to(dtype).contiguous(torch::MemoryFormat::ChannelsLast);
    const auto tokens = torch::zeros({1, side * side, width}).to(dtype),
               matrix = torch::zeros({8 * width, width}).to(dtype);
    double least = std::numeric_limits<double>::infinity();
    for (int run = 0; run <= Runs; ++run) {  // the first one prepares
        const auto begin = std::chrono::steady_clock::now();
        torch::conv2d(image, kernel, {}, 1, 1);
        torch::linear(tokens, matrix);
        const double seconds =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        if (run > 0) least = std::min(least, seconds);
    }
    return least;
}

torch::Dtype choose_precision(const std::string& setting, const UNetConfig& config,
                              const torch::Device& device) {
    if (setting == "fp32") return torch::kFloat32;
    if (setting != "auto" && setting != "bf16")
        throw Error(ErrorCode::InvalidArgument, fmt::format("there is no precision \"{}\"", setting),
                    "use auto, fp32 or bf16");
    const bool able = multiplies_bfloat16(device);
    if (setting == "bf16") {
        if (able) return torch::kBFloat16;
        throw Error(ErrorCode::InvalidArgument, "this processor does not compute in bfloat16",
                    "use the precision auto or fp32");
    }
    const auto& widths = config.block_out_channels;
    if (!able || *std::max_element(widths.begin(), widths.end()) <= WidestSmallUNet) return torch::kFloat32;
    if (device.is_cuda()) return torch::kFloat32;  // as exact as it gets, where time is no concern
    const double single = layer_seconds(config, torch::kFloat32),
                 brief = layer_seconds(config, torch::kBFloat16);
    const bool worth = brief * WorthGain < single;
    log::info("the UNet computes in {}: a layer takes {:.1f} ms in fp32, {:.1f} ms in bf16",
              worth ? "bf16" : "fp32", single * 1e3, brief * 1e3);
    return worth ? torch::kBFloat16 : torch::kFloat32;
}

}  // namespace gse::neural
