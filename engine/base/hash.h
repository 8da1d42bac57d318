// A 64-bit hash of what a question is made of, for answers that are remembered.
#pragma once

#include <cstddef>
#include <cstdint>

#include "engine/base/hash_input.h"
#include "engine/base/image.h"

namespace gse {

/// FNV-1a over 8-byte words with a final mix: a question has a few hundred kilobytes, and chance collisions
/// over the few hundred questions of a session are below 1e-14.
class Hash : public HashInput<Hash> {
public:
    void bytes(const void* data, std::size_t size) {
        const auto* at = add_words(data, size);
        for (; size > 0; --size) add(*at++);
    }
    void image(const Image& image) {
        add(static_cast<std::uint64_t>(image.width));
        add(static_cast<std::uint64_t>(image.height));
        bytes(image.data.data(), image.data.size() * sizeof(float));
    }
    void add(std::uint64_t word) {
        value_ = (value_ ^ word) * 0x100000001b3ULL;
        value_ ^= value_ >> 29;
    }
    std::uint64_t value() const { return value_; }

private:
    std::uint64_t value_ = 0xcbf29ce484222325ULL;
};

}  // namespace gse
