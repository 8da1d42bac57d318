// Machine that runs the kernels: memory of its own, copies, fills and launches. One implementation is the
// CUDA driver, the other the processor that stands in for it in tests. Both run one sequence of launches.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "engine/raster/cuda/arguments.h"

namespace gse::raster::cuda {

/// One entry of kernel_list.inl.
template <class Arguments> struct Kernel { int index; };

namespace kernel_index {
enum : int {
#define GSE_KERNEL(name, Arguments, body) name,
#include "engine/raster/cuda/kernel_list.inl"
#undef GSE_KERNEL
    count
};
}  // namespace kernel_index

namespace kernels {
#define GSE_KERNEL(name, Arguments, body) inline constexpr Kernel<Arguments> name{kernel_index::name};
#include "engine/raster/cuda/kernel_list.inl"
#undef GSE_KERNEL
}  // namespace kernels

/// Names in the PTX text, by index.
inline constexpr const char* KernelNames[] = {
#define GSE_KERNEL(name, Arguments, body) "gse_" #name,
#include "engine/raster/cuda/kernel_list.inl"
#undef GSE_KERNEL
};

/// Queues calls, which are carried out in order. download() waits for all before it. Every call throws Error,
/// also for an earlier launch: Unsupported without memory, Foreign otherwise.
class Device {
public:
    virtual ~Device() = default;

    /// Uninitialised; `bytes` > 0.
    virtual void* allocate(std::size_t bytes) = 0;
    virtual void release(void* memory) noexcept = 0;
    virtual void upload(void* to, const void* from, std::size_t bytes) = 0;
    virtual void download(void* to, const void* from, std::size_t bytes) = 0;
    virtual void fill(void* to, std::uint32_t word, std::size_t words) = 0;
    virtual std::string name() const = 0;

    /// Blocks of BlockThreads threads; none for 0.
    template <class Arguments>
    void launch(Kernel<Arguments> kernel, std::size_t blocks, const Arguments& arguments) {
        if (blocks > 0) run(kernel.index, static_cast<std::uint32_t>(blocks), &arguments, sizeof arguments);
    }

protected:
    virtual void run(int kernel, std::uint32_t blocks, const void* arguments, std::size_t bytes) = 0;
};

/// Blocks that give each of `count` items a thread.
inline std::size_t blocks_for(std::size_t count, std::size_t per_block = BlockThreads) {
    return (count + per_block - 1) / per_block;
}

/// Array in a device's memory. Grows, never shrinks.
template <class T> class DeviceArray {
public:
    explicit DeviceArray(Device& device) : device_(device) {}
    ~DeviceArray() {
        if (data_ != nullptr) device_.release(data_);
    }
    DeviceArray(const DeviceArray&) = delete;
    DeviceArray& operator=(const DeviceArray&) = delete;

    /// Makes room for `count`. The content is lost when there was less. Never null.
    T* at_least(std::size_t count) {
        if (count <= capacity_ && data_ != nullptr) return data_;
        if (data_ != nullptr) device_.release(data_);
        data_ = nullptr;
        capacity_ = 0;
        const std::size_t wanted = count + count / 4 + 1;  // a scene grows little by little
        data_ = static_cast<T*>(device_.allocate(wanted * sizeof(T)));
        capacity_ = wanted;
        return data_;
    }
    T* data() const { return data_; }

    T* upload(std::span<const T> values) {
        T* to = at_least(values.size());
        if (!values.empty()) device_.upload(to, values.data(), values.size_bytes());
        return to;
    }
    /// Uploads all of `values` to the beginning.
    void download(std::span<T> values) const {
        if (!values.empty()) device_.download(values.data(), data_, values.size_bytes());
    }
    /// Fills `count` values with zero bits.
    T* zeros(std::size_t count) {
        static_assert(sizeof(T) % sizeof(std::uint32_t) == 0);
        T* to = at_least(count);
        if (count > 0) device_.fill(to, 0, count * (sizeof(T) / sizeof(std::uint32_t)));
        return to;
    }

private:
    Device& device_;
    T* data_ = nullptr;
    std::size_t capacity_ = 0;
};

}  // namespace gse::raster::cuda
