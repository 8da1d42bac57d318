// The kernels as functions of the processor, and a Device of them.
#include "engine/raster/cuda/emulated_device.h"

#include <cstdlib>
#include <cstring>
#include <vector>

#include "engine/base/check.h"
#include "engine/raster/conventions.h"
#include "engine/raster/cuda/device_rasterizer.h"
#include "engine/raster/cuda/grid.h"

namespace gse::raster::cuda {
namespace emulated {
namespace {

// clang-format off
#include "engine/raster/cuda/kernels.inl"
// clang-format on

struct Entry {
    std::size_t bytes;
    void (*run)(const Grid&, const void*);
};

constexpr Entry Entries[] = {
#define GSE_KERNEL(name, Arguments, body)                             \
    {sizeof(Arguments), [](const Grid& grid, const void* arguments) { \
         body(grid, *static_cast<const Arguments*>(arguments));       \
     }},
#include "engine/raster/cuda/kernel_list.inl"
#undef GSE_KERNEL
};

constexpr int Unknown = 0xff;

struct alignas(64) Line {
    std::byte bytes[64];
};
using SharedMemory = std::vector<Line>;

void run_blocks(int kernel, std::uint32_t blocks, const void* arguments, bool reversed,
                SharedMemory& shared) {
    shared.resize(SharedBytes / sizeof(Line));
    for (std::uint32_t i = 0; i < blocks; ++i) {
        std::memset(static_cast<void*>(shared.data()), Unknown, SharedBytes);
        Entries[kernel].run({reversed ? blocks - 1 - i : i, shared.data(), reversed}, arguments);
    }
}

class EmulatedDevice final : public Device {
public:
    explicit EmulatedDevice(EmulationOrder order) : reversed_(order == EmulationOrder::Reversed) {}

    void* allocate(std::size_t bytes) override {
        void* memory =
            std::aligned_alloc(sizeof(Line), (bytes + sizeof(Line) - 1) / sizeof(Line) * sizeof(Line));
        if (memory == nullptr) throw std::bad_alloc();
        return std::memset(memory, Unknown, bytes);
    }
    void release(void* memory) noexcept override { std::free(memory); }
    void upload(void* to, const void* from, std::size_t bytes) override { std::memcpy(to, from, bytes); }
    void download(void* to, const void* from, std::size_t bytes) override { std::memcpy(to, from, bytes); }
    void fill(void* to, std::uint32_t word, std::size_t words) override {
        for (std::size_t i = 0; i < words; ++i) static_cast<std::uint32_t*>(to)[i] = word;
    }
    std::string name() const override { return "emulated"; }

protected:
    void run(int kernel, std::uint32_t blocks, const void* arguments, std::size_t bytes) override {
        GSE_CHECK_EQ(Entries[kernel].bytes, bytes);
        run_blocks(kernel, blocks, arguments, reversed_, shared_);
    }

private:
    bool reversed_;
    SharedMemory shared_;
};

}  // namespace
}  // namespace emulated

std::unique_ptr<Device> make_emulated_device(EmulationOrder order) {
    return std::make_unique<emulated::EmulatedDevice>(order);
}

void run_emulated(int kernel, std::uint32_t blocks, const void* arguments) {
    emulated::SharedMemory shared;
    emulated::run_blocks(kernel, blocks, arguments, false, shared);
}

std::unique_ptr<Rasterizer> make_emulated_cuda_rasterizer(EmulationOrder order) {
    return make_device_rasterizer(make_emulated_device(order), "emulated cuda");
}

}  // namespace gse::raster::cuda
