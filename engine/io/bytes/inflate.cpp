// zlib and zstd behind a few calls.
#include "engine/io/bytes/inflate.h"

#include <fmt/core.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <limits>
#include <memory>

#include "engine/base/check.h"
#include "engine/base/error.h"
#include "engine/base/memory.h"
#include "engine/io/bytes/byte_reader.h"
#include "engine/io/bytes/claims.h"

namespace gse::io {
namespace {

constexpr std::size_t GrowthBytes = std::size_t{1} << 20;  // at least; then by half of what is there
constexpr int GzipWindow = 15 + 16;                        // largest window, gzip wrapping
constexpr int ZstdLevel = 12;          // seconds for a million splats; higher ones gain little
constexpr uInt InputPiece = 1u << 30;  // zlib counts input in 32 bits

std::size_t next_size(std::size_t filled, std::uint64_t limit) {
    const std::size_t grown = filled + std::max(GrowthBytes, filled / 2);
    return static_cast<std::size_t>(std::min<std::uint64_t>(grown, limit));
}

[[noreturn]] void throw_broken(const char* kind) {
    throw Error(ErrorCode::Malformed, fmt::format("the {} stream inside the file is broken", kind),
                "the file is cut off or damaged; get it again");
}

/// Gzip members one after the other, unpacked a piece at a time. Bytes behind the last one that begin no
/// member are passed over.
class GzipStream {
public:
    explicit GzipStream(std::span<const std::byte> bytes) : bytes_(bytes) {
        GSE_CHECK(inflateInit2(&stream_, GzipWindow) == Z_OK);
    }
    ~GzipStream() { inflateEnd(&stream_); }
    GzipStream(const GzipStream&) = delete;
    GzipStream& operator=(const GzipStream&) = delete;

    /// Fills the start of `target`; returns how many bytes. 0 is the end.
    std::size_t read(std::span<std::byte> target) {
        std::size_t filled = 0;
        while (filled == 0 && !done_ && !target.empty()) filled = step(target);
        return filled;
    }
    /// True when the stream ends with the end of a member.
    bool whole() const { return whole_; }

private:
    std::size_t step(std::span<std::byte> target) {
        const auto piece = static_cast<uInt>(std::min<std::size_t>(bytes_.size() - consumed_, InputPiece));
        const auto room = static_cast<uInt>(std::min<std::size_t>(target.size(), InputPiece));
        stream_.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(bytes_.data() + consumed_));
        stream_.avail_in = piece;
        stream_.next_out = reinterpret_cast<Bytef*>(target.data());
        stream_.avail_out = room;
        const int status = inflate(&stream_, Z_NO_FLUSH);
        consumed_ += piece - stream_.avail_in;
        const std::size_t got = room - stream_.avail_out;
        in_member_ += got;
        if (status == Z_STREAM_END) end_member();
        else if (status == Z_BUF_ERROR) done_ = true;  // no more input
        else if (status != Z_OK && (members_ == 0 || in_member_ > 0)) throw_broken("gzip");
        else if (status != Z_OK) done_ = whole_ = true;  // no member begins there
        return got;
    }
    void end_member() {
        ++members_;
        in_member_ = 0;
        whole_ = !is_gzip(bytes_.subspan(consumed_));
        if (whole_) done_ = true;
        else inflateReset(&stream_);
    }

    z_stream stream_{};
    std::span<const std::byte> bytes_;
    std::size_t consumed_ = 0, members_ = 0, in_member_ = 0;  // the last in unpacked bytes
    bool done_ = false, whole_ = false;
};

/// Bytes that the whole gzip stream gives, or `limit` when there are as many or more. Keeps none of them.
std::uint64_t count_gzip(std::span<const std::byte> bytes, std::uint64_t limit) {
    GzipStream stream(bytes);
    std::vector<std::byte> piece(GrowthBytes);
    std::uint64_t count = 0;
    while (count < limit) {
        const std::size_t got = stream.read(piece);
        count += got;
        if (got > 0) continue;
        if (stream.whole()) break;
        throw Error(ErrorCode::Malformed, "the gzip stream inside the file is cut off", "get the file again");
    }
    return std::min(count, limit);
}

}  // namespace

