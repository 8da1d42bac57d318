// Binary members of a project: arrays, byte-transposed and compressed. Their sizes are checked against the
// reader's expectation. Little-endian.
//
// Member: "GSM1", u32 bytes per element (4 = transposed as 32-bit words, 1 = as it is), u64 bytes unpacked,
// one zstd frame.
//
// Delta, unpacked: u64 changed, removed, added; u32 SH degree of the changed and of the added rows. Then
// identities changed[], removed[], added[] (u64). Then per row set position, log-scale, rotation, opacity
// logit, SH (f32).
//
// Whole set: u64 rows, u32 SH degree, u32 zero, then those five arrays. Absent rows: u64 count, identities
// (u64), weight (f32), manual (i8).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/scene/delta.h"
#include "engine/scene/document.h"

namespace gse::io {

/// Packs bytes. `element` is 4 or 1.
std::string pack_member(std::string_view bytes, std::uint32_t element);

/// Bytes that members may unpack to in total, so that a small file cannot fill the memory.
class UnpackBudget {
public:
    explicit UnpackBudget(std::uint64_t file_bytes);
    /// Counts bytes of a member whose size only the file states. Throws Error (Malformed) or OutOfMemory when
    /// that is too much.
    void spend(std::uint64_t bytes, const std::string& what);
    /// Counts bytes of a member with one value per splat of the scene. Labels may be all zeros and pack very
    /// small.
    void spend_known(std::uint64_t bytes, const std::string& what);

private:
    std::uint64_t file_bytes_;
    std::uint64_t claimed_ = 0, known_ = 0;
};

/// Undoes pack_member(). `what` names the part in messages. `expected` = bytes it must give, or AnySize.
constexpr std::uint64_t AnySize = ~std::uint64_t{0};
std::vector<std::byte> unpack_member(std::span<const std::byte> member, std::uint64_t expected,
                                     UnpackBudget& budget, const std::string& what);

std::string encode_delta(const SceneDelta& delta);
/// Unpacks a delta. Checks all that needs no scene: sizes, ascending identities, added rows of `edit_id`.
SceneDelta decode_delta(std::span<const std::byte> bytes, std::uint64_t edit_id, const std::string& what);

std::string encode_set(const GaussianSet& set);
GaussianData decode_set(std::span<const std::byte> bytes, const std::string& what);

std::string encode_absent(const AbsentRows& rows);
AbsentRows decode_absent(std::span<const std::byte> bytes, const std::string& what);

/// Packs one bit per row, lowest first.
std::string encode_bits(std::span<const std::uint8_t> values);
std::vector<std::uint8_t> decode_bits(std::span<const std::byte> bytes, std::size_t count,
                                      const std::string& what);

}  // namespace gse::io
