// XXH3, 128 bits (Collet, xxHash).
#include "engine/base/content_hash.h"

#define XXH_INLINE_ALL
#include <fmt/format.h>
#include <xxhash.h>

#include <new>

namespace gse {
namespace {

template <class Bytes> auto& state_in(Bytes& bytes) {
    using State = std::conditional_t<std::is_const_v<Bytes>, const XXH3_state_t, XXH3_state_t>;
    static_assert(sizeof(Bytes) >= sizeof(State) && alignof(XXH3_state_t) <= 64);
    return *std::launder(reinterpret_cast<State*>(bytes.data()));
}

}  // namespace

std::string ContentKey::hex() const { return fmt::format("{:016x}{:016x}", high, low); }

ContentHash::ContentHash() {
    new (state_.data()) XXH3_state_t;
    XXH3_128bits_reset(&state_in(state_));
}

void ContentHash::bytes(const void* data, std::size_t size) {
    if (size > 0) XXH3_128bits_update(&state_in(state_), data, size);
}

void ContentHash::text(std::string_view text) {
    numbers(std::uint64_t{text.size()});
    bytes(text.data(), text.size());
}

void ContentHash::texts(const std::vector<std::string>& texts) {
    numbers(std::uint64_t{texts.size()});
    for (const auto& one : texts) text(one);
}

void ContentHash::image(const Image& image) {
    numbers(image.width, image.height, image.channels);
    bytes(image.data.data(), image.data.size() * sizeof(float));
}

ContentKey ContentHash::key() const {
    const auto digest = XXH3_128bits_digest(&state_in(state_));
    return {digest.low64, digest.high64};
}

ContentKey key_of(const Image& image) {
    ContentHash hash;
    hash.image(image);
    return hash.key();
}

}  // namespace gse
