// Arithmetic of sizes, and ranges of values, that tell shifted rows from sound ones.
#include "engine/io/formats/ply/ply_row_fit.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/base/error.h"
#include "engine/io/bytes/byte_reader.h"

namespace gse::io {
namespace {

// With fewer rows a rest that every one of them has the same share of is likely by chance.
constexpr std::uint64_t FewRows = 8;

constexpr float LargestRotation = 1e3f, SmallestRotation = 1e-3f, LargestLogScale = 50, LargestLogit = 1e4f,
                LargestPosition = 1e9f;
constexpr double MostOfAll = 0.9;

constexpr const char* HeaderHint =
    "its header lacks a column or gives one the wrong type; export the scene again";

/// Bytes of all rows that the header describes. Nothing where lists or text leave them open.
std::optional<std::uint64_t> described_bytes(const PlyHeader& header) {
    if (header.encoding == PlyEncoding::Ascii) return std::nullopt;
    std::uint64_t bytes = 0;
    for (const PlyElement& element : header.elements) {
        if (element.has_list()) return std::nullopt;
        bytes = saturating_sum(bytes, saturating_product(element.count, element.row_bytes()));
    }
    return bytes;
}

bool looks_like_splat(const GaussianSpans& set, std::size_t row) {
    float rotation = 0;
    for (std::size_t i = 0; i < 4; ++i) rotation = std::max(rotation, std::abs(set.rotation[row * 4 + i]));
    bool sound = rotation >= SmallestRotation && rotation <= LargestRotation &&
                 !(std::isfinite(set.opacity_logit[row]) && std::abs(set.opacity_logit[row]) > LargestLogit);
    for (std::size_t i = row * 3; i < row * 3 + 3; ++i) {
        const bool flat = set.log_scale[i] == -HUGE_VALF;
        sound = sound && (flat || std::abs(set.log_scale[i]) <= LargestLogScale) &&
                std::abs(set.position[i]) <= LargestPosition;
    }
    return sound;
}

}  // namespace

RowFit row_fit(const PlyHeader& header, const PlyElement& vertex, std::uint64_t body_bytes) {
    const auto described = described_bytes(header);
    if (!described || body_bytes <= *described || vertex.count == 0) return RowFit::Fits;
    const std::uint64_t rest = body_bytes - *described, stride = vertex.row_bytes();
    if (stride == 0 || rest % vertex.count != 0 || rest / vertex.count % stride == 0) return RowFit::Fits;
    return vertex.count < FewRows || rest % stride == 0 ? RowFit::MayBeLonger : RowFit::Longer;
}

void throw_longer_rows(const PlyHeader& header, const PlyElement& vertex, std::uint64_t body_bytes) {
    const std::uint64_t stride = vertex.row_bytes();
    const std::uint64_t rest = body_bytes - described_bytes(header).value_or(body_bytes);
    throw Error(ErrorCode::Malformed,
                fmt::format("the rows of this PLY file are longer than its header says: {} rows of {} bytes "
                            "are announced, and the file has {} bytes for each",
                            vertex.count, stride, stride + rest / vertex.count),
                HeaderHint);
}

void check_line_values(const PlyBody& body, const PlyElement& vertex) {
    const std::size_t rest = body.words_left();
    if (rest == 0 || rest % vertex.count != 0 || vertex.has_list() || body.lines_of_element() != vertex.count)
        return;
    const std::size_t values = vertex.properties.size();
    throw Error(ErrorCode::Malformed,
                fmt::format("the rows of this PLY file are longer than its header says: {} rows of {} values "
                            "are announced, and the lines have {} each",
                            vertex.count, values, values + rest / vertex.count),
                HeaderHint);
}

bool look_like_splats(const GaussianSpans& set) {
    std::size_t sound = 0;
    for (std::size_t row = 0; row < set.size; ++row) sound += looks_like_splat(set, row) ? 1 : 0;
    return static_cast<double>(sound) >= MostOfAll * static_cast<double>(set.size);
}

}  // namespace gse::io
