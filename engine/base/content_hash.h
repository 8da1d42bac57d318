// Hash of contents: keys of caches, and names of what they keep on the disk.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "engine/base/image.h"
#include "engine/base/overridable.h"

namespace gse {

/// Key of all that an answer follows from: 128 bits of XXH3. Not for secrets; two contents have one key by
/// chance with a probability of about 2^-128.
struct ContentKey {
    std::uint64_t low = 0, high = 0;
    friend auto operator<=>(const ContentKey&, const ContentKey&) = default;
    /// 32 hexadecimal digits.
    std::string hex() const;
};

/// Takes contents in pieces; key() may be asked at any time. Every piece counts, and its place.
class ContentHash {
public:
    ContentHash();
    void bytes(const void* data, std::size_t size);
    /// Takes the length first: "ab", "c" is not "a", "bc".
    void text(std::string_view text);
    void texts(const std::vector<std::string>& texts);
    /// Takes numbers as they lie in memory: an int is not a double of the same value.
    template <class... Number> void numbers(const Number&... number) {
        static_assert((std::is_arithmetic_v<Number> && ...));
        (bytes(&number, sizeof number), ...);
    }
    /// Takes width, height, channels and values.
    void image(const Image& image);
    /// Takes names and values of a parameter struct (visit_fields).
    template <class P> void fields(const P& parameters) {
        P::visit_fields(parameters, [&](const char* name, const auto& value, const char*, const auto&...) {
            text(name);
            using Value = std::remove_cvref_t<decltype(value)>;
            if constexpr (std::is_same_v<Value, Overridable>)
                numbers(static_cast<double>(value), value.is_set());
            else if constexpr (std::is_arithmetic_v<Value>) numbers(value);
            else if constexpr (std::is_convertible_v<decltype(value), std::string_view>) text(value);
            else texts(value);
        });
    }
    ContentKey key() const;

private:
    alignas(64) std::array<std::byte, 576> state_;
};

/// Key of one picture.
ContentKey key_of(const Image& image);

}  // namespace gse

template <> struct std::hash<gse::ContentKey> {
    std::size_t operator()(const gse::ContentKey& key) const noexcept { return key.low; }
};
