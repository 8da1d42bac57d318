// Arrays for data that is walked through from end to end. They begin at a cache line. Large ones lie in huge
// pages if the system has some, which saves address look-ups.
#pragma once

#include <cstddef>
#include <new>
#include <vector>

namespace gse {

inline constexpr std::size_t CacheLine = 64;  // bytes

/// Asks for huge pages for memory that was not written to yet. Does nothing if the system has none.
void prefer_huge_pages(void* memory, std::size_t bytes) noexcept;

/// Allocates `bytes` at a multiple of CacheLine, uninitialised. free_lines() releases them and needs the same
/// number. Throws std::bad_alloc.
void* allocate_lines(std::size_t bytes);
void free_lines(void* memory, std::size_t bytes) noexcept;

template <class T> struct LineAllocator {
    using value_type = T;
    LineAllocator() = default;
    template <class U> LineAllocator(const LineAllocator<U>&) {}
    T* allocate(std::size_t count) {
        if (count > static_cast<std::size_t>(-1) / sizeof(T)) throw std::bad_array_new_length();
        return static_cast<T*>(allocate_lines(count * sizeof(T)));
    }
    void deallocate(T* values, std::size_t count) noexcept { free_lines(values, count * sizeof(T)); }
    friend bool operator==(const LineAllocator&, const LineAllocator&) { return true; }
};

template <class T> using LineVector = std::vector<T, LineAllocator<T>>;
using LineFloats = LineVector<float>;

}  // namespace gse