bool is_gzip(std::span<const std::byte> bytes) {
    return bytes.size() >= 2 && bytes[0] == std::byte{0x1f} && bytes[1] == std::byte{0x8b};
}

std::vector<std::byte> inflate_gzip(std::span<const std::byte> bytes, std::uint64_t limit) {
    GzipStream stream(bytes);
    std::vector<std::byte> out;
    std::size_t filled = 0;
    while (filled < limit) {
        if (filled == out.size()) out.resize(next_size(filled, limit));
        const std::size_t got = stream.read(std::span(out).subspan(filled));
        if (got == 0) break;
        filled += got;
    }
    out.resize(filled);
    return out;
}

std::vector<std::byte> unpack_gzip(std::span<const std::byte> bytes, std::uint64_t file_bytes) {
    const std::string what = "the gzip stream inside the file";
    const std::uint64_t honest =
                            std::max(FreeClaim, saturating_product(file_bytes + 1, BytesPerFileByte)) + 1,
                        most = std::min(honest, free_memory());
    const std::uint64_t size = count_gzip(bytes, most);
    check_claim({size, file_bytes}, what);
    if (size == most) throw out_of_memory(size);
    std::vector<std::byte> out(static_cast<std::size_t>(size));
    GzipStream stream(bytes);
    for (std::size_t filled = 0; filled < out.size();) {
        const std::size_t got = stream.read(std::span(out).subspan(filled));
        GSE_CHECK(got > 0);
        filled += got;
    }
    return out;
}

std::vector<std::byte> decompress_zstd(std::span<const std::byte> bytes, std::uint64_t size) {
    const std::unique_ptr<ZSTD_DStream, std::size_t (*)(ZSTD_DStream*)> stream(ZSTD_createDStream(),
                                                                               ZSTD_freeDStream);
    GSE_CHECK(stream != nullptr);
    std::vector<std::byte> out;
    ZSTD_inBuffer input{bytes.data(), bytes.size(), 0};
    std::size_t filled = 0;
    while (filled < size) {
        if (filled == out.size()) out.resize(next_size(filled, size));
        ZSTD_outBuffer output{out.data(), out.size(), filled};
        const std::size_t status = ZSTD_decompressStream(stream.get(), &output, &input);
        if (ZSTD_isError(status)) throw_broken("zstd");
        const bool stalled = output.pos == filled && input.pos == input.size;
        filled = output.pos;
        if (stalled || (status == 0 && filled < size)) throw_broken("zstd");
    }
    return out;
}

std::string deflate_gzip(std::string_view bytes) {
    z_stream stream{};
    GSE_CHECK(deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, GzipWindow, 8, Z_DEFAULT_STRATEGY) ==
              Z_OK);
    const std::unique_ptr<z_stream, int (*)(z_stream*)> guard(&stream, deflateEnd);
    std::string out;
    std::string piece(GrowthBytes, '\0');
    std::size_t consumed = 0;
    int status = Z_OK;
    while (status != Z_STREAM_END) {
        const auto input = static_cast<uInt>(std::min<std::size_t>(bytes.size() - consumed, InputPiece));
        stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data() + consumed));
        stream.avail_in = input;
        stream.next_out = reinterpret_cast<Bytef*>(piece.data());
        stream.avail_out = static_cast<uInt>(piece.size());
        status = deflate(&stream, consumed + input == bytes.size() ? Z_FINISH : Z_NO_FLUSH);
        GSE_CHECK(status == Z_OK || status == Z_STREAM_END || status == Z_BUF_ERROR);
        consumed += input - stream.avail_in;
        out.append(piece.data(), piece.size() - stream.avail_out);
    }
    return out;
}

std::string compress_zstd(std::string_view bytes) {
    std::string out(ZSTD_compressBound(bytes.size()), '\0');
    const std::size_t size = ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), ZstdLevel);
    GSE_CHECK(!ZSTD_isError(size));
    out.resize(size);
    return out;
}

}  // namespace gse::io
