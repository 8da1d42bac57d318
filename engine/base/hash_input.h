// How contents are cut into words: for everything that hashes them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace gse {

/// `Self` has add(std::uint64_t) and bytes(const void*, std::size_t).
template <class Self> class HashInput {
public:
    /// Length first: "ab", "c" is not "a", "bc".
    void text(std::string_view text) {
        self().add(text.size());
        self().bytes(text.data(), text.size());
    }

protected:
    /// Adds all whole words of 8 bytes; returns what is left, of which there are `size` bytes then.
    const unsigned char* add_words(const void* data, std::size_t& size) {
        const auto* at = static_cast<const unsigned char*>(data);
        for (; size >= sizeof(std::uint64_t); size -= sizeof(std::uint64_t), at += sizeof(std::uint64_t)) {
            std::uint64_t word = 0;
            std::memcpy(&word, at, sizeof word);
            self().add(word);
        }
        return at;
    }

private:
    Self& self() { return static_cast<Self&>(*this); }
};

}  // namespace gse
