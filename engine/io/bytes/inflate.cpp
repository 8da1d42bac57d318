// zlib and zstd behind four calls.
#include "engine/io/bytes/inflate.h"

#include <fmt/core.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <limits>
#include <memory>

#include "engine/base/check.h"
#include "engine/base/error.h"

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

}  // namespace

std::vector<std::byte> inflate_gzip(std::span<const std::byte> bytes, std::uint64_t limit) {
    z_stream stream{};
    GSE_CHECK(inflateInit2(&stream, GzipWindow) == Z_OK);
    const std::unique_ptr<z_stream, int (*)(z_stream*)> guard(&stream, inflateEnd);
    std::vector<std::byte> out;
    std::size_t filled = 0, consumed = 0;
    while (filled < limit) {
        if (filled == out.size()) out.resize(next_size(filled, limit));
        const auto piece = static_cast<uInt>(std::min<std::size_t>(bytes.size() - consumed, InputPiece));
        const auto room = static_cast<uInt>(std::min<std::size_t>(out.size() - filled, InputPiece));
        stream.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(bytes.data() + consumed));
        stream.avail_in = piece;
        stream.next_out = reinterpret_cast<Bytef*>(out.data() + filled);
        stream.avail_out = room;
        const int status = inflate(&stream, Z_NO_FLUSH);
        consumed += piece - stream.avail_in;
        filled += room - stream.avail_out;
        if (status == Z_STREAM_END || status == Z_BUF_ERROR) break;  // the latter: no more input
        if (status != Z_OK) throw_broken("gzip");
    }
    out.resize(filled);
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
