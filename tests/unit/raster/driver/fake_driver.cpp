// A stand-in for NVIDIA's driver library, for tests: the functions of driver_functions.h over the processor's
// memory, with the emulated kernels. It refuses what the real one refuses: calls without a context, unknown
// addresses, kernels that the text lacks. The environment variable GSE_FAKE_DRIVER names what goes wrong.
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <string>

#include "engine/raster/cuda/driver_functions.h"
#include "engine/raster/cuda/emulated_device.h"

using namespace gse::raster::cuda;

namespace {

constexpr DriverResult InvalidValue = 1, InvalidContext = 201, InvalidText = 218, NotFound = 500;

struct State {
    std::mutex mutex;
    std::map<DriverAddress, std::size_t> memory;
    int contexts = 0, modules = 0;
    std::string text;
};

State& state() {
    static State all;
    return all;
}

thread_local bool entered = false;
int token;  // what handles point to

bool wrong(const char* what) {
    const char* value = std::getenv("GSE_FAKE_DRIVER");
    return value != nullptr && std::strcmp(value, what) == 0;
}

/// Tells whether [address, address + bytes) lies in one allocation.
bool known(DriverAddress address, std::size_t bytes) {
    const std::lock_guard lock(state().mutex);
    auto after = state().memory.upper_bound(address);
    if (after == state().memory.begin()) return false;
    --after;
    return address + bytes <= after->first + after->second;
}

void* pointer(DriverAddress address) { return reinterpret_cast<void*>(static_cast<std::uintptr_t>(address)); }

}  // namespace

