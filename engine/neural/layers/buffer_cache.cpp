// A list of free buffers, the one that was used last in front.
#include "engine/neural/layers/buffer_cache.h"

#include <c10/core/Allocator.h>
#include <c10/core/CPUAllocator.h>
#include <c10/core/impl/alloc_cpu.h>

#if defined(__GLIBC__)
#include <malloc.h>
#endif

#include <mutex>
#include <new>
#include <vector>

#include "engine/base/aligned.h"

namespace gse::neural {
namespace {

/// In front of every buffer; as long as the alignment that vector instructions are promised.
struct alignas(64) BufferHeader {
    std::size_t bytes = 0;  // of the buffer behind it
};

constexpr std::size_t Granularity = std::size_t{64} << 10;  // sizes are rounded up to it
constexpr std::size_t FitShare = 8;  // a kept buffer may be longer than asked for by this part

std::byte* data_of(BufferHeader* header) { return reinterpret_cast<std::byte*>(header + 1); }
BufferHeader* header_of(void* data) { return static_cast<BufferHeader*>(data) - 1; }

class BufferCache final : public c10::Allocator {
public:
    c10::DataPtr allocate(std::size_t bytes) const override {
        void* data = bytes > 0 ? take(bytes) : nullptr;
        return {data, data, &give_back, c10::Device(c10::DeviceType::CPU)};
    }
    c10::DeleterFnPtr raw_deleter() const override { return &give_back; }

    void release() const {
        std::vector<BufferHeader*> free;
        {
            const std::lock_guard lock(mutex_);
            free.swap(free_);
            use_.kept = 0;
        }
        for (auto* header : free) c10::free_cpu(header);
    }

    BufferUse use() const {
        const std::lock_guard lock(mutex_);
        return use_;
    }

    static BufferCache& instance() {
        static auto* cache = new BufferCache();  // outlives every tensor
        return *cache;
    }

private:
    void* take(std::size_t bytes) const {
        if (bytes < LeastKeptBuffer) return fresh(bytes);
        const auto rounded = (bytes + Granularity - 1) / Granularity * Granularity;
        {
            const std::lock_guard lock(mutex_);
            for (auto i = free_.size(); i-- > 0;) {
                auto* header = free_[i];
                if (header->bytes < rounded || header->bytes > rounded + rounded / FitShare) continue;
                free_.erase(free_.begin() + static_cast<std::ptrdiff_t>(i));
                use_.kept -= header->bytes;
                ++use_.reused;
                return data_of(header);
            }
            ++use_.fresh;
        }
        return fresh(rounded);
    }

    void* fresh(std::size_t bytes) const {
        void* memory = nullptr;
        try {
            memory = c10::alloc_cpu(sizeof(BufferHeader) + bytes);
        } catch (const c10::Error&) {  // what lies here unused may be what is missing
            release();
            memory = c10::alloc_cpu(sizeof(BufferHeader) + bytes);
        }
        prefer_huge_pages(
            memory, sizeof(BufferHeader) +
                        bytes);  // a fault for each 4 KiB costs as much as what is computed with large models
        return data_of(new (memory) BufferHeader{bytes});
    }

    static void give_back(void* data) {
        if (data != nullptr) instance().keep(header_of(data));
    }

    void keep(BufferHeader* header) const {
        if (header->bytes < LeastKeptBuffer || header->bytes > MostKeptBytes) return c10::free_cpu(header);
        std::vector<BufferHeader*> gone;
        {
            const std::lock_guard lock(mutex_);
            free_.push_back(header);
            use_.kept += header->bytes;
            std::size_t count = 0;
            while (use_.kept > MostKeptBytes) use_.kept -= free_[count++]->bytes;
            const auto end = free_.begin() + static_cast<std::ptrdiff_t>(count);
            gone.assign(free_.begin(), end);
            free_.erase(free_.begin(), end);
        }
        for (auto* old : gone) c10::free_cpu(old);
    }

    mutable std::mutex mutex_;
    mutable std::vector<BufferHeader*> free_;  // the one that was used last is the last
    mutable BufferUse use_;
};

}  // namespace

void keep_buffers() {
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && !defined(GSE_SANITIZED)
    static const bool once = [] {
#if defined(__GLIBC__)
        mallopt(M_MMAP_THRESHOLD, static_cast<int>(LeastKeptBuffer));
        mallopt(M_TRIM_THRESHOLD, static_cast<int>(MostKeptBytes));
#endif
        c10::SetCPUAllocator(&BufferCache::instance(), 1);
        return true;
    }();
    static_cast<void>(once);
#endif
}

void release_buffers() {
    BufferCache::instance().release();
#if defined(__GLIBC__)
    malloc_trim(0);
#endif
}

BufferUse buffer_use() { return BufferCache::instance().use(); }

}  // namespace gse::neural
