// Memory by the line, and the wish for large pages.
#include "engine/base/aligned.h"

#include <cstdint>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace gse {
namespace {

constexpr std::size_t LargePage = std::size_t{2} << 20, WorthLargePages = 2 * LargePage;

std::align_val_t alignment(std::size_t bytes) { return std::align_val_t{bytes >= WorthLargePages ? LargePage : CacheLine}; }

}  // namespace

void wish_large_pages([[maybe_unused]] void* at, [[maybe_unused]] std::size_t bytes) noexcept {
#ifdef __linux__
    if (bytes < WorthLargePages) return;
    const std::size_t skipped = (LargePage - reinterpret_cast<std::uintptr_t>(at) % LargePage) % LargePage;
    madvise(static_cast<std::byte*>(at) + skipped, (bytes - skipped) / LargePage * LargePage, MADV_HUGEPAGE);   // any answer will do
#endif
}

void* allocate_lines(std::size_t bytes) {
    void* at = ::operator new(bytes, alignment(bytes));
    wish_large_pages(at, bytes);
    return at;
}

void free_lines(void* at, std::size_t bytes) noexcept { ::operator delete(at, alignment(bytes)); }

}  // namespace gse
