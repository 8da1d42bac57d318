// Cache of large tensors' memory: passes of a network ask for equal sizes again and again. The system fills
// what it gives anew with zeros, page by page.
#pragma once

#include <cstddef>

namespace gse::neural {

/// Bytes. Smaller ones the C library keeps, and none that is longer: this is the most that its threshold can
/// be set to.
constexpr std::size_t LeastKeptBuffer = std::size_t{32} << 20;
constexpr std::size_t MostKeptBytes = std::size_t{768}
                                      << 20;  // not in use, in all; beyond it the longest unused go

struct BufferUse {
    std::size_t kept = 0;    // bytes that are not in use
    std::size_t reused = 0;  // buffers that were given out again so far
    std::size_t fresh = 0;   // large ones that the system gave so far
};

/// From here on torch's CPU tensors are allocated so; may be called again. Not under a sanitizer, which has
/// to see every one.
void keep_buffers();

/// Gives back what is not in use, to the system.
void release_buffers();

/// Scope that asks the networks for a while; gives the buffers back at its end.
class BufferHolder {
public:
    BufferHolder() = default;
    BufferHolder(const BufferHolder&) = delete;
    BufferHolder& operator=(const BufferHolder&) = delete;
    ~BufferHolder() { release_buffers(); }
};

BufferUse buffer_use();

}  // namespace gse::neural
