// Read from the kernel and the libraries.
#include "engine/laboratory/bench/charts/machine.h"

#include <unistd.h>

#include <fstream>
#include <string>
#include <thread>

#include "engine/base/error.h"
#include "engine/raster/rasterizer.h"
#ifdef GSE_WINDOW
#include "engine/vulkan/device.h"
#endif

namespace gse::bench {
namespace {

/// Value behind "model name : " and the like in /proc/cpuinfo, first processor.
std::string processor_line(const std::string& key) {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);) {
        const auto colon = line.find(':');
        if (!line.starts_with(key) || colon == std::string::npos) continue;
        const auto first = line.find_first_not_of(" \t", colon + 1);
        return first == std::string::npos ? std::string() : line.substr(first);
    }
    return {};
}

/// Those that the program makes use of.
std::string instruction_sets() {
    const std::string flags = " " + processor_line("flags") + " ";
    std::string found;
    for (const char* name : {"avx2", "fma", "avx512f", "avx512_bf16", "amx_bf16"})
        if (flags.find(" " + std::string(name) + " ") != std::string::npos)
            found += (found.empty() ? "" : " ") + std::string(name);
    return found.empty() ? "unknown" : found;
}

std::string vulkan_device() {
#ifdef GSE_WINDOW
    try {
        vulkan::Instance instance;
        return vulkan::Device(instance).info().name;
    } catch (const Error&) {  // there is none: a fact about the machine
        return "none";
    }
#else
    return "none";
#endif
}

}  // namespace

nlohmann::ordered_json machine_json() {
    const auto model = processor_line("model name");
    std::string kernels;
    for (const auto& name : raster::usable_kernels()) kernels += (kernels.empty() ? "" : " ") + name;
    const double bytes =
        static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
    return {{"processor", model.empty() ? "unknown" : model},
            {"cores", std::thread::hardware_concurrency()},
            {"memory_mb", static_cast<std::uint64_t>(bytes / (1024.0 * 1024.0))},
            {"instruction_sets", instruction_sets()},
            {"kernels", kernels},
            {"vulkan_device", vulkan_device()}};
}

}  // namespace gse::bench
