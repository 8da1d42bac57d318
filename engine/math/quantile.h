// Order statistics of samples: single elements of the sorted order, found in linear time.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "engine/base/check.h"

namespace gse {

/// Element of that rank (0 = smallest) in ascending order. Reorders `values`; rank < values.size().
template <class T> T element_of_rank(std::vector<T>& values, std::size_t rank) {
    GSE_CHECK(rank < values.size());
    const auto place = values.begin() + static_cast<std::ptrdiff_t>(rank);
    std::nth_element(values.begin(), place, values.end());
    return *place;
}

/// Upper median: the element of rank n / 2. Reorders `values`, which must not be empty.
template <class T> T upper_median(std::vector<T>& values) {
    return element_of_rank(values, values.size() / 2);
}

/// Quantile by nearest rank: the element of rank share (n - 1), rounded. `share` lies in 0..1. Reorders
/// `values`, which must not be empty.
template <class T> T nearest_quantile(std::vector<T>& values, double share) {
    GSE_CHECK(!values.empty());
    return element_of_rank(
        values, static_cast<std::size_t>(std::lround(share * static_cast<double>(values.size() - 1))));
}

/// Quantile by lower rank: the element of rank share (n - 1), rounded down. As nearest_quantile otherwise.
template <class T> T lower_quantile(std::vector<T>& values, double share) {
    GSE_CHECK(!values.empty());
    return element_of_rank(values, static_cast<std::size_t>(share * static_cast<double>(values.size() - 1)));
}

}  // namespace gse
