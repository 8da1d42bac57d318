// Bounds-checked cursor over little-endian bytes. Every overrun becomes one sentence about a truncated file.
#pragma once

#include <fmt/core.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

#include "engine/base/error.h"

namespace gse::io {

/// a * b, or the largest value when that does not fit. Sizes from files are compared, never trusted.
inline std::uint64_t saturating_product(std::uint64_t a, std::uint64_t b) {
    std::uint64_t result = 0;
    return __builtin_mul_overflow(a, b, &result) ? ~std::uint64_t{0} : result;
}

/// a + b, or the largest value when that does not fit.
inline std::uint64_t saturating_sum(std::uint64_t a, std::uint64_t b) {
    std::uint64_t result = 0;
    return __builtin_add_overflow(a, b, &result) ? ~std::uint64_t{0} : result;
}

/// Little-endian scalar at `source`. The machine is little-endian, as everywhere Debian's amd64 and arm64
/// run.
template <class T> T load_scalar(const std::byte* source) {
    static_assert(std::is_trivially_copyable_v<T>);
    T value;
    std::memcpy(&value, source, sizeof value);
    return value;
}

class ByteReader {
public:
    /// `what` names the read thing in messages ("the SPZ file").
    ByteReader(std::span<const std::byte> bytes, std::string what) : bytes_(bytes), what_(std::move(what)) {}

    std::size_t offset() const { return offset_; }
    std::size_t remaining() const { return bytes_.size() - offset_; }
    const std::string& what() const { return what_; }

    std::span<const std::byte> take(std::uint64_t count) {
        if (count > remaining()) throw_truncated(count);
        const auto result = bytes_.subspan(offset_, static_cast<std::size_t>(count));
        offset_ += static_cast<std::size_t>(count);
        return result;
    }
    void skip(std::uint64_t count) { take(count); }
    template <class T> T read() { return load_scalar<T>(take(sizeof(T)).data()); }
    /// Bytes up to the next NUL, which is skipped.
    std::string_view read_terminated() {
        const auto* begin = reinterpret_cast<const char*>(bytes_.data()) + offset_;
        const void* end = remaining() > 0 ? std::memchr(begin, 0, remaining()) : nullptr;
        if (end == nullptr) throw_truncated(1);
        const auto size = static_cast<std::size_t>(static_cast<const char*>(end) - begin);
        offset_ += size + 1;
        return {begin, size};
    }
    /// Count of things that take at least `least_bytes` each. Throws when the rest cannot hold so many.
    std::uint64_t read_count(std::uint64_t least_bytes) {
        const auto count = read<std::uint64_t>();
        if (saturating_product(count, least_bytes) > remaining())
            throw Error(
                ErrorCode::Malformed,
                fmt::format("{} promises {} entries but holds only {} more bytes", what_, count, remaining()),
                "the file is cut off or damaged; get it again");
        return count;
    }

private:
    [[noreturn]] void throw_truncated(std::uint64_t wanted) const {
        throw Error(ErrorCode::Malformed,
                    fmt::format("{} ends early: {} bytes are missing at offset {}", what_,
                                wanted - remaining(), offset_),
                    "the file is cut off or damaged; get it again");
    }

    std::span<const std::byte> bytes_;
    std::size_t offset_ = 0;
    std::string what_;
};

}  // namespace gse::io
