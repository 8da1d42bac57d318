// Memory by the line, in large pages where there is much of it.
#include "engine/base/aligned.h"

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace gse {
namespace {

constexpr std::size_t LargePage = std::size_t{2} << 20, WorthLargePages = 2 * LargePage;

std::align_val_t alignment(std::size_t bytes) { return std::align_val_t{bytes >= WorthLargePages ? LargePage : CacheLine}; }

}  // namespace

void* allocate_lines(std::size_t bytes) {
    void* at = ::operator new(bytes, alignment(bytes));
#ifdef __linux__
    if (bytes >= WorthLargePages) madvise(at, bytes / LargePage * LargePage, MADV_HUGEPAGE);   // a wish: any answer will do
#endif
    return at;
}

void free_lines(void* at, std::size_t bytes) noexcept { ::operator delete(at, alignment(bytes)); }

}  // namespace gse
