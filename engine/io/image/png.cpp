// PNG chunks with zlib's checksum and compression.
#include "engine/io/image/png.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "engine/base/check.h"

namespace gse::io {
namespace {

constexpr std::string_view Signature("\x89PNG\r\n\x1a\n", 8);
constexpr std::size_t LongestKeyword = 79;

void append_big_endian(std::string& out, std::uint32_t value) {
    for (int shift = 24; shift >= 0; shift -= 8) out += static_cast<char>(value >> shift);
}

std::uint32_t big_endian(const std::byte* source, int bytes) {
    std::uint32_t value = 0;
    for (int i = 0; i < bytes; ++i) value = (value << 8) | std::to_integer<std::uint32_t>(source[i]);
    return value;
}

void append_chunk(std::string& out, std::string_view type, std::string_view content) {
    append_big_endian(out, static_cast<std::uint32_t>(content.size()));
    const std::size_t begin = out.size();
    out += type;
    out += content;
    const auto* bytes = reinterpret_cast<const Bytef*>(out.data() + begin);
    append_big_endian(out,
                      static_cast<std::uint32_t>(crc32(0, bytes, static_cast<uInt>(out.size() - begin))));
}

/// Keyword and text as a PNG chunk: tEXt for ASCII, iTXt for the rest of UTF-8.
void append_text(std::string& out, const std::string& keyword, const std::string& text) {
    std::string content = keyword.substr(0, LongestKeyword);
    content.push_back(0);
    const bool ascii =
        std::all_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 128; });
    if (!ascii)
        content += std::string(4, '\0');  // uncompressed, method 0, no language, no translated keyword
    append_chunk(out, ascii ? "tEXt" : "iTXt", content + text);
}

int paeth(int left, int up, int corner) {
    const int guess = left + up - corner;
    const int by_left = std::abs(guess - left), by_up = std::abs(guess - up),
              by_corner = std::abs(guess - corner);
    if (by_left <= by_up && by_left <= by_corner) return left;
    return by_up <= by_corner ? up : corner;
}

using Row = std::vector<std::uint8_t>;

/// Sum of the bytes' distances from zero, read as signed numbers: the usual guess for the best compression.
std::size_t cost_of(const Row& row) {
    std::size_t sum = 0;
    for (const auto byte : row) sum += static_cast<std::size_t>(byte < 128 ? byte : 256 - byte);
    return sum;
}

/// Chooses for every row the filter, of the five, whose bytes have the least sum of absolute values (PNG
/// specification 12.8).
class RowFilter {
public:
    RowFilter(std::size_t row_bytes, std::size_t step) : step_(step), zeros_(row_bytes, 0) {
        candidates_.fill(Row(row_bytes));
    }

    /// Appends the filter's number and the filtered row. `above` is null for the first.
    void append(std::string& out, const std::uint8_t* row, const std::uint8_t* above) {
        filter(row, above != nullptr ? above : zeros_.data());
        std::size_t best = 0, least = cost_of(candidates_[0]);
        for (std::size_t i = 1; i < candidates_.size(); ++i)
            if (const auto cost = cost_of(candidates_[i]); cost < least) best = i, least = cost;
        out += static_cast<char>(best);
        out.append(reinterpret_cast<const char*>(candidates_[best].data()), candidates_[best].size());
    }

private:
    /// Fills the candidates of the five filters: none, sub, up, average, Paeth.
    void filter(const std::uint8_t* row, const std::uint8_t* above) {
        const std::size_t size = zeros_.size(), first = std::min(step_, size);
        auto& [none, sub, up, average, paeth_row] = candidates_;
        std::copy(row, row + size, none.begin());
        for (std::size_t i = 0; i < size; ++i) up[i] = static_cast<std::uint8_t>(row[i] - above[i]);
        for (std::size_t i = 0; i < first; ++i) {  // nothing to the left
            sub[i] = row[i];
            average[i] = static_cast<std::uint8_t>(row[i] - above[i] / 2);
            paeth_row[i] = up[i];
        }
        for (std::size_t i = first; i < size; ++i)
            sub[i] = static_cast<std::uint8_t>(row[i] - row[i - step_]);
        for (std::size_t i = first; i < size; ++i)
            average[i] = static_cast<std::uint8_t>(row[i] - (row[i - step_] + above[i]) / 2);
        for (std::size_t i = first; i < size; ++i)
            paeth_row[i] =
                static_cast<std::uint8_t>(row[i] - paeth(row[i - step_], above[i], above[i - step_]));
    }

    std::size_t step_;
    Row zeros_;
    std::array<Row, 5> candidates_;
};

