// Look-ups in the tensors of a header, under one of the prefixes that programs put before a model's names.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "engine/neural/api/files/weight_header.h"

namespace gse::neural {

/// The tensors whose names begin with a prefix, by the rest of their names.
class TensorNames {
public:
    TensorNames(const WeightHeader& header, std::string_view prefix) : header_(header), prefix_(prefix) {}

    bool has(std::string_view name) const { return find(name) != nullptr; }
    /// Size of a dimension; 0 where there is no such tensor or dimension.
    std::uint64_t size(std::string_view name, std::size_t dimension) const {
        const auto* tensor = find(name);
        return tensor != nullptr && dimension < tensor->shape.size() ? tensor->shape[dimension] : 0;
    }
    std::size_t dimensions(std::string_view name) const {
        const auto* tensor = find(name);
        return tensor != nullptr ? tensor->shape.size() : 0;
    }
    /// Tells whether any name begins so.
    bool begins(std::string_view name) const {
        const auto whole = prefix_ + std::string(name);
        const auto at = header_.tensors.lower_bound(whole);
        return at != header_.tensors.end() && at->first.starts_with(whole);
    }
    /// The first tensor whose name begins and ends so, or null.
    const HeaderTensor* first(std::string_view begin, std::string_view end) const {
        const auto whole = prefix_ + std::string(begin);
        for (auto at = header_.tensors.lower_bound(whole);
             at != header_.tensors.end() && at->first.starts_with(whole); ++at)
            if (at->first.ends_with(end)) return &at->second;
        return nullptr;
    }

private:
    const HeaderTensor* find(std::string_view name) const {
        const auto at = header_.tensors.find(prefix_ + std::string(name));
        return at != header_.tensors.end() ? &at->second : nullptr;
    }

    const WeightHeader& header_;
    std::string prefix_;
};

}  // namespace gse::neural
