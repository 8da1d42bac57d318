// Picks the instruction set at run time; compiled without any special flags so that it runs everywhere.
#include <cstdlib>
#include <string>

#include "engine/base/error.h"
#include "engine/raster/kernels.h"

namespace gse::raster {
namespace {

struct Candidate {
    const Kernels* kernels;
    bool runs_here;
};

}  // namespace

const Kernels& choose_kernels() {
    const char* forced = std::getenv("GSE_CPU");
    const std::string wanted = forced != nullptr ? forced : "";
#ifdef GSE_X86
    const bool avx2 = __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0;
    const bool avx512 = avx2 && __builtin_cpu_supports("avx512f") != 0 &&
                        __builtin_cpu_supports("avx512dq") != 0 && __builtin_cpu_supports("avx512bw") != 0 &&
                        __builtin_cpu_supports("avx512vl") != 0 && __builtin_cpu_supports("popcnt") != 0;
    const Candidate candidates[] = {{&Avx512Kernels, avx512}, {&Avx2Kernels, avx2}, {&ScalarKernels, true}};
#else
    const Candidate candidates[] = {{&ScalarKernels, true}};
#endif
    for (const Candidate& candidate : candidates) {
        if (wanted.empty() && candidate.runs_here) return *candidate.kernels;
        if (wanted != candidate.kernels->name) continue;
        if (candidate.runs_here) return *candidate.kernels;
        throw Error(ErrorCode::Unsupported,
                    "GSE_CPU asks for " + wanted + ", which this processor does not have",
                    "unset GSE_CPU to let the program choose");
    }
    throw Error(ErrorCode::InvalidArgument, "GSE_CPU is \"" + wanted + "\"", "use scalar, avx2 or avx512");
}

}  // namespace gse::raster
