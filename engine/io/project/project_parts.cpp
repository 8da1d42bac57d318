// Binary members of projects: transposition, zstd, and bounds-checked arrays.
#include "engine/io/project/project_parts.h"

#include <fmt/core.h>
#include <zstd.h>

#include <algorithm>
#include <cstring>
#include <memory>

#include "engine/base/check.h"
#include "engine/base/error.h"
#include "engine/base/memory.h"
#include "engine/io/bytes/byte_reader.h"
#include "engine/io/bytes/claims.h"
#include "engine/io/bytes/encoding.h"
#include "engine/io/bytes/inflate.h"

namespace gse::io {
namespace {

constexpr char Magic[] = {'G', 'S', 'M', '1'};
constexpr std::uint32_t WordBytes = 4;
constexpr int Level = 1;  // an autosave must be quick; floats hardly gain from more
constexpr std::uint64_t FreeKnown = std::uint64_t{512}
                                    << 20;  // bytes of labels; zeros pack to a ten-thousandth
constexpr std::uint64_t KnownPerFileByte = 20000;
constexpr int EditShift = 32;

[[noreturn]] void throw_damaged(const std::string& what, const char* how) {
    throw Error(ErrorCode::Malformed, fmt::format("{} of the project {}", what, how),
                "the file is damaged; open an older copy or an autosave");
}

/// Transposes bytes: byte k of word i goes to k * words + i. Floats' exponents come together and compress.
void transpose(const char* from, char* to, std::size_t words) {
    for (std::size_t i = 0; i < words; ++i)
        for (std::size_t k = 0; k < WordBytes; ++k) to[k * words + i] = from[i * WordBytes + k];
}

void transpose_back(const std::byte* from, std::byte* to, std::size_t words) {
    for (std::size_t i = 0; i < words; ++i)
        for (std::size_t k = 0; k < WordBytes; ++k) to[i * WordBytes + k] = from[k * words + i];
}

template <class T> void append_array(std::string& out, std::span<const T> values) {
    out.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
}

template <class T> std::vector<T> read_array(ByteReader& reader, std::uint64_t count) {
    const auto bytes = reader.take(saturating_product(count, sizeof(T)));
    std::vector<T> values(static_cast<std::size_t>(count));
    if (!values.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
}

void append_rows(std::string& out, const GaussianSpans& rows) {
    for (const auto column : {rows.position, rows.log_scale, rows.rotation, rows.opacity_logit, rows.sh})
        append_array(out, column);
}

GaussianData read_rows(ByteReader& reader, std::uint64_t count, int degree) {
    GaussianData data;
    data.sh_degree = degree;
    data.position = read_array<float>(reader, saturating_product(count, 3));
    data.log_scale = read_array<float>(reader, saturating_product(count, 3));
    data.rotation = read_array<float>(reader, saturating_product(count, 4));
    data.opacity_logit = read_array<float>(reader, count);
    data.sh = read_array<float>(reader, saturating_product(count, data.sh_stride()));
    return data;
}

int read_degree(ByteReader& reader, const std::string& what) {
    const auto degree = reader.read<std::uint32_t>();
    if (degree > static_cast<std::uint32_t>(MaxShDegree)) throw_damaged(what, "has an impossible SH degree");
    return static_cast<int>(degree);
}

void check_ascending(std::span<const RowId> ids, const std::string& what) {
    for (std::size_t i = 1; i < ids.size(); ++i)
        if (ids[i] <= ids[i - 1]) throw_damaged(what, "names splats out of order");
}

}  // namespace

std::string pack_member(std::string_view bytes, std::uint32_t element) {
    const bool words = element == WordBytes && bytes.size() % WordBytes == 0;
    std::string turned;
    if (words) {
        turned.resize(bytes.size());
        transpose(bytes.data(), turned.data(), bytes.size() / WordBytes);
    }
    const std::string_view source = words ? std::string_view(turned) : bytes;
    std::string out(Magic, sizeof Magic);
    append_value(out, words ? WordBytes : std::uint32_t{1});
    append_value(out, static_cast<std::uint64_t>(bytes.size()));
    const std::size_t head = out.size();
    out.resize(head + ZSTD_compressBound(source.size()));
    const std::size_t size =
        ZSTD_compress(out.data() + head, out.size() - head, source.data(), source.size(), Level);
    GSE_CHECK(ZSTD_isError(size) == 0);
    out.resize(head + size);
    return out;
}

UnpackBudget::UnpackBudget(std::uint64_t file_bytes) : file_bytes_(file_bytes) {}

void UnpackBudget::spend(std::uint64_t bytes, const std::string& what) {
    check_claim({saturating_sum(claimed_, bytes), file_bytes_},
                what + " of the project, with what comes before it,");
    claimed_ += bytes;
}

void UnpackBudget::spend_known(std::uint64_t bytes, const std::string& what) {
    if (saturating_sum(known_, bytes) >
        saturating_sum(FreeKnown, saturating_product(file_bytes_, KnownPerFileByte)))
        throw Error(ErrorCode::Malformed, "the project has more labels than a scene of its size can use",
                    "the file is damaged or was not made by this program");
    require_memory(bytes, what + " of the project");
    known_ += bytes;
}

std::vector<std::byte> unpack_member(std::span<const std::byte> member, std::uint64_t expected,
                                     UnpackBudget& budget, const std::string& what) {
    ByteReader reader(member, what);
    const auto magic = reader.take(sizeof Magic);
    const auto element = reader.read<std::uint32_t>();
    const auto size = reader.read<std::uint64_t>();
    if (std::memcmp(magic.data(), Magic, sizeof Magic) != 0 || (element != 1 && element != WordBytes) ||
        size % element != 0)
        throw_damaged(what, "does not begin as it should");
    if (expected != AnySize && size != expected)
        throw_damaged(what, fmt::format("has {} bytes where {} are due", size, expected).c_str());
    if (expected == AnySize) budget.spend(size, what);
    else budget.spend_known(size, what);
    std::vector<std::byte> bytes = decompress_zstd(reader.take(reader.remaining()), size);
    if (element == 1) return bytes;
    std::vector<std::byte> turned(bytes.size());
    transpose_back(bytes.data(), turned.data(), bytes.size() / WordBytes);
    return turned;
}

std::string encode_delta(const SceneDelta& delta) {
    std::string out;
    out.reserve(delta.byte_size() + 32);
    append_value(out, static_cast<std::uint64_t>(delta.changed.size()));
    append_value(out, static_cast<std::uint64_t>(delta.removed.size()));
    append_value(out, static_cast<std::uint64_t>(delta.added.size()));
    append_value(out, static_cast<std::uint32_t>(delta.changed_rows.sh_degree));
    append_value(out, static_cast<std::uint32_t>(delta.added_rows.sh_degree));
    append_array(out, std::span<const RowId>(delta.changed));
    append_array(out, std::span<const RowId>(delta.removed));
    append_array(out, std::span<const RowId>(delta.added));
    append_rows(out, spans(delta.changed_rows));
    append_rows(out, spans(delta.added_rows));
    return out;
}

SceneDelta decode_delta(std::span<const std::byte> bytes, std::uint64_t edit_id, const std::string& what) {
    ByteReader reader(bytes, what);
    const auto changed = reader.read<std::uint64_t>();
    const auto removed = reader.read<std::uint64_t>();
    const auto added = reader.read<std::uint64_t>();
    const int changed_degree = read_degree(reader, what);
    const int added_degree = read_degree(reader, what);
    SceneDelta delta;
    delta.changed = read_array<RowId>(reader, changed);
    delta.removed = read_array<RowId>(reader, removed);
    delta.added = read_array<RowId>(reader, added);
    check_ascending(delta.changed, what);
    check_ascending(delta.removed, what);
    check_ascending(delta.added, what);
    for (const RowId id : delta.added)
        if (id >> EditShift != edit_id) throw_damaged(what, "adds splats of another edit");
    delta.changed_rows = read_rows(reader, changed, changed_degree);
    delta.added_rows = read_rows(reader, added, added_degree);
    if (reader.remaining() != 0) throw_damaged(what, "is longer than it says");
    return delta;
}

std::string encode_set(const GaussianSet& set) {
    std::string out;
    out.reserve(set.byte_size() + 16);
    append_value(out, static_cast<std::uint64_t>(set.size()));
    append_value(out, static_cast<std::uint32_t>(set.sh_degree()));
    append_value(out, std::uint32_t{0});
    append_rows(out, set.spans());
    return out;
}

GaussianData decode_set(std::span<const std::byte> bytes, const std::string& what) {
    ByteReader reader(bytes, what);
    const auto count = reader.read<std::uint64_t>();
    const int degree = read_degree(reader, what);
    reader.skip(sizeof(std::uint32_t));
    GaussianData data = read_rows(reader, count, degree);
    if (reader.remaining() != 0) throw_damaged(what, "is longer than it says");
    return data;
}

std::string encode_absent(const AbsentRows& rows) {
    std::string out;
    append_value(out, static_cast<std::uint64_t>(rows.ids.size()));
    append_array(out, std::span<const RowId>(rows.ids));
    append_array(out, std::span<const float>(rows.weight));
    append_array(out, std::span<const std::int8_t>(rows.manual));
    return out;
}

AbsentRows decode_absent(std::span<const std::byte> bytes, const std::string& what) {
    ByteReader reader(bytes, what);
    const auto count = reader.read<std::uint64_t>();
    AbsentRows rows;
    rows.ids = read_array<RowId>(reader, count);
    rows.weight = read_array<float>(reader, count);
    rows.manual = read_array<std::int8_t>(reader, count);
    if (reader.remaining() != 0) throw_damaged(what, "is longer than it says");
    check_ascending(rows.ids, what);
    return rows;
}

std::string encode_bits(std::span<const std::uint8_t> values) {
    std::string out((values.size() + 7) / 8, '\0');
    for (std::size_t i = 0; i < values.size(); ++i)
        if (values[i] != 0)
            out[i / 8] = static_cast<char>(static_cast<unsigned char>(out[i / 8]) | (1u << (i % 8)));
    return out;
}

std::vector<std::uint8_t> decode_bits(std::span<const std::byte> bytes, std::size_t count,
                                      const std::string& what) {
    if (bytes.size() != (count + 7) / 8) throw_damaged(what, "has the wrong number of splats");
    std::vector<std::uint8_t> values(count);
    for (std::size_t i = 0; i < count; ++i)
        values[i] = (std::to_integer<unsigned>(bytes[i / 8]) >> (i % 8)) & 1u;
    return values;
}

}  // namespace gse::io
