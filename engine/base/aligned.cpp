// Allocation at cache lines, in huge pages for large blocks.
#include "engine/base/aligned.h"

#include <cstdint>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace gse {
namespace {

constexpr std::size_t HugePage = std::size_t{2} << 20;  // of x86-64 and most others
constexpr std::size_t WorthHugePages = 2 * HugePage;

std::align_val_t alignment(std::size_t bytes) {
    return std::align_val_t{bytes >= WorthHugePages ? HugePage : CacheLine};
}

}  // namespace

void prefer_huge_pages([[maybe_unused]] void* memory, [[maybe_unused]] std::size_t bytes) noexcept {
#if defined(MADV_HUGEPAGE)
    const auto begin = (reinterpret_cast<std::uintptr_t>(memory) + HugePage - 1) / HugePage * HugePage;
    const auto end = (reinterpret_cast<std::uintptr_t>(memory) + bytes) / HugePage * HugePage;
    if (begin < end) static_cast<void>(madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE));
#endif
}

void* allocate_lines(std::size_t bytes) {
    void* memory = ::operator new(bytes, alignment(bytes));
    if (bytes >= WorthHugePages) prefer_huge_pages(memory, bytes);
    return memory;
}

void free_lines(void* memory, std::size_t bytes) noexcept { ::operator delete(memory, alignment(bytes)); }

}  // namespace gse
