// Names of devices, threads of torch and of OpenBLAS.
#include "engine/neural/layers/devices.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <thread>

#include "engine/base/error.h"

// OpenBLAS has this, other libraries behind torch do not.
extern "C" void openblas_set_num_threads(int count) __attribute__((weak));

namespace gse::neural {
namespace {

std::atomic<bool> blas_threads_set = false;

}  // namespace

torch::Device parse_device(const std::string& name) {
    if (name == "cpu") return torch::kCPU;
    const bool numbered = name.starts_with("cuda:") && name.size() > 5 && name.size() < 8 &&
                          name.find_first_not_of("0123456789", 5) == std::string::npos;
    if (name != "cuda" && !numbered)
        throw Error(ErrorCode::InvalidArgument, fmt::format("\"{}\" is not a device", name),
                    "use cpu, cuda or cuda:1");
    const int index = numbered ? std::stoi(name.substr(5)) : 0;
    if (!torch::cuda::is_available() || index >= static_cast<int>(torch::cuda::device_count()))
        throw Error(ErrorCode::InvalidArgument, fmt::format("there is no device \"{}\" here", name),
                    "this libtorch sees no such GPU; use cpu");
    return torch::Device(torch::kCUDA, static_cast<c10::DeviceIndex>(index));
}

void set_threads(int count) {
    const int cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    torch::set_num_threads(count > 0 ? count : cores);
}

void set_blas_threads(int count) {
    blas_threads_set = true;
    if (openblas_set_num_threads != nullptr) openblas_set_num_threads(count);
}

void prefer_one_blas_thread() {
    if (!blas_threads_set && openblas_set_num_threads != nullptr) openblas_set_num_threads(1);
}

}  // namespace gse::neural
