// Quantisers of the scene writers: few values, or vectors, that stand for many.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/thread_pool.h"

namespace gse::io {

inline constexpr std::size_t CodebookSize = 256;

/// 256 values, ascending. A byte names one.
struct Codebook {
    std::array<float, CodebookSize> values{};

    /// Byte of the nearest value. Of two that are equally near, the lower one.
    std::uint8_t nearest(float value) const;
};

/// Codebook of `values` (finite, in any order) by Lloyd's algorithm on all of them (Lloyd, "Least squares
/// quantization in PCM", 1982). It begins at the density to the power 1/3 (Panter and Dite, "Quantization
/// distortion in pulse-count modulation", 1951). Up to 256 different values are kept exactly. O(N log N),
/// deterministic.
Codebook fit_codebook(std::vector<float> values);

/// Vectors that lie in rows of a larger array. Row r begins at values[r * stride + offset].
struct VectorRows {
    std::span<const float> values;
    std::size_t stride = 0, offset = 0, dimension = 0, count = 0;

    const float* row(std::size_t index) const { return values.data() + index * stride + offset; }
};

/// Vectors that stand for others.
struct Palette {
    std::size_t dimension = 0;
    std::vector<float> entries;         // [E, dimension]; neighbours are alike
    std::vector<std::uint32_t> labels;  // [N] entry of each row

    std::size_t size() const { return dimension == 0 ? 0 : entries.size() / dimension; }
};

/// At most `most` vectors for the rows, by k-means of a tree. Rows are split into few clusters, and entries
/// are shared in proportion to the squared error. Splitting goes on until a cluster needs few entries. That
/// many rows or fewer are kept exactly. Independent of the number of threads. Takes 12 bytes per row beside
/// the result.
Palette fit_palette(const VectorRows& rows, std::size_t most, ThreadPool& pool);

}  // namespace gse::io
