// Lloyd's algorithm on sorted values, with prefix sums. Every pass is exact and costs 256 searches.
#include "engine/io/formats/sog/codebook.h"

#include <algorithm>
#include <cmath>

namespace gse::io {
namespace {

constexpr std::size_t FewestBins = CodebookSize, MostBins = 4096;  // of the density,
constexpr std::size_t ValuesPerBin = 64;  // each with so many that its cube root is not noise
constexpr int MostPasses = 100;           // most stop earlier; each takes microseconds

/// Border between two codes. Values belong to the nearer one.
float boundary(float low, float high) { return static_cast<float>(0.5 * (static_cast<double>(low) + high)); }

/// Codes spaced so that equal steps of the summed density^(1/3) lie between them.
void spread(const std::vector<float>& sorted, Codebook& codebook) {
    const double low = sorted.front(), extent = static_cast<double>(sorted.back()) - low;
    const std::size_t bin_count = std::clamp(sorted.size() / ValuesPerBin, FewestBins, MostBins);
    std::vector<double> bins(bin_count, 0.0);
    for (const float value : sorted) {
        const double unit = (static_cast<double>(value) - low) / extent;
        bins[std::min(bin_count - 1, static_cast<std::size_t>(unit * static_cast<double>(bin_count)))] += 1;
    }
    double total = 0;
    for (double& bin : bins) total += bin = std::cbrt(bin);
    std::size_t bin = 0;
    double before = 0;
    for (std::size_t i = 0; i < CodebookSize; ++i) {
        const double wanted = (static_cast<double>(i) + 0.5) / static_cast<double>(CodebookSize) * total;
        while (bin + 1 < bin_count && before + bins[bin] <= wanted) before += bins[bin++];
        const double inside = bins[bin] > 0 ? std::clamp((wanted - before) / bins[bin], 0.0, 1.0) : 0.5;
        codebook.values[i] = static_cast<float>(low + (static_cast<double>(bin) + inside) /
                                                          static_cast<double>(bin_count) * extent);
    }
}

/// Moves each code to the mean of its values. Returns false when nothing moved.
bool improve(const std::vector<float>& sorted, const std::vector<double>& sums, Codebook& codebook) {
    bool moved = false;
    std::size_t begin = 0;
    for (std::size_t i = 0; i < CodebookSize; ++i) {
        std::size_t end = sorted.size();
        if (i + 1 < CodebookSize)  // what is moved is behind the boundary: the next code is still the old one
            end = static_cast<std::size_t>(
                std::upper_bound(sorted.begin() + static_cast<std::ptrdiff_t>(begin), sorted.end(),
                                 boundary(codebook.values[i], codebook.values[i + 1])) -
                sorted.begin());
        if (end > begin) {
            const auto mean =
                static_cast<float>((sums[end] - sums[begin]) / static_cast<double>(end - begin));
            // Sums of many values are rounded.
            const float inside = std::clamp(mean, sorted[begin], sorted[end - 1]);
            moved |= inside != codebook.values[i];
            codebook.values[i] = inside;
        }
        begin = end;
    }
    return moved;
}

}  // namespace

std::uint8_t Codebook::nearest(float value) const {
    const auto above = std::lower_bound(values.begin(), values.end(), value);
    if (above == values.begin()) return 0;
    if (above == values.end()) return static_cast<std::uint8_t>(CodebookSize - 1);
    const auto index = static_cast<std::size_t>(above - values.begin());
    const double up = static_cast<double>(*above) - value,
                 down = static_cast<double>(value) - values[index - 1];
    return static_cast<std::uint8_t>(up < down ? index : index - 1);
}

Codebook fit_codebook(std::vector<float> values) {
    Codebook codebook;
    if (values.empty()) return codebook;
    std::sort(values.begin(), values.end());
    std::vector<float> different;
    std::unique_copy(values.begin(), values.end(), std::back_inserter(different));
    if (different.size() <= CodebookSize) {
        codebook.values.fill(different.back());
        std::copy(different.begin(), different.end(), codebook.values.begin());
        return codebook;
    }
    different = {};
    std::vector<double> sums(values.size() + 1, 0.0);
    for (std::size_t i = 0; i < values.size(); ++i) sums[i + 1] = sums[i] + values[i];
    spread(values, codebook);
    for (int pass = 0; pass < MostPasses && improve(values, sums, codebook); ++pass) {}
    return codebook;
}

}  // namespace gse::io
