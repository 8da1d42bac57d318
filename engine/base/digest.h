// A 128-bit digest of contents, for names of entries that outlive the process.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>

#include "engine/base/hash_input.h"
#include "engine/base/image.h"

namespace gse {

/// Two lanes of multiply and rotate that feed each other, over words of 8 bytes. Not for secrets: two
/// different contents have the same digest by chance with a probability of about 2^-128.
class Digest : public HashInput<Digest> {
public:
    void bytes(const void* data, std::size_t size) {
        const auto* at = add_words(data, size);
        std::uint64_t rest = size;  // how many bytes are left counts too
        for (; size > 0; --size) rest = rest << 8 | *at++;
        add(rest);
    }
    void image(const Image& image) {
        add(static_cast<std::uint64_t>(image.width));
        add(static_cast<std::uint64_t>(image.height));
        add(static_cast<std::uint64_t>(image.channels));
        bytes(image.data.data(), image.data.size() * sizeof(float));
    }
    void add(std::uint64_t word) {
        first_ = std::rotl(first_ ^ word * 0x9e3779b97f4a7c15ULL, 29) * 0xbf58476d1ce4e5b9ULL + second_;
        second_ = std::rotl(second_ + word, 37) * 0x94d049bb133111ebULL ^ first_;
    }
    std::array<std::uint64_t, 2> value() const {
        return {mixed(first_ + std::rotl(second_, 17)), mixed(second_ ^ mixed(first_))};
    }
    /// 32 hexadecimal digits.
    std::string hex() const {
        std::string text;
        for (const std::uint64_t part : value())
            for (int shift = 60; shift >= 0; shift -= 4) text += "0123456789abcdef"[part >> shift & 15];
        return text;
    }

private:
    static std::uint64_t mixed(std::uint64_t word) {
        word = (word ^ word >> 30) * 0xbf58476d1ce4e5b9ULL;
        word = (word ^ word >> 27) * 0x94d049bb133111ebULL;
        return word ^ word >> 31;
    }

    std::uint64_t first_ = 0x243f6a8885a308d3ULL, second_ = 0x13198a2e03707344ULL;
};

}  // namespace gse
