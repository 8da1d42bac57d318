// Functions of the CUDA driver that are used, as NVIDIA documents them (CUDA Driver API, version 6.0 and
// newer).
#pragma once

#include <cstddef>
#include <cstdint>

namespace gse::raster::cuda {

using DriverResult = int;                  // CUresult
using DriverDevice = int;                  // CUdevice
using DriverAddress = unsigned long long;  // CUdeviceptr
struct DriverContext;                      // CUctx_st
struct DriverModule;                       // CUmod_st
struct DriverFunction;                     // CUfunc_st
struct DriverStream;                       // CUstream_st

inline constexpr DriverResult DriverSuccess = 0, DriverOutOfMemory = 2, DriverNoDevice = 100;
inline constexpr int DriverCapabilityMajor = 75, DriverCapabilityMinor = 76;  // CUdevice_attribute
inline constexpr int DriverJitErrorLog = 5, DriverJitErrorLogBytes = 6;       // CUjit_option

/// GSE_DRIVER(member, name in the library, parameters).
#define GSE_DRIVER_FUNCTIONS(GSE_DRIVER)                                                                 \
    GSE_DRIVER(init, "cuInit", (unsigned flags))                                                         \
    GSE_DRIVER(error_name, "cuGetErrorName", (DriverResult result, const char** text))                   \
    GSE_DRIVER(error_text, "cuGetErrorString", (DriverResult result, const char** text))                 \
    GSE_DRIVER(device_count, "cuDeviceGetCount", (int* count))                                           \
    GSE_DRIVER(device, "cuDeviceGet", (DriverDevice * device, int ordinal))                              \
    GSE_DRIVER(device_name, "cuDeviceGetName", (char* name, int length, DriverDevice device))            \
    GSE_DRIVER(attribute, "cuDeviceGetAttribute", (int* value, int attribute, DriverDevice device))      \
    GSE_DRIVER(retain, "cuDevicePrimaryCtxRetain", (DriverContext * *context, DriverDevice device))      \
    GSE_DRIVER(release, "cuDevicePrimaryCtxRelease_v2", (DriverDevice device))                           \
    GSE_DRIVER(make_current, "cuCtxSetCurrent", (DriverContext * context))                               \
    GSE_DRIVER(load, "cuModuleLoadDataEx",                                                               \
               (DriverModule * *module, const void* image, unsigned count, int* options, void** values)) \
    GSE_DRIVER(unload, "cuModuleUnload", (DriverModule * module))                                        \
    GSE_DRIVER(function, "cuModuleGetFunction",                                                          \
               (DriverFunction * *function, DriverModule * module, const char* name))                    \
    GSE_DRIVER(allocate, "cuMemAlloc_v2", (DriverAddress * address, std::size_t bytes))                  \
    GSE_DRIVER(free, "cuMemFree_v2", (DriverAddress address))                                            \
    GSE_DRIVER(upload, "cuMemcpyHtoD_v2", (DriverAddress to, const void* from, std::size_t bytes))       \
    GSE_DRIVER(download, "cuMemcpyDtoH_v2", (void* to, DriverAddress from, std::size_t bytes))           \
    GSE_DRIVER(fill, "cuMemsetD32_v2", (DriverAddress to, unsigned word, std::size_t words))             \
    GSE_DRIVER(launch, "cuLaunchKernel",                                                                 \
               (DriverFunction * function, unsigned grid_x, unsigned grid_y, unsigned grid_z,            \
                unsigned block_x, unsigned block_y, unsigned block_z, unsigned shared_bytes,             \
                DriverStream* stream, void** parameters, void** extra))

}  // namespace gse::raster::cuda