std::string compressed_pixels(const BytePixels& pixels) {
    const auto step = static_cast<std::size_t>(pixels.channels);
    const std::size_t row_bytes = static_cast<std::size_t>(pixels.width) * step;
    RowFilter filter(row_bytes, step);
    std::string filtered;
    filtered.reserve((row_bytes + 1) * static_cast<std::size_t>(pixels.height));
    for (std::size_t y = 0; y < static_cast<std::size_t>(pixels.height); ++y) {
        const std::uint8_t* row = pixels.data.data() + y * row_bytes;
        filter.append(filtered, row, y > 0 ? row - row_bytes : nullptr);
    }
    uLongf size = compressBound(static_cast<uLong>(filtered.size()));
    std::string out(size, '\0');
    const int status = compress2(reinterpret_cast<Bytef*>(out.data()), &size,
                                 reinterpret_cast<const Bytef*>(filtered.data()),
                                 static_cast<uLong>(filtered.size()), Z_DEFAULT_COMPRESSION);
    GSE_CHECK_EQ(status, Z_OK);
    out.resize(size);
    return out;
}

/// Content after the keyword of a tEXt or an uncompressed iTXt chunk.
void read_text_chunk(std::string_view type, std::string_view content, PngText& text) {
    const std::size_t end = content.find('\0');
    if (end == std::string_view::npos) return;
    const std::string keyword(content.substr(0, end));
    content.remove_prefix(end + 1);
    if (type == "iTXt") {
        if (content.size() < 2 || content[0] != 0) return;
        content.remove_prefix(2);
        for (int i = 0; i < 2; ++i) {
            const std::size_t stop = content.find('\0');
            if (stop == std::string_view::npos) return;
            content.remove_prefix(stop + 1);
        }
    }
    text[keyword] = std::string(content);
}

/// Size in the first start-of-frame segment of a JPEG.
std::optional<ImageSize> jpeg_size(std::span<const std::byte> bytes) {
    std::size_t offset = 2;
    while (offset + 9 <= bytes.size() && bytes[offset] == std::byte{0xff}) {
        const auto marker = std::to_integer<unsigned>(bytes[offset + 1]);
        const bool frame =
            marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
        if (frame)
            return ImageSize{static_cast<int>(big_endian(&bytes[offset + 7], 2)),
                             static_cast<int>(big_endian(&bytes[offset + 5], 2))};
        offset += 2 + big_endian(&bytes[offset + 2], 2);
    }
    return std::nullopt;
}

}  // namespace

std::string encode_png(const BytePixels& pixels, const PngText& text) {
    GSE_CHECK(pixels.width > 0 && pixels.height > 0);
    std::string header;
    append_big_endian(header, static_cast<std::uint32_t>(pixels.width));
    append_big_endian(header, static_cast<std::uint32_t>(pixels.height));
    header += static_cast<char>(8);  // bits
    header += static_cast<char>(pixels.channels == 1 ? 0 : pixels.channels == 3 ? 2 : 6);
    header += std::string(3, '\0');  // deflate, adaptive filters, not interlaced
    std::string out(Signature);
    append_chunk(out, "IHDR", header);
    append_chunk(out, "sRGB", std::string(1, '\0'));
    for (const auto& [keyword, value] : text) append_text(out, keyword, value);
    append_chunk(out, "IDAT", compressed_pixels(pixels));
    append_chunk(out, "IEND", "");
    return out;
}

PngText parse_png_text(std::span<const std::byte> bytes) {
    PngText text;
    std::size_t offset = Signature.size();
    while (offset + 12 <= bytes.size()) {
        const std::size_t size = big_endian(&bytes[offset], 4);
        if (size > bytes.size() - offset - 12) break;
        const auto* begin = reinterpret_cast<const char*>(&bytes[offset + 4]);
        const std::string_view type(begin, 4);
        if (type == "tEXt" || type == "iTXt") read_text_chunk(type, {begin + 4, size}, text);
        offset += 12 + size;
    }
    return text;
}

std::optional<ImageSize> parse_image_size(std::span<const std::byte> bytes) {
    if (bytes.size() >= 24 && std::memcmp(bytes.data(), Signature.data(), Signature.size()) == 0)
        return ImageSize{static_cast<int>(big_endian(&bytes[16], 4) & 0x7fffffff),
                         static_cast<int>(big_endian(&bytes[20], 4) & 0x7fffffff)};
    if (bytes.size() >= 4 && bytes[0] == std::byte{0xff} && bytes[1] == std::byte{0xd8})
        return jpeg_size(bytes);
    return std::nullopt;
}

}  // namespace gse::io
