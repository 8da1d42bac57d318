// Picks the instruction set at run time. Compiled without any special flags so that it runs everywhere.
#include <cstdlib>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/raster/kernels.h"
#include "engine/raster/rasterizer.h"

namespace gse::raster {
namespace {

struct Candidate {
    const Kernels* kernels;
    bool runs_here;
};

/// Instruction sets, best first.
std::vector<Candidate> all_candidates() {
#ifdef GSE_X86
    const bool avx2 = __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0;
    const bool avx512 = avx2 && __builtin_cpu_supports("avx512f") != 0 &&
                        __builtin_cpu_supports("avx512dq") != 0 && __builtin_cpu_supports("avx512bw") != 0 &&
                        __builtin_cpu_supports("avx512vl") != 0 && __builtin_cpu_supports("popcnt") != 0;
    return {{&Avx512Kernels, avx512}, {&Avx2Kernels, avx2}, {&ScalarKernels, true}};
#else
    return {{&ScalarKernels, true}};
#endif
}

}  // namespace

const Kernels& choose_kernels(const char* name) {
    const char* forced = std::getenv("GSE_CPU");
    const std::string named = name, wanted = !named.empty() ? named : forced != nullptr ? forced : "";
    for (const Candidate& candidate : all_candidates()) {
        if (wanted.empty() && candidate.runs_here) return *candidate.kernels;
        if (wanted != candidate.kernels->name) continue;
        if (candidate.runs_here) return *candidate.kernels;
        if (!named.empty())
            throw Error(ErrorCode::Unsupported, "this processor does not run the kernels " + wanted);
        throw Error(ErrorCode::Unsupported,
                    "GSE_CPU asks for " + wanted + ", which this processor does not have",
                    "unset GSE_CPU to let the program choose");
    }
    if (!named.empty())
        throw Error(ErrorCode::InvalidArgument, "there are no kernels \"" + wanted + "\"",
                    "use scalar, avx2 or avx512");
    throw Error(ErrorCode::InvalidArgument, "GSE_CPU is \"" + wanted + "\"", "use scalar, avx2 or avx512");
}

std::vector<std::string> usable_kernels() {
    std::vector<std::string> names;
    for (const Candidate& candidate : all_candidates())
        if (candidate.runs_here) names.emplace_back(candidate.kernels->name);
    return names;
}

}  // namespace gse::raster
