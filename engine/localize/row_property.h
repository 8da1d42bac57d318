// Rows by a property: faint, large, of one colour, far from all others. Every property is a value in [0,1]
// per row, so that one slider over one histogram serves all.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "engine/base/thread_pool.h"
#include "engine/scene/gaussian_set.h"

namespace gse::localize {

enum class RowProperty : std::uint8_t {
    Opacity,  // as it is
    Size,  // of the largest standard deviation, as a share of the scene's extent (diagonal of its 2nd to 98th
           // percentiles)
    Colour,    // how far the base colour is from a picked one: CIE 1976 colour difference (L*a*b*, D65)
    Isolation  // mean distance to the 8 nearest rows, over the median of all rows (statistical outlier
               // removal, Rusu et al. 2008)
};

/// Ends of the scales of sizes, colour differences and isolation: beyond it values are 1. Sizes and isolation
/// are on a logarithmic scale.
constexpr double LeastSize = 1e-4, MostSize = 1, MostDifference = 100, LeastIsolation = 0.25,
                 MostIsolation = 64;

/// Values [N] in [0,1]; NaN for rows whose values are not finite (they are never chosen). `colour` is sRGB in
/// [0,1], for Colour alone. Isolation takes time (a k-d tree over all rows). `threads` may be null.
std::vector<float> row_values(const GaussianSet& set, RowProperty property,
                              const std::array<float, 3>& colour, ThreadPool* threads);

/// Mean base colour of the rows whose byte is set, sRGB in [0,1]. Mid grey if there is none.
std::array<float, 3> mean_colour(const GaussianSet& set, std::span<const std::uint8_t> rows);

/// Amount that a value in [0,1] stands for: opacity, share of the extent, colour difference, or times the
/// usual distance.
double property_amount(RowProperty property, double value);
/// The value of an amount, clamped to [0,1].
double property_value(RowProperty property, double amount);

/// Byte per row [N]: 1 if least <= value <= most. `within` (a byte per row, or empty) limits it.
std::vector<std::uint8_t> rows_between(std::span<const float> values, float least, float most,
                                       std::span<const std::uint8_t> within = {});

/// Rows by one property, as an artist chooses them.
struct RowChoice {
    RowProperty property = RowProperty::Opacity;
    std::array<float, 3> colour{0.5f, 0.5f, 0.5f};  // sRGB in [0,1], for Colour alone
    float threshold = 0.1f;                         // value in [0,1], see property_amount()
    bool above = false;                             // what is more, else what is less
    bool within_label = false;                      // of the active label only

    bool operator==(const RowChoice&) const = default;
};

/// Byte per row [N]: 1 for chosen rows. `values` are those of the choice's property.
std::vector<std::uint8_t> chosen_rows(const RowChoice& choice, std::span<const float> values,
                                      std::span<const std::uint8_t> within);

/// Choice in words: "opacity below 0.10", "size above 3.2 %", "colour within 12", "above 4.0 times the usual
/// distance".
std::string choice_text(const RowChoice& choice);

}  // namespace gse::localize