extern "C" {

DriverResult cuInit(unsigned flags) {
    if (wrong("no device")) return DriverNoDevice;
    return flags == 0 ? DriverSuccess : InvalidValue;
}
DriverResult cuGetErrorName(DriverResult result, const char** text) {
    *text = result == InvalidText ? "CUDA_ERROR_INVALID_PTX" : "CUDA_ERROR";
    return DriverSuccess;
}
DriverResult cuGetErrorString(DriverResult, const char** text) {
    *text = "something is wrong";
    return DriverSuccess;
}
DriverResult cuDeviceGetCount(int* count) {
    *count = wrong("empty") ? 0 : 1;
    return DriverSuccess;
}
DriverResult cuDeviceGet(DriverDevice* device, int ordinal) {
    *device = 7;
    return ordinal == 0 ? DriverSuccess : InvalidValue;
}
DriverResult cuDeviceGetName(char* name, int length, DriverDevice device) {
    std::strncpy(name, "Fake 9000", static_cast<std::size_t>(length));
    return device == 7 ? DriverSuccess : InvalidValue;
}
DriverResult cuDeviceGetAttribute(int* value, int attribute, DriverDevice device) {
    *value = attribute == DriverCapabilityMajor ? (wrong("old") ? 5 : 9) : 2;
    return device == 7 ? DriverSuccess : InvalidValue;
}
DriverResult cuDevicePrimaryCtxRetain(DriverContext** context, DriverDevice device) {
    *context = reinterpret_cast<DriverContext*>(&token);
    ++state().contexts;
    return device == 7 ? DriverSuccess : InvalidValue;
}
DriverResult cuDevicePrimaryCtxRelease_v2(DriverDevice) {
    --state().contexts;
    return DriverSuccess;
}
DriverResult cuCtxSetCurrent(DriverContext* context) {
    entered = context == reinterpret_cast<DriverContext*>(&token);
    return entered ? DriverSuccess : InvalidContext;
}
DriverResult cuModuleLoadDataEx(DriverModule** module, const void* image, unsigned count, int* options,
                                void** values) {
    if (!entered) return InvalidContext;
    state().text = static_cast<const char*>(image);
    if (wrong("text")) {
        if (count == 2 && options[0] == DriverJitErrorLog && options[1] == DriverJitErrorLogBytes)
            std::strncpy(static_cast<char*>(values[0]), "ptxas: line 7\nno such instruction",
                         reinterpret_cast<std::size_t>(values[1]));
        return InvalidText;
    }
    *module = reinterpret_cast<DriverModule*>(&token);
    ++state().modules;
    return DriverSuccess;
}
DriverResult cuModuleUnload(DriverModule*) {
    --state().modules;
    return entered ? DriverSuccess : InvalidContext;
}
DriverResult cuModuleGetFunction(DriverFunction** function, DriverModule*, const char* name) {
    for (int i = 0; i < kernel_index::count; ++i) {
        if (std::strcmp(name, KernelNames[i]) != 0 ||
            state().text.find(std::string(".entry ") + name + "(") == std::string::npos)
            continue;
        *function = reinterpret_cast<DriverFunction*>(static_cast<std::uintptr_t>(i + 1));
        return DriverSuccess;
    }
    return NotFound;
}
DriverResult cuMemAlloc_v2(DriverAddress* address, std::size_t bytes) {
    if (!entered) return InvalidContext;
    if (bytes == 0) return InvalidValue;
    if (wrong("memory")) return DriverOutOfMemory;
    void* memory = std::aligned_alloc(256, (bytes + 255) / 256 * 256);
    std::memset(memory, 0xff, bytes);
    *address = reinterpret_cast<std::uintptr_t>(memory);
    const std::lock_guard lock(state().mutex);
    state().memory[*address] = bytes;
    return DriverSuccess;
}
DriverResult cuMemFree_v2(DriverAddress address) {
    const std::lock_guard lock(state().mutex);
    if (!entered || state().memory.erase(address) == 0) return InvalidValue;
    std::free(pointer(address));
    return DriverSuccess;
}
DriverResult cuMemcpyHtoD_v2(DriverAddress to, const void* from, std::size_t bytes) {
    if (!entered || !known(to, bytes)) return InvalidValue;
    std::memcpy(pointer(to), from, bytes);
    return DriverSuccess;
}
DriverResult cuMemcpyDtoH_v2(void* to, DriverAddress from, std::size_t bytes) {
    if (!entered || !known(from, bytes)) return InvalidValue;
    std::memcpy(to, pointer(from), bytes);
    return DriverSuccess;
}
DriverResult cuMemsetD32_v2(DriverAddress to, unsigned word, std::size_t words) {
    if (!entered || !known(to, words * sizeof word)) return InvalidValue;
    for (std::size_t i = 0; i < words; ++i) static_cast<unsigned*>(pointer(to))[i] = word;
    return DriverSuccess;
}
DriverResult cuLaunchKernel(DriverFunction* function, unsigned grid_x, unsigned grid_y, unsigned grid_z,
                            unsigned block_x, unsigned block_y, unsigned block_z, unsigned shared_bytes,
                            DriverStream* stream, void** parameters, void** extra) {
    if (!entered || grid_x == 0 || grid_y != 1 || grid_z != 1 || block_x != BlockThreads || block_y != 1 ||
        block_z != 1)
        return InvalidValue;
    if (shared_bytes != 0 || stream != nullptr || extra != nullptr) return InvalidValue;
    const int kernel = static_cast<int>(reinterpret_cast<std::uintptr_t>(function)) - 1;
    if (wrong("launch") && kernel == kernel_index::blend) return InvalidValue;
    if (wrong("result") &&
        kernel == kernel_index::gradient) {  // as a device would that computes something else
        GradientArguments arguments;
        std::memcpy(&arguments, parameters[0], sizeof arguments);
        arguments.view.negative_slope = 0.5f;
        run_emulated(kernel, grid_x, &arguments);
        return DriverSuccess;
    }
    run_emulated(kernel, grid_x, parameters[0]);
    return DriverSuccess;
}

/// Contexts, modules and allocations that were not given back.
int fake_driver_leaks() {
    return state().contexts + state().modules + static_cast<int>(state().memory.size());
}

}  // extern "C"
