// Random UUIDs (RFC 9562, section 5.4).
#include "engine/remote/http/unique_id.h"

#include <cstdint>
#include <random>

#include <fmt/format.h>

namespace gse::remote {

std::string unique_id() {
    std::random_device random;
    const auto word = [&] { return std::uint32_t{random()}; };
    const std::uint32_t a = word(), b = word(), c = word(), d = word();
    return fmt::format("{:08x}-{:04x}-4{:03x}-{:04x}-{:04x}{:08x}", a, b >> 16, b & 0xfff,
                       0x8000 | (c >> 16 & 0x3fff), c & 0xffff, d);
}

}  // namespace gse::remote
